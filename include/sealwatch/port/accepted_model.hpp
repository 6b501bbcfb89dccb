// The explained model that an operator has accepted for one asset, as layers keep it. Only what the services published
// comes into force: an acceptance names a model_discrepancy and carries its model, unaltered. One that comes before the
// discrepancy waits for it, and people are told. The next acceptance, a revocation or a replacement of what was analysed ends it.
//
// The inputs themselves are the memory: the acceptance in force, the last few discrepancies, and acceptances that wait
// stay unconsumed.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/core/time.hpp"
#include "sealwatch/message/advisory_generation.hpp"
#include "sealwatch/message/health_assessment.hpp"
#include "sealwatch/port/layer.hpp"

namespace sealwatch {

class AcceptedModel {
 public:
  static constexpr std::size_t kMostKnown = 8;    ///< discrepancies
  static constexpr std::size_t kMostWaiting = 8;  ///< acceptances
  static constexpr std::int64_t kPatience_ns = 3'600'000'000'000;

  void take(const ModelDiscrepancy& published, Conclusion& conclusion) {
    known_.push_back(published);
    forget_all_but(kMostKnown, conclusion);
    const auto its = std::ranges::find(waiting_, published.header.message_id, &ModelAcceptance::discrepancy_id);
    if (its == waiting_.end()) return;
    const ModelAcceptance acceptance = *its;
    const auto before = static_cast<std::size_t>(its - waiting_.begin());
    waiting_.erase(its);
    decide(acceptance, published, before, conclusion);
  }
  void take(const ModelAcceptance& acceptance, Conclusion& conclusion) {
    if (acceptance.revoked) return revoke(acceptance, conclusion);
    const auto named = std::ranges::find(known_, acceptance.discrepancy_id,
                                         [](const ModelDiscrepancy& one) { return one.header.message_id; });
    if (named != known_.end()) return decide(acceptance, *named, waiting_.size(), conclusion);
    if (waiting_.size() == kMostWaiting) refuse_first("others were accepted after it", conclusion);
    waiting_.push_back(acceptance);
  }
  void take(const MaintenanceEvent& event, Conclusion& conclusion) {
    const auto of_what_was_there = [&event](std::int64_t time_ns) {
      return !event.header.event_time_known || event.header.event_time_ns >= time_ns;
    };
    if (in_force_ && of_what_was_there(in_force_->discrepancy_time_ns)) end(conclusion);
    for (const ModelAcceptance& one : waiting_)  // fetched back, with what ended it, before the discrepancy
      if (of_what_was_there(one.discrepancy_time_ns)) conclusion.consumed.push_back(one.header.message_id);
    std::erase_if(waiting_, [&](const auto& one) { return of_what_was_there(one.discrepancy_time_ns); });
    for (const ModelDiscrepancy& one : known_)
      if (of_what_was_there(one.header.event_time_ns)) conclusion.consumed.push_back(one.header.message_id);
    std::erase_if(known_, [&](const auto& one) { return of_what_was_there(one.header.event_time_ns); });
  }
  /// Lets time pass: what names a discrepancy that nobody published does not wait for ever. It counts from the first
  /// call: who fetches back what was said years ago waits for its discrepancy from then on.
  void tick(UtcTime now, Conclusion& conclusion) {
    std::erase_if(waits_since_, [this](const auto& one) {
      return std::ranges::none_of(waiting_, [&](const auto& said) { return said.header.message_id == one.first; });
    });
    for (const ModelAcceptance& said : waiting_) waits_since_.try_emplace(said.header.message_id, now);
    while (!waiting_.empty() &&
           now.nanoseconds - waits_since_.at(waiting_.front().header.message_id).nanoseconds > kPatience_ns)
      refuse_first("no service has published it", conclusion);
  }

  /// Acceptances that count for nothing until the services publish what they name.
  [[nodiscard]] std::vector<Refusal> waiting() const {
    std::vector<Refusal> all;
    for (const ModelAcceptance& one : waiting_)
      all.push_back({one, "no service has published '" + one.discrepancy_id + "', whose model " + one.accepted_by +
                              " accepted: until one does it does not count"});
    return all;
  }

  [[nodiscard]] bool in_force() const { return in_force_.has_value(); }
  /// Inputs that are kept as memory (Layer::held).
  [[nodiscard]] std::size_t held() const { return known_.size() + waiting_.size() + (in_force_ ? 1 : 0); }
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
  void revoke(const ModelAcceptance& revocation, Conclusion& conclusion) {
    conclusion.consumed.push_back(revocation.header.message_id);
    if (in_force_ && in_force_->discrepancy_id == revocation.discrepancy_id) end(conclusion);
    for (const ModelAcceptance& one : waiting_)
      if (one.discrepancy_id == revocation.discrepancy_id) conclusion.consumed.push_back(one.header.message_id);
    std::erase_if(waiting_, [&](const auto& one) { return one.discrepancy_id == revocation.discrepancy_id; });
  }
  /// `earlier`: of those that wait, the first so many came before it.
  void decide(const ModelAcceptance& acceptance, const ModelDiscrepancy& named, std::size_t earlier,
              Conclusion& conclusion) {
    const bool explains = named.analysed && named.verdict == DiscrepancyVerdict::mismatch && !named.physics.empty();
    const bool unaltered = acceptance.explained == named.explained && acceptance.version == named.version &&
                           acceptance.discrepancy_time_ns == named.header.event_time_ns;
    if (!explains) return refuse(acceptance, "that explains nothing which could be accepted", conclusion);
    if (!unaltered) return refuse(acceptance, "its model is not the one that was published there", conclusion);
    for (; earlier > 0; --earlier) refuse_first("another was accepted after it", conclusion);
    end(conclusion);
    in_force_ = acceptance;
  }
  static void refuse(const ModelAcceptance& acceptance, const std::string& why, Conclusion& conclusion) {
    conclusion.consumed.push_back(acceptance.header.message_id);
    conclusion.refused.push_back({acceptance, "accepts '" + acceptance.discrepancy_id + "', and " + why});
  }
  void refuse_first(const std::string& why, Conclusion& conclusion) {
    refuse(waiting_.front(), why, conclusion);
    waiting_.pop_front();
  }
  /// The oldest go, but for the one in force.
  void forget_all_but(std::size_t most, Conclusion& conclusion) {
    if (known_.size() <= most) return;
    const auto oldest = std::ranges::find_if(
        known_, [this](const ModelDiscrepancy& one) { return one.header.message_id != discrepancy_id(); });
    conclusion.consumed.push_back(oldest->header.message_id);
    known_.erase(oldest);
  }
  void end(Conclusion& conclusion) {
    if (in_force_) conclusion.consumed.push_back(in_force_->header.message_id);
    in_force_.reset();
  }

  std::optional<ModelAcceptance> in_force_;
  std::deque<ModelDiscrepancy> known_;
  std::deque<ModelAcceptance> waiting_;
  std::map<std::string, UtcTime> waits_since_;  ///< of those that wait, by message id
};

}  // namespace sealwatch
