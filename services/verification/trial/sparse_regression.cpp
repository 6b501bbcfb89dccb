#include "services/verification/trial/sparse_regression.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <map>

#include "sealwatch/model/eha.hpp"
#include "sealwatch/model/no_extra.hpp"
#include "services/common/model/law_columns.hpp"

namespace sealwatch::verification {
namespace {

using mismatch::Candidate;

constexpr Eigen::Index kHalfWindow = 10;  // samples: parabolas over a fifth of a second at 100 Hz
constexpr double kRidge = 1e-6;           // of columns of unit length: laws that look alike share their effect

/// A channel and its rate by parabolas through its neighbours; its known low-pass is undone.
struct Smoothed {
  Eigen::VectorXd value, rate;
};

Smoothed smooth(const std::vector<double>& time_s, const std::vector<double>& values, double time_constant_s) {
  const auto samples = static_cast<Eigen::Index>(values.size());
  Smoothed out{.value = Eigen::VectorXd(samples), .rate = Eigen::VectorXd(samples)};
  for (Eigen::Index k = 0; k < samples; ++k) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (Eigen::Index j = std::max(k - kHalfWindow, Eigen::Index{0}); j <= std::min(k + kHalfWindow, samples - 1);
         ++j) {
      const double t = time_s[static_cast<std::size_t>(j)] - time_s[static_cast<std::size_t>(k)];
      const Eigen::Vector3d powers(1.0, t, t * t);
      normal += powers * powers.transpose();
      right += powers * values[static_cast<std::size_t>(j)];
    }
    const Eigen::Vector3d parabola = normal.fullPivLu().solve(right);
    out.value[k] = parabola[0] + time_constant_s * parabola[1];
    out.rate[k] = parabola[1] + 2.0 * time_constant_s * parabola[2];
  }
  return out;
}

enum BalanceIndex : std::size_t { kWinding, kChamberA, kPiston, kBalances };

std::size_t balance_of(const Candidate& candidate) {
  switch (candidate.law->kind) {
    case SiteKind::voltage_command:
    case SiteKind::winding_voltage:
      return kWinding;
    case SiteKind::outflow:
    case SiteKind::compliance:
      return candidate.element == "chamber_a" ? kChamberA : kBalances;
    case SiteKind::seal_leakage:
      return kChamberA;
    case SiteKind::piston_force:
      return kPiston;
    default:
      return kBalances;
  }
}

const std::array<std::vector<std::string_view>, kBalances> kNeeds = {
    {{"motor_voltage", "motor_current", "shaft_speed"},
     {"flow", "velocity", "position", "pressure_a", "pressure_b"},
     {"pressure_a", "pressure_b", "velocity", "position"}}};

/// Rows of one balance: target, columns that are always there, laws.
struct Balance {
  std::vector<double> target;
  std::vector<std::vector<double>> always, laws;
  std::vector<const Candidate*> which;
};

EhaParameters<double> datasheet(const AssetConfig& asset) {
  EhaParameters<double> p{};
  EhaParameters<double>::visit(
      [&asset](std::string_view name, double& value) {
        const auto own = asset.parameters.find(std::string(name));
        if (const ParameterDescription* described = find_plant("eha").value()->find_parameter(name))
          value = own != asset.parameters.end() ? own->second.value : described->value;
      },
      p);
  return p;
}

class Regression {
 public:
  Regression(const AssetConfig& asset, const std::vector<Candidate>& candidates, std::size_t recordings)
      : p_(datasheet(asset)) {
    for (const Candidate& candidate : candidates) {
      const std::size_t balance = balance_of(candidate);
      if (balance == kBalances) continue;
      for (const std::size_t strength : mismatch::strengths_of(*candidate.law)) {
        columns_.push_back({.law = candidate.law,
                            .sites = {candidate.sites.front()},
                            .parameters = candidate.grid.front(),
                            .strength = strength});
        owner_.push_back(balance);
        balances_[balance].which.push_back(&candidate);
      }
    }
    const std::array<std::size_t, kBalances> always = {1, 2, 1 + recordings};
    for (std::size_t b = 0; b < kBalances; ++b) {
      balances_[b].always.resize(always[b]);
      balances_[b].laws.resize(balances_[b].which.size());
    }
  }

  void add(const TimeSeries& recorded, std::size_t recording) {
    std::map<std::string_view, Smoothed> known;
    for (const Series& channel : recorded.channels) {
      const ChannelDescription* described = find_plant("eha").value()->find_channel(channel.name);
      known[channel.name] =
          smooth(recorded.time_s, channel.values, described == nullptr ? 0.0 : described->time_constant_s);
    }
    std::array<bool, kBalances> usable{};
    for (std::size_t b = 0; b < kBalances; ++b)
      usable[b] = std::ranges::all_of(kNeeds[b], [&](std::string_view name) { return known.contains(name); });
    LawColumns laws(columns_, **find_plant("eha"));
    for (std::size_t k = 0; k < recorded.time_s.size(); ++k)
      add_row(known, usable, laws, recorded.time_s[k], k, recording);
  }

  [[nodiscard]] const std::array<Balance, kBalances>& balances() const { return balances_; }

 private:
  void add_row(const std::map<std::string_view, Smoothed>& known, const std::array<bool, kBalances>& usable,
               LawColumns& laws, double t, std::size_t sample, std::size_t recording) {
    const auto at = static_cast<Eigen::Index>(sample);
    const auto value = [&](std::string_view name) { return known.contains(name) ? known.at(name).value[at] : 0.0; };
    const auto rate = [&](std::string_view name) { return known.contains(name) ? known.at(name).rate[at] : 0.0; };
    const double u = value("motor_voltage"), i = value("motor_current"), w = value("shaft_speed");
    const double p_a = value("pressure_a"), p_b = value("pressure_b"), dp = p_a - p_b;
    const double v = value("velocity"), x = value("position"), q = value("flow");
    const double fill = (p_.V_0 + p_.A_C * x) * rate("pressure_a");
    const Eha::State<double> y = {u, i, w, p_a, p_b, p_a, p_b, v, x};
    std::array<std::array<double, kSiteSignals>, Eha::kSites.size()> signals;
    for (std::size_t site = 0; site < signals.size(); ++site)
      signals[site] = Eha::signals<double>(site, y, Eha::Input{u, rate("motor_voltage")}, p_, NoExtra{});
    std::vector<double> weights(laws.entries().size());
    laws.weigh(t, signals, weights);

    const double z = u - p_.R_M * p_.C_M * rate("motor_voltage");  // behind the driver's filter
    const std::array<double, kBalances> targets = {z - p_.Omega_M * w - p_.L_M * rate("motor_current"), q - p_.A_C * v,
                                                   p_.A_C * dp - p_.m_C * rate("velocity")};
    const std::array<std::vector<double>, kBalances> always = {{{i}, {fill, dp}, {v}}};
    for (std::size_t b = 0; b < kBalances; ++b) {
      if (!usable[b]) continue;
      Balance& balance = balances_[b];
      balance.target.push_back(targets[b]);
      for (std::size_t k = 0; k < balance.always.size(); ++k)
        balance.always[k].push_back(k < always[b].size() ? always[b][k]
                                                         : (k - always[b].size() == recording ? 1.0 : 0.0));
    }
    std::array<std::size_t, kBalances> next{};
    for (std::size_t k = 0; k < columns_.size(); ++k) {
      const std::size_t b = owner_[k], own = next[b]++;
      const bool softness = columns_[k].law->kind == SiteKind::compliance;
      if (usable[b]) balances_[b].laws[own].push_back(weights[k] * (softness ? rate("pressure_a") : 1.0));
    }
  }

  EhaParameters<double> p_;
  std::vector<LawColumn> columns_;
  std::vector<std::size_t> owner_;  ///< balance of each column
  std::array<Balance, kBalances> balances_;
};

Eigen::MatrixXd as_matrix(const std::vector<std::vector<double>>& columns, std::size_t rows) {
  Eigen::MatrixXd out(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns.size()));
  for (std::size_t k = 0; k < columns.size(); ++k)
    out.col(static_cast<Eigen::Index>(k)) = Eigen::Map<const Eigen::VectorXd>(columns[k].data(), out.rows());
  return out;
}

/// Least squares of laws of unit length, what is always there taken off everything.
struct Reduced {
  Eigen::MatrixXd gram;
  Eigen::VectorXd gradient, length;
  double square = 0.0, samples = 0.0;

  explicit Reduced(const Balance& balance) : samples(static_cast<double>(balance.target.size())) {
    Eigen::MatrixXd base = as_matrix(balance.always, balance.target.size());
    for (Eigen::Index k = 0; k < base.cols(); ++k)
      if (const double size = base.col(k).norm(); size > 0.0) base.col(k) /= size;
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(base);
    const Eigen::MatrixXd span = qr.householderQ() * Eigen::MatrixXd::Identity(base.rows(), qr.rank());
    const Eigen::VectorXd raw = Eigen::Map<const Eigen::VectorXd>(balance.target.data(), base.rows());
    const Eigen::VectorXd target = raw - span * (span.transpose() * raw);
    Eigen::MatrixXd laws = as_matrix(balance.laws, balance.target.size());
    const Eigen::VectorXd before = laws.colwise().norm();
    laws -= span * (span.transpose() * laws);
    length = laws.colwise().norm();
    for (Eigen::Index k = 0; k < laws.cols(); ++k)
      if (length[k] > 1e-6 * before[k]) {
        laws.col(k) /= length[k];
      } else {
        length[k] = 0.0;
        laws.col(k).setZero();
      }
    gram = laws.transpose() * laws;
    gradient = laws.transpose() * target;
    square = target.squaredNorm();
  }

  [[nodiscard]] Eigen::VectorXd solve(const std::vector<Eigen::Index>& kept) const {
    Eigen::MatrixXd own = gram(kept, kept);
    own.diagonal().array() += kRidge;
    return own.ldlt().solve(gradient(kept));
  }
  [[nodiscard]] double bic(const std::vector<Eigen::Index>& kept) const {
    double left = square;
    if (!kept.empty()) {
      const Eigen::VectorXd k = solve(kept);
      left += k.dot(gram(kept, kept) * k) - 2.0 * k.dot(gradient(kept));
    }
    return samples * std::log(std::max(left, 1e-12 * square) / samples) +
           static_cast<double>(kept.size()) * std::log(samples);
  }

  /// All, then without what is below the threshold, until nothing is.
  [[nodiscard]] std::vector<Eigen::Index> threshold(double least) const {
    std::vector<Eigen::Index> kept;
    for (Eigen::Index k = 0; k < length.size(); ++k)
      if (length[k] > 0.0) kept.push_back(k);
    while (!kept.empty()) {
      const Eigen::VectorXd now = solve(kept);
      std::vector<Eigen::Index> next;
      for (std::size_t k = 0; k < kept.size(); ++k)
        if (std::abs(now[static_cast<Eigen::Index>(k)]) >= least) next.push_back(kept[k]);
      if (next.size() == kept.size()) break;
      kept = std::move(next);
    }
    return kept;
  }
};

void regress(const Balance& balance, std::vector<SparseTerm>& found) {
  if (balance.target.empty() || balance.laws.empty()) return;
  const Reduced problem(balance);
  std::vector<Eigen::Index> best;
  double lowest = problem.bic(best);
  constexpr double kFinest = 1e-4, kRatio = 1.25;  // thresholds, of the target's length
  for (double share = kFinest; share < 1.0; share *= kRatio) {
    const std::vector<Eigen::Index> kept = problem.threshold(share * std::sqrt(problem.square));
    if (const double own = problem.bic(kept); own < lowest) {
      lowest = own;
      best = kept;
    }
  }
  if (best.empty()) return;
  const Eigen::VectorXd strengths = problem.solve(best);
  for (std::size_t k = 0; k < best.size(); ++k) {
    std::vector<Eigen::Index> without = best;
    without.erase(without.begin() + static_cast<std::ptrdiff_t>(k));
    const Candidate& candidate = *balance.which[static_cast<std::size_t>(best[k])];
    found.push_back({.id = std::string(candidate.law->id),
                     .element = candidate.element,
                     .strength = strengths[static_cast<Eigen::Index>(k)] / problem.length[best[k]],
                     .gain = problem.bic(without) - lowest});
  }
}

}  // namespace

std::vector<SparseTerm> sparse_regression(const AssetConfig& asset, const mismatch::Data& recordings,
                                          const std::vector<Candidate>& candidates) {
  Regression regression(asset, candidates, recordings.samples.size());
  for (std::size_t k = 0; k < recordings.samples.size(); ++k) regression.add(recordings.samples[k], k);
  std::vector<SparseTerm> found;
  for (const Balance& balance : regression.balances()) regress(balance, found);
  std::ranges::sort(found, std::ranges::greater{}, &SparseTerm::gain);
  return found;
}

}  // namespace sealwatch::verification
