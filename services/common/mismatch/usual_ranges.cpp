#include "services/common/mismatch/usual_ranges.hpp"

#include <cmath>

#include "services/common/mismatch/criterion.hpp"
#include "services/common/mismatch/verdict.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr double kUsualRange = 10.0;  // about a value

// Powers of ten from its middle to its ends: one where nobody gave it, more where it was widened; 0 for any other range.
int powers_of(const ParameterSetting& setting) {
  constexpr double kRounded = 1e-9;
  if (setting.min <= 0.0 || setting.max <= setting.min) return 0;
  const double powers = 0.5 * std::log10(setting.max / setting.min);
  return std::abs(powers - std::round(powers)) < kRounded ? static_cast<int>(std::lround(powers)) : 0;
}

// False where no parameter is at an end of a usual range.
bool widen(const FittedModel& model, AssetConfig& asset) {
  bool widened = false;
  for (std::size_t k = 0; k < model.problem.shared.size(); ++k) {
    const auto parameter = asset.parameters.find(model.problem.shared[k].name);
    if (parameter == asset.parameters.end() || !at_bound(model.problem.shared[k], model.optimum.point.shared[k]))
      continue;
    if (powers_of(parameter->second) == 0) continue;
    parameter->second.min /= kUsualRange;
    parameter->second.max *= kUsualRange;
    widened = true;
  }
  return widened;
}

}  // namespace

FittedModel beyond_usual_ranges(FittedModel model, const Data& data, int threads) {
  AssetConfig wider = model.asset;
  while (excess(model) > kGross && widen(model, wider)) {
    Result<FittedModel> again = fit_model(wider, data, &model, threads);
    if (!again || again->misfit > (1.0 - kExplainedAtLeast) * model.misfit) break;
    model = std::move(*again);
    wider = model.asset;
  }
  return model;
}

std::vector<std::string> wider_ranges_in_words(const AssetConfig& asset) {
  std::vector<std::string> sentences;
  for (const auto& [name, setting] : asset.parameters)
    if (setting.estimate && powers_of(setting) > 1)
      sentences.push_back("No range is given for " + name + ", and a tenth to ten times its value was too narrow.");
  return sentences;
}

}  // namespace sealwatch::mismatch
