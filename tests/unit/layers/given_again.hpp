// What a runner does for layers that let go of what waits: it gives it again; and a flood that makes them.
#pragma once

#include <gtest/gtest.h>
#include <malloc.h>

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "sealwatch/port/layer.hpp"

namespace sealwatch::test {

/// The layer is given again what it asks for, out of all that it `received`.
inline Conclusion receive(Layer& layer, const Message& input, const std::vector<Message>& received) {
  Conclusion conclusion = layer.receive(input);
  while (!conclusion.again.empty()) {
    const std::string id = conclusion.again.front();
    conclusion.again.erase(conclusion.again.begin());
    const auto found =
        std::ranges::find_if(received, [&](const Message& message) { return header_of(message).message_id == id; });
    if (found == received.end()) {
      ADD_FAILURE() << "asks for " << id << ", which was not received";
      return conclusion;
    }
    Conclusion rest = layer.receive(*found);
    std::ranges::move(rest.outputs, std::back_inserter(conclusion.outputs));
    std::ranges::move(rest.consumed, std::back_inserter(conclusion.consumed));
    std::ranges::move(rest.refused, std::back_inserter(conclusion.refused));
    conclusion.again.insert(conclusion.again.begin(), rest.again.begin(), rest.again.end());
    if (rest.later) conclusion.later = std::move(rest.later);
  }
  return conclusion;
}

/// Half a test that nobody made, as a forger sends it.
inline Message forged(const Message& half, int number) {
  Message message = half;
  header_of(message).pst_id = "forged-" + std::to_string(number);
  header_of(message).message_id = std::string(name_of(topic_of(half))) + "/" + header_of(message).pst_id;
  return message;
}

/// A hundred thousand such halves, whose other halves never come, make the layer hold no more than half as many do.
inline void expect_flat_under_forged_halves(Layer& layer, const std::vector<Message>& halves) {
  constexpr int kForged = 100'000;
  constexpr std::size_t kMostOpen = 5000;  // of each topic
  std::size_t halfway = 0, open = 0, refused = 0;
  for (int k = 0; k < kForged; ++k) {
    const Conclusion conclusion = layer.receive(forged(halves[static_cast<std::size_t>(k) % halves.size()], k));
    open += 1 - conclusion.consumed.size();
    refused += conclusion.refused.size();
    if (k == kForged / 2) halfway = ::mallinfo2().uordblks;
  }
  EXPECT_LE(open, kMostOpen * halves.size());
  EXPECT_EQ(open + refused, static_cast<std::size_t>(kForged)) << "what is not kept is told of";
  EXPECT_LT(::mallinfo2().uordblks, halfway + 1'000'000);
}

}  // namespace sealwatch::test
