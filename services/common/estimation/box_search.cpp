#include "services/common/estimation/box_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "services/common/estimation/minimum_in_box.hpp"

namespace sealwatch {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
// Far from the optimum a shape that is hardly seen yet must not run to the end of its range: the first damping, and how
// it falls (K. Madsen, H. B. Nielsen, O. Tingleff, Methods for Non-Linear Least Squares Problems, 2004).
constexpr double kDamping = 1e-4, kUndamped = 1e-8, kFalls = 1.0 / 3.0;
// Unknowns are of the order of one: no step goes further in any of them, until steps prove that the linear model holds.
// Damping alone leaves a step long in what the recordings hardly show.
constexpr double kOrderOfOne = 3.0, kShrinks = 0.25, kWidens = 3.0, kNearest = 1e-7;
constexpr double kLinear = 0.25, kTrusted = 0.75;
constexpr double kBent = 0.75;  // the second term of a curved step, of its first
// Residuals that do not vanish add r d2r/dx2 to the curvature of their squares. What the last step saw of it scales the
// linear model's (sizing: M. Al-Baali, R. Fletcher, J. Oper. Res. Soc. 36 (1985) 405), at most by this: beyond, steps are
// too long for any quadratic model.
constexpr double kMostCurvature = 4.0;

bool has_range(const Unknown& unknown) { return unknown.max > unknown.min; }

double inside(const Unknown& unknown, double value) {
  return has_range(unknown) ? std::clamp(value, unknown.to_unknown(unknown.min), unknown.to_unknown(unknown.max))
                            : value;
}

// How far a step may leave the range: by its own width. Where the recordings hardly show an unknown nothing else ends its
// way, and what is held at its end in the end has been bent to values that nothing has.
void keep_near_range(const Unknown& unknown, double at, double& low, double& high) {
  const double least = unknown.to_unknown(unknown.min), most = unknown.to_unknown(unknown.max), width = most - least;
  low = std::min(0.0, least - width - at);
  high = std::max(0.0, most + width - at);
}

}  // namespace

struct BoxSearch::LinearModel {
  Eigen::MatrixXd gram;
  Eigen::VectorXd gradient, low, high;
  bool has_kept = false;   ///< some derivatives are those of an earlier point
  double curvature = 1.0;  ///< that is in gram already, beside that of the linear residuals

  [[nodiscard]] Eigen::VectorXd step(double damping, double radius = kInfinite) const {
    return minimum_in_box(gram, gradient, low.cwiseMax(-radius), high.cwiseMin(radius), damping);
  }
  /// Fall of the cost.
  [[nodiscard]] double promised(const Eigen::VectorXd& by) const { return -by.dot(gradient + 0.5 * gram * by); }
  void curve(double times) {
    gram *= times / curvature;
    curvature = times;
  }
  /// Times the curvature of linear residuals, where a step let the cost fall by `change`.
  [[nodiscard]] double curvature_seen(const Eigen::VectorXd& by, double change) const {
    const double linear = 0.5 * by.dot(gram * by) / curvature;
    const double seen = (-by.dot(gradient) - change) / linear;
    return seen >= 1.0 ? std::min(seen, kMostCurvature) : 1.0;  // not where nothing moved
  }
};

BoxSearch::BoxSearch(const PemProblem& problem, PemPoint& point, SideBySide& costs)
    : problem_(problem), point_(point), costs_(costs), held_(point.shared.size(), false) {
  size_ = static_cast<Eigen::Index>(point.shared.size());
  for (const std::vector<double>& own : point.own) size_ += static_cast<Eigen::Index>(own.size());
}

double BoxSearch::evaluate(bool may_keep) {
  ++iterations_;
  costs_.evaluate(may_keep);
  if (costs_.failed()) return kInfinite;
  double sum = 0.0;
  for (const RecordingCost* cost : costs_.costs()) sum += 0.5 * cost->compressed().rightCols(1).squaredNorm();
  for (std::size_t k = 0; k < point_.shared.size(); ++k)
    if (problem_.shared[k].is_known()) sum += 0.5 * std::pow(problem_.shared[k].prior_residual(point_.shared[k]), 2);
  return sum;
}

std::vector<Eigen::Index> BoxSearch::places_of(std::size_t recording) const {
  std::vector<Eigen::Index> place(point_.shared.size() + point_.own[recording].size());
  const auto own = place.begin() + static_cast<std::ptrdiff_t>(point_.shared.size());
  std::iota(place.begin(), own, Eigen::Index{0});
  Eigen::Index first_own = static_cast<Eigen::Index>(point_.shared.size());
  for (std::size_t k = 0; k < recording; ++k) first_own += static_cast<Eigen::Index>(point_.own[k].size());
  std::iota(own, place.end(), first_own);
  return place;
}

BoxSearch::LinearModel BoxSearch::linear_model() const {
  LinearModel here{.gram = Eigen::MatrixXd::Zero(size_, size_),
                   .gradient = Eigen::VectorXd::Zero(size_),
                   .low = Eigen::VectorXd::Constant(size_, -kInfinite),
                   .high = Eigen::VectorXd::Constant(size_, kInfinite)};
  const auto shared = static_cast<Eigen::Index>(point_.shared.size());
  for (std::size_t k = 0; k < costs_.costs().size(); ++k) {
    const RecordingCost& cost = *costs_.costs()[k];
    const Eigen::MatrixXd& all = cost.compressed();
    const Eigen::Index n = all.cols() - 1;
    const std::vector<Eigen::Index> place = places_of(k);
    here.gram(place, place) += all.leftCols(n).transpose() * all.leftCols(n);
    here.gradient(place) += all.leftCols(n).transpose() * all.col(n);
    here.has_kept = here.has_kept || cost.has_kept();
    cost.set_out_from_here();
  }
  for (Eigen::Index k = 0; k < shared; ++k) {
    const Unknown& unknown = problem_.shared[static_cast<std::size_t>(k)];
    const double at = point_.shared[static_cast<std::size_t>(k)];
    if (held_[static_cast<std::size_t>(k)]) here.low(k) = here.high(k) = 0.0;
    if (!unknown.is_known()) {
      if (!held_[static_cast<std::size_t>(k)] && has_range(unknown))
        keep_near_range(unknown, at, here.low(k), here.high(k));
      continue;
    }
    here.gram(k, k) += 1.0 / (unknown.prior_std * unknown.prior_std);
    here.gradient(k) -= unknown.prior_residual(at) / unknown.prior_std;
    if (held_[static_cast<std::size_t>(k)] || !has_range(unknown)) continue;
    here.low(k) = unknown.to_unknown(unknown.min) - at;
    here.high(k) = unknown.to_unknown(unknown.max) - at;
  }
  return here;
}

// Along a curved valley residuals are r + s J v + s^2 (a + J w): a the bend that the step v has shown, w what the linear
// model has against it. The cost is a polynomial of s, and least where its second term still is below the first.
// Geodesic acceleration (M. K. Transtrum, J. P. Sethna, arXiv:1201.5885), with the bend of a step that was too long.
BoxSearch::Step BoxSearch::bent(const LinearModel& here, const Eigen::VectorXd& v) const {
  Bend a{.slope = Eigen::VectorXd::Zero(size_)};
  for (std::size_t k = 0; k < costs_.costs().size(); ++k) {
    const std::vector<Eigen::Index> place = places_of(k);
    const Bend one = costs_.costs()[k]->bend(v(place));
    a.slope(place) += one.slope;
    a.with_residual += one.with_residual;
    a.square += one.square;
  }
  const Eigen::MatrixXd gram = here.gram / here.curvature;
  const Eigen::VectorXd w = minimum_in_box(gram, a.slope, here.low - v, here.high - v, kUndamped),
                        size = gram.diagonal().cwiseSqrt();
  const double first = v.dot(here.gradient), second = 0.5 * v.dot(gram * v) + a.with_residual + w.dot(here.gradient),
               third = v.dot(a.slope + gram * w), fourth = 0.5 * (a.square + w.dot(2.0 * a.slope + gram * w));
  const double longest = std::min(1.0, kBent * size.cwiseProduct(v).norm() / size.cwiseProduct(w).norm());
  constexpr int kPlaces = 100;  // closer where s is small
  double least = 0.0, best = 0.0;
  for (int k = 1; k <= kPlaces; ++k) {
    const double s = longest * k * k / (kPlaces * kPlaces),
                 change = s * (first + s * (second + s * (third + s * fourth)));
    if (change < least) least = change, best = s;
  }
  return {.by = best * v + best * best * w, .promised = -least};
}

BoxSearch::Step BoxSearch::take(Step step, bool may_keep) {
  move(step.by);
  step.after = evaluate(may_keep);
  return step;
}

void BoxSearch::move(const Eigen::VectorXd& by) {
  Eigen::Index k = 0;
  for (std::size_t j = 0; j < point_.shared.size(); ++j) {
    point_.shared[j] += by(k++);
    if (problem_.shared[j].is_known()) point_.shared[j] = inside(problem_.shared[j], point_.shared[j]);  // rounding
  }
  for (std::vector<double>& own : point_.own)
    for (double& value : own) value += by(k++);
}

bool BoxSearch::hold_outside() {
  bool any = false;
  for (std::size_t k = 0; k < held_.size(); ++k) {
    const double end = inside(problem_.shared[k], point_.shared[k]);
    if (end == point_.shared[k]) continue;
    point_.shared[k] = end;
    held_[k] = any = true;
  }
  return any;
}

bool BoxSearch::let_go(double tolerance) {
  const Eigen::VectorXd gradient = linear_model().gradient;
  bool any = false;
  for (std::size_t k = 0; k < held_.size(); ++k) {
    const Unknown& unknown = problem_.shared[k];
    const double slope = gradient(static_cast<Eigen::Index>(k)), lower = unknown.to_unknown(unknown.min);
    const bool inwards = point_.shared[k] <= lower ? slope < 0.0 : slope > 0.0;
    const double promised = std::abs(slope) * (unknown.to_unknown(unknown.max) - lower);
    if (!held_[k] || !inwards || promised <= tolerance) continue;
    held_[k] = false;
    any = true;
  }
  return any;
}

SearchEnd BoxSearch::descend(const StoppingRule& rule, int maximum_iterations) {
  const int end = iterations_ + maximum_iterations;
  cost_ = evaluate(iterations_ == 0);
  if (!std::isfinite(cost_)) return SearchEnd::stuck;
  double damping = kDamping, radius = kOrderOfOne;
  int taken = 0;                // steps
  bool shortened = false;       // the last step was taken back,
  bool beyond_is_none = false;  // and one of those in a row led to where there is no simulation
  bool may_keep = rule.is_near_noise(cost_);
  LinearModel here = linear_model();
  double curvature = 1.0;
  const auto renew_model = [&] {
    here = linear_model();
    here.curve(curvature);
  };
  // Where kept derivatives lead no further, those of the point itself decide.
  const auto renew = [&] {
    if (!here.has_kept || passed(rule.deadline)) return false;
    const double cost = evaluate(false);
    if (!std::isfinite(cost)) return false;
    cost_ = cost;
    renew_model();
    return true;
  };
  while (iterations_ <= end) {
    if (rule.on_iteration) rule.on_iteration(iterations_);
    if (passed(rule.deadline)) return SearchEnd::out_of_time;
    if (rule.is_hopeless(cost_, taken)) return SearchEnd::hopeless;
    const double tolerance = rule.at_cost(cost_);
    Eigen::VectorXd by = here.step(kUndamped);
    if (!by.allFinite()) return SearchEnd::stuck;
    const double expected = here.promised(by);
    promised_ = here.curvature * expected;  // a search may yet come as far as the linear model says
    if (expected <= tolerance) {
      if (renew()) continue;
      return SearchEnd::converged;
    }
    if (promised_ <= rule.bound.decides_nothing * cost_) return SearchEnd::out_of_iterations;
    if (rule.bound.is_out_of_reach(cost_, promised_)) {
      if (renew()) continue;
      return SearchEnd::out_of_reach;
    }
    const Eigen::VectorXd limited = here.step(damping, radius);
    const bool promises = here.promised(limited) > tolerance;
    if (shortened && !promises) {  // the slope is known no better than that, or the way is barred
      if (renew()) continue;
      return beyond_is_none ? SearchEnd::stuck : SearchEnd::converged;
    }
    if (promises) by = limited;
    const PemPoint before = point_;
    Step step = take({.by = by, .promised = here.promised(by)}, may_keep);
    if (step.is_simulated()) curvature = here.curvature_seen(by, cost_ - step.after);
    if (step.is_simulated() && !step.is_kept(cost_)) {
      if (Step curved = bent(here, by); curved.promised > tolerance) {
        point_ = before;
        curved = take(std::move(curved), may_keep);
        // One that the model along the curve does not foresee may lead to another, worse minimum.
        if (cost_ - curved.after >= kLinear * curved.promised) step = std::move(curved);
      }
    }
    const double change = cost_ - step.after, kept = change / step.promised;
    if (!step.is_kept(cost_)) {
      const double length = by.cwiseAbs().maxCoeff();
      point_ = before;
      here.curve(curvature);
      beyond_is_none = beyond_is_none || !step.is_simulated();
      if (renew()) continue;
      // Where a step of the order of one promises nothing (an unknown that sets out at many times its scale), it must be
      // longer: else the search would end where it set out.
      radius = std::min(kOrderOfOne, kShrinks * length);
      if (here.promised(here.step(damping, radius)) <= tolerance) radius = kShrinks * length;
      if (radius < kNearest) return SearchEnd::stuck;
      shortened = true;
      continue;
    }
    const double length = step.by.cwiseAbs().maxCoeff();
    damping = std::max(kUndamped, damping * std::max(kFalls, 1.0 - std::pow(2.0 * kept - 1.0, 3)));
    if (kept > kTrusted) radius = std::max(radius, kWidens * length);
    if (kept < kLinear) radius = std::min(radius, std::max(kOrderOfOne, kShrinks * length));
    may_keep = kept > kTrusted && rule.is_near_noise(step.after);
    shortened = beyond_is_none = false;
    ++taken;
    cost_ = step.after;
    renew_model();
    if (change <= tolerance && kept > kLinear && !renew()) return SearchEnd::converged;
  }
  promised_ = here.curvature * here.promised(here.step(kUndamped));
  return SearchEnd::out_of_iterations;
}

SearchEnd BoxSearch::run(const StoppingRule& rule, int maximum_iterations) {
  SearchEnd end = descend(rule, maximum_iterations);
  bool let_go_of_some = false;  // once: what is held and let go in turns would never end
  while (end == SearchEnd::converged || end == SearchEnd::out_of_iterations) {
    if (!hold_outside()) {
      if (end == SearchEnd::out_of_iterations || let_go_of_some) break;
      costs_.PrepareForEvaluation(true, true);  // a step that was taken back may have been the last one
      if (costs_.failed() || !let_go(rule.at_cost(cost_))) break;
      let_go_of_some = true;
    }
    end = descend(rule, maximum_iterations);
  }
  // Where the next search goes on, or what is told of this one.
  if (end == SearchEnd::stuck || end == SearchEnd::out_of_reach || end == SearchEnd::hopeless) hold_outside();
  return end;
}

}  // namespace sealwatch
