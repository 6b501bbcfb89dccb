// What other laws leave where they take the place of laws that a model has, on the linear model there.
//
//   L      parameters of the laws that go; d their change: strengths to nothing, shapes as they are (or a value of the
//          asset file that was free, and its way back)
//   H      J'J and what is known beforehand, of all unknowns; o: all but L
//   G_L    H_LL - H_Lo H_oo^-1 H_oL
//   S c    the law that comes, of strengths c;  S = J M + S~  (screening.hpp), M_L the rows of L
//   change of the others  -M_o c - H_oo^-1 H_oL (d + M_L c)
//   rise of the misfit    min over c of  (d + M_L c)' G_L (d + M_L c) + c' S~'S~ c
//
// Large effects are not linear: the rise tells how far off a law is, and not its refit's misfit.
#pragma once

#include <optional>
#include <vector>

#include "sealwatch/mismatch/explain.hpp"
#include "services/common/mismatch/refits.hpp"
#include "services/common/mismatch/screening.hpp"

namespace sealwatch::mismatch {

/// A law in the place of others: how much more is missed on the linear model, and where its refit sets out.
struct StandIn {
  double rise = 0.0;
  LawStart start;
};

class Replacement {
 public:
  /// Shared unknowns of a model, and by how much each changes.
  struct Going {
    std::vector<Eigen::Index> parameters;
    std::vector<double> change;
  };

  /// `out`: slots of the laws of `whole` that go, ascending.
  Replacement(const Trial& whole, const std::vector<std::size_t>& out);
  /// A free value of the model goes back to what it is known to be.
  Replacement(const FittedModel& whole, const KnownValue& goes);

  /// The law that comes, at the point of its grid that does best. `of_whole`: screening of the whole model; nothing where
  /// that did not ask this law.
  [[nodiscard]] std::optional<StandIn> stand_in(const Screening& of_whole, const Effect& comes) const;

  /// Whether its refit may end near the whole model, even if the rise is a tenth of what the linear model says.
  [[nodiscard]] bool may_do_as_well(const StandIn& stand_in) const;
  /// The same of nothing in their place.
  [[nodiscard]] bool may_go() const;

 private:
  Replacement(const FittedModel& whole, const Going& going);
  /// Of all unknowns of the whole model, beside the law of that strength: -M_o c - H_oo^-1 H_oL (d + M_L c).
  [[nodiscard]] PemPoint change_beside(const Screening& of_whole, const std::vector<Eigen::Index>& columns,
                                       const Eigen::VectorXd& strength) const;

  Eigen::Index shared_ = 0;               ///< shared unknowns of the whole model
  std::vector<Eigen::Index> parameters_;  ///< L, among them
  Eigen::VectorXd change_;                ///< d
  std::vector<Eigen::Index> others_;      ///< o
  Eigen::MatrixXd gram_;                  ///< G_L
  Eigen::MatrixXd follow_;                ///< H_oo^-1 H_oL
  double near_ = 0.0;                     ///< rise of a model that is no alternative any more
};

/// Those of the laws (candidates at an element each, whatever is there already) that may do as well as the effects `out` of
/// the trial in their place, as starts of refits from it (RefitOptions::sized). None where they cannot be asked.
[[nodiscard]] std::vector<std::vector<LawStart>> stand_ins(const Trial& whole, const std::vector<std::size_t>& out,
                                                           std::vector<Candidate> laws, const Data& data,
                                                           const ExplainOptions& options);

/// The candidates of these starts' laws, at their elements.
[[nodiscard]] std::vector<Candidate> candidates_of(const std::vector<LawStart>& starts, const FittedModel& model);

}  // namespace sealwatch::mismatch
