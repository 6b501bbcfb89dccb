// The restart property of port/layer.hpp, for any layer: stopped after any input and brought back from what was stored,
// it ends with the same outputs as if it had never stopped.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "sealwatch/port/layer.hpp"
#include "tests/unit/layers/given_again.hpp"

namespace sealwatch::test {

/// A runner without bus: keeps what a journal keeps.
class StoredRun {
 public:
  explicit StoredRun(std::function<std::unique_ptr<Layer>()> make) : make_(std::move(make)), layer_(make_()) {}

  void receive(const Message& input) {
    if (!received_.insert(header_of(input).message_id).second) return;
    waiting_.push_back(input);
    keep(completed(test::receive(*layer_, input, waiting_)));
  }
  /// A new layer, brought back by the contract; of a test of which the last output tells all, by that alone.
  void restart() {
    layer_ = make_();
    std::map<std::string, const Message*> lasts;
    for (const Message& output : outputs_) lasts[header_of(output).pst_id] = &output;
    for (const Message& output : outputs_) {
      const Message* const last = lasts.at(header_of(output).pst_id);
      const bool told = !header_of(output).pst_id.empty() && layer_->tells_all(*last);
      if (!told || last == &output) layer_->restore(output);
    }
    const std::vector<Message> again = waiting_;
    for (const Message& input : again) keep(completed(test::receive(*layer_, input, again)));
  }
  [[nodiscard]] const std::vector<Message>& outputs() const { return outputs_; }
  [[nodiscard]] std::size_t waiting() const { return waiting_.size(); }

 private:
  void keep(const Conclusion& conclusion) {
    for (const Message& output : conclusion.outputs)
      if (output_ids_.insert(header_of(output).message_id).second) outputs_.push_back(output);
    for (const std::string& id : conclusion.consumed)
      std::erase_if(waiting_, [&id](const Message& input) { return header_of(input).message_id == id; });
  }

  std::function<std::unique_ptr<Layer>()> make_;
  std::unique_ptr<Layer> layer_;
  std::vector<Message> outputs_;
  std::vector<Message> waiting_;
  std::set<std::string> received_;
  std::set<std::string> output_ids_;
};

/// Bit for bit, NaN included: as the struct's own == says for everything else.
inline bool identical(const Message& a, const Message& b) {
  if (a == b) return true;
  const auto* block_a = std::get_if<SampleBlock>(&a);
  const auto* block_b = std::get_if<SampleBlock>(&b);
  if (!block_a || !block_b || block_a->samples.channels.size() != block_b->samples.channels.size()) return false;
  SampleBlock x = *block_a;
  SampleBlock y = *block_b;
  for (SampleBlock* block : {&x, &y})
    for (Series& channel : block->samples.channels)
      for (double& value : channel.values)
        if (value != value) value = 1e300;
  return x == y;
}

inline void expect_restartable(const std::function<std::unique_ptr<Layer>()>& make,
                               const std::vector<Message>& inputs) {
  StoredRun undisturbed(make);
  for (const Message& input : inputs) undisturbed.receive(input);
  ASSERT_FALSE(undisturbed.outputs().empty());
  for (std::size_t stop = 0; stop <= inputs.size(); ++stop) {
    StoredRun run(make);
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      if (i == stop) run.restart();
      run.receive(inputs[i]);
    }
    run.restart();
    ASSERT_EQ(run.outputs().size(), undisturbed.outputs().size()) << "stopped before input " << stop;
    for (std::size_t i = 0; i < run.outputs().size(); ++i)
      ASSERT_TRUE(identical(run.outputs()[i], undisturbed.outputs()[i]))
          << "stopped before input " << stop << ": " << header_of(run.outputs()[i]).message_id;
    EXPECT_EQ(run.waiting(), undisturbed.waiting());
  }
}

}  // namespace sealwatch::test
