// Layers one behind the other in one process, without bus and journal: each message goes to every layer that reads its
// topic, in the order of conclusion. The same layers over a bus conclude the same, and what they set aside is set aside
// here.
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sealwatch/port/layer.hpp"
#include "services/common/runtime/asset_lanes.hpp"

namespace sealwatch {

class InProcessPipeline {
 public:
  using Observer = std::function<void(const Message&)>;
  /// Told of a message on which a layer failed twice, and why.
  using OnSetAside = std::function<void(std::string_view layer, const Message& input, const std::string& why)>;
  /// `observer` sees every message that a layer concluded, once.
  InProcessPipeline(const std::vector<LayerMaker>& layers, Observer observer, OnSetAside on_set_aside = {},
                    const AssetLanes::Options& options = {});
  ~InProcessPipeline();
  /// Takes one message from outside and all that follows from it.
  void push(const Message& message);
  /// What is asked some times a second while layers compute: once it is true, push leaves the rest undone.
  void stop_when(std::function<bool()> is_over) { is_over_ = std::move(is_over); }
  /// Whether a computation that did not end goes on in a thread: destroying this would wait for it.
  [[nodiscard]] bool hangs() const { return hangs_; }

 private:
  struct Reader;
  void deliver(Reader& reader, const Message& message);
  void conclude(Reader& reader, const std::string& asset_id);
  void take(Reader& reader, LaneResult result);
  void begin_anew(Reader& reader, const std::string& asset_id);

  std::vector<std::unique_ptr<Reader>> readers_;
  Observer observer_;
  OnSetAside on_set_aside_;
  std::map<std::string, std::string> concluded_;  ///< asset by message id
  std::deque<Message> waiting_;
  std::function<bool()> is_over_ = [] { return false; };
  bool hangs_ = false;
};

}  // namespace sealwatch
