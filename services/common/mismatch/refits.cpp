#include "services/common/mismatch/refits.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <ranges>
#include <span>
#include <utility>

#include "sealwatch/model/law_sizes.hpp"
#include "services/common/core/in_parallel.hpp"
#include "services/common/mismatch/candidates.hpp"
#include "services/common/mismatch/criterion.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr int kFirstRound = 8;           // iterations of every refit
constexpr int kRound = 10, kRounds = 3;  // iterations of those that go on, so often
constexpr std::size_t kGoOn = 5;         // refits that go on after the first round
constexpr std::size_t kAhead = 2;        // refits that come first: what they come to is to be reached by the others
// In a gross misfit a refit does not go on that is further off than so many times the best, or than so many times what
// its linear model promises.
constexpr double kHopeful = 10.0;
constexpr double kNearer = 0.5;   // nor does any where a round leaves more than this share of the distance to the best
constexpr double kFar = 100.0;    // times the noise: a model that misses by more says nothing of sizes
constexpr double kSmaller = 0.1;  // strength with which one starts again that set out too far

// Whether a strength of the laws added last has come to an end of its range: nothing depends on their shapes there.
bool came_to_an_end(const FittedModel& model, const std::vector<LawStart>& added) {
  const std::vector<PhysicsTerm>& physics = model.asset.physics;
  for (std::size_t k = 0; k < added.size(); ++k)
    for (const LawParameter& parameter : added[k].effect.law->parameters) {
      if (!parameter.strength) continue;
      const PhysicsTerm& term = physics[physics.size() - added.size() + k];
      const ParameterSetting& setting = term.parameters.at(std::string(parameter.name));
      if (setting.value <= setting.min || setting.value >= setting.max) return true;
    }
  return false;
}

// The laws added last (`added`) with their shapes held at their start values until the sizes fit, then free: let free
// at once, beside sizes that are far off, a shape drifts to the end of its range and stays there. Where that leaves
// nothing of a law, the shape was a wrong one, and is free from the start.
Result<FittedModel> sizes_first(AssetConfig asset, const std::vector<LawStart>& added, const Data& data,
                                const FittedModel& from, int threads, const SearchBound& bound) {
  const AssetConfig free = asset;
  for (std::size_t k = 0; k < added.size(); ++k)
    for (const LawParameter& parameter : added[k].effect.law->parameters)
      if (!parameter.strength)
        asset.physics[asset.physics.size() - added.size() + k].parameters.at(std::string(parameter.name)).estimate =
            false;
  const Result<FittedModel> sized = fit_model_beside({}, asset, data, from, threads, kFirstRound, {});
  const bool sizes_fit = sized && !came_to_an_end(*sized, added);
  return fit_model_beside({}, free, data, sizes_fit ? *sized : from, threads, kFirstRound, bound);
}

// What changes beside all of them; empty where that is not known.
PemPoint beside_all(const std::vector<LawStart>& added, double share) {
  PemPoint all;
  const auto add = [share](const std::vector<double>& change, std::vector<double>& sum) {
    sum.resize(change.size(), 0.0);
    for (std::size_t k = 0; k < change.size(); ++k) sum[k] += share * change[k];
  };
  for (const LawStart& law : added) {
    if (law.beside.own.empty()) return {};
    add(law.beside.shared, all.shared);
    all.own.resize(law.beside.own.size());
    for (std::size_t r = 0; r < all.own.size(); ++r) add(law.beside.own[r], all.own[r]);
  }
  return all;
}

// Values of the asset file that are known within a tolerance.
std::vector<KnownValue> known_parameters(const Data& data, const AssetConfig& asset) {
  std::vector<KnownValue> known;
  std::ranges::copy_if(data.known, std::back_inserter(known),
                       [&](const KnownValue& value) { return asset.parameters.contains(value.name); });
  return known;
}

// Whether a model was fitted beside such values as they are known.
bool lacks_tolerances(const FittedModel& model, const Data& data) {
  return std::ranges::any_of(known_parameters(data, model.asset), [&](const KnownValue& value) {
    return std::ranges::find(model.problem.shared, value.name, &Unknown::name) == model.problem.shared.end();
  });
}

// A trial while it is being worked on.
struct Refit {
  std::vector<Effect> effects;
  std::shared_ptr<FittedModel> model;
};

// A law that contains a plainer one (Law::limit) has that one's strength first. Without it, at less than a hundredth of
// what matters, it is neither: dry friction that is there near standstill alone is no dry friction.
bool lost_its_core(const Refit& refit) {
  constexpr double kNothing = 0.01;
  const AssetConfig& asset = refit.model->asset;
  const PlantDescription& plant = refit.model->problem.recordings.front().simulation->plant();
  const std::size_t first = asset.physics.size() - refit.effects.size();
  for (std::size_t k = 0; k < refit.effects.size(); ++k) {
    const Law& law = *refit.effects[k].law;
    if (law.limit.empty()) continue;
    const LawParameter& core = law.parameters[strengths_of(law).front()];
    const double value = asset.physics[first + k].parameters.at(std::string(core.name)).value;
    if (std::abs(value) < kNothing * sealwatch::significant_size(plant, core)) return true;
  }
  return false;
}

// Whether a refit goes on: where it may come near the best of them, or what is to beat. Further off than twice what
// decides it is no alternative to it. In a gross misfit the linear model tells less of how far down a search leads: it is
// believed to a tenth. A refit goes on as long as it also comes much nearer to the best.
class GoesOn {
 public:
  /// `best`: the best model so far, or one of about its misfit.
  GoesOn(const FittedModel& best, double to_beat)
      : gross_(excess(best) > kGross),
        best_(std::min(best.misfit, to_beat)),
        limit_(best_ + 2.0 * kWorthAnother * dispersion(best)) {}

  /// The same for every iteration of a search; a cost is half a misfit.
  [[nodiscard]] SearchBound bound() const {
    return {.cost = 0.5 * limit_, .optimism = gross_ ? kHopeful : kOptimistic};
  }
  /// Of searches with known values as they are known: their tolerances come later.
  [[nodiscard]] SearchBound bound_of_first() const {
    return {.cost = 0.5 * kHopeful * best_, .optimism = kHopeful, .decides_nothing = kDecidesNothing};
  }

  [[nodiscard]] bool at_first(const FittedModel& model) const { return may_come_near(model) && is_hopeful(model); }
  [[nodiscard]] bool is_hopeful(const FittedModel& model) const { return model.misfit <= kHopeful * best_; }
  [[nodiscard]] bool after(const FittedModel& before, const FittedModel& model) const {
    const bool nearer = model.misfit - best_ <= kNearer * std::max(before.misfit - best_, 0.0);
    return may_come_near(model) && nearer;
  }

 private:
  [[nodiscard]] bool may_come_near(const FittedModel& model) const {
    return !model.optimum.converged && could_reach(model, gross_ ? kHopeful : kOptimistic) <= limit_;
  }

  bool gross_;
  double best_, limit_;
};

// Only the best keeps its derivatives, which take as much memory as all else: a search may go on from there.
std::vector<Trial> trials_of(std::vector<Refit> refits) {
  if (refits.empty()) return {};
  const double phi = dispersion(*refits.front().model);
  std::ranges::stable_sort(refits, {}, [&](const Refit& refit) { return criterion(*refit.model, phi); });
  std::vector<Trial> trials;
  for (Refit& refit : refits) {
    if (!trials.empty())
      for (Linearisation& at : refit.model->optimum.at_optimum) at.jacobian.resize(0, 0);
    trials.push_back({std::move(refit.effects), std::move(refit.model)});
  }
  return trials;
}

// Refits of one model with laws. In a gross misfit values that are known within a tolerance decide nothing yet: a first
// round compares laws beside these as they are known, at half the cost or less; what goes on has their tolerances.
class Refits {
 public:
  Refits(const Trial& from, const Data& data, int threads, const RefitOptions& options)
      : from_(from), data_(data), threads_(threads), options_(options), gross_(excess(*from.model) > kGross) {
    if (gross_ && !known_parameters(data, from.model->asset).empty()) first_ = as_known(from.model->asset, data);
  }

  std::vector<Trial> run(const std::vector<std::vector<LawStart>>& laws) {
    std::vector<Refit> refits = first_round(laws);
    if (refits.empty()) return {};
    const std::size_t count = options_.first_round_only ? 0 : std::min(refits.size(), kGoOn),
                      ahead = first_ ? std::min(count, kAhead) : count;
    best_ = refits.front().model;
    go_on(std::span(refits).first(ahead));
    go_on(std::span(refits).subspan(ahead, count - ahead));
    std::erase_if(refits, lost_its_core);
    return trials_of(std::move(refits));
  }

 private:
  [[nodiscard]] int threads_of_each(std::size_t refits) const {
    return std::max(1, threads_ / static_cast<int>(refits));
  }
  [[nodiscard]] const Data& first_data() const { return first_ ? first_->data : data_; }
  [[nodiscard]] SearchBound bound_after(const FittedModel& best) const {
    const GoesOn goes_on(best, options_.to_beat);
    return first_ ? goes_on.bound_of_first() : goes_on.bound();
  }

  // The best first.
  std::vector<Refit> first_round(const std::vector<std::vector<LawStart>>& laws) {
    std::vector<Refit> refits;
    if (std::isfinite(options_.to_beat)) bound_ = bound_after(*from_.model);
    for (std::size_t begin = 0, count = 0; begin < laws.size(); begin += count) {
      count = std::min(begin == 0 ? kAhead : laws.size(), laws.size() - begin);
      for (Refit& refit : in_parallel<Refit>(
               count, threads_, [&](std::size_t k) { return one(laws[begin + k], threads_of_each(count)); }))
        if (refit.model != nullptr) refits.push_back(std::move(refit));
      if (refits.empty()) continue;
      std::ranges::stable_sort(refits, {}, [](const Refit& refit) { return refit.model->misfit; });
      bound_ = bound_after(*refits.front().model);
      least_ = refits.front().model->misfit;
    }
    return refits;
  }

  // With a strength of nothing a law leaves what was there before: one that leaves more set out too far.
  [[nodiscard]] Refit one(const std::vector<LawStart>& added, int threads) const {
    if (!may_come_to_bound(added.front())) return {};
    Refit refit = start(added, 1.0, threads);
    const bool cut = refit.model != nullptr && refit.model->optimum.out_of_reach;
    const bool worse = options_.again_smaller && !cut && options_.in_place_of.empty() && excess(*from_.model) < kFar &&
                       (refit.model == nullptr || refit.model->misfit > from_.model->misfit);
    if (!worse || (first_ && !may_be_best(added.front()))) return refit;
    Refit again = start(added, kSmaller, threads);
    const bool better = again.model != nullptr && (refit.model == nullptr || again.model->misfit < refit.model->misfit);
    return better ? again : refit;
  }

  [[nodiscard]] Refit start(const std::vector<LawStart>& added, double share, int threads) const {
    Refit refit{.effects = from_.effects, .model = nullptr};
    AssetConfig asset = first_ ? first_->asset : from_.model->asset;
    for (const std::size_t out : options_.in_place_of | std::views::reverse) {
      asset.physics.erase(asset.physics.end() - static_cast<std::ptrdiff_t>(refit.effects.size() - out));
      refit.effects.erase(refit.effects.begin() + static_cast<std::ptrdiff_t>(out));
    }
    for (const LawStart& law : added) {
      refit.effects.push_back(law.effect);
      std::vector<double> parameters = law.parameters;
      for (const std::size_t k : strengths_of(*law.effect.law)) parameters[k] *= share;
      asset = with_law(std::move(asset), *law.effect.law, law.effect.element, parameters);
    }
    const auto set_out = [&](const PemPoint& beside) {
      return fit_model_beside(beside, asset, first_data(), *from_.model, threads, kFirstRound, bound_);
    };
    // In a gross misfit the linear model of a free run says too little of what changes beside a law.
    const bool tells_little = gross_ && data_.held_within_s == 0.0;
    const PemPoint beside = tells_little ? PemPoint{} : beside_all(added, share);
    const bool has_sizes = options_.in_place_of.empty() || options_.sized;
    Result<FittedModel> model =
        has_sizes ? set_out(beside) : sizes_first(asset, added, first_data(), *from_.model, threads, bound_);
    if (!model && !beside.own.empty()) model = set_out({});  // where the linear model leads, nothing can be simulated
    if (model) refit.model = std::make_shared<FittedModel>(std::move(*model));
    return refit;
  }

  [[nodiscard]] bool may_be_best(const LawStart& start) const {
    return start.asked_at - kOptimisticOfPromise * start.promised <= least_;
  }

  [[nodiscard]] bool may_come_to_bound(const LawStart& start) const {
    const bool near = start.asked_at <= kGross * from_.model->residuals;
    const double optimism = near ? kOptimisticOfPromise : kOptimisticFarOff;
    return 0.5 * (start.asked_at - optimism * start.promised) <= bound_.cost;
  }

  // Each as long as it may come near the best so far.
  void go_on(std::span<Refit> refits) {
    const std::vector<Refit> gone_on = in_parallel<Refit>(
        refits.size(), threads_, [&](std::size_t k) { return further(refits[k], threads_of_each(refits.size())); });
    std::ranges::copy(gone_on, refits.begin());
    for (const Refit& refit : gone_on)
      if (refit.model->misfit < best_->misfit) best_ = refit.model;
  }

  [[nodiscard]] Refit further(Refit refit, int threads) const {
    const GoesOn goes_on(*best_, options_.to_beat);
    bool open = goes_on.at_first(*refit.model) || !is_exact_enough(*refit.model);
    if (first_ && goes_on.is_hopeful(*refit.model)) {
      Result<FittedModel> model =
          fit_model(refit.model->asset, data_, refit.model.get(), threads, kRound, goes_on.bound());
      if (!model) return refit;
      refit.model = std::make_shared<FittedModel>(std::move(*model));
      open = goes_on.at_first(*refit.model);
    }
    for (int round = 0; round < kRounds && open; ++round) {
      Result<FittedModel> model = continue_fit(*refit.model, data_, threads, kRound, goes_on.bound());
      if (!model || (is_exact_enough(*refit.model) && model->misfit > refit.model->misfit)) break;
      open = goes_on.after(*refit.model, *model);
      refit.model = std::make_shared<FittedModel>(std::move(*model));
    }
    return refit;
  }

  const Trial& from_;
  const Data& data_;
  std::optional<AsKnown> first_;  ///< of a first round that goes on with tolerances
  int threads_;
  const RefitOptions& options_;
  bool gross_;
  SearchBound bound_;                                       ///< of the first round
  double least_ = std::numeric_limits<double>::infinity();  ///< misfit of the refits that came first
  std::shared_ptr<const FittedModel> best_;                 ///< of those that went on
};

}  // namespace

LawStart last_law_of(const Trial& trial) {
  LawStart start{.effect = trial.effects.back(), .parameters = {}};
  const std::map<std::string, ParameterSetting>& found = trial.model->asset.physics.back().parameters;
  for (const LawParameter& parameter : start.effect.law->parameters)
    start.parameters.push_back(found.at(std::string(parameter.name)).value);
  return start;
}

std::optional<Trial> with_given_values(const Trial& found, const Data& data) {
  AssetConfig asset = found.model->asset;
  for (const auto& [name, value] : data.given)
    if (const auto parameter = asset.parameters.find(name); parameter != asset.parameters.end())
      parameter->second.value = value;
  const FittedModel nowhere;
  Result<FittedModel> model = fit_model(asset, data, &nowhere, 1, 0);
  if (!model) return std::nullopt;
  return Trial{found.effects, std::make_shared<const FittedModel>(std::move(*model))};
}

AsKnown as_known(const AssetConfig& asset, const Data& data) {
  AsKnown plain{asset, data};
  for (const KnownValue& value : known_parameters(data, asset)) {
    plain.asset.parameters.at(value.name).value = value.value;
    std::erase_if(plain.data.known, [&](const KnownValue& one) { return one.name == value.name; });
  }
  return plain;
}

double could_reach(const FittedModel& model, double optimism) {
  if (model.optimum.converged) return model.misfit;
  return model.misfit - optimism * 2.0 * model.optimum.promised;
}

Trial with_derivatives(Trial trial, const Data& data, int threads) {
  if (trial.model->optimum.at_optimum.front().jacobian.size() > 0) return trial;
  Result<FittedModel> again = continue_fit(*trial.model, data, threads, 0);
  if (again) trial.model = std::make_shared<const FittedModel>(std::move(*again));
  return trial;
}

Trial polished(Trial trial, const Data& data, int threads) {
  constexpr int kRounds = 3;
  if (lacks_tolerances(*trial.model, data)) {
    Result<FittedModel> with = fit_model(trial.model->asset, data, trial.model.get(), threads);
    if (with) trial.model = std::make_shared<const FittedModel>(std::move(*with));
  }
  for (int round = 0; round < kRounds; ++round) {
    const bool exact = is_exact_enough(*trial.model);
    if (exact && trial.model->optimum.converged) break;
    Result<FittedModel> further = continue_fit(*trial.model, data, threads, kSearchIterations);
    if (!further || (exact && further->misfit > trial.model->misfit)) break;
    trial.model = std::make_shared<const FittedModel>(std::move(*further));
  }
  return trial;
}

Result<FittedModel> fit_baseline(const AssetConfig& asset, const Data& data, const FittedModel& from, int threads) {
  Result<FittedModel> there = fit_model(asset, data, &from, threads, 0);
  if (!there) return there;
  const SearchBound little_is_enough{.decides_nothing = kDecidesNothing};
  return continue_fit(*there, data, threads, kSearchIterations,
                      excess(*there) > kGross ? little_is_enough : SearchBound{});
}

std::vector<Trial> refit(const Trial& from, const std::vector<std::vector<LawStart>>& laws, const Data& data,
                         int threads, const RefitOptions& options) {
  return Refits(from, data, threads, options).run(laws);
}

}  // namespace sealwatch::mismatch
