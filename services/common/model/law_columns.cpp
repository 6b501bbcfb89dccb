#include "services/common/model/law_columns.hpp"

#include <algorithm>
#include <cmath>

#include "sealwatch/model/law_sizes.hpp"

namespace sealwatch {
namespace {

constexpr double kLongestHiddenStep_s = 2e-3;
constexpr int kNewtonIterations = 4;
constexpr double kNext = 1e-4;  // of the hidden state: Newton's next change would be about its square
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
    laws_[k].parameters = without_strengths(laws_[k]);
    roundings_.push_back(roundings_of(plant, *laws_[k].law));
    hidden_.push_back(laws_[k].hidden);
    for (const std::size_t site : laws_[k].sites) entries_.push_back({.column = k, .site = site});
  }
}

// Implicit Euler in short steps, the signals linear between the calls; the midpoint rule for a pure integral.
void LawColumns::advance(std::size_t law, double step_s, Signals signals) {
  const LawColumn& column = laws_[law];
  const std::size_t site = column.sites.back();
  const int steps = std::max(1, static_cast<int>(std::ceil(step_s / kLongestHiddenStep_s)));
  const double h = step_s / steps;
  double& hidden = hidden_[law];
  for (int k = 1; k <= steps; ++k) {
    const double share = static_cast<double>(k) / steps;
    std::array<double, kSiteSignals> at;
    for (std::size_t s = 0; s < kSiteSignals; ++s) at[s] = last_[site][s] + share * (signals[site][s] - last_[site][s]);
    const LawScalar slope = column.law->evaluate(law_input(at, hidden, column.parameters, roundings_[law])).rate;
    if (slope.derivative[kSiteSignals] == 0.0) {
      std::array<double, kSiteSignals> middle;
      const double half = (k - 0.5) / steps;
      for (std::size_t s = 0; s < kSiteSignals; ++s)
        middle[s] = last_[site][s] + half * (signals[site][s] - last_[site][s]);
      hidden += h * column.law->evaluate(law_input(middle, hidden, column.parameters, roundings_[law])).rate.value;
      continue;
    }
    const double before = hidden;
    for (int iteration = 0; iteration < kNewtonIterations; ++iteration) {
      const LawScalar rate = column.law->evaluate(law_input(at, hidden, column.parameters, roundings_[law])).rate;
      const double change = (before + h * rate.value - hidden) / (1.0 - h * rate.derivative[kSiteSignals]);
      hidden += change;
      if (std::abs(change) <= kNext * (std::abs(hidden) + column.law->hidden->scale)) break;
    }
  }
}

void LawColumns::weigh(double t, Signals signals, std::span<double> weights) {
  if (!started_) last_.assign(signals.begin(), signals.end());
  for (std::size_t k = 0; !started_ && k < laws_.size(); ++k)
    if (laws_[k].law->hidden && laws_[k].law->hidden->settled) advance(k, kSettling_s, signals);
  const double step_s = t - time_;
  if (started_ && step_s > 0.0)
    for (std::size_t k = 0; k < laws_.size(); ++k)
      if (laws_[k].law->hidden) advance(k, step_s, signals);
  std::size_t entry = 0;
  for (std::size_t k = 0; k < laws_.size(); ++k)
    for (const std::size_t site : laws_[k].sites) {
      const LawOutput output =
          laws_[k].law->evaluate(law_input(signals[site], hidden_[k], laws_[k].parameters, roundings_[k]));
      weights[entry++] = laws_[k].unit * output.contribution.derivative[kSiteSignals + 1 + laws_[k].strength];
    }
  last_.assign(signals.begin(), signals.end());
  time_ = t;
  started_ = true;
}

}  // namespace sealwatch
