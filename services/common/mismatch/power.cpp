#include "services/common/mismatch/power.hpp"

#include <algorithm>

#include "services/common/mismatch/effects.hpp"

namespace sealwatch::mismatch {
namespace {

// Laws that hide in free parameters, how much larger than an engineer's limit they would have to be to show, and how
// far they would then have moved the seal's estimate, before the data is said to be too poor.
constexpr double kConcealed = 0.5;
constexpr double kTooLarge = 1.0;
constexpr double kLeakageMatters = 0.1;  // of R_CL: the standard error above which a fit is not admissible either

}  // namespace

std::vector<Power> power_of(const Screening& screening, const PlantDescription& plant) {
  std::vector<Power> power;
  for (const Variant& variant : screening.variants) {
    const Candidate& candidate = screening.candidates[variant.candidate];
    if (variant.point != 0) continue;
    const LawParameter& strength = candidate.law->parameters[strengths_of(*candidate.law).front()];
    power.push_back({.what = law_at({candidate.law, candidate.element}, plant),
                     .minimum_detectable = variant.minimum_detectable,
                     .unit = unit_of(strength, candidate.element, plant),
                     .absorbed_share = std::clamp(variant.absorbed, 0.0, 1.0),
                     .significant = significant_size(candidate, plant),
                     .leakage_shift = variant.leakage_shift});
  }
  std::ranges::stable_sort(power, {}, [](const Power& one) { return one.what.id; });
  return power;
}

std::vector<const Power*> could_not_show(const std::vector<Power>& power) {
  std::vector<const Power*> blind;
  for (const Power& one : power)
    if (one.absorbed_share > kConcealed && one.minimum_detectable > kTooLarge * one.significant &&
        one.leakage_shift > kLeakageMatters && one.significant > 0.0)
      blind.push_back(&one);
  return blind;
}

}  // namespace sealwatch::mismatch
