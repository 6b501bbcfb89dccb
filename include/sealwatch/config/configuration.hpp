// The whole configuration: assets, sites, services, topics' QoS and topology, as validated before anything starts.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sealwatch/config/advice.hpp"
#include "sealwatch/config/asset.hpp"
#include "sealwatch/config/site_decision.hpp"
#include "sealwatch/core/fields.hpp"

namespace sealwatch {

/// QoS of one topic where it departs from the defaults of docs/topics.md.
struct TopicQos {
  bool keep_all = true;         ///< false: keep_last 1 (state topics)
  bool transient_local = true;  ///< a late subscriber gets the last message of every asset
  double lifespan_s = 0.0;      ///< 0: for ever
};

struct LoggingConfig {
  std::string level = "info";  ///< trace, debug, info, warn, error
  std::string directory;       ///< "" : standard error only
  double rotate_at_MB = 10.0;
  std::int32_t rotated_files = 5;
};

/// For how long a service's journal keeps samples (sample_block, test_window) that all readers have, or a folder its
/// files; conclusions stay for ever. 0: for ever, or however much.
struct RetentionConfig {
  double days = 0.0;
  double megabytes = 0.0;  ///< of one journal or folder
};

struct ServiceConfig {
  bool enabled = true;
  std::string journal;               ///< SOCI connection string; default "sqlite3://<state_directory>/<service>.db"
  std::string recordings_directory;  ///< data_acquisition only: recordings dropped here are taken in; "" none
  RetentionConfig recordings_retention = {};  ///< of those that were seen to, in each of done/ and rejected/
  double deadline_s = 120.0;                  ///< processor time for one message (runtime/workers.hpp)
};

/// One of the forecasters that judge every history side by side; what the methods are: forecast/forecaster.hpp.
struct ForecasterConfig {
  std::string method = "ols";
  std::int32_t window_months = 36;
  std::vector<ForecasterConfig> members = {};  ///< of method average; none: its default members
};

/// Ageing constants of a site's own fleet (forecast/fleet_population.hpp says what each is), as `sealwatch fleet fit`
/// gives them.
struct FleetConstants {
  double initial_rate = 0.0;
  double initial_rate_std = 0.0;
  double steepening = 0.0;
  double steepening_std = 0.0;
  double rate_steepening_correlation = 0.0;
  double irregularity_std = 0.0;
  SEALWATCH_FIELDS(FleetConstants, initial_rate, initial_rate_std, steepening, steepening_std,
                   rate_steepening_correlation, irregularity_std)
};

struct Configuration {
  std::int32_t domain = 0;
  std::string state_directory = "state";
  std::string cyclonedds_uri;  ///< passed on as CYCLONEDDS_URI where the environment has none
  LoggingConfig logging;
  std::map<std::string, ServiceConfig> services;  ///< by service name
  std::vector<ForecasterConfig> forecasters;      ///< the primary one first; none: the default ones
  std::optional<FleetConstants> fleet;            ///< of all forecasters; none: the reference's
  AdviceOptions advice;
  std::map<std::string, TopicQos> topics;  ///< by topic name
  std::vector<SiteConfig> sites;
  std::map<std::string, SiteDecision> decisions;  ///< by site; none: neither costs nor proof tests are known
  std::vector<AssetConfig> assets;
  std::map<std::string, UtcTime> commissioned;  ///< by asset id, where it is known: no test is older
  std::vector<std::string> senders;             ///< sources of raw samples that are expected; none: all are
  RetentionConfig retention;
  bool refuses_unknown_assets = false;   ///< that have no asset file; else some are taken (admission.hpp)
  bool refuses_unknown_writers = true;   ///< of topics that only services write (stranger_watch.hpp)
  bool acts_confirmed_by_second = true;  ///< what lowers an advisory counts once a second person confirms it

  [[nodiscard]] const AssetConfig* find_asset(const std::string& asset_id) const {
    for (const AssetConfig& asset : assets)
      if (asset.asset_id == asset_id) return &asset;
    return nullptr;
  }
  [[nodiscard]] const SiteConfig* find_site(const std::string& site) const {
    for (const SiteConfig& candidate : sites)
      if (candidate.site == site) return &candidate;
    return nullptr;
  }
  [[nodiscard]] SiteDecision decision_of(const std::string& site) const {
    const auto found = decisions.find(site);
    return found == decisions.end() ? SiteDecision{} : found->second;
  }
};

}  // namespace sealwatch
