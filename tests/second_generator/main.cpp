// Test recordings with hidden physics for `sealwatch explain`, from code that shares nothing with it.
//
//   second_generator --stratum NAME --seed N --out DIR [--truth-only] [--noise F] [--tolerance F] [--sensor-tolerance F]

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <stdexcept>

#include "tests/second_generator/bench.hpp"

namespace second_generator {

struct Options {
  std::string stratum;
  int seed = -1;
  std::filesystem::path out;
  bool truth_only = false;
  double noise = 1.0;               // factor of the sensors' noise
  double tolerance = 0.005;         // half width of what the datasheet leaves open, as a share
  double sensor_tolerance = 0.005;  // the same of the sensors' gains and offsets
};

static Options parse(int count, char** words) {
  Options options;
  for (int k = 1; k < count; ++k) {
    const std::string key = words[k];
    if (key == "--truth-only") {
      options.truth_only = true;
      continue;
    }
    if (k + 1 == count) throw std::invalid_argument(key + ": its value is missing");
    const std::string value = words[++k];
    if (key == "--stratum")
      options.stratum = value;
    else if (key == "--seed")
      options.seed = std::stoi(value);
    else if (key == "--out")
      options.out = value;
    else if (key == "--noise")
      options.noise = std::stod(value);
    else if (key == "--tolerance")
      options.tolerance = std::stod(value);
    else if (key == "--sensor-tolerance")
      options.sensor_tolerance = std::stod(value);
    else
      throw std::invalid_argument("no option " + key);
  }
  if (options.stratum.empty() || options.seed < 0 || options.out.empty())
    throw std::invalid_argument("give --stratum NAME --seed N --out DIR");
  return options;
}

static void write(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file(path);
  file << text;
  if (!file.flush()) throw std::runtime_error(path.string() + ": cannot be written");
}

template <typename... Numbers>
static std::string print(const char* format, Numbers... numbers) {
  char text[200];
  std::snprintf(text, sizeof text, format, numbers...);
  return text;
}

// The datasheet: what is estimated, from its nominal value; all else has its default.
static std::string datasheet(const Set& set) {
  std::string text = "asset_id: SECOND-" + set.stratum + "-" + std::to_string(set.seed) + "\nmodel: eha\nparameters:\n";
  for (const auto& p : kParameters)
    if (p.free)
      text += print("  %s: {value: %.6g, min: %.6g, max: %.6g, estimate: true}\n", p.name, p.nominal, 0.1 * p.nominal,
                    3.0 * p.nominal);
  return text;
}

static bool is_written(const Set& set, int channel) {
  if (!set.source_sensors) return true;
  return channel >= 4 || (!set.differential && channel >= 2);
}

static std::string csv(const Set& set, const Recording& r) {
  static const std::array<const char*, 7> formats = {",%.5f", ",%.4f", ",%.1f", ",%.1f", ",%.6e", ",%.8f", ",%.8f"};
  std::string text = "time[s]";
  if (!set.source_sensors) text += ",motor_voltage[V]";
  if (set.differential) text += ",pressure_differential[Pa]";
  for (int c = 0; c < 7; ++c)
    if (is_written(set, c)) text += std::string(",") + kChannels[c].name + "[" + kChannels[c].unit + "]";
  text += "\n";
  for (std::size_t k = 0; k < r.time.size(); ++k) {
    text += print("%.6f", r.time[k] - r.time[0]);
    if (!set.source_sensors) text += print(",%.5f", r.voltage[k]);
    if (set.differential) text += print(",%.1f", r.samples[k][2] - r.samples[k][3]);
    for (int c = 0; c < 7; ++c)
      if (is_written(set, c)) text += print(formats[c], r.samples[k][c]);
    text += "\n";
  }
  return text;
}

static std::string sidecar(const Set& set, const Recording& r, int test, const std::string& name) {
  std::string text =
      "recording_id: " + name + "\nasset_id: SECOND-" + set.stratum + "-" + std::to_string(set.seed) + "\ntest: pst\n";
  // What changes between tests has a month to do so; all other tests are of one morning.
  text += set.stratum == "change" ? print("start_time: 2031-%02d-12T03:00:00Z\n", test + 1)
                                  : print("start_time: 2031-04-12T%02d:00:00Z\n", test + 3);
  if (r.hold && !set.source_sensors) text += "interpolation: hold\n";
  if (!r.noise_known) return text;
  std::string noise;
  for (int c = 0; c < 7; ++c)
    if (is_written(set, c)) noise += print("%s%s: %.5g", noise.empty() ? "" : ", ", kChannels[c].name, r.noise[c]);
  if (set.differential) noise += print(", pressure_differential: %.5g", std::hypot(r.noise[2], r.noise[3]));
  return text + "noise_std: {" + noise + "}\n";
}

static void generate(const Options& options) {
  const Set set = draw_set(options.stratum, options.seed, options.tolerance, options.sensor_tolerance);
  std::filesystem::create_directories(options.out);
  write(options.out / "truth.json", truth(set));
  if (options.truth_only) return;
  write(options.out / "asset.yaml", datasheet(set));
  for (int test = 0; test < kTests; ++test) {
    const std::string name =
        test < kFitted ? "fit_" + std::to_string(test + 1) : "holdout_" + std::to_string(test - kFitted + 1);
    const Recording recording = record(set, test, options.noise);
    write(options.out / (name + ".csv"), csv(set, recording));
    write(options.out / (name + ".yaml"), sidecar(set, recording, test, name));
  }
}

}  // namespace second_generator

int main(int count, char** words) {
  try {
    second_generator::generate(second_generator::parse(count, words));
  } catch (const std::invalid_argument& error) {
    std::cerr << "second_generator: " << error.what() << "\n";
    return 2;
  } catch (const std::exception& error) {
    std::cerr << "second_generator: " << error.what() << "\n";
    return 3;
  }
  return 0;
}
