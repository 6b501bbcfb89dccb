// A layer of ISO 13374 as a pure function of its inputs: no transport, no clock of its own, no storage.
//
// Whoever runs it (a daemon, the command line in process, a test) keeps this contract:
//   1. at start: restore(m) for every message this layer concluded before, in the order it concluded them;
//   2. then receive(m) for every input that was received but not consumed before, in the order of receipt;
//   3. then receive(m) for each new input, at most once for each message id, and again where a conclusion asks for it.
// After each receive the runner stores the conclusion's outputs and marks the consumed inputs in one transaction, and
// only then publishes. A layer killed anywhere and started again by this contract ends with the same outputs.
// What a conclusion leaves for later is run in another thread, one after another in the order of receipt, while the
// layer goes on receiving; what comes of it is stored like any other conclusion. Until then its inputs are not
// consumed, so that a layer killed meanwhile is given them again.
//
// For that a layer keeps no state but (a) what it can rebuild from its own outputs in restore and (b) inputs that it
// has not consumed yet.
//
// Each asset has a layer object of its own: one that computes for long, waits for something or fails holds up no other
// asset. An object is called by one thread at a time, not always the same; several objects are called at once, so what
// they share must bear that. An object that raised an exception is thrown away and made anew by 1 and 2.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <iterator>
#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sealwatch/core/time.hpp"
#include "sealwatch/message/topics.hpp"

namespace sealwatch {

/// An input that a layer does not act upon, and why: it is told to people, and stands in the audit trail where a person
/// said it. It is consumed as well.
struct Refusal {
  Message input;
  std::string reason;
};

struct Conclusion {
  std::vector<Message> outputs;       ///< headers complete but for writer_id, stream_sequence, publishing_time_ns
  std::vector<std::string> consumed;  ///< message ids of inputs that are not needed again
  /// What takes long to conclude: owns all that it needs and shares nothing of the layer that changes. Asked to stop, it
  /// ends soon, whatever it then returns or raises.
  std::function<Conclusion(const std::stop_token&)> later = {};
  std::vector<Refusal> refused = {};
  /// Inputs that it has not consumed, and of which it let go what they say: they are received again, before all others.
  std::vector<std::string> again = {};
};

/// The conclusion with what it left for later, done here and now.
[[nodiscard]] inline Conclusion completed(Conclusion conclusion, const std::stop_token& stop = {}) {
  while (const auto later = std::exchange(conclusion.later, {})) {
    Conclusion rest = later(stop);
    std::ranges::move(rest.outputs, std::back_inserter(conclusion.outputs));
    std::ranges::move(rest.consumed, std::back_inserter(conclusion.consumed));
    std::ranges::move(rest.refused, std::back_inserter(conclusion.refused));
    std::ranges::move(rest.again, std::back_inserter(conclusion.again));
    conclusion.later = std::move(rest.later);
  }
  return conclusion;
}

class Layer {
 public:
  virtual ~Layer() = default;
  [[nodiscard]] virtual std::string_view name() const = 0;
  [[nodiscard]] virtual std::span<const Topic> inputs() const = 0;
  [[nodiscard]] virtual std::span<const Topic> outputs() const = 0;
  /// Takes back one of its own earlier outputs.
  virtual void restore(const Message& own_output) = 0;
  /// Whether restoring this output, the last about its test, restores what all of that test would: whoever starts the
  /// layer may then leave the others out. True for layers that make many of a test, or large ones.
  [[nodiscard]] virtual bool tells_all(const Message& last_of_test) const {
    (void)last_of_test;
    return false;
  }
  /// Takes one input; never fails: bad content becomes a message that says so.
  [[nodiscard]] virtual Conclusion receive(const Message& input) = 0;
  /// The same, as runners call it, for layers that may compute for long before they return: asked to stop, it ends soon,
  /// whatever it then returns or raises, and the object is thrown away.
  [[nodiscard]] virtual Conclusion receive_until(const Message& input, const std::stop_token& stop) {
    (void)stop;
    return receive(input);
  }
  /// How many of its unconsumed inputs it keeps as its memory: they wait for nothing.
  [[nodiscard]] virtual std::size_t held() const { return 0; }
  /// Acts among them that count for nothing until something comes, which may never come, and what: people are told.
  [[nodiscard]] virtual std::vector<Refusal> waiting() const { return {}; }
  /// Lets time pass in live operation (never called in replay or offline): tests that became overdue, tests whose end
  /// never came. Must depend on `now` only in whether it concludes, not in what.
  [[nodiscard]] virtual Conclusion tick(UtcTime now) {
    (void)now;
    return {};
  }
};

/// Makes the layer object of an asset, also of one that is not in the configuration.
using LayerMaker = std::function<std::unique_ptr<Layer>(const std::string& asset_id)>;

}  // namespace sealwatch
