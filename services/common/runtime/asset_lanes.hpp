// One lane for each asset: its layer object (port/layer.hpp) and its inputs, in the order of receipt. Lanes compute side
// by side, so that an asset whose messages take long, wait or fail holds up no other.
//
// A message on which the layer fails (it raised an exception, ran out of memory, did not end in time, or its process
// died with it) is tried a second time in a process of its own (trial.hpp). If it fails there too, it is the message's
// fault. If not, it was something else's, such as a kill from outside: then it is given to the layer again, but not for
// ever, as what ends well there may still be what ends the service. Kills from outside come in storms, so that many more
// deaths than failures are put up with.
//
// The owner's thread alone calls; the layers are called by worker threads.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "sealwatch/port/layer.hpp"
#include "services/common/runtime/trial.hpp"
#include "services/common/runtime/try_record.hpp"
#include "services/common/runtime/workers.hpp"

namespace sealwatch {

/// What became of an input, or of what it left for later.
struct LaneResult {
  std::string asset_id;
  std::shared_ptr<const Message> input;
  Conclusion conclusion;            ///< without what it leaves for later, which the lane does itself
  std::string failure;              ///< why there is none; ""
  bool is_message_s_fault = false;  ///< of a failure: it is not to be tried again
};

class AssetLanes {
 public:
  struct Options {
    Workers::Limits workers = {};
    std::string try_record = {};  ///< file of the try record; "": what fails the process is forgotten
  };
  /// Reads an input that only the journal holds.
  using Load = std::function<Result<std::optional<Message>>(const std::string& message_id)>;

  /// `on_result` is called by worker threads.
  AssetLanes(LayerMaker make, Load load, std::function<void()> on_result, const Options& options);

  /// Reads the try record.
  [[nodiscard]] Status prepare();
  /// Makes the asset's lane where there is none.
  void know(const std::string& asset_id);
  /// Takes back an output of the past.
  void restore(const Message& own_output);
  /// Puts an input at the end of its asset's lane; without `message` it is loaded in its turn.
  void add(const std::string& asset_id, const std::string& message_id, std::shared_ptr<const Message> message);
  /// Lets go of messages that wait, but for a few: they can be loaded, once they are in the journal.
  void save_memory();
  /// Begins what can begin, looks after what goes on.
  [[nodiscard]] Status advance();
  [[nodiscard]] std::vector<LaneResult> take_results();
  /// Until something has a result, or the time is over.
  void wait(std::chrono::milliseconds timeout);
  /// Throws the asset's layer away, with all that waits and goes on; its past and its inputs are then given again.
  void begin_anew(const std::string& asset_id);
  /// The message counts as one that never failed.
  void forgive(const std::string& message_id) { record_.end(message_id); }

  /// Whether a layer is taking a message now.
  [[nodiscard]] bool is_receiving(const std::string& asset_id) const;
  /// Inputs that wait or from which something is being concluded.
  [[nodiscard]] std::size_t open() const { return waiting_ + receiving_ + later_; }
  [[nodiscard]] std::size_t later() const { return later_; }
  /// Inputs that layers keep as their memory (Layer::held).
  [[nodiscard]] std::size_t held() const;
  /// The layer of an asset from whose inputs everything is concluded; none while something is under way.
  [[nodiscard]] Layer* at_rest(const std::string& asset_id);
  [[nodiscard]] std::vector<std::string> assets() const;
  /// Whether something must be looked at soon, though nothing arrives.
  [[nodiscard]] bool on_trial() const { return !trials_.empty(); }
  /// Stops all work; false when some of it goes on after `patience`.
  [[nodiscard]] bool stop(std::chrono::milliseconds patience);

 private:
  struct Input {
    std::string message_id;
    std::shared_ptr<const Message> message;
  };
  struct Later {
    std::shared_ptr<const Message> input;
    std::function<Conclusion(const std::stop_token&)> work;
  };
  struct Lane {
    std::shared_ptr<Layer> layer;
    std::uint64_t generation = 0;  ///< of the layer object: what an earlier one still computes is dropped
    std::deque<Input> waiting;
    std::optional<Input> receiving;
    std::deque<Later> later;  ///< the first of them is being done
    std::stop_source stop;
    std::size_t held = 0;
    std::unique_ptr<Trial> trial;
    bool failed = false;  ///< its layer is in no state to go on, until it begins anew
  };
  struct Raw {
    LaneResult result;
    std::uint64_t generation = 0;
    bool of_later = false;
    std::size_t held = 0;
  };
  using Compute = std::function<Conclusion(const std::stop_token&)>;

  Lane& lane(const std::string& asset_id);
  [[nodiscard]] Status begin_next(const std::string& asset_id, Lane& lane);
  void try_first(const std::string& asset_id, Lane& lane);
  void look_at_trials();
  void receive(const std::string& asset_id, Lane& lane);
  void do_later(const std::string& asset_id, Lane& lane);
  void compute(const std::string& asset_id, Lane& lane, std::shared_ptr<const Message> input, bool of_later,
               Compute work);
  void post(Raw raw);
  /// The result as its owner sees it; none when its layer was thrown away meanwhile.
  [[nodiscard]] bool settle(Raw& raw);
  void fail_without_a_try(const std::string& asset_id, const Input& input, const std::string& why);

  LayerMaker make_;
  Load load_;
  std::function<void()> on_result_;
  Options options_;
  std::map<std::string, Lane> lanes_;
  std::set<std::string> ready_;   ///< assets that may be able to begin something
  std::set<std::string> trials_;  ///< assets with a message on trial
  std::size_t waiting_ = 0;
  std::size_t receiving_ = 0;
  std::size_t later_ = 0;
  TryRecord record_;
  std::mutex mutex_;
  std::condition_variable arrived_;
  std::vector<Raw> results_;
  Workers workers_;  ///< last: its threads end first
};

}  // namespace sealwatch
