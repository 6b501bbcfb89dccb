// The explained model that an operator has accepted for one asset, as layers keep it. The acceptance itself is the
// memory: an input that stays unconsumed for as long as it is in force. The next acceptance, a revocation or a
// replacement of what was analysed ends it.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/message/advisory_generation.hpp"
#include "sealwatch/message/health_assessment.hpp"

namespace sealwatch {

class AcceptedModel {
 public:
  /// Ids of the messages that are no longer needed.
  [[nodiscard]] std::vector<std::string> take(const ModelAcceptance& acceptance) {
    std::vector<std::string> over;
    if (acceptance.revoked) {
      over.push_back(acceptance.header.message_id);
      if (in_force_ && in_force_->discrepancy_id == acceptance.discrepancy_id) end(over);
      return over;
    }
    end(over);
    in_force_ = acceptance;
    return over;
  }
  [[nodiscard]] std::vector<std::string> take(const MaintenanceEvent& event) {
    std::vector<std::string> over;
    const bool of_what_was_there =
        in_force_ && (!event.header.event_time_known || event.header.event_time_ns >= in_force_->discrepancy_time_ns);
    if (of_what_was_there) end(over);
    return over;
  }

  [[nodiscard]] bool in_force() const { return in_force_.has_value(); }
  /// "" when none is.
  [[nodiscard]] std::string discrepancy_id() const { return in_force_ ? in_force_->discrepancy_id : std::string(); }

  /// The asset with the accepted model's parameters and physics; as it is when none is in force or when it is of
  /// another plant.
  [[nodiscard]] AssetConfig applied_to(AssetConfig asset) const {
    if (!in_force_ || in_force_->explained.model != asset.model) return asset;
    for (const ModelParameter& parameter : in_force_->explained.parameters)
      if (const auto known = asset.parameters.find(parameter.name); known != asset.parameters.end())
        known->second = setting_of(parameter);
    asset.physics.clear();
    for (const ModelPhysics& law : in_force_->explained.physics) {
      PhysicsTerm& term =
          asset.physics.emplace_back(PhysicsTerm{.id = law.id, .element = law.element, .parameters = {}});
      for (const ModelParameter& parameter : law.parameters) term.parameters[parameter.name] = setting_of(parameter);
    }
    return asset;
  }

 private:
  static ParameterSetting setting_of(const ModelParameter& parameter) {
    return {.value = parameter.value, .min = parameter.min, .max = parameter.max, .estimate = parameter.estimate};
  }
  void end(std::vector<std::string>& over) {
    if (in_force_) over.push_back(in_force_->header.message_id);
    in_force_.reset();
  }

  std::optional<ModelAcceptance> in_force_;
};

}  // namespace sealwatch
