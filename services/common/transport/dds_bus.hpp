// Bus over Cyclone DDS: one participant, one DDS topic for each sealwatch topic ("sealwatch/" + name), writers made at
// the first publish. QoS: docs/topics.md. No DDS type shows here; only services/common/transport includes DDS headers.
#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>

#include "sealwatch/config/configuration.hpp"
#include "sealwatch/core/result.hpp"
#include "sealwatch/port/bus.hpp"

namespace sealwatch {

/// What becomes of messages beyond what a bus holds for an owner that does not call receive. Either way nobody waits.
enum class SlowReader {
  asks_again,    ///< the newest numbered ones are left out: their writers' journals have them (services)
  loses_oldest,  ///< only the last of each asset stay (watchers and clients)
};

class DdsBus : public Bus {
 public:
  /// Makes the writer of `topic` and waits until at least `count` readers of it are matched. For whoever sends from the
  /// start on, like a replay: what is published before a reader is known reaches it only as the last of each asset.
  [[nodiscard]] virtual Status wait_for_subscribers(Topic topic, std::size_t count,
                                                    std::chrono::milliseconds timeout) = 0;
};

/// Joins configuration.domain. Cyclone's own settings come from the environment's CYCLONEDDS_URI where it is set, else
/// from configuration.cyclonedds_uri, else they keep to this machine (loopback, multicast, lease of 2 s); all buses of
/// a process that share a domain share the first one's settings.
[[nodiscard]] Result<std::unique_ptr<DdsBus>> open_dds_bus(const Configuration& configuration,
                                                           SlowReader slow_reader = SlowReader::asks_again);

/// Whether Cyclone DDS takes these settings (configuration.cyclonedds_uri); what it has against them it says on
/// standard error.
[[nodiscard]] Status check_dds_settings(const std::string& cyclonedds_uri);

/// Others whom Cyclone DDS refused since the last call: by DDS Security, in its own words, or as they offer less than
/// the services' readers ask for; nothing when it was nobody. One caller in a process.
[[nodiscard]] std::optional<std::string> refused_by_dds();

/// The same as the plain port.
[[nodiscard]] Result<std::unique_ptr<Bus>> make_dds_bus(const Configuration& configuration);

}  // namespace sealwatch
