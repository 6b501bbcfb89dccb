// What a service's journal may drop of its samples: what is older than the configuration says, or, where the journal is
// larger than it says, the oldest; never what somebody still needs:
//
//   every service that reads the topic has read it, by its own word since this one started: it has it in its own journal
//   for as long as it needs it; the test is set aside nowhere; it is not its asset's newest, which late subscribers get;
//   it is older than a day, so that no test still runs
//
// Pure: whoever owns it says the time.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "sealwatch/config/configuration.hpp"
#include "sealwatch/message/topics.hpp"

namespace sealwatch {

class Retention {
 public:
  struct Sample {
    Topic topic;
    std::vector<std::string> readers;
  };
  /// Topics with samples, and who reads them (docs/topics.md).
  [[nodiscard]] static const std::vector<Sample>& samples() {
    static const std::vector<Sample> all = {
        {Topic::sample_block, {"data_manipulation"}},
        {Topic::test_window, {"state_detection", "health_assessment", "prognostic_assessment"}}};
    return all;
  }

  explicit Retention(RetentionConfig config) : config_(config) {}

  [[nodiscard]] bool is_bounded() const { return config_.days > 0.0 || config_.megabytes > 0.0; }
  /// Takes note of how far a service has read the streams of `writer_id`.
  void hear(const ServiceStatus& status, const std::string& writer_id) {
    for (const StreamPosition& position : status.received)
      if (const auto topic = value_of<Topic>(position.topic); topic && position.writer_id == writer_id)
        read_[{*topic, status.service}] = position.sequence;
  }
  /// Up to where all readers have read; 0 where one of them has not been heard.
  [[nodiscard]] std::uint64_t read_by_all(const Sample& sample) const {
    std::uint64_t least = std::numeric_limits<std::uint64_t>::max();
    for (const std::string& reader : sample.readers) {
      const auto known = read_.find({sample.topic, reader});
      least = std::min(least, known == read_.end() ? 0 : known->second);
    }
    return least;
  }
  [[nodiscard]] bool is_over(UtcTime concluded, UtcTime now, double used_bytes) const {
    constexpr double kYoungest_days = 1.0;
    const double age_days = seconds_between(concluded, now) / kSecondsPerDay;
    if (age_days < kYoungest_days) return false;
    return (config_.days > 0.0 && age_days > config_.days) ||
           (config_.megabytes > 0.0 && used_bytes > 1e6 * config_.megabytes);
  }

 private:
  RetentionConfig config_;
  std::map<std::pair<Topic, std::string>, std::uint64_t> read_;  ///< by topic and service
};

}  // namespace sealwatch
