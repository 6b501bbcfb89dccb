// Runs one layer over a bus with a journal, by the contract of port/layer.hpp and the stream protocol of
// message/service.hpp.
//
//   receive -> put streams in order -> [journal: inputs, conclusions, positions: one transaction] -> publish
//
// What is published was committed before; what was committed and not published, because the process was killed in
// between, is asked for by its readers, as the heartbeat says how far each stream goes. A layer that was stopped at any
// point and is run again on the same journal ends with the same outputs.
#pragma once

#include <atomic>
#include <chrono>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sealwatch/port/bus.hpp"
#include "sealwatch/port/layer.hpp"
#include "services/common/runtime/admission.hpp"
#include "services/common/runtime/heartbeat.hpp"
#include "services/common/runtime/later_work.hpp"
#include "services/common/runtime/latest_outputs.hpp"
#include "services/common/runtime/resend_queue.hpp"
#include "services/common/runtime/stream_reader.hpp"
#include "services/common/store/journal.hpp"

namespace sealwatch {

struct RunnerOptions {
  std::string version = {};
  Heartbeat::Options heartbeat = {};
  /// Batches begin so far apart at least: of a thousand messages a second, two or three share a transaction, which
  /// nearly halves what is written to the journal.
  std::chrono::milliseconds batch_pause{2};
  /// A batch is committed when the layer has computed for this long.
  std::chrono::milliseconds batch_time{100};
  /// Time does not pass for the layer until the writers have had so long to say what it missed while it was dead.
  std::chrono::milliseconds settling{3000};
  /// Inputs that come from no bus (recordings dropped into a directory), asked for about once a second. A message that
  /// comes twice is taken once, by its id.
  std::function<std::vector<Message>()> local_inputs = {};
  StreamReader::Limits streams = {};
};

class LayerRunner {
 public:
  /// Everything must outlive the runner. `heartbeat_bus` is used by a thread of the runner's own.
  LayerRunner(Layer& layer, Bus& bus, Bus& heartbeat_bus, Journal& journal, const Clock& clock,
              RunnerOptions options = {});

  /// Subscribes, gives the layer its past back, publishes the last state of every asset.
  [[nodiscard]] Status start();
  /// One round: takes what the bus has (waiting at most `timeout`), concludes, commits, publishes, serves requests.
  /// After an Error the runner cannot go on: the layer may be ahead of the journal. Start again from the journal.
  [[nodiscard]] Status step(std::chrono::milliseconds timeout);
  /// Steps until `stop` is set (then wake the bus).
  [[nodiscard]] Status run(const std::atomic<bool>& stop);

 private:
  using Key = std::pair<std::string, std::string>;  // topic, writer id

  [[nodiscard]] Status restore_past();
  void sort_in(BusItem item);
  void sort_in(Message message);
  void sort_in(const ServiceStatus& status);
  void sort_in(const ResendRequest& request);
  void note_rival(const ServiceStatus& rival);
  /// Runs `work` inside a transaction and publishes what it concluded.
  [[nodiscard]] Status in_batch(const std::function<Status()>& work);
  [[nodiscard]] Status take_ready();
  [[nodiscard]] Status take(Message message);
  void give_memory_back();
  [[nodiscard]] Status keep(Conclusion conclusion, const std::string& input_id);
  [[nodiscard]] Status keep_what_is_done();
  [[nodiscard]] Status let_time_pass();
  [[nodiscard]] Status serve_resends();
  [[nodiscard]] Status publish_latest();
  void send_requests();
  /// False when the bus did not take it: then what follows is left to be asked for, so that one reader that does not
  /// take its messages cannot hold up this service for long.
  bool publish(const Message& message, std::string_view event);
  void note_error(const std::string& text);
  void report_progress();

  Layer& layer_;
  Bus& bus_;
  Bus& heartbeat_bus_;
  Journal& journal_;
  const Clock& clock_;
  RunnerOptions options_;
  std::unique_ptr<StreamReader> reader_;
  std::deque<Message> ready_;  ///< inputs in order, not yet taken
  std::vector<Message> outbox_;
  std::map<Key, std::uint64_t> committed_;    ///< positions in the journal
  std::map<Key, std::uint64_t> uncommitted_;  ///< positions of the running batch
  LatestOutputs latest_;
  ResendQueue resends_;
  Admission admission_;
  bool drained_ = false;    ///< the bus had nothing more at the last look
  bool replaying_ = false;  ///< the last input was a recording played back: time does not pass
  std::string last_error_;  ///< with its time
  std::string rival_;       ///< writer id of another service of this kind, heard last
  std::chrono::steady_clock::time_point started_{};
  std::chrono::steady_clock::time_point last_second_{};
  std::chrono::steady_clock::time_point last_work_{};  ///< when the last batch began
  bool holds_memory_ = false;                          ///< of work done since memory was given back
  LaterWork later_;
  std::unique_ptr<Heartbeat> heartbeat_;
};

}  // namespace sealwatch
