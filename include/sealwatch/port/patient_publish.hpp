// Publishing for those who have nothing else to do meanwhile: again and again until the bus takes the message.
#pragma once

#include <chrono>
#include <thread>

#include "sealwatch/port/bus.hpp"

namespace sealwatch {

template <class Content>
[[nodiscard]] Status publish_patiently(Bus& bus, const Content& content,
                                       std::chrono::milliseconds patience = std::chrono::milliseconds(5000)) {
  constexpr std::chrono::milliseconds kPause{20};
  const auto end = std::chrono::steady_clock::now() + patience;
  Status published = bus.publish(content);
  while (!published && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(kPause);
    published = bus.publish(content);
  }
  return published;
}

}  // namespace sealwatch
