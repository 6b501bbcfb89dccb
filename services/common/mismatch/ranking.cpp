#include "services/common/mismatch/ranking.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "services/common/mismatch/criterion.hpp"
#include "services/common/mismatch/verdict.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr std::size_t kSecondStarts = 4;  // of laws with a shape, from another point of its grid, in a gross misfit
constexpr std::size_t kPairs = 4;         // refits of pairs
constexpr double kPairAhead =
    0.02;  // of the misfit: a pair that promises less more than the best single is passed over
constexpr double kSmallestStart = 0.02, kLargestStart = 50.0;  // of a strength's usual size

// Unknowns that had taken on what the law does give it back: else it would come on top of that.
PemPoint beside(const Screening& screening, const Variant& variant, std::span<const double> strengths) {
  PemPoint change{.shared = std::vector<double>(static_cast<std::size_t>(screening.shared_like_law.rows()), 0.0),
                  .own = {}};
  for (const Eigen::MatrixXd& own : screening.own_like_law)
    change.own.emplace_back(static_cast<std::size_t>(own.rows()), 0.0);
  const auto give_back = [&](double units, const Eigen::MatrixXd& shared_like,
                             const std::vector<Eigen::MatrixXd>& own_like, Eigen::Index column) {
    const auto take = [&](const Eigen::MatrixXd& like, std::vector<double>& from) {
      Eigen::Map<Eigen::VectorXd>(from.data(), std::ssize(from)) -= units * like.col(column);
    };
    take(shared_like, change.shared);
    for (std::size_t r = 0; r < change.own.size(); ++r) take(own_like[r], change.own[r]);
  };
  for (std::size_t k = 0; k < strengths.size(); ++k) {
    const Eigen::Index column = variant.columns[k];
    give_back(strengths[k] / screening.unit[static_cast<std::size_t>(column)], screening.shared_like_law,
              screening.own_like_law, column);
  }
  const HeldUnknowns& held = screening.held;
  for (std::size_t k = 0; k < variant.back.size(); ++k) {
    give_back(variant.back[k], held.shared_like, held.own_like, static_cast<Eigen::Index>(k));
    change.shared[static_cast<std::size_t>(held.unknown[k])] += variant.back[k];
  }
  return change;
}

LawStart start_of(const Screening& screening, const Variant& variant, bool in_proportion = false) {
  const Candidate& candidate = screening.candidates[variant.candidate];
  LawStart start{.effect = {candidate.law, candidate.element},
                 .parameters = candidate.grid[variant.point],
                 .promised = variant.gain,
                 .asked_at = screening.misfit};
  const std::vector<std::size_t> strengths = strengths_of(*candidate.law);
  for (std::size_t k = 0; k < strengths.size(); ++k) {
    double& value = start.parameters[strengths[k]];
    const double usual = std::abs(candidate.strength_scale * value);
    // The strength of a free angle comes as sine and cosine.
    const double linear = variant.strength.size() == strengths.size()
                              ? variant.strength[k]
                              : std::hypot(variant.strength[0], variant.strength[1]);
    const bool told = in_proportion && linear != 0.0;
    const double size =
        told ? std::abs(linear) : std::clamp(std::abs(linear), kSmallestStart * usual, kLargestStart * usual);
    value = linear < 0.0 && candidate.law->parameters[strengths[k]].min < 0.0 ? -size : size;
  }
  if (variant.columns.size() != strengths.size()) return start;
  std::vector<double> sizes;
  for (const std::size_t k : strengths) sizes.push_back(start.parameters[k]);
  start.beside = beside(screening, variant, sizes);
  return start;
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

}  // namespace

LawStart start_with(const Screening& screening, Variant variant, std::vector<double> strengths) {
  variant.strength = std::move(strengths);
  variant.back.clear();
  variant.gain = std::numeric_limits<double>::infinity();
  return start_of(screening, variant, true);
}

std::vector<const Variant*> by_gain(const Screening& screening) {
  std::vector<const Variant*> order;
  for (const Variant& variant : screening.variants)
    if (variant.gain > 0.0) order.push_back(&variant);
  std::ranges::stable_sort(order, std::greater<>(), [](const Variant* variant) { return variant->gain; });
  return order;
}

Screening causes_in(Screening screening, const FittedModel& model) {
  const std::vector<const Variant*> order = by_gain(screening);
  const double most = order.empty() ? 0.0 : order.front()->gain,
               half_of_what_is_left = kExplainedAtLeast * (model.misfit - model.residuals);
  for (Variant& variant : screening.variants)
    if (is_sensor(screening.candidates[variant.candidate].law->kind) && variant.gain < most &&
        kOptimistic * variant.gain < half_of_what_is_left)
      variant.gain = 0.0;
  return screening;
}

std::vector<LawStart> ranked_laws(const Screening& screening, std::size_t most, bool in_proportion) {
  std::vector<LawStart> starts;
  for (const Variant* variant : best_of_each(screening)) {
    if (starts.size() == most) break;
    starts.push_back(start_of(screening, *variant, in_proportion));
  }
  return starts;
}

std::size_t nearly_as_promising(const Screening& screening, std::size_t most, double least) {
  constexpr std::size_t kLeast = 3;
  constexpr double kShare = 0.5, kFarBehind = 2.0 * kWorthAnother;
  const std::vector<const Variant*> ranked = best_of_each(screening);
  std::size_t count = 0;
  while (count < std::min(most, ranked.size())) {
    const double best = ranked.front()->gain, gain = ranked[count]->gain;
    if (count >= kLeast && gain < kShare * best && gain < best - kFarBehind) break;
    if (count > 0 && gain < least) break;
    ++count;
  }
  return count;
}

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

std::vector<std::vector<LawStart>> ranked_pairs(const Screening& screening, double misfit, bool also_measurements) {
  struct Pair {
    const Variant *a, *b;
    double gain;
  };
  const std::vector<const Variant*> singles = best_of_each(screening);
  const auto of_measurement = [&](const Variant& variant) {
    return is_of_measurement(screening.candidates[variant.candidate].law->kind);
  };
  std::vector<Pair> pairs;
  for (std::size_t j = 0; j < singles.size(); ++j)
    for (std::size_t k = j + 1; k < singles.size(); ++k) {
      const Candidate &a = screening.candidates[singles[j]->candidate],
                      &b = screening.candidates[singles[k]->candidate];
      if (overlap(*a.law, *b.law) && a.element == b.element) continue;
      if (!also_measurements && (of_measurement(*singles[j]) || of_measurement(*singles[k]))) continue;
      pairs.push_back({singles[j], singles[k], pair_gain(screening, *singles[j], *singles[k])});
    }
  std::ranges::stable_sort(pairs, std::greater<>(), &Pair::gain);
  std::vector<std::vector<LawStart>> starts;
  for (const Pair& pair : pairs) {
    if (starts.size() == kPairs || pair.gain < singles.front()->gain + std::max(kWorthAnother, kPairAhead * misfit))
      break;
    starts.push_back({start_of(screening, *pair.a), start_of(screening, *pair.b)});
    for (LawStart& start : starts.back()) start.promised = pair.gain;
  }
  return starts;
}

std::vector<double> usual_size(const Candidate& candidate, std::size_t point) {
  std::vector<double> parameters = candidate.grid[point];
  for (const std::size_t k : strengths_of(*candidate.law)) parameters[k] *= candidate.strength_scale;
  return parameters;
}

}  // namespace sealwatch::mismatch
