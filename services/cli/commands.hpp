// The subcommands of `sealwatch`, each with its options. Every run_* returns an exit status:
// 0 ok, 1 the command ran and the answer is "no", 2 bad usage or input, 3 internal failure.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace sealwatch::cli {

inline constexpr int kOk = 0;
inline constexpr int kAnswerIsNo = 1;
inline constexpr int kBadInput = 2;
inline constexpr int kInternalFailure = 3;

struct SimulateOptions {
  std::string asset_file;
  std::string directory;
  std::string start = "2009-03-17T10:00:00Z";
  std::uint64_t seed = 1;
  int months = 1;
  double sample_rate_Hz = 200.0;
  double condition = 1.0;           ///< theta at the first test
  bool ageing = false;              ///< a whole life: the seal ages from month to month
  double missing_share = 0.0;       ///< of the months: no test
  double cut_share = 0.0;           ///< of the tests: cut short
  std::vector<std::string> inputs;  ///< recordings whose inputs drive the asset's plant, in place of the virtual bench
  std::string map_file;             ///< how they are written; "": as the asset file says
  bool noise = false;               ///< of the sensors, on what is simulated from them
};
int run_simulate_input(const SimulateOptions& options);
int run_simulate(const SimulateOptions& options);

struct FitOptions {
  std::string asset_file;
  std::string map_file;  ///< how the recordings are written; "": as the asset file says
  std::vector<std::string> recordings;
  std::string model;  ///< "" the best that the channels allow
  double time_limit_s = std::numeric_limits<double>::infinity();
  int threads = 2;
  bool json = false;
};
int run_fit(const FitOptions& options);

struct ExplainOptions {
  std::string asset_file;
  std::string map_file;  ///< how the recordings are written; "": as the asset file says
  std::vector<std::string> fit;
  std::vector<std::string> holdout;
  std::string directory;       ///< for report.json, report.html and asset.explained.yaml
  std::uint64_t seed = 1;      ///< the same seed gives the same report
  double time_limit_s = 60.0;  ///< of the search
  int threads = 2;
  bool json = false;
};
int run_explain(const ExplainOptions& options);

struct PlantImportOptions {
  std::string fmu;
  std::string file;                   ///< plant file to write
  std::string interface;              ///< "me", "cs"; "": whichever there is
  std::vector<std::string> settings;  ///< NAME=VALUE
};
int run_plant_import(const PlantImportOptions& options);

struct PlantExportOptions {
  std::string asset_file;
  std::string fmu;              ///< to write
  std::optional<int> fmi = {};  ///< version of the standard: 2 or 3; none: an imported FMU's own, else 2
};
int run_plant_export(const PlantExportOptions& options);

struct ValidateOptions {
  std::string asset_file;
  std::string map_file;  ///< how the recordings are written; "": as the asset file says
  std::vector<std::string> recordings;
  std::string directory;  ///< for report.html and validation.json
  bool fit = false;       ///< estimate the asset's free parameters first
  std::string simulated;  ///< a trace of somebody's simulation to hold against the recording, in place of a model
  std::string page;       ///< of a trace: HTML file to write; "": none
  std::vector<std::string> inputs;  ///< of a trace: channels that drive the simulation
  bool json = false;
};
int run_validate(const ValidateOptions& options);
int run_validate_trace(const ValidateOptions& options);

struct AssetNewOptions {
  std::string log;       ///< somebody's own recording
  std::string file;      ///< asset file to write
  std::string model;     ///< "": the plant that the most of the log's columns speak for
  std::string asset_id;  ///< "": the log's name
  bool yes = false;      ///< takes the guess without asking
};
int run_asset_new(const AssetNewOptions& options);

struct ForecastOptions {
  std::string history_file;         ///< "": what the services keep
  std::string state_directory;      ///< where they keep it; "": by the configuration
  std::string asset;                ///< file; for what the services keep also an id, or "" where there is one asset
  std::vector<std::string> before;  ///< dates to give the probability of failure for
  std::string config;               ///< whose campaigns, costs and forecasters are taken; "": none
  std::vector<double> costs;        ///< planned, after failure, a failed month, an unused month; empty: not known
  std::string page;                 ///< HTML file to write; "": none
  double threshold = 0.60;
  bool threshold_given = false;
  bool json = false;
};
int run_forecast(const ForecastOptions& options);

struct FleetFitOptions {
  std::vector<std::string> histories;  ///< one a life
  std::vector<std::string> installed;  ///< date of each; none: a month before its first test
  std::string asset_file;              ///< seal resistances, for histories of R_CL
  bool json = false;
};
int run_fleet_fit(const FleetFitOptions& options);

struct ReplayOptions {
  std::string config;
  std::vector<std::string> recordings;
  std::string state_directory;  ///< of the services started with_services; "": the configuration's
  std::string asset_file;       ///< whose recordings are meant where they do not say
  std::string map_file;         ///< how the recordings are written; "": as the asset files say
  std::string speed = "max";
  std::string results_directory;  ///< write each message as one JSON line per topic
  std::string page;               ///< HTML file for the forecasts at the end; "": none
  bool offline = false;
  bool with_services = false;  ///< start the six services for the time of the replay
  bool json = false;
  bool quiet = false;
};
int run_replay(const ReplayOptions& options);

struct WatchOptions {
  std::string config;
  std::vector<std::string> topics;
  std::string asset_id;
  double seconds = 0.0;  ///< 0: until interrupted
  bool json = false;
};
int run_watch(const WatchOptions& options);

struct ShowOptions {
  std::string config;
  std::string state_directory;  ///< "": the journals of the configuration
  std::string id;               ///< of a message, a test or an asset
  std::string csv;              ///< file for the waveform of the test; "": none
  bool json = false;
};
int run_show(const ShowOptions& options);

struct UpOptions {
  std::string config;
  std::string state_directory;  ///< "": the configuration's
  std::string security;         ///< directory of identities (deploy/security); "": CYCLONEDDS_URI for all
};
int run_up(const UpOptions& options);

struct StatusOptions {
  std::string config;
  double seconds = 2.5;
  bool json = false;
};
int run_status(const StatusOptions& options);

struct QuarantineOptions {
  std::string config;
  std::string state_directory;
  bool json = false;
  bool all = false;
  std::string message_id;
  std::string by;
};
int run_quarantine_list(const QuarantineOptions& options);
int run_quarantine_retry(const QuarantineOptions& options);

struct ConfirmOptions {
  std::string config;
  std::string asset_id;
  std::string act_id;
  bool reject = false;
  std::string by;
  std::string remark;
};
int run_confirm(const ConfirmOptions& options);

struct AuditOptions {
  std::string config;
  std::string state_directory;
  std::string asset_id;  ///< "" all
  std::string contains;  ///< a hash that was noted earlier; "" none
  bool json = false;
};
int run_audit(const AuditOptions& options);

struct BackupOptions {
  std::string config;
  std::string state_directory;
  std::string directory;  ///< of the copies
};
int run_backup(const BackupOptions& options);
int run_restore(const BackupOptions& options);

struct AcknowledgeOptions {
  std::string config;
  std::string asset_id;
  std::string advisory_id;
  std::string by;
  std::string remark;
};
int run_acknowledge(const AcknowledgeOptions& options);

/// Setting an alarm aside until a date, or taking it back into view.
struct ShelveOptions {
  std::string config;
  std::string asset_id;  ///< "-" for an alarm about none
  std::string alarm_id;
  std::string until;  ///< "": back into view
  std::string by;
  std::string reason;
};
int run_shelve(const ShelveOptions& options);

/// An asset on which somebody works, or no longer.
struct OutOfServiceOptions {
  std::string config;
  std::string asset_id;
  bool back = false;
  std::string by;
  std::string reason;
};
int run_out_of_service(const OutOfServiceOptions& options);

struct ReplacedOptions {
  std::string config;
  std::string asset_id;
  std::string at;
  std::string what = "actuator";
  std::string by;
  std::string remark;
};
int run_replaced(const ReplacedOptions& options);

/// Tests that must not count, or count again.
struct RetractOptions {
  std::string config;
  std::string asset_id;
  std::string pst_id;    ///< one test; "" none
  std::string since;     ///< all tests from this UTC time on; "" none
  std::string withdraw;  ///< id of the retraction that is taken back; "" none
  std::string by;
  std::string reason;
};
int run_retract(const RetractOptions& options);

/// An explained model comes into force, or no longer.
struct AcceptOptions {
  std::string config;
  std::string asset_id;
  std::string discrepancy_id;
  bool revoke = false;
  std::string by;
  std::string remark;
};
int run_accept(const AcceptOptions& options);

struct ConfigCheckOptions {
  std::string config;
  bool json = false;
};
int run_config_check(const ConfigCheckOptions& options);

struct PlantCheckOptions {
  std::string file;
  bool json = false;
};
int run_plant_check(const PlantCheckOptions& options);

struct PlantShowOptions {
  std::string name;  ///< of a built-in plant, or a plant file
  bool json = false;
};
int run_plant_show(const PlantShowOptions& options);

struct LawsOptions {
  std::string asked;  ///< a law's id, an element or a kind of site; "": all
  bool json = false;
};
int run_laws(const LawsOptions& options);

/// Prints the shell's completion script, made from the program's own options.
struct CompletionOptions {
  std::string shell = "bash";
};

/// Configuration used where none is given: $SEALWATCH_CONFIG, /etc/sealwatch, ./config.
[[nodiscard]] std::string default_config();

}  // namespace sealwatch::cli
