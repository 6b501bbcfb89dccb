// `sealwatch replay`: recorded tests through the live services, or the same layers in this process.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <set>
#include <utility>

#include "services/cli/commands.hpp"
#include "services/cli/layers.hpp"
#include "services/cli/replay_feeder.hpp"
#include "services/cli/replay_log.hpp"
#include "services/cli/replay_page.hpp"
#include "services/cli/replay_source.hpp"
#include "services/cli/session.hpp"
#include "services/cli/supervisor.hpp"
#include "services/common/runtime/in_process_pipeline.hpp"
#include "services/common/runtime/stream_reader.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch::cli {
namespace {

using std::chrono::steady_clock;

/// How many tests data acquisition may lie behind: enough to keep all services busy, few enough to keep memory small.
constexpr std::size_t kTestsAhead = 6;
/// And how many tests any later service may lie behind the one before it.
constexpr std::uint64_t kLongestBacklog = 12;
/// Without any sign of progress for this long, the replay gives up and says what it waits for.
constexpr std::chrono::seconds kPatience{60};
/// But where all services are heard, they may conclude from the last inputs for as long as they are let to: mismatch
/// analyses take minutes, and nothing comes meanwhile.
constexpr std::chrono::seconds kPatienceForConclusions{660};
/// Services that run are heard within a second or two; those just started may need longer on a busy machine.
constexpr std::chrono::seconds kPatienceForRunning{4};
constexpr std::chrono::seconds kPatienceForStarted{15};
/// What was concluded before comes to a late subscriber at once, after this long all of it, unless something is lost.
constexpr std::chrono::milliseconds kQuietWhenAllCame{500};
constexpr std::chrono::seconds kPatienceForKnown{3};

/// Recorded seconds per second; 0 for "max".
std::optional<double> speed_of(const std::string& text) {
  if (text == "max") return 0.0;
  char* end = nullptr;
  const double speed = std::strtod(text.c_str(), &end);
  if (end != text.c_str() && *end == '\0' && speed >= 1.0 && speed <= 1000.0) return speed;
  complain(Error{
      .file = {}, .place = "--speed", .value = text, .rule = "must be a number from 1 to 1000, or max", .advice = {}});
  return std::nullopt;
}

/// `hangs`: something computes that does not end, so that the process must end without waiting for it.
int replay_offline(const LayerSet& layers, ReplaySource& source, ReplayLog& log, bool& hangs) {
  const auto set_aside = [&log](std::string_view layer, const Message& input, const std::string& why) {
    log.refuse(header_of(input).message_id + " of " + asset_of(input) + ": " + std::string(layer) +
               " failed on it twice (" + why + "); its test is set aside, all others go on");
  };
  auto pipeline = std::make_unique<InProcessPipeline>(
      layers.makers(), [&log](const Message& message) { log.take(message); }, set_aside);
  pipeline->stop_when(interrupted);
  for (std::vector<RawSamples> blocks = source.next(); !blocks.empty() && !interrupted(); blocks = source.next())
    for (RawSamples& block : blocks) pipeline->push(Message(std::move(block)));
  hangs = pipeline->hangs();
  if (hangs) (void)pipeline.release();
  return interrupted() ? kAnswerIsNo : kOk;
}

/// What each service that the configuration enables reads: those that a replay waits for.
std::map<std::string, std::vector<std::string>> enabled_inputs(const LayerSet& layers,
                                                               const Configuration& configuration) {
  auto inputs = layers.inputs_by_layer();
  std::erase_if(inputs, [&](const auto& layer) { return !enabled(configuration, layer.first); });
  return inputs;
}

/// One replay over the bus.
class LiveReplay {
 public:
  LiveReplay(Session& session, const LayerSet& layers, ReplaySource& source, ReplayLog& log, double speed)
      : session_(session),
        log_(log),
        feeder_(
            unique_name("replay"), [&source] { return source.next(); }, kTestsAhead, speed),
        quiescence_(enabled_inputs(layers, session.configuration)) {}

  int run(Supervisor* supervisor) {
    if (const Status joined = join(); !joined) return give_up(joined.error());
    if (!wait_for_services(supervisor)) return supervisor != nullptr && supervisor->refused() ? kBadInput : kAnswerIsNo;
    hear_what_is_known(supervisor);
    reader_.emplace("replay", quiescence_.written(ReplayLog::topics()), StreamReader::Limits{.compares = false});
    last_progress_ = steady_clock::now();
    while (!interrupted() && !over()) {
      if (quiescence_.keeps_up(kLongestBacklog)) feeder_.feed(*session_.bus, steady_clock::now());
      const std::vector<BusItem> items = session_.bus->receive(std::chrono::milliseconds(20));
      for (const BusItem& item : items) take(item);
      if (items.empty()) ask_for_missing();
      tend(supervisor);
      if (const auto since = steady_clock::now() - last_progress_; since > kPatience) {
        if (!feeder_.done() || !quiescence_.is_concluding() || since > kPatienceForConclusions) return stalled();
        if (!std::exchange(told_of_conclusions_, true))
          log_.remark("waiting: " + quiescence_.explain() + "; a mismatch analysis takes minutes");
      }
    }
    return interrupted() ? kAnswerIsNo : kOk;
  }

 private:
  Status join() {
    if (Status joined = session_.bus->subscribe(ReplayLog::topics()); !joined) return joined;
    return session_.bus->subscribe_service_topics();
  }

  bool wait_for_services(Supervisor* supervisor) {
    const auto end = steady_clock::now() + (supervisor != nullptr ? kPatienceForStarted : kPatienceForRunning);
    while (!interrupted() && steady_clock::now() < end) {
      for (const BusItem& item : session_.bus->receive(std::chrono::milliseconds(100))) {
        if (const auto* status = std::get_if<ServiceStatus>(&item)) take_heartbeat(*status);
        if (const auto* message = std::get_if<Message>(&item)) take_earlier(*message);
      }
      tend(supervisor);
      if (supervisor != nullptr && supervisor->refused()) return false;  // and has said why
      if (quiescence_.missing().empty()) return true;
    }
    std::string missing;
    for (const std::string& service : quiescence_.missing()) text::add_to_list(missing, service);
    complain(Error{
        .file = {},
        .place = {},
        .value = {},
        .rule = "no heartbeat from " + missing + " in DDS domain " + std::to_string(session_.configuration.domain),
        .advice = "start the services with `sealwatch up`, or replay --with-services, or replay --offline"});
    return false;
  }

  void take_earlier(const Message& message) {
    log_.take_earlier(message);
    known_topics_.insert(std::string(name_of(topic_of(message))));
  }

  /// Waits for the last word on each asset from before this replay: a message of every topic that has been written, and
  /// a pause.
  void hear_what_is_known(Supervisor* supervisor) {
    const auto written = quiescence_.written(ReplayLog::topics());
    const auto awaited = [&] {
      return std::ranges::any_of(written, [&](const StreamPosition& stream) {
        return stream.sequence > 0 && !known_topics_.contains(stream.topic);
      });
    };
    const bool anything =
        std::ranges::any_of(written, [](const StreamPosition& stream) { return stream.sequence > 0; });
    auto last = steady_clock::now();
    const auto end = last + kPatienceForKnown;
    while (anything && !interrupted() && steady_clock::now() < end &&
           (awaited() || steady_clock::now() - last < kQuietWhenAllCame)) {
      for (const BusItem& item : session_.bus->receive(std::chrono::milliseconds(50))) {
        if (const auto* status = std::get_if<ServiceStatus>(&item)) take_heartbeat(*status);
        const auto* message = std::get_if<Message>(&item);
        if (message == nullptr) continue;
        take_earlier(*message);
        last = steady_clock::now();
      }
      tend(supervisor);
    }
  }

  void take(const BusItem& item) {
    if (const auto* message = std::get_if<Message>(&item)) {
      for (const Message& next : reader_->accept(*message)) log_.take(next);
      last_progress_ = steady_clock::now();
    } else if (const auto* status = std::get_if<ServiceStatus>(&item)) {
      take_heartbeat(*status);
      for (const StreamPosition& written : quiescence_.written(ReplayLog::topics()))
        (void)reader_->note_written(written, seconds(steady_clock::now()));
    } else {
      feeder_.take(std::get<ResendRequest>(item), *session_.bus);
    }
  }

  void take_heartbeat(const ServiceStatus& status) {
    feeder_.take(status);
    quiescence_.take(status);
    for (const std::string& reason : feeder_.take_refusals()) log_.refuse(reason);
  }

  /// Everything sent, everything concluded, and all conclusions seen.
  [[nodiscard]] bool over() const {
    return feeder_.done() && quiescence_.reached(feeder_.writer_id(), feeder_.last_sequence()) && !reader_->is_behind();
  }

  void ask_for_missing() {
    for (const ResendRequest& request : reader_->requests(seconds(steady_clock::now())))
      (void)session_.bus->publish(request);  // it is asked again, more rarely
  }

  static double seconds(steady_clock::time_point time) {
    return std::chrono::duration<double>(time.time_since_epoch()).count();
  }

  void tend(Supervisor* supervisor) {
    if (supervisor == nullptr) return;
    for (const std::string& event : supervisor->tend()) log_.remark(event);
  }

  int give_up(const Error& error) {
    complain(error);
    return kInternalFailure;
  }

  int stalled() {
    const std::string disabled = explain_disabled(session_.configuration);
    complain(Error{.file = {},
                   .place = {},
                   .value = {},
                   .rule = "nothing has come for 60 s; " + quiescence_.explain() +
                           (feeder_.not_taken().empty() ? "" : "; " + feeder_.not_taken()),
                   .advice = disabled.empty() ? "see the services' logs, and `sealwatch status`" : disabled});
    return kInternalFailure;
  }

  Session& session_;
  ReplayLog& log_;
  ReplayFeeder feeder_;
  Quiescence quiescence_;
  std::optional<StreamReader>
      reader_;  ///< conclusions in order and without gaps, from where the services stood at the start
  steady_clock::time_point last_progress_;
  bool told_of_conclusions_ = false;
  std::set<std::string> known_topics_;  ///< of which something from before this replay was heard
};

/// Replays through the services that run in this domain, started here if the user asked for it.
int replay_live(const ReplayOptions& options, const LayerSet& layers, ReplaySource& source, ReplayLog& log,
                double speed) {
  std::optional<Session> session = open_session(options.config);
  if (!session) return kBadInput;
  std::optional<InstanceLock> alone;
  std::optional<Supervisor> supervisor;
  if (options.with_services) {
    const auto programs = service_programs(options.config, options.state_directory, session->configuration);
    if (!free_to_start(*session, names_of(programs))) return kBadInput;
    auto lock = take_supervisor_lock(options.state_directory, session->configuration);
    if (!lock) {
      complain(lock.error());
      return kBadInput;
    }
    if (*lock) alone.emplace(std::move(**lock));
    supervisor.emplace(programs);
    if (const Status started = supervisor->start(); !started) {
      complain(started.error());
      return kInternalFailure;
    }
  }
  return LiveReplay(*session, layers, source, log, speed).run(supervisor ? &*supervisor : nullptr);
}

/// Offline an asset file (an explained one, for instance) stands in place of the configured asset, or beside those; the
/// services have their own configuration.
bool use_asset_file(const ReplayOptions& options, Configuration& configuration) {
  if (options.asset_file.empty()) return true;
  std::optional<AssetConfig> asset = load_asset_or_explain(options.asset_file);
  if (!asset) return false;
  const auto configured = std::ranges::find(configuration.assets, asset->asset_id, &AssetConfig::asset_id);
  const bool known = configured != configuration.assets.end();
  if (!options.offline && known && configured->physics.size() != asset->physics.size()) {
    complain(Error{.file = options.asset_file,
                   .place = "physics",
                   .value = {},
                   .rule = "is not what the services have of asset " + asset->asset_id,
                   .advice = "put this file in place of the asset's in the configuration, or replay --offline"});
    return false;
  }
  if (options.offline && known) *configured = std::move(*asset);
  if (options.offline && !known) configuration.assets.push_back(std::move(*asset));
  return true;
}

}  // namespace

int run_replay(const ReplayOptions& options) {
  const std::optional<double> speed = speed_of(options.speed);
  std::optional<Configuration> configuration = load_or_explain(options.config);
  if (!speed || !configuration || !use_asset_file(options, *configuration)) return kBadInput;
  std::optional<ReplaySource> source = ReplaySource::open(options, *configuration);
  if (!source) return kBadInput;
  Result<LayerSet> layers = LayerSet::make(*configuration);
  if (!layers) {
    complain(layers.error());
    return kInternalFailure;
  }
  if (std::error_code error; !options.results_directory.empty()) {
    std::filesystem::create_directories(options.results_directory, error);
    if (error) {
      complain(Error{.file = options.results_directory,
                     .place = "--results",
                     .value = {},
                     .rule = "cannot be written to: " + error.message(),
                     .advice = {}});
      return kBadInput;
    }
  }
  ReplayLog log(options, source->tests());
  catch_interrupts(options.offline ? kCommandStops : kSupervisorStops);
  bool hangs = false;
  int result = options.offline ? replay_offline(*layers, *source, log, hangs)
                               : replay_live(options, *layers, *source, log, *speed);
  if (const Status written = log.finish(source->failures() == 0); !written) {
    complain(written.error());
    return kBadInput;
  }
  if (!options.page.empty() && result == kOk) result = write_replay_page(options, *configuration, log.histories());
  const std::string silence = log.without_advice();
  if (result == kOk && !silence.empty() && source->tests() > source->failures())
    std::fprintf(stderr, "sealwatch: %s\n", silence.c_str());
  if ((source->failures() > 0 || log.any_refused()) && result == kOk) result = kBadInput;
  if (hangs) std::fflush(nullptr);
  if (hangs) std::_Exit(result);
  return result;
}

}  // namespace sealwatch::cli
