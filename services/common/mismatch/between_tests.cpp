#include "services/common/mismatch/between_tests.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "services/common/mismatch/effects.hpp"
#include "services/common/mismatch/telling.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr double kAgrees = 1.5;    // mean square over the noise's, of one recording by itself
constexpr double kChanged = 10.0;  // standard errors between the smallest and the largest value

struct Course {
  double least = INFINITY, most = -INFINITY, largest_std = 0.0;
  std::string unit;
  [[nodiscard]] double standard_errors() const { return largest_std > 0.0 ? (most - least) / largest_std : 0.0; }
};

struct Misfit {
  double sum = 0.0, residuals = 0.0;
};

/// Of the model with its laws on all recordings; nothing where it cannot be simulated on a held-out one.
std::optional<Misfit> misfit_in_common(const FittedModel& best, const Data& holdout) {
  Misfit all{best.misfit, best.residuals};
  if (holdout.samples.empty()) return all;
  const Result<FittedModel> held_out = fit_model(with_fixed_parameters(best.asset), holdout, nullptr, 1);
  if (!held_out) return std::nullopt;
  return Misfit{all.sum + held_out->misfit, all.residuals + held_out->residuals};
}

std::vector<Data> one_by_one(const Data& data) {
  std::vector<Data> ones;
  for (std::size_t k = 0; k < data.samples.size(); ++k) {
    ones.push_back({.names = {data.names[k]},
                    .samples = {data.samples[k]},
                    .colour = {},
                    .groups = {},
                    .resolution = data.resolution});
    if (!data.colour.empty()) ones.back().colour = {data.colour[k]};
  }
  return ones;
}

}  // namespace

std::optional<std::string> change_between_tests(const AssetConfig& asset, const Data& fit, const Data& holdout,
                                                const FittedModel& best) {
  std::map<std::string, Course> courses;
  double largest_misfit = 0.0, misfit = 0.0, free = 0.0;
  std::vector<Data> ones = one_by_one(fit);
  for (Data& one : one_by_one(holdout)) ones.push_back(std::move(one));
  for (const Data& one : ones) {
    const Result<FittedModel> model = fit_model(asset, one, nullptr, 1);
    if (!model || model->misfit > kAgrees * model->residuals) return std::nullopt;
    largest_misfit = std::max(largest_misfit, model->misfit / model->residuals);
    misfit += model->misfit;
    free += static_cast<double>(model->free_shared);
    for (const ParameterShift& parameter : parameter_shifts(asset, *model, *model)) {
      if (!std::isfinite(parameter.after_std)) continue;
      Course& course = courses[parameter.name];
      course.least = std::min(course.least, parameter.after);
      course.most = std::max(course.most, parameter.after);
      course.largest_std = std::max(course.largest_std, parameter.after_std);
      course.unit = parameter.unit;
    }
  }
  const std::optional<Misfit> common = misfit_in_common(best, holdout);
  if (!common) return std::nullopt;
  const double phi = std::max(1.0, misfit / common->residuals), penalty = std::log(common->residuals);
  if (misfit / phi + free * penalty >= common->sum / phi + static_cast<double>(best.free_shared) * penalty)
    return std::nullopt;
  const auto changed =
      std::ranges::max_element(courses, {}, [](const auto& entry) { return entry.second.standard_errors(); });
  if (changed == courses.end() || changed->second.standard_errors() < kChanged) return std::nullopt;
  std::string text = "Each recording alone agrees with the model (mean squared residual at most ";
  text.append(number(largest_misfit)).append(" times the noise's), all together do not: ").append(changed->first);
  text.append(" runs from ").append(number(changed->second.least)).append(" to ").append(number(changed->second.most));
  text.append(" ").append(changed->second.unit).append(" from test to test, ");
  text.append(number(changed->second.standard_errors()));
  text.append(" standard errors. The asset changed between these tests; missing physics cannot be seen within one.");
  return text;
}

}  // namespace sealwatch::mismatch
