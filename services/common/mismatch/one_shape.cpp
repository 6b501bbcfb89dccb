#include "services/common/mismatch/one_shape.hpp"

#include <algorithm>
#include <cmath>

#include "services/common/mismatch/standard_errors.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr double kUncertain = 1.0 / 3.0;  // of a strength: its standard error
constexpr double kExplainsEnough = 0.5;   // of what they take

bool is_uncertain(const Effect& effect, const FittedModel& model, const std::vector<double>& errors) {
  for (const LawParameter& parameter : effect.law->parameters) {
    if (!parameter.strength) continue;
    const std::string name = physics_parameter_name(effect.element, effect.law->id, parameter.name);
    for (std::size_t k = 0; k < errors.size(); ++k)
      if (model.problem.shared[k].name == name)
        return std::isfinite(errors[k]) && errors[k] > kUncertain * std::abs(*estimate_of(model, name));
  }
  return false;
}

bool imitate_one_shape(const Trial& best) {
  const auto elsewhere = [&](const Effect& effect) { return effect.element != best.effects.front().element; };
  if (best.effects.size() < 2 || std::ranges::any_of(best.effects, elsewhere)) return false;
  const std::vector<double> errors = standard_errors(*best.model);
  return std::ranges::count_if(best.effects,
                               [&](const Effect& effect) { return is_uncertain(effect, *best.model, errors); }) >= 2;
}

}  // namespace

void one_shape_for_several(Naming& naming, const Data& data, const ExplainOptions& options) {
  if (!imitate_one_shape(naming.best)) return;
  const std::string& element = naming.best.effects.front().element;
  const Trial* form = nullptr;
  for (const Trial& trial : naming.trials) {
    if (trial.effects.size() != 1 || !trial.effects[0].law->closed_form || trial.effects[0].element != element)
      continue;
    if (form == nullptr || trial.model->misfit < form->model->misfit) form = &trial;
  }
  const double taken = naming.baseline->misfit - naming.best.model->misfit;
  if (form == nullptr || naming.baseline->misfit - form->model->misfit < kExplainsEnough * taken) return;
  auto last = screen(*form->model, data, {.seed = options.seed, .threads = options.threads});
  if (!last) return;
  naming.best = with_derivatives(*form, data, options.threads);
  naming.last = std::move(*last);
}

}  // namespace sealwatch::mismatch
