#include "services/common/mismatch/replacement.hpp"

#include <algorithm>
#include <utility>

#include "services/common/mismatch/criterion.hpp"
#include "services/common/mismatch/linear_algebra.hpp"
#include "services/common/mismatch/normal_equations.hpp"
#include "services/common/mismatch/ranking.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr double kOff = 10.0;  // times the rise is less than by the linear model, at most

Eigen::MatrixXd normal_matrix(const FittedModel& model) {
  Eigen::MatrixXd normal = normal_equations(model).gram;
  for (std::size_t k = 0; k < model.problem.shared.size(); ++k)
    if (const Unknown& unknown = model.problem.shared[k]; unknown.is_known())
      normal(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(k)) +=
          1.0 / (unknown.prior_std * unknown.prior_std);
  return normal;
}

std::vector<Eigen::Index> all_but(const std::vector<Eigen::Index>& of, Eigen::Index all) {
  std::vector<Eigen::Index> others;
  for (Eigen::Index k = 0; k < all; ++k)
    if (std::ranges::find(of, k) == of.end()) others.push_back(k);
  return others;
}

// `to`: the value of the unknown; none: it stays as it is.
void add(const FittedModel& whole, const std::string& name, std::optional<double> to, Replacement::Going& going) {
  const auto unknown = std::ranges::find(whole.problem.shared, name, &Unknown::name);
  if (unknown == whole.problem.shared.end()) return;
  const auto k = unknown - whole.problem.shared.begin();
  going.parameters.push_back(k);
  going.change.push_back(to ? unknown->to_unknown(*to) - whole.optimum.point.shared[static_cast<std::size_t>(k)] : 0.0);
}

Replacement::Going laws_that_go(const Trial& whole, const std::vector<std::size_t>& out) {
  Replacement::Going going;
  for (const std::size_t slot : out)
    for (const LawParameter& parameter : whole.effects[slot].law->parameters)
      add(*whole.model,
          physics_parameter_name(whole.effects[slot].element, whole.effects[slot].law->id, parameter.name),
          parameter.strength ? std::optional(0.0) : std::nullopt, going);
  return going;
}

Replacement::Going value_that_goes(const FittedModel& whole, const KnownValue& value) {
  Replacement::Going going;
  add(whole, value.name, value.value, going);
  return going;
}

}  // namespace

Replacement::Replacement(const FittedModel& whole, const Going& going)
    : shared_(std::ssize(whole.problem.shared)),
      parameters_(going.parameters),
      change_(Eigen::Map<const Eigen::VectorXd>(going.change.data(), std::ssize(going.change))),
      near_(2.0 * kWorthAnother * dispersion(whole)) {
  const Eigen::MatrixXd normal = normal_matrix(whole);
  others_ = all_but(parameters_, normal.rows());
  gram_ = normal(parameters_, parameters_);
  const Eigen::MatrixXd across = normal(others_, parameters_);
  if (!others_.empty()) follow_ = NormalMatrix(submatrix(normal, others_)).solve(across);
  if (!others_.empty()) gram_ -= across.transpose() * follow_;
}

Replacement::Replacement(const Trial& whole, const std::vector<std::size_t>& out)
    : Replacement(*whole.model, laws_that_go(whole, out)) {}

Replacement::Replacement(const FittedModel& whole, const KnownValue& goes)
    : Replacement(whole, value_that_goes(whole, goes)) {}

std::optional<StandIn> Replacement::stand_in(const Screening& of_whole, const Effect& comes) const {
  if (parameters_.empty() || of_whole.shared_like_law.rows() != shared_) return std::nullopt;
  std::optional<StandIn> best;
  for (const Variant& variant : of_whole.variants) {
    const Candidate& candidate = of_whole.candidates[variant.candidate];
    if (candidate.law != comes.law || candidate.element != comes.element) continue;
    const Eigen::MatrixXd like_law = of_whole.shared_like_law(parameters_, variant.columns);
    const Eigen::VectorXd pull = -(like_law.transpose() * (gram_ * change_));
    const Eigen::MatrixXd normal = submatrix(of_whole.gram, variant.columns) + like_law.transpose() * gram_ * like_law;
    const Eigen::VectorXd strength = NormalMatrix(normal).solve(pull).col(0);
    const double rise = change_.dot(gram_ * change_) - pull.dot(strength);
    if (best && best->rise <= rise) continue;
    std::vector<double> strengths;
    for (Eigen::Index k = 0; k < strength.size(); ++k)
      strengths.push_back(strength(k) *
                          of_whole.unit[static_cast<std::size_t>(variant.columns[static_cast<std::size_t>(k)])]);
    best = StandIn{rise, start_with(of_whole, variant, std::move(strengths))};
    best->start.beside = change_beside(of_whole, variant.columns, strength);
  }
  return best;
}

PemPoint Replacement::change_beside(const Screening& of_whole, const std::vector<Eigen::Index>& columns,
                                    const Eigen::VectorXd& strength) const {
  Eigen::VectorXd change = Eigen::VectorXd::Zero(std::ssize(parameters_) + std::ssize(others_));
  change.head(shared_) = of_whole.shared_like_law(Eigen::all, columns) * strength;
  Eigen::Index at = shared_;
  for (const Eigen::MatrixXd& own : of_whole.own_like_law) {
    change.segment(at, own.rows()) = own(Eigen::all, columns) * strength;
    at += own.rows();
  }
  change *= -1.0;
  const Eigen::VectorXd left = change_ - change(parameters_);
  if (!others_.empty()) change(others_) -= follow_ * left;
  change(parameters_).setZero();
  PemPoint point{.shared = {change.data(), change.data() + shared_}, .own = {}};
  at = shared_;
  for (const Eigen::MatrixXd& own : of_whole.own_like_law) {
    point.own.emplace_back(change.data() + at, change.data() + at + own.rows());
    at += own.rows();
  }
  return point;
}

bool Replacement::may_do_as_well(const StandIn& stand_in) const { return stand_in.rise < kOff * near_; }
bool Replacement::may_go() const { return change_.dot(gram_ * change_) < kOff * near_; }

std::vector<std::vector<LawStart>> stand_ins(const Trial& whole, const std::vector<std::size_t>& out,
                                             std::vector<Candidate> laws, const Data& data,
                                             const ExplainOptions& options) {
  std::vector<std::vector<LawStart>> starts;
  if (laws.empty()) return starts;
  const auto beside =
      screen_laws(*whole.model, std::move(laws), data, {.draws = 1, .seed = options.seed, .threads = options.threads});
  if (!beside) return starts;
  const Replacement replacement(whole, out);
  for (const Candidate& candidate : beside->candidates) {
    // Another form of a law that goes lies between the points of its grid.
    const bool is_form = std::ranges::any_of(out, [&](std::size_t slot) {
      const Effect& goes = whole.effects[slot];
      return goes.law->id == candidate.law->id && goes.element == candidate.element;
    });
    if (const auto stand_in = replacement.stand_in(*beside, {candidate.law, candidate.element});
        stand_in && (is_form || replacement.may_do_as_well(*stand_in)))
      starts.push_back({stand_in->start});
  }
  return starts;
}

std::vector<Candidate> candidates_of(const std::vector<LawStart>& starts, const FittedModel& model) {
  std::vector<Candidate> laws = find_candidates(*model.problem.recordings.front().simulation, {}, Laws::all);
  std::erase_if(laws, [&](const Candidate& law) {
    return std::ranges::none_of(starts, [&](const LawStart& start) {
      return start.effect.law == law.law && start.effect.element == law.element;
    });
  });
  return laws;
}

}  // namespace sealwatch::mismatch
