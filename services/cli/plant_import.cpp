// `sealwatch plant import`: a first plant file for an FMU.
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "sealwatch/core/visible_text.hpp"
#include "services/cli/commands.hpp"
#include "services/cli/session.hpp"
#include "services/common/fmi/import_fmu.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch::cli {
namespace {

namespace fs = std::filesystem;

/// How the plant file names the FMU: from its own folder, so that both can be moved together.
std::string path_from(const fs::path& file, const fs::path& fmu) {
  std::error_code error;
  const fs::path folder = fs::absolute(file).parent_path();
  const fs::path relative = fs::relative(fmu, folder, error);
  return error || relative.empty() ? fs::absolute(fmu).string() : relative.string();
}

/// A file that is there already may have been completed by hand: it is never written over.
Status write_new(const std::string& file, const std::string& text) {
  std::FILE* stream = std::fopen(file.c_str(), "wx");
  if (stream == nullptr)
    return fail(
        Error{.file = file,
              .place = {},
              .value = {},
              .rule = errno == EEXIST ? "is there already" : std::string("cannot be written: ") + std::strerror(errno),
              .advice = "give another name with --out"});
  const bool written = std::fwrite(text.data(), 1, text.size(), stream) == text.size();
  if (std::fclose(stream) == 0 && written) return {};
  return fail(Error{.file = file, .place = {}, .value = {}, .rule = "cannot be written completely", .advice = {}});
}

}  // namespace

int run_plant_import(const PlantImportOptions& options) {
  fmi::Settings settings;
  for (const std::string& setting : options.settings) {
    const std::size_t equals = setting.find('=');
    if (equals == std::string::npos || equals == 0)
      return complain(Error{.file = {},
                            .place = "--set",
                            .value = setting,
                            .rule = "must be NAME=VALUE",
                            .advice = "NAME is a parameter of the FMU"}),
             kBadInput;
    settings[setting.substr(0, equals)] = setting.substr(equals + 1);
  }
  fmi::Choice choice = fmi::Choice::model_exchange_first;
  if (!options.interface.empty())
    choice = options.interface == "cs" ? fmi::Choice::co_simulation : fmi::Choice::model_exchange;
  const auto fmu = fmi::FmuFile::open(options.fmu, settings, choice);
  if (!fmu) return complain(fmu.error()), kBadInput;
  const auto tell = [&](const std::string& words) {
    std::fprintf(stderr, "sealwatch: %s: %s\n", options.fmu.c_str(), visible(words, false).c_str());
  };
  const auto text = fmi::plant_file_of(**fmu, path_from(options.file, options.fmu), {.tell = tell});
  if (!text) return complain(text.error()), kBadInput;
  if (const Status written = write_new(options.file, *text); !written) return complain(written.error()), kBadInput;
  const fmi::ModelDescription& description = (*fmu)->description();
  std::printf("%s: %s, %s of %s%s\nComplete it, then: sealwatch plant check %s\n", options.file.c_str(),
              text::count_of((*fmu)->co_simulation() ? std::size_t{0} : description.states.size(), "state").c_str(),
              text::count_of(description.variables.size(), "variable").c_str(), description.model_name.c_str(),
              (*fmu)->co_simulation() ? " (Co-Simulation: no physics can be added to it)" : "", options.file.c_str());
  return kOk;
}

}  // namespace sealwatch::cli
