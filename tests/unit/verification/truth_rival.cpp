#include "tests/unit/verification/truth_rival.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "services/verification/truth/conditions.hpp"

namespace sealwatch::bench {
namespace {

constexpr double kStep = 0.01;       // of a logarithm or a share: far above the integration error, far below 1
constexpr double kLoadStep = 1e-3;   // share of the load
constexpr double kMostChange = 0.5;  // of a logarithm in one iteration
constexpr double kSettledShare = 0.02, kSettled = 0.05;  // a decrease of d that does not matter
constexpr double kCommand_s = 0.02, kSample_s = 0.01;    // corners of the command cost the integrator its long steps
// Of the normal equations' diagonal: few channels leave many directions all but free.
constexpr double kDamping = 1e-5, kMoreDamping = 30.0;
constexpr int kIterations = 10, kTrials = 4;

constexpr std::array kFree = {&TruthParameters::seal_resistance, &TruthParameters::piston_viscosity,
                              &TruthParameters::pump_resistance, &TruthParameters::motor_viscosity,
                              &TruthParameters::oil_modulus,     &TruthParameters::winding_resistance};

/// One test of the truth: the command now and then, linear between, and the outputs at every sample under that command.
struct Reference {
  PlannedTrialTest planned;
  std::vector<double> command_V;
  Eigen::VectorXd outputs;
};

class Distance {
 public:
  Distance(const TrialPlan& truth, const TruthRival& rival) : truth_(truth), rival_(rival) {
    plan_ = truth;
    plan_.effects = rival.effects;
    plan_.faults = rival.faults;
  }

  [[nodiscard]] std::size_t shared() const { return kFree.size() + rival_.effects.size() + rival_.faults.size(); }

  Status add(const PlannedTrialTest& planned) {
    Reference reference{.planned = planned, .command_V = {}, .outputs = {}};
    TruthTest test = truth_test(truth_, planned);
    test.sensors = {{.channel = "motor_voltage"}};
    const double last = planned.profile.duration_s();
    std::vector<double> times;
    for (double t = 0.0; t <= last; t = kCommand_s * static_cast<double>(times.size())) times.push_back(t);
    auto command = run_truth(test, planned.profile, times);
    if (!command) return fail(command.error());
    reference.command_V = std::move(command->front());
    auto outputs = simulate(truth_, truth_test(truth_, planned), reference);
    if (!outputs) return fail(outputs.error());
    reference.outputs = std::move(*outputs);
    references_.push_back(std::move(reference));
    return {};
  }

  /// Residuals of test k: shared values and the test's load factor.
  [[nodiscard]] Result<Eigen::VectorXd> miss(std::size_t k, const Eigen::VectorXd& shared, double load) const {
    const TrialPlan plan = changed(shared);
    TruthTest test = truth_test(plan, references_[k].planned);
    test.parameters.load *= 1.0 + load;
    auto outputs = simulate(plan, std::move(test), references_[k]);
    if (!outputs) return fail(outputs.error());
    return Eigen::VectorXd(*outputs - references_[k].outputs);
  }

  [[nodiscard]] TrialPlan changed(const Eigen::VectorXd& shared) const {
    TrialPlan plan = plan_;
    Eigen::Index at = 0;
    for (double TruthParameters::*parameter : kFree) plan.parameters.*parameter *= std::exp(shared[at++]);
    for (HiddenEffect& effect : plan.effects) effect.size *= 1.0 + shared[at++];
    for (SensorFault& fault : plan.faults) fault.size *= 1.0 + shared[at++];
    return plan;
  }

  [[nodiscard]] std::size_t tests() const { return references_.size(); }

 private:
  /// Outputs over their noise, faults included.
  [[nodiscard]] static Result<Eigen::VectorXd> simulate(const TrialPlan& plan, TruthTest test,
                                                        const Reference& reference) {
    test.command_V = reference.command_V;
    test.command_step_s = kCommand_s;
    std::vector<double> times;
    const double last = reference.planned.profile.duration_s();
    for (double t = 0.0; t <= last; t = kSample_s * static_cast<double>(times.size())) times.push_back(t);
    const auto values = run_truth(test, reference.planned.profile, times);
    if (!values) return fail(values.error());
    std::vector<double> all;
    for (std::size_t c = 0; c < plan.channels.size(); ++c) {
      const double sigma = usual_noise(plan.channels[c]);
      if (!(sigma > 0.0)) continue;
      const auto [gain, bias] = fault_of(plan, plan.channels[c]);
      for (const double value : (*values)[c]) all.push_back((gain * value + bias) / sigma);
    }
    return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size())));
  }

  const TrialPlan& truth_;
  TruthRival rival_;
  TrialPlan plan_;
  std::vector<Reference> references_;
};

/// Search for the shared values and each test's load.
struct Search {
  const Distance& distance;
  Eigen::VectorXd shared;
  std::vector<double> loads;

  [[nodiscard]] Result<double> cost(const Eigen::VectorXd& at, const std::vector<double>& own) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < distance.tests(); ++k) {
      const auto r = distance.miss(k, at, own[k]);
      if (!r) return fail(r.error());
      sum += r->squaredNorm();
    }
    return sum;
  }

  [[nodiscard]] Result<double> run(bool own_only) {
    auto now = cost(shared, loads);
    if (!now) return now;
    for (int iteration = 0; iteration < kIterations; ++iteration) {
      const auto normal = linearise(own_only);
      if (!normal) return fail(normal.error());
      const double before = *now;
      if (const Status moved = move(*normal, *now); !moved) return fail(moved.error());
      if (before - *now < kSettled + kSettledShare * before) break;
    }
    return now;
  }

 private:
  struct Normal {
    Eigen::MatrixXd matrix;
    Eigen::VectorXd gradient;
  };

  /// Unknowns: the shared values (none where own_only), then each load.
  [[nodiscard]] Result<Normal> linearise(bool own_only) const {
    const auto shared_size = own_only ? Eigen::Index{0} : shared.size();
    const Eigen::Index size = shared_size + static_cast<Eigen::Index>(loads.size());
    Normal normal{.matrix = Eigen::MatrixXd::Zero(size, size), .gradient = Eigen::VectorXd::Zero(size)};
    for (std::size_t k = 0; k < loads.size(); ++k) {
      const auto base = distance.miss(k, shared, loads[k]);
      if (!base) return fail(base.error());
      Eigen::MatrixXd slopes(base->size(), shared_size + 1);
      for (Eigen::Index j = 0; j <= shared_size; ++j) {
        Eigen::VectorXd at = shared;
        if (j < shared_size) at[j] += kStep;
        const auto there = distance.miss(k, at, loads[k] + (j == shared_size ? kLoadStep : 0.0));
        if (!there) return fail(there.error());
        slopes.col(j) = (*there - *base) / (j == shared_size ? kLoadStep : kStep);
      }
      std::vector<Eigen::Index> places;
      for (Eigen::Index j = 0; j < shared_size; ++j) places.push_back(j);
      places.push_back(shared_size + static_cast<Eigen::Index>(k));
      normal.matrix(places, places) += slopes.transpose() * slopes;
      normal.gradient(places) -= slopes.transpose() * *base;
    }
    return normal;
  }

  /// Takes the step, with more damping while it does not help.
  Status move(const Normal& normal, double& now) {
    const Eigen::Index own = normal.gradient.size() - static_cast<Eigen::Index>(loads.size());
    double damping = kDamping;
    for (int k = 0; k < kTrials; ++k, damping *= kMoreDamping) {
      Eigen::MatrixXd damped = normal.matrix;
      damped.diagonal() += damping * normal.matrix.diagonal().cwiseMax(1e-6);
      Eigen::VectorXd step = damped.ldlt().solve(normal.gradient);
      const double largest = step.cwiseAbs().maxCoeff();
      if (largest > kMostChange) step *= kMostChange / largest;
      const Eigen::VectorXd at = own > 0 ? Eigen::VectorXd(shared + step.head(own)) : shared;
      std::vector<double> theirs = loads;
      for (std::size_t t = 0; t < theirs.size(); ++t) theirs[t] += step[own + static_cast<Eigen::Index>(t)];
      const auto there = cost(at, theirs);
      if (!there) return fail(there.error());
      if (*there >= now) continue;
      now = *there;
      shared = at;
      loads = std::move(theirs);
      return {};
    }
    return {};
  }
};

}  // namespace

Result<RivalFit> closest_rival(const TrialPlan& truth, std::span<const PlannedTrialTest> tests, const TruthRival& rival,
                               std::span<const PlannedTrialTest> other_tests) {
  Distance fitted(truth, rival);
  for (const PlannedTrialTest& test : tests)
    if (const Status added = fitted.add(test); !added) return fail(added.error());
  Search search{.distance = fitted,
                .shared = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(fitted.shared())),
                .loads = std::vector<double>(tests.size(), 0.0)};
  const auto found = search.run(false);
  if (!found) return fail(found.error());
  const TrialPlan best = fitted.changed(search.shared);
  RivalFit fit{.distance = *found,
               .parameters = best.parameters,
               .rival = {.effects = best.effects, .faults = best.faults},
               .elsewhere = 0.0};
  if (other_tests.empty()) return fit;
  Distance elsewhere(truth, rival);
  for (const PlannedTrialTest& test : other_tests)
    if (const Status added = elsewhere.add(test); !added) return fail(added.error());
  Search own{.distance = elsewhere, .shared = search.shared, .loads = std::vector<double>(other_tests.size(), 0.0)};
  const auto there = own.run(true);
  if (!there) return fail(there.error());
  fit.elsewhere = *there;
  return fit;
}

}  // namespace sealwatch::bench
