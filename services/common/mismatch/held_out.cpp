#include "services/common/mismatch/held_out.hpp"

#include <algorithm>
#include <optional>

#include "sealwatch/model/physics.hpp"
#include "services/common/core/in_parallel.hpp"
#include "services/common/mismatch/criterion.hpp"
#include "services/common/mismatch/explain_input.hpp"
#include "services/common/mismatch/own_values.hpp"
#include "services/common/mismatch/telling.hpp"
#include "services/common/mismatch/windows.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr std::size_t kMostInTurn = 4;  // recordings that are left out one by one; of more, a third at a time
constexpr std::size_t kThirds = 3;

std::size_t part_of(std::size_t recording, std::size_t count) {
  return count <= kMostInTurn ? recording : recording * kThirds / count;
}

// By a model that was fitted to other recordings; a parameter that differs from one to the next, and not by wear, is fitted.
Result<FittedModel> predict(const HeldOut& of, const FittedModel& model, const Data& fitted, const Data& data,
                            std::size_t recording) {
  AssetConfig asset = with_fixed_parameters(model.asset);
  const std::string& own = of.fit.own_parameter;
  if (!own.empty() && own == what_wears(asset))
    asset.parameters.at(own).value = predicted_leakage(model, fitted, data.start_time[recording]);
  else if (!own.empty())
    asset.parameters.at(own).estimate = true;
  Data one = in_windows(only(data, recording), of.window_s);
  one.own_parameter.clear();
  one.known.clear();  // as fitted
  one.relative_tolerance = tolerance_for(model);
  return fit_model(asset, one, nullptr, 1);
}

bool is_strength(const PhysicsTerm& term, const std::string& parameter) {
  return std::ranges::any_of(all_laws(), [&](const Law& law) {
    const auto of_law = std::ranges::find(law.parameters, parameter, &LawParameter::name);
    return law.id == term.id && of_law != law.parameters.end() && of_law->strength;
  });
}

// A law that changes nothing in the recordings that a model was fitted to keeps the strength that another one gave it:
// they say nothing of it, and it is no prediction of theirs.
void leave_out_untold(FittedModel& model) {
  constexpr double kTold = 0.01;  // of the misfit, to first order: a hundredth of what one sample's noise makes
  for (PhysicsTerm& term : model.asset.physics)
    for (auto& [parameter, setting] : term.parameters) {
      const std::string name = physics_parameter_name(term.element, term.id, parameter);
      const auto unknown = std::ranges::find(model.problem.shared, name, &Unknown::name);
      if (unknown == model.problem.shared.end() || !is_strength(term, parameter)) continue;
      const auto k = unknown - model.problem.shared.begin();
      const double size = unknown->logarithmic ? 1.0 : model.optimum.point.shared[static_cast<std::size_t>(k)];
      double change = 0.0;
      for (const Linearisation& at : model.optimum.at_optimum)
        change += at.jacobian.cols() > k ? at.jacobian.col(k).squaredNorm() * size * size : 2.0 * kTold;
      if (change < kTold) setting.value = 0.0;
    }
}

// Each of these recordings, by a model that was not fitted to them.
void predict_each(const HeldOut& of, const FittedModel& model, const Data& fitted, const Data& data, std::size_t first,
                  std::size_t end, Predictions& models) {
  auto each = in_parallel<std::optional<Result<FittedModel>>>(end - first, of.options.threads, [&](std::size_t k) {
    return std::optional(predict(of, model, fitted, data, first + k));
  });
  for (auto& one : each) models.push_back(std::move(*one));
}

// Places of the windows of all recordings but these among the windows of all; of whole recordings without windows.
std::vector<std::size_t> places_of_others(const Data& prepared, std::size_t first, std::size_t end) {
  std::vector<std::size_t> places;
  for (std::size_t k = 0; k < prepared.samples.size(); ++k) {
    const std::size_t recording = prepared.groups.empty() ? k : static_cast<std::size_t>(prepared.groups[k]);
    if (recording < first || recording >= end) places.push_back(k);
  }
  return places;
}

// The model fitted to the others of the recordings that it was fitted to, from where it is; from its asset where that
// does not lead to anything.
Result<FittedModel> fit_to_others(const HeldOut& of, const FittedModel& model, const Data& rest,
                                  std::span<const std::size_t> places) {
  const Data prepared = in_windows(rest, of.window_s);
  Result<FittedModel> refitted = fit_to_some(model, prepared, places, of.options.threads);
  return refitted ? std::move(refitted) : fit_model(model.asset, prepared, nullptr, of.options.threads);
}

// Each part of the fitted recordings by the model that is fitted to the others.
Predictions predict_in_turn(const HeldOut& of, const FittedModel& model) {
  Predictions models;
  const Data all = in_windows(of.fit, of.window_s);
  const std::size_t count = of.fit.samples.size();
  for (std::size_t first = 0; first < count;) {
    std::size_t end = first;
    while (end < count && part_of(end, count) == part_of(first, count)) ++end;
    Data rest = of.fit;
    for (std::size_t k = end; k-- > first;) rest = without(rest, k);
    Result<FittedModel> refitted = fit_to_others(of, model, rest, places_of_others(all, first, end));
    if (refitted) leave_out_untold(*refitted);
    if (refitted) predict_each(of, *refitted, rest, of.fit, first, end, models);
    for (std::size_t k = first; !refitted && k < end; ++k) models.emplace_back(fail(refitted.error()));
    first = end;
  }
  return models;
}

Result<RecordingComparison> compare_whole(const FittedModel& before, const FittedModel& after, const Data& data,
                                          std::size_t recording, double window_s) {
  if (window_s == 0.0) return compare(before, after, only(data, recording), 0);
  const auto old_model = free_run(before, data, recording), new_model = free_run(after, data, recording);
  if (!old_model) return fail(old_model.error());
  if (!new_model) return fail(new_model.error());
  return compare(*old_model, *new_model, only(data, recording), 0);
}

}  // namespace

Data in_windows(const Data& data, double window_s) { return window_s > 0.0 ? cut_into_windows(data, window_s) : data; }

Result<FittedModel> free_run(const FittedModel& model, const Data& data, std::size_t recording) {
  Data one = only(data, recording);
  one.known.clear();
  one.relative_tolerance = tolerance_for(model);
  return fit_model(with_fixed_parameters(model.asset), one, nullptr, 1);
}

void add_gain(RecordingComparison& comparison, const BlockGains& blocks, const FittedModel& after, std::uint64_t seed) {
  const GainInterval interval = gain_interval(blocks, dispersion(after), seed);
  comparison.likelihood_gain = interval.gain;
  comparison.gain_low = interval.low;
  comparison.gain_high = interval.high;
}

std::shared_ptr<const Predictions> HeldOut::predictions(const Trial& trial) const {
  KeptPredictions::Predicted& known = kept->of[{trial.model, in_turn()}];
  if (known.models != nullptr && (!known.cut || passed(fit.deadline))) return known.models;
  auto models = std::make_shared<Predictions>();
  if (in_turn() && fit.samples.size() >= 2) *models = predict_in_turn(*this, *trial.model);
  if (!in_turn()) predict_each(*this, *trial.model, fit, holdout, 0, holdout.samples.size(), *models);
  known = {.models = std::move(models), .cut = passed(fit.deadline)};
  return known.models;
}

Result<BlockGains> HeldOut::gains(const Trial& before, const Trial& after,
                                  std::vector<RecordingComparison>* compared) const {
  return gains(*predictions(before), *predictions(after), *after.model, compared);
}

Result<BlockGains> HeldOut::gains(const Predictions& before, const Predictions& after, const FittedModel& model_after,
                                  std::vector<RecordingComparison>* compared) const {
  BlockGains blocks;
  const Data& data = predicted();
  for (std::size_t k = 0; k < after.size(); ++k) {
    const Result<FittedModel>&old_model = before[k], &new_model = after[k];
    if (!new_model && compared == nullptr) return fail(new_model.error());
    if (!old_model || !new_model) {
      blocks.not_compared.push_back(data.names[k] + " (" +
                                    reason_in_words(old_model ? new_model.error() : old_model.error()) + ")");
      continue;
    }
    BlockGains own;
    for (std::size_t window = 0; window < old_model->problem.recordings.size(); ++window) {
      const BlockGains piece = block_gains(*old_model, *new_model, window);
      own.gain.insert(own.gain.end(), piece.gain.begin(), piece.gain.end());
    }
    blocks.gain.insert(blocks.gain.end(), own.gain.begin(), own.gain.end());
    if (compared == nullptr) continue;
    auto comparison = compare_whole(*old_model, *new_model, data, k, window_s);
    if (!comparison) {
      blocks.not_compared.push_back(data.names[k] + " as a whole (" + reason_in_words(comparison.error()) + ")");
      continue;
    }
    (in_turn() ? comparison->left_out : comparison->holdout) = true;
    add_gain(*comparison, own, model_after, options.seed);
    compared->push_back(std::move(*comparison));
  }
  return blocks;
}

}  // namespace sealwatch::mismatch
