// figures PLAIN.csv HIDDEN.csv REPORT.html FORECAST.html OUT: writes the documentation's pictures into OUT (docs/figures.sh).
#include <cstdio>
#include <exception>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>

#include "services/common/recording/recording_file.hpp"
#include "tests/figures/figures.hpp"

namespace sealwatch::figures {
namespace {

std::string text_of(const std::string& file) {
  std::ifstream stream(file);
  if (!stream) throw std::runtime_error(file + " cannot be read");
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

Recording recorded(const std::string& file) {
  const auto plant = find_plant("eha");
  if (!plant) throw std::runtime_error(plant.error().describe());
  auto recording = read_recording(file, **plant);
  if (!recording) throw std::runtime_error(recording.error().describe());
  return std::move(*recording);
}

void write_all(const std::string& plain_file, const std::string& hidden_file, const std::string& report_file,
               const std::string& forecast_file, const std::string& directory) {
  const Recording plain = recorded(plain_file);
  const Recording hidden = recorded(hidden_file);
  const std::string report = text_of(report_file);
  const std::map<std::string, std::string> pictures{{"actuator", actuator()},
                                                    {"layers", layers()},
                                                    {"pst", partial_stroke(plain)},
                                                    {"signature", valve_signature(hidden)},
                                                    {"concealed", concealed_effect(plain, hidden)},
                                                    {"report", first_screen(report)},
                                                    {"explain", before_and_after(report, "pressure A")},
                                                    {"forecast", forecast_screen(text_of(forecast_file))}};
  for (const auto& [name, svg] : pictures)
    if (!(std::ofstream(directory + "/" + name + ".svg") << svg))
      throw std::runtime_error(directory + " cannot be written");
}

}  // namespace
}  // namespace sealwatch::figures

int main(int argc, char** argv) try {
  if (argc != 6) {
    std::fputs("figures PLAIN.csv HIDDEN.csv REPORT.html FORECAST.html OUT\n", stderr);
    return 2;
  }
  sealwatch::figures::write_all(argv[1], argv[2], argv[3], argv[4], argv[5]);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "figures: %s\n", error.what());
  return 3;
}
