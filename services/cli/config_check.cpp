// `sealwatch config check`: the whole configuration, every fault with file and line.
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "services/cli/commands.hpp"
#include "services/common/runtime/configuration_loader.hpp"
#include "services/common/store/journal.hpp"
#include "services/common/transport/dds_bus.hpp"

namespace sealwatch::cli {
namespace {

namespace fs = std::filesystem;

/// The state directory is made by whoever starts the services: what is needed is a place that may be written.
Status check_state_directory(const std::string& directory) {
  fs::path place = fs::absolute(directory);
  std::error_code none;
  while (!fs::exists(place, none) && place.has_relative_path()) place = place.parent_path();
  if (fs::is_directory(place, none) && ::access(place.c_str(), W_OK) == 0) return {};
  return fail(Error{.file = {},
                    .place = "key state_directory",
                    .value = directory,
                    .rule = "cannot be made or written by this user: " + place.string() + " is in the way",
                    .advice = "name another, or check as the user that the services run as"});
}

/// What a file may say and the machine may refuse.
std::vector<Error> check_surroundings(const std::string& file, const Configuration& configuration) {
  std::vector<Error> errors;
  const auto check = [&](Status status, const std::string& place) {
    if (status) return;
    Error error = status.error();
    error.file = file;
    if (!place.empty()) error.place = place;
    errors.push_back(std::move(error));
  };
  check(check_dds_settings(configuration.cyclonedds_uri), {});
  check(check_state_directory(configuration.state_directory), {});
  for (const auto& [service, config] : configuration.services) {
    const bool by_default =
        config.journal == "sqlite3://" + (fs::path(configuration.state_directory) / (service + ".db")).string();
    if (!by_default) check(Journal::check(config.journal), "key services." + service + ".journal");
  }
  return errors;
}

Checked<Configuration> load_and_check(const std::string& file) {
  auto configuration = load_configuration(file);
  if (!configuration) return configuration;
  std::vector<Error> errors = check_surroundings(file, *configuration);
  if (!errors.empty()) return tl::unexpected(std::move(errors));
  return configuration;
}

}  // namespace

int run_config_check(const ConfigCheckOptions& options) {
  const auto configuration = load_and_check(options.config);
  if (options.json) {
    nlohmann::ordered_json result = {{"schema", "sealwatch.config_check/1"},
                                     {"config", options.config},
                                     {"valid", configuration.has_value()},
                                     {"errors", nlohmann::ordered_json::array()}};
    if (!configuration)
      for (const Error& error : configuration.error())
        result["errors"].push_back({{"file", error.file},
                                    {"place", error.place},
                                    {"value", error.value},
                                    {"rule", error.rule},
                                    {"advice", error.advice}});
    std::printf("%s\n", result.dump(1).c_str());
  } else if (configuration) {
    std::printf("%s: valid: %zu assets, %zu sites, DDS domain %d, state in %s\n", options.config.c_str(),
                configuration->assets.size(), configuration->sites.size(), configuration->domain,
                configuration->state_directory.c_str());
    if (configuration->assets.empty())
      std::printf("no asset is configured, so nothing will be watched: put one file for each actuator into assets/\n");
  } else {
    for (const Error& error : configuration.error()) std::fprintf(stderr, "%s\n", error.describe().c_str());
    std::fprintf(stderr, "%zu fault%s found\n", configuration.error().size(),
                 configuration.error().size() == 1 ? "" : "s");
  }
  return configuration ? kOk : kBadInput;
}

}  // namespace sealwatch::cli
