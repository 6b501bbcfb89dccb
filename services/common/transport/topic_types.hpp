// Every topic's DDS type, and samples of it to and from sealwatch's messages.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <memory_resource>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "dds/dds.h"
#include "sealwatch/config/configuration.hpp"
#include "sealwatch/port/bus.hpp"

namespace sealwatch::transport {

/// Everything that tells one topic from another at run time.
struct TopicType {
  std::string name;  ///< without the prefix: "advisory"
  const dds_topic_descriptor_t* descriptor = nullptr;
  /// None where the bytes are no such message; what only its header tells of is one that says so (message/outside.hpp).
  /// They are Cyclone's, with the four that name their encoding.
  std::unique_ptr<BusItem> (*decode)(std::span<const std::byte> bytes) = nullptr;  ///< null: no message
  TopicQos qos;  ///< default; a Configuration may override it
  /// Messages that wait for a reader's owner (inbox.hpp), and how many are taken from DDS at once. Of bulky topics
  /// (windows of samples, up to about 1 MB each) few wait.
  std::int32_t reader_limit = 0;
  std::size_t batch = 0;
};

/// Index of a topic in topic_types(): static_cast<std::size_t>(Topic), then these.
inline constexpr std::size_t kServiceStatusIndex = EnumNames<Topic>::kNames.size();
inline constexpr std::size_t kResendRequestIndex = kServiceStatusIndex + 1;
/// maintenance_event of its own: what retracts tests, so that DDS Security can grant the one right without the other.
inline constexpr std::size_t kRetractionIndex = kResendRequestIndex + 1;
inline constexpr std::size_t kTopicCount = kRetractionIndex + 1;

[[nodiscard]] const std::vector<TopicType>& topic_types();

/// A message as the C struct that dds_write takes; valid as long as the message is.
class DdsSample {
 public:
  explicit DdsSample(const Message& message);
  explicit DdsSample(const ServiceStatus& status);
  explicit DdsSample(const ResendRequest& request);
  DdsSample(const DdsSample&) = delete;
  DdsSample& operator=(const DdsSample&) = delete;
  [[nodiscard]] const void* get() const { return sample_; }

 private:
  template <class T>
  void lend(const T& message);

  std::array<std::byte, 4096> first_buffer_;
  std::pmr::monotonic_buffer_resource memory_{first_buffer_.data(), first_buffer_.size()};
  const void* sample_ = nullptr;
};

}  // namespace sealwatch::transport
