#include "services/common/mismatch/usual_ranges.hpp"

#include <cmath>

#include "services/common/mismatch/criterion.hpp"
#include "services/common/mismatch/verdict.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr double kUsualRange = 10.0;  // about a value

bool are_equal(double one, double other) {
  constexpr double kRounded = 1e-9;
  return std::abs(one - other) <= kRounded * std::abs(other);
}

// The plant's own range of a parameter where nobody gave it; null for any other.
const ParameterDescription* find_usual_range(const PlantDescription& plant, const std::string& name) {
  const ParameterDescription* const own = plant.find_parameter(name);
  const bool usual =
      own != nullptr && are_equal(kUsualRange * own->min, own->value) && are_equal(own->max, kUsualRange * own->value);
  return usual ? own : nullptr;
}

// Whether it is the plant's own, as it is or widened: its middle stays.
bool is_of_usual_range(const ParameterSetting& setting, const ParameterDescription& own) {
  return setting.max >= own.max && are_equal(setting.min * setting.max, own.min * own.max);
}

// False where no parameter is at an end of a usual range.
bool widen(const FittedModel& model, AssetConfig& asset) {
  const PlantDescription& plant = model.problem.recordings.front().simulation->plant();
  bool widened = false;
  for (std::size_t k = 0; k < model.problem.shared.size(); ++k) {
    const auto parameter = asset.parameters.find(model.problem.shared[k].name);
    if (parameter == asset.parameters.end() || !at_bound(model.problem.shared[k], model.optimum.point.shared[k]))
      continue;
    const ParameterDescription* const own = find_usual_range(plant, parameter->first);
    if (own == nullptr || !is_of_usual_range(parameter->second, *own)) continue;
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

std::vector<std::string> wider_ranges_in_words(const AssetConfig& fitted, const AssetConfig& given) {
  std::vector<std::string> sentences;
  for (const auto& [name, setting] : fitted.parameters)
    if (const auto before = given.parameters.find(name);
        before != given.parameters.end() && setting.max > before->second.max)
      sentences.push_back("No range is given for " + name + ", and a tenth to ten times its value was too narrow.");
  return sentences;
}

}  // namespace sealwatch::mismatch
