#include "services/common/runtime/configuration_loader.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <utility>

#include "sealwatch/core/text.hpp"
#include "sealwatch/message/topics.hpp"
#include "services/common/runtime/log.hpp"
#include "services/common/runtime/service_options.hpp"
#include "services/common/runtime/yaml_map.hpp"
#include "services/common/store/journal.hpp"

namespace sealwatch {
namespace {

namespace fs = std::filesystem;

/// DDS domains are limited by the port numbers they are mapped to.
constexpr NumberRule kDomain{.min = 0, .max = 232, .words = "must be a whole number from 0 to 232"};
constexpr NumberRule kFiles{.min = 1, .max = 1000, .words = "must be a whole number from 1 to 1000"};

constexpr NumberRule kDeadline{.min = 0.1, .max = 86400, .words = "must be a number of seconds from 0.1 to 86400"};
constexpr NumberRule kLeadTime{.min = 0, .max = 120, .words = "must be a number of months from 0 to 120"};
constexpr NumberRule kInterval{.min = 0.1, .max = 600, .words = "must be a number of months from 0.1 to 600"};
/// A valve with 1e-3 per hour fails every six weeks: a rate per 1e6 hours (OREDA) that was not divided.
constexpr NumberRule kRate{
    .min = 0, .max = 1e-3, .min_excluded = true, .words = "must be a rate per hour above 0, at most 1e-3"};

fs::path file_of(const std::string& path) {
  std::error_code none;
  return fs::is_directory(path, none) ? fs::path(path) / "sealwatch.yaml" : fs::path(path);
}

/// Whoever is told of a configuration that is not there learns where it was looked for, and how to name another.
Error not_there(const fs::path& file) {
  std::error_code none;  // of "", where a script's variable was empty
  return {.file = fs::absolute(file, none).lexically_normal().string(),
          .place = {},
          .value = {},
          .rule = "does not exist: no configuration",
          .advice =
              "give the folder that holds sealwatch.yaml (--config or SEALWATCH_CONFIG): /etc/sealwatch if installed, "
              "config in a checkout"};
}

template <class Enum>
std::vector<std::string> names_of() {
  return {EnumNames<Enum>::kNames.begin(), EnumNames<Enum>::kNames.end()};
}

void read_logging(YamlMap& root, LoggingConfig& logging) {
  auto map = root.map("logging");
  if (!map) return;
  map->read("level", logging.level, names_of<LogLevel>());
  map->read("directory", logging.directory);
  map->read("rotate_at_MB", logging.rotate_at_MB, kPositive);
  map->read("rotated_files", logging.rotated_files, kFiles);
  map->finish();
}

/// Of less than a day a test could still be running.
void read_retention(YamlMap& parent, const std::string& key, RetentionConfig& retention) {
  constexpr NumberRule kDays{.min = 1.0, .words = "must be 1 or more; leave it out to keep samples for ever"};
  constexpr NumberRule kMegabytes{.min = 10.0, .words = "must be 10 or more; leave it out for no bound"};
  auto map = parent.map(key);
  if (!map) return;
  map->read("days", retention.days, kDays);
  map->read("megabytes", retention.megabytes, kMegabytes);
  map->finish();
}

void read_services(YamlMap& root, Configuration& configuration) {
  for (const std::string& service : service_names()) configuration.services[service];
  auto services = root.map("services");
  if (!services) return;
  for (const std::string& service : service_names()) {
    auto map = services->map(service);
    if (!map) continue;
    ServiceConfig& config = configuration.services[service];
    map->read("enabled", config.enabled);
    map->read("journal", config.journal);
    map->read("deadline_s", config.deadline_s, kDeadline);
    if (const Status known = Journal::check_kind(config.journal); !config.journal.empty() && !known)
      map->fault("journal", without_password(config.journal), known.error().rule, known.error().advice);
    if (service == "data_acquisition") {
      map->read("recordings_directory", config.recordings_directory);
      read_retention(*map, "recordings_retention", config.recordings_retention);
    }
    read_service_options(service, *map, configuration);
    map->finish();
  }
  services->finish();
}

void read_topics(YamlMap& root, Configuration& configuration) {
  auto topics = root.map("topics");
  if (!topics) return;
  for (const std::string& topic : names_of<Topic>()) {
    auto map = topics->map(topic);
    if (!map) continue;
    TopicQos& qos = configuration.topics[topic];
    map->read("keep_all", qos.keep_all);
    map->read("transient_local", qos.transient_local);
    map->read("lifespan_s", qos.lifespan_s, kNotNegative);
    map->finish();
  }
  topics->finish();
}

/// Who is expected to send tests.
void read_senders(YamlMap& root, Configuration& configuration) {
  for (const YAML::Node& node : root.list("senders")) {
    if (node.IsScalar() && !node.Scalar().empty())
      configuration.senders.push_back(node.Scalar());
    else
      root.fault("senders", {}, "must be a list of names: the source_id of raw samples");
  }
}

/// What is done with whom the configuration does not name.
void read_unknown(YamlMap& root, const std::string& key, bool& refuses) {
  std::string said = refuses ? "refuse" : "take";
  root.read(key, said, {"take", "refuse"});
  refuses = said == "refuse";
}

void read_operator_acts(YamlMap& root, Configuration& configuration) {
  auto map = root.map("operator_acts");
  if (!map) return;
  map->read("confirmed_by_second", configuration.acts_confirmed_by_second);
  map->finish();
}

void read_campaigns(YamlMap& site, SiteConfig& config) {
  std::size_t index = 0;
  for (const YAML::Node& node : site.list("campaigns")) {
    YamlMap map = site.inside(node, "campaigns", index++);
    Campaign campaign;
    const bool dated = map.read("start", campaign.start);
    if (!map.has("start")) map.fault("start", {}, "must be given");
    if (map.read("label", campaign.label) ? campaign.label.empty() : !map.has("label"))
      map.fault("label", {}, "must be given: advice names the campaign by it");
    map.finish();
    const auto same_day = [&](const Campaign& other) {
      return format_date(other.start) == format_date(campaign.start);
    };
    const auto other = std::ranges::find_if(config.campaigns, same_day);
    if (dated && other != config.campaigns.end())
      map.fault("start", format_date(campaign.start), "is the day of campaign '" + other->label + "' already",
                "take one of them out, or correct its day");
    config.campaigns.push_back(std::move(campaign));
  }
  std::ranges::stable_sort(config.campaigns, {}, &Campaign::start);
}

/// All or none: costs that are given would be compared with defaults in another currency.
SiteCosts read_costs(YamlMap& map) {
  SiteCosts costs;
  for (auto [key, target] : {std::pair{"planned", &costs.planned},
                             {"after_failure", &costs.after_failure},
                             {"failed_month", &costs.failed_month},
                             {"unused_month", &costs.unused_month}})
    if (!map.read(key, *target, kNotNegative) && !map.has(key))
      map.fault(key, {}, "must be given: costs are compared with each other", "write 0 where there is none");
  map.read("currency", costs.currency);
  map.finish();
  return costs;
}

/// `now`: where it is known, what is said to have happened must have.
SiteDecision read_decision(YamlMap& site, std::optional<UtcTime> now) {
  constexpr NumberRule kShare{.min = 0.0, .max = 1.0, .words = "must be a number from 0 to 1"};
  SiteDecision decision;
  if (auto map = site.map("costs")) {
    decision.costs = read_costs(*map);
  }
  if (auto map = site.map("safety")) {
    SiteSafety& safety = decision.safety.emplace();
    map->read("dangerous_undetected_per_hour", safety.dangerous_undetected_per_hour, kRate);
    map->read("partial_stroke_coverage", safety.partial_stroke_coverage, kShare);
    map->read("full_stroke_interval_months", safety.full_stroke_interval_months, kInterval);
    if (UtcTime last; map->read("last_full_stroke", last)) {
      safety.last_full_stroke = last;
      if (now && last > *now)
        map->fault("last_full_stroke", format_date(last), "is in the future", "write the day of the last one");
    }
    map->finish();
  }
  return decision;
}

void read_sites(YamlMap& root, std::optional<UtcTime> now, Configuration& configuration) {
  std::size_t index = 0;
  for (const YAML::Node& node : root.list("sites")) {
    YamlMap map = root.inside(node, "sites", index++);
    SiteConfig site;
    if (!map.read("site", site.site) && !map.has("site")) map.fault("site", {}, "must be given");
    const bool twice = configuration.find_site(site.site) != nullptr;
    if (twice) map.fault("site", site.site, "is there twice", "name each site once");
    map.read("booking_lead_time_months", site.booking_lead_time_months, kLeadTime);
    read_campaigns(map, site);
    configuration.decisions[site.site] = read_decision(map, now);
    map.finish();
    if (!twice && !site.site.empty()) configuration.sites.push_back(std::move(site));
  }
}

/// Asset files named under `assets:`, else all in the directory "assets" beside the file.
std::vector<std::string> asset_files(YamlMap& root, const fs::path& directory) {
  std::vector<std::string> files;
  if (root.has("assets")) {
    for (const YAML::Node& node : root.list("assets")) {
      if (node.IsScalar())
        files.push_back((directory / node.Scalar()).lexically_normal().string());
      else
        root.fault("assets", {}, "must be a list of file names");
    }
    return files;
  }
  (void)root.take("assets");
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(directory / "assets", none))
    if (entry.path().extension() == ".yaml") files.push_back(entry.path().lexically_normal().string());
  std::ranges::sort(files);
  return files;
}

void read_assets(const std::vector<std::string>& files, Configuration& configuration, std::vector<Error>& errors) {
  std::vector<std::string> sites;
  for (const SiteConfig& site : configuration.sites) sites.push_back(site.site);
  std::map<std::string, std::string> file_of;
  for (const std::string& file : files) {
    Checked<AssetConfig> asset = check_asset(file, &sites);
    if (!asset) {
      errors.insert(errors.end(), asset.error().begin(), asset.error().end());
      continue;
    }
    const auto [other, is_new] = file_of.emplace(asset->asset_id, file);
    if (!is_new)
      errors.push_back({file, "key asset_id", asset->asset_id,
                        "is the id of another asset already, in " + other->second, "give each asset an id of its own"});
    configuration.assets.push_back(std::move(*asset));
  }
}

/// Dates by asset id; a key that is no asset is a fault.
void read_commissioned(YamlMap& dates, Configuration& configuration) {
  for (const AssetConfig& asset : configuration.assets)
    if (UtcTime date; dates.read(asset.asset_id, date)) configuration.commissioned[asset.asset_id] = date;
  dates.finish();
}

/// Journals, logs and recordings are in the state directory unless the file says otherwise.
void place_in_state_directory(Configuration& configuration) {
  const fs::path state = configuration.state_directory;
  const auto place = [&state](std::string& directory) {
    if (!directory.empty()) directory = (state / directory).lexically_normal().string();
  };
  place(configuration.logging.directory);
  for (auto& [service, config] : configuration.services) {
    place(config.recordings_directory);
    if (config.journal.empty()) config.journal = "sqlite3://" + (state / (service + ".db")).string();
  }
}

/// Two services never share a journal: each would refuse the other's.
void check_journals(const std::string& file, const Configuration& configuration, std::vector<Error>& errors) {
  std::map<std::string, std::string> service_at;
  for (const std::string& service : service_names()) {
    const std::string& journal = configuration.services.at(service).journal;
    const auto [other, is_new] = service_at.emplace(Journal::place_of(journal), service);
    if (!is_new)
      errors.push_back({file, place_in_yaml(file, "services." + service + ".journal"), without_password(journal),
                        "is the journal of " + other->second + " too: each service has one of its own",
                        "give each service its own file or, in PostgreSQL, its own schema"});
  }
}

}  // namespace

const std::vector<std::string>& service_names() {
  static const std::vector<std::string> names = {"data_acquisition",  "data_manipulation",     "state_detection",
                                                 "health_assessment", "prognostic_assessment", "advisory_generation"};
  return names;
}

std::string place_in_configuration(const std::string& path, const std::string& key) {
  return place_in_yaml(file_of(path).string(), key);
}

Checked<Configuration> load_configuration(const std::string& path, const ConfigurationOverrides& overrides) {
  const fs::path file = file_of(path);
  std::vector<Error> errors;
  std::error_code none;
  if (!fs::exists(file, none)) return tl::unexpected(std::vector{not_there(file)});
  const auto root = load_yaml(file.string(), errors);
  if (!root) return tl::unexpected(errors);
  YamlMap map(file.string(), *root, {}, errors);
  Configuration configuration;
  map.read("domain", configuration.domain, kDomain);
  map.read("state_directory", configuration.state_directory);
  if (configuration.state_directory.empty()) map.fault("state_directory", {}, "must not be empty");
  map.read("cyclonedds_uri", configuration.cyclonedds_uri);
  read_logging(map, configuration.logging);
  read_services(map, configuration);
  read_topics(map, configuration);
  read_senders(map, configuration);
  read_retention(map, "retention", configuration.retention);
  read_unknown(map, "unknown_assets", configuration.refuses_unknown_assets);
  read_unknown(map, "unknown_writers", configuration.refuses_unknown_writers);
  read_operator_acts(map, configuration);
  read_sites(map, overrides.now, configuration);
  const std::vector<std::string> files = asset_files(map, file.parent_path());
  auto commissioned = map.map("commissioned");
  map.finish();
  read_assets(files, configuration, errors);
  if (commissioned) read_commissioned(*commissioned, configuration);
  if (!errors.empty()) return tl::unexpected(errors);
  if (overrides.state_directory) configuration.state_directory = *overrides.state_directory;
  if (overrides.domain) configuration.domain = *overrides.domain;
  place_in_state_directory(configuration);
  check_journals(file.string(), configuration, errors);
  if (!errors.empty()) return tl::unexpected(errors);
  return configuration;
}

/// Those of a thousand assets do not each begin as a copy of all: that took longer than to read their files.
std::function<Configuration(const std::string& asset_id)> configurations_of_assets(const Configuration& configuration) {
  auto common = std::make_shared<Configuration>(configuration);
  auto assets = std::make_shared<std::map<std::string, AssetConfig>>();
  for (AssetConfig& asset : std::exchange(common->assets, {})) {
    const std::string asset_id = asset.asset_id;
    assets->emplace(asset_id, std::move(asset));
  }
  return [common, assets](const std::string& asset_id) {
    Configuration of_asset = *common;
    if (const auto asset = assets->find(asset_id); asset != assets->end()) of_asset.assets.push_back(asset->second);
    return of_asset;
  };
}

}  // namespace sealwatch
