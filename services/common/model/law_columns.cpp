#include "services/common/model/law_columns.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "sealwatch/model/law_sizes.hpp"

namespace sealwatch {
namespace {

constexpr double kLongestHiddenStep_s = 2e-3;
constexpr int kNewtonIterations = 4;
constexpr double kNext = 1e-3;  // of the hidden state: Newton's next change would be about its square
constexpr double kSettling_s = 10.0;

std::vector<double> without_strengths(const LawColumn& column) {
  std::vector<double> parameters = column.parameters;
  for (std::size_t k = 0; k < parameters.size(); ++k)
    if (column.law->parameters[k].strength) parameters[k] = 0.0;
  return parameters;
}

}  // namespace

LawColumns::LawColumns(std::vector<LawColumn> laws, const PlantDescription& plant) : laws_(std::move(laws)) {
  for (std::size_t k = 0; k < laws_.size(); ++k) {
    const LawColumn& column = laws_[k];
    shape_of(column, plant).strengths.push_back({column.strength, column.unit, entries_.size()});
    for (const std::size_t site : column.sites) entries_.push_back({.column = k, .site = site});
  }
}

LawColumns::Shape& LawColumns::shape_of(const LawColumn& column, const PlantDescription& plant) {
  const std::vector<double> parameters = without_strengths(column);
  const LawInput at = law_input({}, column.hidden, parameters, roundings_of(plant, *column.law));
  const auto same = [&](const Shape& known) {
    return known.law == column.law && known.sites == column.sites && known.at.hidden.value == column.hidden &&
           std::ranges::equal(known.at.parameter, at.parameter, {}, &LawScalar::value, &LawScalar::value);
  };
  const auto known = std::ranges::find_if(shapes_, same);
  if (known != shapes_.end()) return *known;
  return shapes_.emplace_back(Shape{.law = column.law, .sites = column.sites, .at = at, .strengths = {}});
}

// Implicit Euler in short steps, the signals linear between the calls; the midpoint rule for a pure integral.
void LawColumns::advance(Shape& shape, double step_s, Signals signals) {
  const std::size_t site = shape.sites.back();
  const int steps = std::max(1, static_cast<int>(std::ceil(step_s / kLongestHiddenStep_s)));
  const double h = step_s / steps;
  const auto rate_at = [&](double share) {
    for (std::size_t s = 0; s < kSiteSignals; ++s)
      shape.at.signal[s].value = last_.signals[site][s] + share * (signals[site][s] - last_.signals[site][s]);
    return shape.law->evaluate(shape.at).rate;
  };
  double& hidden = shape.at.hidden.value;
  for (int k = 1; k <= steps; ++k) {
    const double share = static_cast<double>(k) / steps;
    LawScalar rate = rate_at(share);
    if (rate.derivative[kSiteSignals] == 0.0) {
      hidden += h * rate_at((k - 0.5) / steps).value;
      continue;
    }
    const double before = hidden;
    for (int iteration = 1;; ++iteration) {
      const double change = (before + h * rate.value - hidden) / (1.0 - h * rate.derivative[kSiteSignals]);
      hidden += change;
      const double size = std::abs(hidden) + shape.law->hidden->scale;
      if (iteration == kNewtonIterations || std::abs(change) <= kNext * size) break;
      rate = rate_at(share);
    }
  }
}

// A law of one's own may have no value where the plant goes ("sqrt(speed)"): what else is asked goes on.
double LawColumns::Shape::finite_or_none(double weight) {
  if (std::isfinite(weight)) return weight;
  finite = false;
  return 0.0;
}

void LawColumns::mark_not_finite(RowMatrix& sensitivities) const {
  const Eigen::Index first = sensitivities.cols() - std::ssize(laws_);
  for (const Shape& shape : shapes_)
    for (const Shape::Strength& strength : shape.strengths)
      if (!shape.finite)
        sensitivities.col(first + static_cast<Eigen::Index>(entries_[strength.first_entry].column))
            .setConstant(std::numeric_limits<double>::quiet_NaN());
}

void LawColumns::take_back_last_step() {
  last_ = before_;
  for (Shape& shape : shapes_) shape.at.hidden.value = shape.hidden_before;
}

void LawColumns::weigh(double t, Signals signals, std::span<double> weights) {
  if (started_ && t < last_.time && before_.time <= t) take_back_last_step();
  if (!started_) last_ = {.time = t, .signals = {signals.begin(), signals.end()}};
  const double step_s = t - last_.time;
  for (Shape& shape : shapes_) {
    if (!shape.law->hidden) continue;
    if (!started_ && shape.law->hidden->settled) advance(shape, kSettling_s, signals);
    if (!started_ || step_s > 0.0) shape.hidden_before = shape.at.hidden.value;
    if (started_ && step_s > 0.0) advance(shape, step_s, signals);
  }
  for (Shape& shape : shapes_)
    for (std::size_t k = 0; k < shape.sites.size(); ++k) {
      for (std::size_t s = 0; s < kSiteSignals; ++s) shape.at.signal[s].value = signals[shape.sites[k]][s];
      const LawScalar contribution = shape.law->evaluate(shape.at).contribution;
      for (const auto& [parameter, unit, first_entry] : shape.strengths)
        weights[first_entry + k] = shape.finite_or_none(unit * contribution.derivative[kSiteSignals + 1 + parameter]);
    }
  if (!started_ || step_s > 0.0) std::swap(before_, last_);
  last_.time = t;
  last_.signals.assign(signals.begin(), signals.end());
  started_ = true;
}

}  // namespace sealwatch
