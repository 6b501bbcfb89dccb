// All topics in one list: DDS type, journal and JSON are generated from it.
#pragma once

#include <string>
#include <string_view>
#include <variant>

#include "sealwatch/message/act_record.hpp"
#include "sealwatch/message/advisory_generation.hpp"
#include "sealwatch/message/data_acquisition.hpp"
#include "sealwatch/message/data_manipulation.hpp"
#include "sealwatch/message/health_assessment.hpp"
#include "sealwatch/message/prognostic_assessment.hpp"
#include "sealwatch/message/service.hpp"
#include "sealwatch/message/state_detection.hpp"

namespace sealwatch {

using MessageAlternatives = std::variant<RawSamples, SampleBlock, TestWindow, TestFeatures, StateReport, HealthReport,
                                         LeakageEstimate, RemainingLife, PstRequest, Advisory, Acknowledgement,
                                         MaintenanceEvent, ModelDiscrepancy, ModelAcceptance, ActRecord>;

/// A message of one of the topics that carry assets' data (the service topics are the runtime's own affair). A variant
/// with a name of its own, so that copying, moving and destroying fifteen topics is compiled once and not in each of
/// the 150 files that hold one: two seconds a file.
struct Message : MessageAlternatives {
  using MessageAlternatives::MessageAlternatives;
  Message();
  Message(const Message& other);
  Message(Message&& other) noexcept;
  Message& operator=(const Message& other);
  Message& operator=(Message&& other) noexcept;
  ~Message();
};

/// Same order as Message's alternatives: static_cast<Topic>(message.index()). A topic's DDS name is "sealwatch/" +
/// name.
SEALWATCH_ENUM(Topic, raw_samples, sample_block, test_window, test_features, state_report, health_report,
               leakage_estimate, remaining_life, pst_request, advisory, acknowledgement, maintenance_event,
               model_discrepancy, model_acceptance, act_record)

[[nodiscard]] inline Topic topic_of(const Message& message) { return static_cast<Topic>(message.index()); }
[[nodiscard]] const Header& header_of(const Message& message);
[[nodiscard]] Header& header_of(Message& message);
[[nodiscard]] const std::string& asset_of(const Message& message);

}  // namespace sealwatch
