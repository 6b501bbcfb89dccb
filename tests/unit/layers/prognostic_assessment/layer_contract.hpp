// Runs a layer by the contract of port/layer.hpp, with a death and restart where a test wants one.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "sealwatch/port/layer.hpp"
#include "tests/unit/layers/given_again.hpp"

namespace sealwatch::test {

using LayerFactory = std::function<std::unique_ptr<Layer>()>;

/// Outputs of all inputs in order; the layer dies and is restored after `death_after` inputs.
inline std::vector<Message> run_layer(const LayerFactory& make, const std::vector<Message>& inputs,
                                      std::optional<std::size_t> death_after = {}) {
  std::unique_ptr<Layer> layer = make();
  std::vector<Message> outputs;
  std::vector<Message> open;  // received, not consumed
  const auto receive = [&](const Message& input) {
    const Conclusion conclusion = test::receive(*layer, input, open);
    outputs.insert(outputs.end(), conclusion.outputs.begin(), conclusion.outputs.end());
    for (const std::string& id : conclusion.consumed)
      std::erase_if(open, [&](const Message& message) { return header_of(message).message_id == id; });
  };
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    if (death_after == i) {
      layer = make();
      for (const Message& output : std::vector<Message>(outputs)) layer->restore(output);
      for (const Message& message : std::vector<Message>(open)) receive(message);
    }
    open.push_back(inputs[i]);
    receive(inputs[i]);
  }
  return outputs;
}

template <class T>
std::vector<T> of_kind(const std::vector<Message>& messages) {
  std::vector<T> found;
  for (const Message& message : messages)
    if (const T* one = std::get_if<T>(&message)) found.push_back(*one);
  return found;
}

}  // namespace sealwatch::test
