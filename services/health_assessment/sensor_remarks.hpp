// What the status of its channel and the alignment say about a sensor, as log-likelihood beside its signature.
//
//   FAILED                          +8   data acquisition saw it frozen, out of range, ...: 88 % on its own
//   OK in earlier tests, now lost   +6   50 % on its own: it may have been switched off on purpose
//   sign swapped, late or early     +7
#pragma once

#include <map>
#include <set>
#include <string>

#include "sealwatch/message/data_manipulation.hpp"
#include "sealwatch/message/state_detection.hpp"
#include "services/health_assessment/ambiguity.hpp"

namespace sealwatch {

using SensorRemarks = std::map<std::string, SensorRemark>;  // by element, "sensor:flow"

[[nodiscard]] SensorRemarks sensor_remarks(const StateReport& report, const TestFeatures& features);

/// Elements that a remark speaks of.
[[nodiscard]] std::set<std::string> suspects_of(const SensorRemarks& remarks);

/// Channels that this test has, whatever their status.
[[nodiscard]] std::set<std::string> recorded_channels(const TestFeatures& features);

}  // namespace sealwatch
