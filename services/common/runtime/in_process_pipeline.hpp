// Layers one behind the other in one process, without bus and journal: each message goes to every layer that reads its
// topic, in the order of conclusion. The same layers over a bus conclude the same.
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "sealwatch/port/layer.hpp"

namespace sealwatch {

class InProcessPipeline {
 public:
  using Observer = std::function<void(const Message&)>;
  /// `observer` sees every message that a layer concluded, once.
  InProcessPipeline(std::vector<std::unique_ptr<Layer>> layers, Observer observer);
  /// Takes one message from outside and all that follows from it.
  void push(const Message& message);

 private:
  struct Reader {
    std::unique_ptr<Layer> layer;
    std::set<std::string> received;
    std::map<std::pair<Topic, std::string>, std::string> last_unnumbered;  ///< message id by topic and asset
  };
  void deliver(Reader& reader, const Message& message);

  std::vector<Reader> readers_;
  Observer observer_;
  std::set<std::string> concluded_;
  std::deque<Message> waiting_;
};

}  // namespace sealwatch
