// All topics in one list: DDS type, journal and JSON are generated from it.
#pragma once

#include <string_view>
#include <variant>

#include "sealwatch/message/advisory_generation.hpp"
#include "sealwatch/message/data_acquisition.hpp"
#include "sealwatch/message/data_manipulation.hpp"
#include "sealwatch/message/health_assessment.hpp"
#include "sealwatch/message/prognostic_assessment.hpp"
#include "sealwatch/message/service.hpp"
#include "sealwatch/message/state_detection.hpp"

namespace sealwatch {

/// A message of one of the topics that carry assets' data (the service topics are the runtime's own affair).
using Message = std::variant<RawSamples, SampleBlock, TestWindow, TestFeatures, StateReport, HealthReport,
                             LeakageEstimate, RemainingLife, PstRequest, Advisory, Acknowledgement, MaintenanceEvent,
                             ModelDiscrepancy, ModelAcceptance>;

/// Same order as Message's alternatives: static_cast<Topic>(message.index()). A topic's DDS name is "sealwatch/" +
/// name.
SEALWATCH_ENUM(Topic, raw_samples, sample_block, test_window, test_features, state_report, health_report,
               leakage_estimate, remaining_life, pst_request, advisory, acknowledgement, maintenance_event,
               model_discrepancy, model_acceptance)

[[nodiscard]] inline Topic topic_of(const Message& message) { return static_cast<Topic>(message.index()); }
[[nodiscard]] inline const Header& header_of(const Message& message) {
  return std::visit([](const auto& m) -> const Header& { return m.header; }, message);
}
[[nodiscard]] inline Header& header_of(Message& message) {
  return std::visit([](auto& m) -> Header& { return m.header; }, message);
}
[[nodiscard]] inline const std::string& asset_of(const Message& message) {
  return std::visit([](const auto& m) -> const std::string& { return m.asset_id; }, message);
}

}  // namespace sealwatch
