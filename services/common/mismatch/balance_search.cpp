#include "services/common/mismatch/balance_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sealwatch/model/physics.hpp"
#include "services/common/core/in_parallel.hpp"
#include "services/common/dense/dense.hpp"
#include "services/common/mismatch/balance_options.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr double kWorthAnother = 12.0;  // as for laws that a simulation names (naming.cpp)
constexpr std::size_t kRefits = 7;      // for each balance
constexpr std::size_t kMostDatasheetValues = 8;
constexpr int kFewIterations = 10;

double criterion(const BalanceErrors& errors, std::size_t unknowns) {
  double sum = 0.0, all = 0.0;
  for (std::size_t b = 0; b < errors.sigma.size(); ++b) {
    if (!(errors.sigma[b] > 0.0)) continue;
    sum += 2.0 * errors.blocks[b] * std::log(errors.sigma[b]);
    all += errors.blocks[b];
  }
  return sum + static_cast<double>(unknowns) * std::log(std::max(all, 2.0));
}

// The model with an option in it, refitted.
struct Attempt {
  BalanceOption option;
  BalanceProblem problem;
  BalanceModel model;
  double criterion = std::numeric_limits<double>::infinity();
};

class Search {
 public:
  Search(const AssetConfig& asset, const PlantDescription& plant, const SwitchedBalances& balances, int maximum_laws,
         int threads)
      : maximum_laws_(maximum_laws), threads_(threads), options_(balance_options(asset, plant)) {
    problem_.balances = &balances;
    problem_.unknowns = free_unknowns(asset, balances.recordings());
    fixed_ = problem_.unknowns.size();
    fit_.model = {.asset = asset, .load_factor = std::vector<double>(balances.recordings(), 0.0)};
    datasheet_ = asset;
  }

  BalanceFit run() {
    problem_.fit(fit_.model, kBalanceIterations);
    const BalanceErrors before = problem_.errors(fit_.model);
    fit_.error_before.assign(before.sigma.begin(), before.sigma.end());
    fit_.baseline = fit_.model;
    const std::vector<double> errors_of_free = standard_errors();
    for (std::size_t k = 0; k < fixed_ && !problem_.unknowns[k].element.empty(); ++k)
      fit_.free.push_back({.name = problem_.unknowns[k].name,
                           .before = value_of(fit_.model, problem_.unknowns[k]),
                           .before_std = errors_of_free[k]});
    while (add_best()) {
    }
    polish();
    fit_.criterion_before = criterion(before, fixed_);
    say_errors();
    return std::move(fit_);
  }

  BalanceFit again(const BalanceFit& found) {
    fit_ = found;
    for (const BalanceFinding& finding : fit_.findings) problem_.unknowns.push_back(finding.what);
    problem_.fit(fit_.model, kBalanceIterations);
    const double now = criterion(problem_.errors(fit_.model), problem_.unknowns.size());
    std::vector<Attempt> all =
        in_parallel<Attempt>(fit_.findings.size(), threads_, [&](std::size_t k) { return without(k); });
    for (std::size_t k = 0; k < all.size(); ++k) {
      fit_.findings[k].weight = all[k].criterion - now;
      fit_.findings[k].without = std::move(all[k].model);
    }
    fill_values();
    say_errors();
    return std::move(fit_);
  }

 private:
  [[nodiscard]] bool allowed(const BalanceOption& option) const {
    std::size_t laws = 0, values = 0;
    for (std::size_t k = fixed_; k < problem_.unknowns.size(); ++k) {
      const BalanceUnknown& taken = problem_.unknowns[k];
      if (taken.law == nullptr) ++values;
      if (taken.law != nullptr && taken.law->evaluate != nullptr) ++laws;
      if (taken.element == option.unknown.element && taken.name == option.unknown.name &&
          taken.law == option.unknown.law)
        return false;
      if (taken.law != nullptr && option.unknown.law != nullptr && taken.element == option.unknown.element &&
          taken.law->id == option.unknown.law->id)
        return false;  // another form of the same law
    }
    if (option.unknown.law == nullptr) return values < kMostDatasheetValues;
    return option.unknown.law->evaluate == nullptr || laws < static_cast<std::size_t>(maximum_laws_);
  }

  // For each balance the options that promise most to it on the linearised problem, what is free projected off.
  [[nodiscard]] std::vector<const BalanceOption*> ranked() const {
    const SwitchedBalances::Residuals residuals = problem_.balances->residuals(fit_.model);
    const BalanceErrors errors = errors_of(residuals);
    const StackedBalances here = stack(residuals, errors);
    const Eigen::VectorXd root = here.weight.cwiseSqrt();
    const Eigen::MatrixXd j = root.asDiagonal() * problem_.jacobian(fit_.model, here, errors);
    const dense::Symmetric factor(BalanceProblem::normal(j, Eigen::VectorXd::Ones(j.rows())));
    const Eigen::VectorXd r = root.cwiseProduct(here.residual);
    std::array<std::vector<std::pair<double, const BalanceOption*>>, SwitchedBalances::kBalances.size()> gains;
    for (const BalanceOption& option : options_) {
      if (!allowed(option)) continue;
      BalanceModel model = fit_.model;
      if (option.term) model.asset.physics.push_back(*option.term);
      Eigen::VectorXd s = root.cwiseProduct(problem_.column(model, option.unknown, here, errors));
      s -= j * factor.solve(Eigen::VectorXd(j.transpose() * s));
      Eigen::Index at = 0;
      for (std::size_t b = 0; b < gains.size(); at += residuals[b++].size()) {
        const auto part = s.segment(at, residuals[b].size());
        const double size = part.squaredNorm(), along = part.dot(r.segment(at, residuals[b].size()));
        if (size > 0.0) gains[b].emplace_back(along * along / size, &option);
      }
    }
    std::vector<const BalanceOption*> order;
    for (auto& gain : gains) {
      std::ranges::stable_sort(gain, std::greater<>(), &std::pair<double, const BalanceOption*>::first);
      std::vector<const BalanceOption*> taken;
      for (std::size_t k = 0; k < gain.size() && taken.size() < kRefits; ++k)
        if (std::ranges::none_of(
                taken, [&](const BalanceOption* other) { return same_law(other->unknown, gain[k].second->unknown); }))
          taken.push_back(gain[k].second);
      for (const BalanceOption* option : taken)
        if (std::ranges::find(order, option) == order.end()) order.push_back(option);
    }
    return order;
  }

  [[nodiscard]] Attempt attempt(const BalanceOption& option, int iterations) const {
    Attempt tried{.option = option, .problem = problem_, .model = fit_.model};
    if (option.term) tried.model.asset.physics.push_back(*option.term);
    tried.problem.unknowns.push_back(option.unknown);
    tried.problem.fit(tried.model, iterations);
    tried.criterion = criterion(tried.problem.errors(tried.model), tried.problem.unknowns.size());
    return tried;
  }

  bool add_best() {
    const auto order = ranked();
    std::vector<Attempt> attempts =
        in_parallel<Attempt>(order.size(), threads_, [&](std::size_t k) { return attempt(*order[k], kFewIterations); });
    const double now = criterion(problem_.errors(fit_.model), problem_.unknowns.size());
    std::erase_if(attempts, [&](Attempt& tried) {
      return std::any_of(tried.problem.unknowns.begin() + static_cast<std::ptrdiff_t>(fixed_),
                         tried.problem.unknowns.end(),
                         [&](const BalanceUnknown& unknown) { return at_bound(tried.model, unknown); });
    });
    auto best = std::ranges::min_element(attempts, {}, &Attempt::criterion);
    if (best == attempts.end() || best->criterion > now - kWorthAnother) return false;
    // One cause that acts in several places before one in each of them, unless that is decisively worse.
    const double limit = best->criterion + kWorthAnother;
    for (auto other = attempts.begin(); other != attempts.end(); ++other)
      if (other->option.unknown.law != nullptr && best->option.unknown.law != nullptr && other->criterion < limit &&
          other->option.places > best->option.places)
        best = other;
    BalanceFinding found{.what = best->option.unknown, .alternatives = {}, .without = {}};
    for (const Attempt& other : attempts) {
      if (&other == &*best || other.criterion > now - kWorthAnother) continue;
      BalanceModel model = other.model;
      found.alternatives.push_back({.what = other.option.unknown,
                                    .value = value_of(model, other.option.unknown),
                                    .weight = std::max(0.0, other.criterion - best->criterion),
                                    .alternatives = {},
                                    .without = {}});
    }
    std::ranges::stable_sort(found.alternatives, {}, &BalanceFinding::weight);
    fit_.model = std::move(best->model);
    problem_ = std::move(best->problem);
    fit_.findings.push_back(std::move(found));
    problem_.fit(fit_.model, kBalanceIterations);
    return true;
  }

  void say_errors() {
    const BalanceErrors after = problem_.errors(fit_.model);
    fit_.error_after.assign(after.sigma.begin(), after.sigma.end());
    fit_.criterion_after = criterion(after, problem_.unknowns.size());
  }

  // The fit without one finding.
  [[nodiscard]] Attempt without(std::size_t finding) const {
    Attempt tried{.option = {}, .problem = problem_, .model = fit_.model};
    const BalanceUnknown out = problem_.unknowns[fixed_ + finding];
    tried.problem.unknowns.erase(tried.problem.unknowns.begin() + static_cast<std::ptrdiff_t>(fixed_ + finding));
    put_back(tried.model, datasheet_, out);
    tried.problem.fit(tried.model, kBalanceIterations);
    tried.criterion = criterion(tried.problem.errors(tried.model), tried.problem.unknowns.size());
    return tried;
  }

  // Takes out what is not needed, then weighs what stays.
  void polish() {
    for (bool dropped = true; dropped && !fit_.findings.empty();) {
      dropped = false;
      const double now = criterion(problem_.errors(fit_.model), problem_.unknowns.size());
      std::vector<Attempt> all =
          in_parallel<Attempt>(fit_.findings.size(), threads_, [&](std::size_t k) { return without(k); });
      for (std::size_t k = 0; k < fit_.findings.size() && !dropped; ++k) {
        Attempt& fewer = all[k];
        fit_.findings[k].weight = fewer.criterion - now;
        if (fewer.criterion > now + kWorthAnother) {
          fit_.findings[k].without = std::move(fewer.model);
          continue;
        }
        fit_.model = std::move(fewer.model);
        problem_ = std::move(fewer.problem);
        fit_.findings.erase(fit_.findings.begin() + static_cast<std::ptrdiff_t>(k));
        dropped = true;
      }
    }
    fill_values();
    std::ranges::stable_sort(fit_.findings, std::greater<>(), &BalanceFinding::weight);
  }

  // Of every unknown, in its own unit: infinite where the balances do not see it or it is at its bound.
  [[nodiscard]] std::vector<double> standard_errors() {
    const SwitchedBalances::Residuals residuals = problem_.balances->residuals(fit_.model);
    const BalanceErrors errors = errors_of(residuals);
    const StackedBalances here = stack(residuals, errors);
    const Eigen::VectorXd ones = Eigen::VectorXd::Ones(here.weight.size());
    const Eigen::MatrixXd matrix =
        BalanceProblem::normal(problem_.jacobian(fit_.model, here, errors), ones) / kCorrelatedBlocks;
    const Eigen::MatrixXd covariance = dense::inverse(matrix);
    std::vector<double> found;
    for (std::size_t k = 0; k < problem_.unknowns.size(); ++k) {
      const BalanceUnknown& unknown = problem_.unknowns[k];
      const double slope = unknown.logarithmic ? value_of(fit_.model, unknown) : unknown.unit;
      const double variance = covariance(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(k));
      const bool seen = variance > 0.0 && !at_bound(fit_.model, unknown) && !(unknown.logarithmic && variance > 4.0);
      found.push_back(seen ? slope * std::sqrt(variance) : std::numeric_limits<double>::infinity());
    }
    return found;
  }

  void fill_values() {
    const std::vector<double> errors = standard_errors();
    for (std::size_t k = 0; k < fit_.findings.size(); ++k) {
      BalanceFinding& found = fit_.findings[k];
      found.value = value_of(fit_.model, found.what);
      found.std_error = errors[fixed_ + k];
      found.at_bound = at_bound(fit_.model, found.what);
      if (found.what.law == nullptr) found.datasheet = datasheet_.parameters.at(found.what.name).value;
    }
    for (std::size_t k = 0; k < fit_.free.size(); ++k) {
      fit_.free[k].after = value_of(fit_.model, problem_.unknowns[k]);
      fit_.free[k].after_std = errors[k];
    }
  }

  int maximum_laws_, threads_;
  std::vector<BalanceOption> options_;
  BalanceProblem problem_;
  std::size_t fixed_ = 0;
  AssetConfig datasheet_;
  BalanceFit fit_;
};

}  // namespace

BalanceFit search_balances(const AssetConfig& asset, const PlantDescription& plant, const SwitchedBalances& balances,
                           int maximum_laws, int threads) {
  return Search(asset, plant, balances, maximum_laws, threads).run();
}

BalanceFit refit_findings(const AssetConfig& asset, const PlantDescription& plant, const SwitchedBalances& balances,
                          const BalanceFit& found, int threads) {
  return Search(asset, plant, balances, static_cast<int>(found.findings.size()), threads).again(found);
}

BalanceFit refit_balances(const AssetConfig& asset, const SwitchedBalances& balances, const BalanceFit& found) {
  BalanceFit fit;
  BalanceProblem problem{.balances = &balances, .unknowns = free_unknowns(asset, balances.recordings())};
  fit.baseline = {.asset = asset, .load_factor = std::vector<double>(balances.recordings(), 0.0)};
  problem.fit(fit.baseline, kBalanceIterations);
  for (const BalanceFinding& finding : found.findings) problem.unknowns.push_back(finding.what);
  fit.model = {.asset = found.model.asset, .load_factor = fit.baseline.load_factor};
  problem.fit(fit.model, kBalanceIterations);
  return fit;
}

double held_out_loss(const SwitchedBalances& balances, const BalanceModel& model) {
  BalanceModel held_out{.asset = model.asset, .load_factor = std::vector<double>(balances.recordings(), 0.0)};
  BalanceProblem problem{.balances = &balances, .unknowns = {}};
  for (const BalanceUnknown& unknown : free_unknowns(model.asset, balances.recordings()))
    if (unknown.element.empty()) problem.unknowns.push_back(unknown);
  problem.fit(held_out, kBalanceIterations);
  return balance_loss(balances.residuals(held_out)) / kCorrelatedBlocks;
}

}  // namespace sealwatch::mismatch
