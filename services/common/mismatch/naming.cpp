#include "services/common/mismatch/naming.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <thread>
#include <utility>

#include "services/common/mismatch/plain_laws.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr std::size_t kSingles = 8;        // refits of single laws
constexpr std::size_t kSecondStarts = 4;   // of laws with a shape, from another point of its grid, in a gross misfit
constexpr double kWorthRoughly = 2.0;      // criterion that a law must bring in a gross misfit
constexpr std::size_t kOtherShapes = 8;    // refits of the best law from other points of its grid
constexpr std::size_t kPairs = 4;          // refits of pairs
constexpr int kFirstRound = 8;             // iterations of every refit
constexpr std::size_t kSecondRound = 5;    // refits that go on,
constexpr int kLastRound = 30;             // so many iterations more
constexpr double kHopeful = 10.0;          // times the best misfit: further off a refit does not go on
constexpr std::size_t kUnlistedForms = 5;  // refits of closed forms
constexpr double kPairAhead =
    0.02;  // of the misfit: a pair that promises less more than the best single is passed over
constexpr double kSmallestStart = 0.02, kLargestStart = 50.0;  // of a strength's usual size

bool same(const Effect& a, const Effect& b) { return a.law->id == b.law->id && a.element == b.element; }

LawStart start_of(const Screening& screening, const Variant& variant) {
  const Candidate& candidate = screening.candidates[variant.candidate];
  LawStart start{.effect = {candidate.law, candidate.element}, .parameters = candidate.grid[variant.point]};
  const std::vector<std::size_t> strengths = strengths_of(*candidate.law);
  for (std::size_t k = 0; k < strengths.size(); ++k) {
    double& value = start.parameters[strengths[k]];
    const double usual = std::abs(candidate.strength_scale * value);
    // The strength of a free angle comes as sine and cosine.
    const double linear = variant.strength.size() == strengths.size()
                              ? variant.strength[k]
                              : std::hypot(variant.strength[0], variant.strength[1]);
    const double size = std::clamp(std::abs(linear), kSmallestStart * usual, kLargestStart * usual);
    value = linear < 0.0 && candidate.law->parameters[strengths[k]].min < 0.0 ? -size : size;
  }
  return start;
}

// A trial while it is being worked on.
struct Refit {
  std::vector<Effect> effects;
  std::shared_ptr<FittedModel> model;
};

// Only those near the best keep their derivatives: ten recordings' worth of them take as much memory as all else.
std::vector<Trial> trials_of(std::vector<Refit> refits) {
  constexpr double kNear = 1.05;
  double best = std::numeric_limits<double>::infinity();
  for (const Refit& refit : refits) best = std::min(best, refit.model->misfit);
  std::vector<Trial> trials;
  for (Refit& refit : refits) {
    if (refit.model->misfit > kNear * best)
      for (Linearisation& at : refit.model->optimum.at_optimum) at.jacobian.resize(0, 0);
    trials.push_back({std::move(refit.effects), std::move(refit.model)});
  }
  return trials;
}

// f(0), f(1), ... on several threads, in this order.
template <class Item, class F>
std::vector<Item> in_parallel(std::size_t count, int threads, const F& f) {
  std::vector<Item> results(count);
  std::atomic<std::size_t> next = 0;
  std::vector<std::jthread> workers;
  for (int worker = 0; worker < threads; ++worker)
    workers.emplace_back([&] {
      for (std::size_t k = next++; k < count; k = next++) results[k] = f(k);
    });
  workers.clear();
  return results;
}

std::vector<const Variant*> by_gain(const Screening& screening) {
  std::vector<const Variant*> order;
  for (const Variant& variant : screening.variants)
    if (variant.gain > 0.0) order.push_back(&variant);
  std::ranges::stable_sort(order, std::greater<>(), [](const Variant* variant) { return variant->gain; });
  return order;
}

// Of each law at each element its best variant, best first.
std::vector<const Variant*> best_of_each(const Screening& screening) {
  std::vector<const Variant*> best;
  for (const Variant* variant : by_gain(screening)) {
    const Candidate& candidate = screening.candidates[variant->candidate];
    const bool known = std::ranges::any_of(best, [&](const Variant* other) {
      const Candidate& taken = screening.candidates[other->candidate];
      return taken.law == candidate.law && taken.element == candidate.element;
    });
    if (!known) best.push_back(variant);
  }
  return best;
}

// Of the best laws another point of their shape's grid: far from a recording the linearised gain says little about
// where a refit ends, and from one start it may end in a hollow beside the best.
std::vector<LawStart> second_starts(const Screening& screening) {
  std::vector<LawStart> starts;
  for (const Variant* best : best_of_each(screening)) {
    if (starts.size() == kSecondStarts) break;
    for (const Variant* other : by_gain(screening)) {
      if (other == best || other->candidate != best->candidate) continue;
      starts.push_back(start_of(screening, *other));
      break;
    }
  }
  return starts;
}

// The best pairs of different laws that promise clearly more than the best single law.
std::vector<std::vector<LawStart>> ranked_pairs(const Screening& screening, double misfit) {
  struct Pair {
    const Variant *a, *b;
    double gain;
  };
  const std::vector<const Variant*> singles = best_of_each(screening);
  std::vector<Pair> pairs;
  for (std::size_t j = 0; j < singles.size(); ++j)
    for (std::size_t k = j + 1; k < singles.size(); ++k) {
      const Candidate &a = screening.candidates[singles[j]->candidate],
                      &b = screening.candidates[singles[k]->candidate];
      if (a.law->id == b.law->id && a.element == b.element) continue;
      pairs.push_back({singles[j], singles[k], pair_gain(screening, *singles[j], *singles[k])});
    }
  std::ranges::stable_sort(pairs, std::greater<>(), &Pair::gain);
  std::vector<std::vector<LawStart>> starts;
  for (const Pair& pair : pairs) {
    if (starts.size() == kPairs || pair.gain < singles.front()->gain + std::max(kWorthAnother, kPairAhead * misfit))
      break;
    starts.push_back({start_of(screening, *pair.a), start_of(screening, *pair.b)});
  }
  return starts;
}

double smallest_dispersion(const std::vector<Trial>& trials, const FittedModel& model) {
  double phi = dispersion(model);
  for (const Trial& trial : trials) phi = std::min(phi, dispersion(*trial.model));
  return phi;
}

std::vector<Forbidden> forbidden_by_physics(const Screening& screening) {
  std::vector<Forbidden> found;
  const double best_gain = by_gain(screening).empty() ? 0.0 : by_gain(screening).front()->gain;
  for (const Variant& variant : screening.variants) {
    const Candidate& candidate = screening.candidates[variant.candidate];
    if (variant.physical || variant.columns.size() != 1) continue;
    const Eigen::Index column = variant.columns.front();
    const double gradient = screening.gradient(column), gram = screening.gram(column, column);
    if (gradient * gradient / gram < std::max(0.5 * best_gain, 27.0)) continue;
    const Effect effect{candidate.law, candidate.element};
    if (std::ranges::any_of(found, [&](const Forbidden& other) { return same(other.effect, effect); })) continue;
    found.push_back({effect, gradient / gram * screening.unit[static_cast<std::size_t>(column)], variant.score});
  }
  return found;
}

// What a law must bring to stay. In a gross misfit the criterion, with its correlation time from the residuals, is wary
// enough: there the recordings that took no part decide.
double worth_keeping(const Naming& naming) {
  return excess(*naming.best.model) > kGross ? kWorthRoughly : kWorthAnother;
}

// Laws whose removal does not cost what another law must bring are taken out again.
void drop_what_is_not_needed(Naming& naming, const Data& data, int threads) {
  for (bool dropped = true; dropped && naming.best.effects.size() > 1;) {
    dropped = false;
    for (std::size_t out = 0; out < naming.best.effects.size() && !dropped; ++out) {
      Trial fewer{.effects = naming.best.effects, .model = nullptr};
      fewer.effects.erase(fewer.effects.begin() + static_cast<std::ptrdiff_t>(out));
      AssetConfig asset = naming.best.model->asset;
      asset.physics.erase(asset.physics.end() - static_cast<std::ptrdiff_t>(naming.best.effects.size() - out));
      Result<FittedModel> model = fit_model(asset, data, naming.best.model.get(), threads);
      if (!model) continue;
      fewer.model = std::make_shared<const FittedModel>(std::move(*model));
      naming.trials.push_back(fewer);
      const double phi = dispersion(*naming.best.model);
      if (criterion(*fewer.model, phi) < criterion(*naming.best.model, phi) + worth_keeping(naming)) {
        naming.best = fewer;
        dropped = true;
      }
    }
  }
  const double phi = dispersion(*naming.best.model);
  if (criterion(*naming.baseline, phi) < criterion(*naming.best.model, phi) + worth_keeping(naming))
    naming.best = {{}, naming.baseline};
}

// Whether the best law of a screening promises, on the linearised model, what another law must bring.
bool promising(const Screening& screening, const FittedModel& model) {
  const std::vector<const Variant*> order = by_gain(screening);
  const double penalty = std::log(model.residuals);  // of one more parameter
  return !order.empty() && order.front()->gain / excess(model) > kWorthAnother + penalty;
}

// Where listed laws leave something beyond the noise: closed forms in place of the laws found, and beside them.
Status try_unlisted(Naming& naming, const Data& data, const ExplainOptions& options) {
  const ScreeningOptions forms{.seed = options.seed, .threads = options.threads, .unlisted = true};
  std::vector<Trial> trials;
  for (const Trial& from : {Trial{{}, naming.baseline}, naming.best}) {
    if (static_cast<int>(from.effects.size()) == options.maximum_laws) continue;
    const auto screening = screen(*from.model, data, forms);
    if (!screening) return fail(screening.error());
    if (!promising(*screening, *from.model)) continue;
    std::vector<std::vector<LawStart>> starts;
    for (LawStart& start : ranked_laws(*screening, kUnlistedForms)) starts.push_back({std::move(start)});
    for (Trial& trial : refit(from, starts, data, options.threads)) trials.push_back(std::move(trial));
    if (naming.best.effects.empty()) break;
  }
  naming.trials.insert(naming.trials.end(), trials.begin(), trials.end());
  const double phi = smallest_dispersion(trials, *naming.best.model);
  const Trial* best = best_of(trials, phi);
  if (best == nullptr || criterion(*best->model, phi) > criterion(*naming.best.model, phi) - kWorthAnother) return {};
  naming.best = polished(*best, data, options.threads);
  drop_what_is_not_needed(naming, data, options.threads);
  const auto next = screen(*naming.best.model, data, {.seed = options.seed, .threads = options.threads});
  if (!next) return fail(next.error());
  naming.last = *next;
  return {};
}

// A channel that stays at its largest value shows by itself that its sensor has reached the end of its range. In a
// gross misfit that comes first: what lies beyond the end would otherwise be asked of the plant.
Status begin_with_what_shows(Naming& naming, const Data& data, const ScreeningOptions& options) {
  if (excess(*naming.baseline) <= kGross) return {};
  std::vector<LawStart> ends;
  for (const Candidate& candidate : naming.first.candidates)
    if (candidate.law->kind == SiteKind::sensor_saturation && ends.empty())
      ends.push_back({{candidate.law, candidate.element}, candidate.grid.front()});
  if (ends.empty()) return {};
  const std::vector<Trial> trials = refit(naming.best, {ends}, data, options.threads);
  if (trials.empty() || trials.front().model->misfit >= naming.baseline->misfit) return {};
  naming.best = trials.front();
  naming.trials.push_back(naming.best);
  Result<Screening> next = screen(*naming.best.model, data, options);
  if (!next) return fail(next.error());
  naming.last = std::move(*next);
  return {};
}

}  // namespace

// A search that ran out of iterations goes on from where it is.
Trial polished(Trial trial, const Data& data, int threads) {
  constexpr int kRounds = 3, kIterations = 30;
  for (int round = 0; round < kRounds && !trial.model->optimum.converged; ++round) {
    Result<FittedModel> further = continue_fit(*trial.model, data, threads, kIterations);
    if (!further || further->misfit > trial.model->misfit) break;
    trial.model = std::make_shared<const FittedModel>(std::move(*further));
  }
  return trial;
}

std::vector<LawStart> ranked_laws(const Screening& screening, std::size_t most) {
  std::vector<LawStart> starts;
  for (const Variant* variant : best_of_each(screening)) {
    if (starts.size() == most) break;
    starts.push_back(start_of(screening, *variant));
  }
  return starts;
}

std::vector<Trial> refit(const Trial& from, const std::vector<std::vector<LawStart>>& laws, const Data& data,
                         int threads) {
  const auto one = [&](const std::vector<LawStart>& added) -> Refit {
    Refit refit{.effects = from.effects, .model = nullptr};
    AssetConfig asset = from.model->asset;
    for (const LawStart& start : added) {
      refit.effects.push_back(start.effect);
      asset = with_law(std::move(asset), *start.effect.law, start.effect.element, start.parameters);
    }
    Result<FittedModel> model = fit_model(asset, data, from.model.get(), 1, kFirstRound);
    if (model) refit.model = std::make_shared<FittedModel>(std::move(*model));
    return refit;
  };
  // Those that are not far from the best go on.
  const auto further = [&](Refit refit) -> Refit {
    if (refit.model->optimum.converged) return refit;
    Result<FittedModel> model = continue_fit(*refit.model, data, 1, kLastRound);
    if (model && model->misfit <= refit.model->misfit) refit.model = std::make_shared<FittedModel>(std::move(*model));
    return refit;
  };
  std::vector<Refit> refits = in_parallel<Refit>(laws.size(), threads, [&](std::size_t k) { return one(laws[k]); });
  std::erase_if(refits, [](const Refit& refit) { return refit.model == nullptr; });
  if (refits.empty()) return {};
  std::ranges::stable_sort(refits, {}, [](const Refit& refit) { return refit.model->misfit; });
  const double limit = kHopeful * refits.front().model->misfit;
  const auto far = std::ranges::find_if(refits, [&](const Refit& refit) { return refit.model->misfit > limit; });
  const auto count = std::min(static_cast<std::size_t>(far - refits.begin()), kSecondRound);
  std::ranges::move(in_parallel<Refit>(count, threads, [&](std::size_t k) { return further(refits[k]); }),
                    refits.begin());
  return trials_of(std::move(refits));
}

namespace {

std::vector<double> usual_size(const Candidate& candidate, std::size_t point) {
  std::vector<double> parameters = candidate.grid[point];
  for (const std::size_t k : strengths_of(*candidate.law)) parameters[k] *= candidate.strength_scale;
  return parameters;
}

// Each law that was just added, alone, at its usual size and from all points of its shape's grid: where something is
// left beyond the noise, its refit from the linear step may have ended in a hollow, which another law was or would be
// asked to fill.
Status from_other_shapes(Naming& naming, const Trial& before, const Screening& asked, const Data& data,
                         const ExplainOptions& options) {
  if (!differs(naming.last.p_value, *naming.best.model, options.false_alarm_rate)) return {};
  std::vector<std::vector<LawStart>> starts;
  for (std::size_t added = before.effects.size(); added < naming.best.effects.size(); ++added) {
    std::vector<std::vector<LawStart>> own;
    for (const Variant* variant : by_gain(asked)) {
      const Candidate& candidate = asked.candidates[variant->candidate];
      const Effect& effect = naming.best.effects[added];
      if (candidate.law == effect.law && candidate.element == effect.element && own.size() < kOtherShapes)
        own.push_back({{effect, usual_size(candidate, variant->point)}});
    }
    starts.insert(starts.end(), own.begin(), own.end());
  }
  if (starts.empty()) return {};
  const std::vector<Trial> trials = refit(before, starts, data, options.threads);
  const double phi = smallest_dispersion(trials, *naming.best.model);
  const Trial* best = best_of(trials, phi);
  if (best == nullptr || criterion(*best->model, phi) > criterion(*naming.best.model, phi)) return {};
  naming.best = polished(*best, data, options.threads);
  naming.trials.push_back(naming.best);
  Result<Screening> next = screen(*naming.best.model, data, {.seed = options.seed, .threads = options.threads});
  if (!next) return fail(next.error());
  naming.last = std::move(*next);
  return {};
}

}  // namespace

Result<Naming> name_effects(std::shared_ptr<const FittedModel> baseline, const Data& data,
                            const ExplainOptions& options, const Progress& progress) {
  const ScreeningOptions screening{.seed = options.seed, .threads = options.threads};
  Result<Screening> first = screen(*baseline, data, screening);
  if (!first) return fail(first.error());
  Naming naming{
      .baseline = baseline, .best = {{}, baseline}, .trials = {{{}, baseline}}, .first = *first, .last = *first};
  naming.forbidden = forbidden_by_physics(naming.first);
  if (const Status status = begin_with_what_shows(naming, data, screening); !status) return fail(status.error());
  while (static_cast<int>(naming.best.effects.size()) < options.maximum_laws) {
    if (!differs(naming.last.p_value, *naming.best.model, options.false_alarm_rate) ||
        !promising(naming.last, *naming.best.model))
      break;
    const std::size_t level = naming.best.effects.size();
    const bool gross = excess(*naming.best.model) > kGross;
    if (progress) progress("trying laws", 0.3 + 0.15 * static_cast<double>(level));
    std::vector<std::vector<LawStart>> starts;
    for (LawStart& start : ranked_laws(naming.last, level == 0 || gross ? kSingles : kSingles / 2 + 1))
      starts.push_back({std::move(start)});
    if (gross)
      for (LawStart& start : second_starts(naming.last)) starts.push_back({std::move(start)});
    if (static_cast<int>(level) + 2 <= options.maximum_laws)
      for (auto& pair : ranked_pairs(naming.last, naming.best.model->misfit)) starts.push_back(std::move(pair));
    const std::vector<Trial> trials = refit(naming.best, starts, data, options.threads);
    naming.trials.insert(naming.trials.end(), trials.begin(), trials.end());
    const double phi = smallest_dispersion(trials, *naming.best.model);
    const Trial* best = best_of(trials, phi);
    // Where much is missing the first law may bring little before the second is there: what is not needed in the end is
    // taken out again.
    const double worth = gross ? 0.0 : kWorthAnother;
    if (best == nullptr || criterion(*best->model, phi) > criterion(*naming.best.model, phi) - worth) break;
    const Trial before = std::exchange(naming.best, polished(*best, data, options.threads));
    naming.trials.push_back(naming.best);
    Result<Screening> next = screen(*naming.best.model, data, screening);
    if (!next) return fail(next.error());
    const Screening asked = std::exchange(naming.last, std::move(*next));
    if (const Status status = from_other_shapes(naming, before, asked, data, options); !status)
      return fail(status.error());
  }
  drop_what_is_not_needed(naming, data, options.threads);
  prefer_plain_laws(naming, data, options.threads);
  if (naming.last.p_value <= options.false_alarm_rate)
    if (const Status status = try_unlisted(naming, data, options); !status) return fail(status.error());
  return naming;
}

}  // namespace sealwatch::mismatch
