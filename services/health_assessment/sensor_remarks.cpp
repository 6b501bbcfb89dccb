#include "services/health_assessment/sensor_remarks.hpp"

namespace sealwatch {
namespace {

constexpr double kFailed = 8.0;
constexpr double kLost = 6.0;
constexpr double kMisaligned = 7.0;

}  // namespace

SensorRemarks sensor_remarks(const StateReport& report, const TestFeatures& features) {
  SensorRemarks remarks;
  for (const AlignmentRemark& alignment : features.alignment) {
    const std::string what = alignment.sign_swapped ? "its sign is swapped" : "it is out of step";
    remarks["sensor:" + alignment.channel] = {kMisaligned, alignment.remark.empty() ? what : alignment.remark};
  }
  for (const std::string& channel : report.stale_channels)
    remarks["sensor:" + channel] = {kLost, "the channel was OK in most earlier tests and is not in this one"};
  for (const ChannelStatus& status : features.channel_status)
    if (status.state == ChannelState::FAILED)
      remarks["sensor:" + status.channel] = {kFailed, "the channel is FAILED: " + status.reason};
  return remarks;
}

std::set<std::string> suspects_of(const SensorRemarks& remarks) {
  std::set<std::string> elements;
  for (const auto& [element, remark] : remarks) elements.insert(element);
  return elements;
}

std::set<std::string> recorded_channels(const TestFeatures& features) {
  std::set<std::string> channels;
  for (const ChannelStatus& status : features.channel_status)
    if (status.state != ChannelState::NOT_USED) channels.insert(status.channel);
  return channels;
}

}  // namespace sealwatch
