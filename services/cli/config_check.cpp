// `sealwatch config check`: the whole configuration, every fault with file and line.
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "sealwatch/core/visible_text.hpp"
#include "sealwatch/message/id_part.hpp"
#include "services/cli/commands.hpp"
#include "services/cli/folded_name.hpp"
#include "services/cli/terminal.hpp"
#include "services/common/runtime/configuration_loader.hpp"
#include "services/common/runtime/system_clock.hpp"
#include "services/common/store/journal.hpp"
#include "services/common/transport/dds_bus.hpp"

namespace sealwatch::cli {
namespace {

namespace fs = std::filesystem;

/// Whether something can be made there: permissions do not tell of /proc, or of a disk that is read-only.
bool may_be_written(const fs::path& directory) {
  std::string probe = (directory / ".sealwatch-XXXXXX").string();
  if (::mkdtemp(probe.data()) == nullptr) return false;
  ::rmdir(probe.c_str());
  return true;
}

/// The services make what is not there: what is needed is a place that may be written. A link that leads nowhere is
/// there.
Status check_directory(const std::string& directory) {
  fs::path place = fs::absolute(directory);
  std::error_code none;
  while (fs::symlink_status(place, none).type() == fs::file_type::not_found && place.has_relative_path())
    place = place.parent_path();
  if (fs::is_directory(place, none) && may_be_written(place)) return {};
  return fail(Error{.file = {},
                    .place = {},
                    .value = directory,
                    .rule = "cannot be made or written by this user: " + place.string() + " is in the way",
                    .advice = "name another, or check as the user that the services run as"});
}

/// What a file may say and the machine may refuse.
std::vector<Error> check_surroundings(const std::string& file, const Configuration& configuration) {
  std::vector<Error> errors;
  const auto check = [&](Status status, const std::string& key) {
    if (status) return;
    Error error = status.error();
    if (error.value.empty() && error.file != file) error.value = error.file;  // a journal's connection
    error.file = file;
    error.place = place_in_configuration(file, key);
    errors.push_back(std::move(error));
  };
  check(check_dds_settings(configuration.cyclonedds_uri), "cyclonedds_uri");
  check(check_directory(configuration.state_directory), "state_directory");
  if (!configuration.logging.directory.empty())
    check(check_directory(configuration.logging.directory), "logging.directory");
  for (const auto& [service, config] : configuration.services) {
    const bool by_default =
        config.journal == "sqlite3://" + (fs::path(configuration.state_directory) / (service + ".db")).string();
    if (!by_default) check(Journal::check(config.journal), "services." + service + ".journal");
    if (!config.recordings_directory.empty())
      check(check_directory(config.recordings_directory), "services." + service + ".recordings_directory");
  }
  return errors;
}

Checked<Configuration> load_and_check(const std::string& file) {
  auto configuration = load_configuration(file, {.now = SystemClock().now()});
  if (!configuration) return configuration;
  std::vector<Error> errors = check_surroundings(file, *configuration);
  if (!errors.empty()) return tl::unexpected(std::move(errors));
  return configuration;
}

/// Ids that people take for one another: the same but for capitals, or for how a letter with a mark is written.
void warn_of_alike(const std::string& what, const std::vector<std::string>& ids, std::vector<std::string>& warnings) {
  std::map<std::string, std::string> by_look;
  for (const std::string& id : ids)
    if (const auto [other, is_new] = by_look.emplace(folded_name(id), id); !is_new && other->second != id)
      warnings.push_back(what + " '" + id + "' differs from '" + other->second +
                         "' in capitals, or in how Unicode writes a letter, alone: people take one for the other; "
                         "give one of them another id");
}

/// What is allowed and yet leaves the others without work: a service of the chain that is disabled here. And assets that
/// are alike in the ids of their tests.
std::vector<std::string> warnings_of(const Configuration& configuration) {
  const auto is_enabled = [&](const std::string& service) { return configuration.services.at(service).enabled; };
  std::vector<std::string> warnings;
  const std::vector<std::string>& chain = service_names();
  for (auto service = chain.begin(); service != chain.end(); ++service)
    if (!is_enabled(*service) && std::any_of(service, chain.end(), is_enabled))
      warnings.push_back("services." + *service + " is disabled here: unless it runs on another machine of domain " +
                         std::to_string(configuration.domain) +
                         ", the services after it get nothing, and a replay waits for them in vain");
  std::map<std::string, std::string> asset_of_id_part;
  for (const AssetConfig& asset : configuration.assets)
    if (const auto [other, is_new] = asset_of_id_part.emplace(id_part(asset.asset_id), asset.asset_id); !is_new)
      warnings.push_back(alike_in_ids(asset.asset_id, other->second));
  std::vector<std::string> assets, sites;
  for (const AssetConfig& asset : configuration.assets) assets.push_back(asset.asset_id);
  for (const SiteConfig& site : configuration.sites) sites.push_back(site.site);
  warn_of_alike("asset", assets, warnings);
  warn_of_alike("site", sites, warnings);
  return warnings;
}

}  // namespace

int run_config_check(const ConfigCheckOptions& options) {
  const auto configuration = load_and_check(options.config);
  if (options.json) {
    nlohmann::ordered_json result = {{"schema", "sealwatch.config_check/1"},
                                     {"config", options.config},
                                     {"valid", configuration.has_value()},
                                     {"errors", nlohmann::ordered_json::array()}};
    if (configuration) result["warnings"] = warnings_of(*configuration);
    if (!configuration)
      for (const Error& error : configuration.error())
        result["errors"].push_back({{"file", error.file},
                                    {"place", error.place},
                                    {"value", error.value},
                                    {"rule", error.rule},
                                    {"advice", error.advice}});
    std::printf("%s\n", result.dump(1, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
  } else if (configuration) {
    std::printf("%s: valid: %s, %s, DDS domain %d, state in %s\n", options.config.c_str(),
                count_of(configuration->assets.size(), "asset").c_str(),
                count_of(configuration->sites.size(), "site").c_str(), configuration->domain,
                configuration->state_directory.c_str());
    for (const std::string& warning : warnings_of(*configuration)) std::printf("warning: %s\n", warning.c_str());
    if (configuration->assets.empty())
      std::printf("no asset is configured, so nothing will be watched: put one file for each actuator into assets/\n");
  } else {
    for (const Error& error : configuration.error()) std::fprintf(stderr, "%s\n", visible(error.describe()).c_str());
    std::fprintf(stderr, "%zu fault%s found\n", configuration.error().size(),
                 configuration.error().size() == 1 ? "" : "s");
  }
  return configuration ? kOk : kBadInput;
}

}  // namespace sealwatch::cli
