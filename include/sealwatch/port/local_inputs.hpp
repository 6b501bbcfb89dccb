// Inputs of a service that come from no bus, such as recordings that are dropped into a directory.
//
// The runner's thread calls, between its other work. What takes long (to look at files, to read them) is done by a
// thread of the implementation's own: nobody else's messages wait for it.
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "sealwatch/message/service.hpp"
#include "sealwatch/message/topics.hpp"
#include "sealwatch/port/layer.hpp"

namespace sealwatch {

/// Kind of the alarms about what was not taken.
inline constexpr const char* kRecordingNotTaken = "recording_not_taken";

class LocalInputs {
 public:
  /// The layer of an asset, where nothing is under way in it.
  using LayerAtRest = std::function<const Layer*(const std::string& asset_id)>;

  virtual ~LocalInputs() = default;
  /// About once a second: the time to ask layers what they have concluded. `woken` gives a layer that forgot its past it
  /// back; to `awake` it is none.
  virtual void look(const LayerAtRest& woken, const LayerAtRest& awake) = 0;
  /// What to call, in any thread, when there is something to take, before the first look.
  // NOLINTNEXTLINE(performance-unnecessary-value-param): others keep it
  virtual void on_some(std::function<void()> /*call*/) {}
  /// Whether there is something to take.
  [[nodiscard]] virtual bool has_some() = 0;
  /// A small piece of what is ready, in order: other messages get their turn after it. A message that comes twice is
  /// taken once, by its id.
  [[nodiscard]] virtual std::vector<Message> take() = 0;
  /// What was not taken, for as long as nobody has seen to it.
  [[nodiscard]] virtual std::vector<ServiceAlarm> alarms() { return {}; }
  /// Ends the work. False when some of it goes on after `patience`: then only the end of the process stops it.
  [[nodiscard]] virtual bool stop(std::chrono::milliseconds patience) = 0;
};

}  // namespace sealwatch
