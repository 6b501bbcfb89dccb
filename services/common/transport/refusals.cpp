#include "services/common/transport/refusals.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <mutex>
#include <optional>
#include <string>

#include "dds/ddsrt/log.h"
#include "services/common/transport/dds_bus.hpp"

namespace sealwatch {
namespace {

struct Refusals {
  std::mutex mutex;
  std::string last;
  std::size_t count = 0;
};
Refusals& refusals() {
  static Refusals instance;
  return instance;
}

void take_line(void* /*unused*/, const dds_log_data_t* data) {
  const std::string_view line(data->message, data->size);
  std::fwrite(line.data(), 1, line.size(), stderr);
  if (!line.ends_with('\n')) std::fputc('\n', stderr);
  if (transport::tells_a_refusal(line))
    transport::note_refusal("DDS Security refused a connection; last message of Cyclone: " +
                            std::string(line.substr(0, line.find_last_not_of("\n ") + 1)));
}

}  // namespace

namespace transport {

// By Cyclone 0.10: in ddsi_security_omg.c, ddsi_handshake.c and its three plugins.
bool tells_a_refusal(std::string_view line) {
  constexpr std::array<std::string_view, 7> kWords = {"handshake reply failed",    "handshake request failed",
                                                      "process handshake failed",  "could not get remote participant",
                                                      "does not have permissions", "non secure remote",
                                                      "not allowed by security"};
  const auto same = [](char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
  };
  return std::ranges::any_of(kWords, [&](std::string_view words) {
    return std::search(line.begin(), line.end(), words.begin(), words.end(), same) != line.end();
  });
}

void note_refusal(const std::string& words) {
  Refusals& known = refusals();
  const std::lock_guard lock(known.mutex);
  known.last = words;
  ++known.count;
}

void listen_to_cyclone() {
  static const bool once = (dds_set_log_sink(&take_line, nullptr), true);
  (void)once;
}

}  // namespace transport

std::optional<std::string> refused_by_dds() {
  Refusals& known = refusals();
  const std::lock_guard lock(known.mutex);
  if (known.count == 0) return std::nullopt;
  known.count = 0;
  return known.last;
}

}  // namespace sealwatch
