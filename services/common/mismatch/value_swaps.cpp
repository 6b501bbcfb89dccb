#include "services/common/mismatch/value_swaps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <ranges>
#include <utility>

#include "services/common/core/in_parallel.hpp"
#include "services/common/mismatch/candidates.hpp"
#include "services/common/mismatch/criterion.hpp"
#include "services/common/mismatch/linear_algebra.hpp"
#include "services/common/mismatch/normal_equations.hpp"
#include "services/common/mismatch/tolerance.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr std::size_t kFitted = 4;  // swaps that are fitted: those that promise most
constexpr int kIterations = 10;     // of each, before the best of them go on
// Of what the laws' going costs, a wrong value takes on nearly all on the linear model, and what promises that much less
// than another is not fitted.
constexpr double kNearlyAll = 0.9;
constexpr double kGrossOptimism = 10.0;
// Times what the linear model promises of a value beside all laws: it is off by half at most, and does little that the
// model does not tell. In place of laws it promises no fall but a rise.
constexpr double kMostOfPromise = 3.0;

bool is_among(const std::vector<std::size_t>& slots, std::size_t slot) {
  return std::ranges::find(slots, slot) != slots.end();
}

// The asset as it was found, without the laws and free values that go, and with the value free from where it was known.
AssetConfig swapped(const SwapQuestion& of, const std::vector<std::size_t>& out, const KnownValue& value) {
  const Trial& found = of.found;
  AssetConfig asset = found.model->asset;
  for (const KnownValue& back : of.back) {
    ParameterSetting& setting = asset.parameters.at(back.name);
    setting.value = back.value;
    setting.estimate = false;
  }
  const auto first = asset.physics.size() - found.effects.size();
  for (const std::size_t slot : out | std::views::reverse)
    asset.physics.erase(asset.physics.begin() + static_cast<std::ptrdiff_t>(first + slot));
  asset.parameters.at(value.name).value = value.value;
  return with_free_value(std::move(asset), value.name);
}

// A swap on the linear model.
struct Promise {
  KnownValue value;
  std::vector<std::size_t> out;
  double misfit = 0.0;
  double parameters = 0.0;  ///< more than what was found has
  double slack = 0.0;       ///< by which the linear model may be wrong here
  double predicted = 0.0;   ///< the value
  PemPoint change = {};     ///< of the unknowns of the model with all values
};

class LinearSwaps {
 public:
  // `all`: what was found, with all values as unknowns within their tolerances.
  LinearSwaps(const SwapQuestion& of, const FittedModel& all)
      : found_(of.found), back_(of.back), all_(all), normal_(normal_equations(all)) {
    normal_.gradient *= -1.0;  // J is of the residuals
    const std::vector<Unknown>& shared = all.problem.shared;
    for (std::size_t k = 0; k < shared.size(); ++k) {
      if (!shared[k].is_known()) continue;
      const auto at = static_cast<Eigen::Index>(k);
      normal_.gram(at, at) += 1.0 / (shared[k].prior_std * shared[k].prior_std);
      normal_.gradient(at) += shared[k].prior_residual(all.optimum.point.shared[k]) / shared[k].prior_std;
    }
  }

  /// The least misfit without the effects `out`, with everything else within its range; a value that is free may be off
  /// by kOffByAtMost.
  struct Least {
    double misfit = 0.0;
    Eigen::VectorXd change;
  };
  [[nodiscard]] Least least(const std::vector<std::size_t>& out, const KnownValue* value = nullptr) const {
    constexpr int kRounds = 8;  // in which what would leave its range is held at its end
    double misfit = all_.misfit;
    Eigen::MatrixXd gram = normal_.gram;
    Eigen::VectorXd gradient = normal_.gradient, change = Eigen::VectorXd::Zero(gradient.size());
    std::vector<Eigen::Index> free;
    for (Eigen::Index j = 0; j < change.size(); ++j) {
      const bool shared = j < std::ssize(all_.problem.shared);
      const std::optional<double> gone = shared ? without(out, static_cast<std::size_t>(j)) : std::nullopt;
      if (gone)
        change(j) = *gone;
      else
        free.push_back(j);
      if (shared && value != nullptr && name_of(j) == value->name) misfit -= take_off_what_is_known(j, gram, gradient);
    }
    for (int round = 0; round < kRounds; ++round) {
      change(free) = Eigen::VectorXd::Zero(std::ssize(free));
      const Eigen::VectorXd right = gradient - gram * change;
      change(free) = NormalMatrix(submatrix(gram, free)).solve(subvector(right, free)).col(0);
      if (std::erase_if(free, [&](Eigen::Index j) { return is_held(j, value, change(j)); }) == 0) break;
    }
    return {.misfit = misfit + change.dot(gram * change) - 2.0 * change.dot(gradient), .change = change};
  }

  [[nodiscard]] Promise promise(const std::vector<std::size_t>& out, const KnownValue& value) const {
    const Least least = this->least(out, &value);
    double parameters = 1.0, predicted = value.value;
    for (std::size_t j = 0; j < all_.problem.shared.size(); ++j) {
      const Unknown& unknown = all_.problem.shared[j];
      if (without(out, j)) parameters -= 1.0;
      if (unknown.name == value.name)
        predicted = unknown.to_value(all_.optimum.point.shared[j] + least.change(static_cast<Eigen::Index>(j)));
    }
    return {.value = value,
            .out = out,
            .misfit = least.misfit,
            .parameters = parameters,
            .slack = 0.0,
            .predicted = predicted,
            .change = point_of(least.change)};
  }

 private:
  [[nodiscard]] const std::string& name_of(Eigen::Index shared) const {
    return all_.problem.shared[static_cast<std::size_t>(shared)].name;
  }

  // Its share of the misfit, which goes with it.
  double take_off_what_is_known(Eigen::Index of, Eigen::MatrixXd& gram, Eigen::VectorXd& gradient) const {
    const Unknown& unknown = all_.problem.shared[static_cast<std::size_t>(of)];
    if (!unknown.is_known()) return 0.0;
    const double residual = unknown.prior_residual(all_.optimum.point.shared[static_cast<std::size_t>(of)]);
    gram(of, of) -= 1.0 / (unknown.prior_std * unknown.prior_std);
    gradient(of) -= residual / unknown.prior_std;
    return residual * residual;
  }

  // A change that leads out of the range is that to its end.
  [[nodiscard]] bool is_held(Eigen::Index of, const KnownValue* value, double& change) const {
    if (of >= std::ssize(all_.problem.shared)) return false;
    const Unknown& unknown = all_.problem.shared[static_cast<std::size_t>(of)];
    const double at = all_.optimum.point.shared[static_cast<std::size_t>(of)];
    double least = unknown.to_unknown(unknown.min) - at, most = unknown.to_unknown(unknown.max) - at;
    if (value != nullptr && unknown.name == value->name) {
      AssetConfig asset = found_.model->asset;
      asset.parameters.at(value->name).value = value->value;
      const ParameterSetting free = with_free_value(std::move(asset), value->name).parameters.at(value->name);
      least = unknown.to_unknown(free.min) - at;
      most = unknown.to_unknown(free.max) - at;
    }
    if (change >= least && change <= most) return false;
    change = std::clamp(change, std::min(least, most), std::max(least, most));
    return true;
  }

  // By how much a shared unknown changes as what it belongs to goes; nothing where that stays. Without its strength a
  // law's shape does nothing.
  [[nodiscard]] std::optional<double> without(const std::vector<std::size_t>& out, std::size_t unknown) const {
    const Unknown& of = all_.problem.shared[unknown];
    const double at = all_.optimum.point.shared[unknown];
    if (const auto back = std::ranges::find(back_, of.name, &KnownValue::name); back != back_.end())
      return of.to_unknown(back->value) - at;
    for (const std::size_t slot : out)
      for (const LawParameter& parameter : found_.effects[slot].law->parameters)
        if (of.name ==
            physics_parameter_name(found_.effects[slot].element, found_.effects[slot].law->id, parameter.name))
          return parameter.strength ? -at : 0.0;
    return std::nullopt;
  }

  [[nodiscard]] PemPoint point_of(const Eigen::VectorXd& change) const {
    Eigen::Index at = 0;
    const auto take = [&](std::size_t count) {
      std::vector<double> values(count);
      for (double& value : values) value = change(at++);
      return values;
    };
    PemPoint point{.shared = take(all_.problem.shared.size()), .own = {}};
    for (const PemRecording& part : all_.problem.recordings) point.own.push_back(take(part.own.size()));
    return point;
  }

  const Trial& found_;
  const std::vector<KnownValue>& back_;
  const FittedModel& all_;
  NormalEquations normal_;  ///< what is known included
};

// What was found, with every value as an unknown within its tolerance.
Result<FittedModel> with_all_values(const SwapQuestion& of) {
  Data all = of.data;
  std::erase_if(all.known, [&](const KnownValue& one) {
    return std::ranges::find(of.values, one.name, &KnownValue::name) != of.values.end();
  });
  all.known.insert(all.known.begin(), of.values.begin(), of.values.end());
  return fit_model(of.found.model->asset, all, of.found.model.get(), of.threads, 0);
}

// The most promising first, by the criterion that they would come to.
std::vector<Promise> promises_of(const SwapQuestion& of, const FittedModel& all, double phi) {
  const LinearSwaps linear(of, all);
  std::vector<Promise> promises;
  const double as_found = linear.least({}).misfit;
  for (const std::vector<std::size_t>& out : of.out) {
    const double going = linear.least(out).misfit - as_found;
    for (const KnownValue& value : of.values) {
      if (of.found.model->asset.parameters.at(value.name).estimate) continue;
      Promise promise = linear.promise(out, value);
      promise.slack = (1.0 - kNearlyAll) * going + phi * kWorthAnother;
      if (promise.misfit - as_found <= promise.slack) promises.push_back(std::move(promise));
    }
  }
  double best = std::numeric_limits<double>::infinity();
  for (const Promise& promise : promises) best = std::min(best, promise.misfit);
  std::erase_if(promises, [&](const Promise& promise) { return promise.misfit > best + promise.slack; });
  const double penalty = std::log(all.residuals / phi);
  std::ranges::stable_sort(promises, {},
                           [&](const Promise& one) { return one.misfit / phi + penalty * one.parameters; });
  if (promises.size() > kFitted) promises.resize(kFitted);
  return promises;
}

// From where the linear model leads, and where that cannot be simulated or is too far, from what was found.
std::optional<FittedModel> fitted(const SwapQuestion& of, const Promise& promise, const FittedModel& all,
                                  const SearchBound& bound) {
  const AssetConfig asset = swapped(of, promise.out, promise.value);
  Result<FittedModel> model = fit_model_beside(promise.change, asset, of.data, all, 1, kIterations, bound);
  if (!model || model->optimum.out_of_reach) {
    Result<FittedModel> other = fit_model_beside({}, asset, of.data, all, 1, kIterations, bound);
    if (other && (!model || model->optimum.out_of_reach)) model = std::move(other);
  }
  if (!model || model->optimum.out_of_reach) return std::nullopt;
  return std::move(*model);
}

}  // namespace

std::vector<std::vector<std::size_t>> subsets_of(std::size_t count) {
  std::vector<std::vector<std::size_t>> subsets;
  for (std::size_t bits = 1; bits < std::size_t{1} << count; ++bits) {
    std::vector<std::size_t>& subset = subsets.emplace_back();
    for (std::size_t k = 0; k < count; ++k)
      if ((bits >> k & 1U) != 0) subset.push_back(k);
  }
  return subsets;
}

std::vector<ValueSwap> values_in_place_of(const SwapQuestion& of) {
  const Result<FittedModel> all = with_all_values(of);
  if (!all) return {};
  const FittedModel& found = *of.found.model;
  const double phi = dispersion(found), penalty = std::log(found.residuals / phi);
  const std::vector<Promise> promises = promises_of(of, *all, phi);
  const auto limit = [&](const Promise& one) {  // of the misfit: `behind` the criterion of what was found
    return phi *
           (criterion(found, phi) + of.behind - penalty * (static_cast<double>(found.free_shared) + one.parameters));
  };
  const auto models = in_parallel<std::shared_ptr<const FittedModel>>(promises.size(), of.threads, [&](std::size_t k) {
    const SearchBound bound{.cost = 0.5 * limit(promises[k]),
                            .optimism = excess(found) > kGross ? kGrossOptimism : kOptimistic};
    const double at_best = all->misfit - kMostOfPromise * (all->misfit - promises[k].misfit);
    if (promises[k].out.empty() && at_best > limit(promises[k])) return std::shared_ptr<const FittedModel>();
    std::optional<FittedModel> model = fitted(of, promises[k], *all, bound);
    return model ? std::make_shared<const FittedModel>(std::move(*model)) : nullptr;
  });
  std::vector<ValueSwap> swaps;
  for (std::size_t k = 0; k < promises.size(); ++k) {
    if (models[k] == nullptr) continue;
    ValueSwap swap{promises[k].value, promises[k].out, polished({{}, models[k]}, of.data, of.threads),
                   promises[k].predicted};
    const bool behind = criterion_behind(*swap.with.model, found) > of.behind;
    if (behind || !are_beyond_tolerance(*swap.with.model, {swap.value})) continue;
    for (std::size_t slot = 0; slot < of.found.effects.size(); ++slot)
      if (!is_among(swap.out, slot)) swap.with.effects.push_back(of.found.effects[slot]);
    swaps.push_back(std::move(swap));
  }
  if (swaps.empty()) return swaps;
  double best_phi = phi;
  for (const ValueSwap& swap : swaps) best_phi = std::min(best_phi, dispersion(*swap.with.model));
  std::ranges::stable_sort(swaps, {}, [&](const ValueSwap& swap) { return criterion(*swap.with.model, best_phi); });
  swaps.front().with = with_derivatives(swaps.front().with, of.data, of.threads);
  return swaps;
}

}  // namespace sealwatch::mismatch
