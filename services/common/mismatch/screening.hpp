// One sensitivity pass over a fitted model: what every absent law would change, how much of that the free parameters
// swallow, and how strongly the residual asks for it.
//
//   s_j    whitened change of all outputs by law j at strength 0 (for its usual size)
//   s~_j   = P s_j, with the columns of all free parameters, loads and initial states projected off
//   g = S~' r,  G = S~' S~,  U_b = S~_b' r_b   per block b of time, V = sum_b (U_b - U_mean)(U_b - U_mean)'
//   score of a law with strengths I   T = min(g_I' V_I^-1 g_I, g_I' G_I^-1 g_I), chi-squared of |I| under noise alone;
//                                     V here from U_b - G_b k: without the law's own best share k = G_I^-1 g_I
//   against an interval: with |k| <= k_0 = resolution x significant size as the null, one strength counts with
//                        (|g| - k_0 G)^2 / V where that is positive, several with 0 where all stay within
//   gain of a law, if added           d = max 2 g'k - k'G k              (drop of the whitened misfit, linearised)
//                                     over its strengths and, within their ranges, unknowns that are held at an end
//   absorbed share                    a = 1 - |s~|^2/|s|^2
//   minimum detectable strength       sqrt(lambda / |s~|^2), lambda = 27 (80 % power at 1 % over the whole catalogue)
//
// Where measured inputs drive the simulation, their noise moves it, and residual and s_j with it: U_b then has a mean
// of its own, E(S~_b' r_b). It is drawn, with as much noise again on the inputs (windows.hpp), and taken off U_b
// (simulation and extrapolation: J. R. Cook, L. A. Stefanski, J. American Statistical Association 89 (1994) 1314).
//
// p-value: the largest of all scores against its distribution when g is noise alone, N(0, G), which keeps the laws'
// correlation; expressed as an effective number of independent laws.
// Score test: C. R. Rao, Proc. Cambridge Philosophical Society 44 (1948) 50. Method in words: docs/mismatch.md.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "services/common/mismatch/candidates.hpp"
#include "services/common/mismatch/fitted_model.hpp"

namespace sealwatch::mismatch {

/// One candidate at one point of its shape grid.
struct Variant {
  std::size_t candidate = 0;
  std::size_t point = 0;              ///< of the candidate's grid
  std::vector<Eigen::Index> columns;  ///< of the screening's matrices, one for each strength
  double score = 0.0;                 ///< T
  double p_value = 1.0;               ///< of T alone
  double gain = 0.0;                  ///< d with strengths kept within their bounds, held unknowns coming back
  std::vector<double> strength;       ///< linear estimate of each strength, in the law's unit
  std::vector<double> back = {};      ///< by how much each held unknown comes back beside it
  bool physical = true;               ///< the unconstrained estimate is within its bounds
  double absorbed = 0.0;
  double minimum_detectable = 0.0;  ///< of the first strength, in the law's unit
  double leakage_shift = 0.0;       ///< relative change of R_CL that would swallow a law of that size
};

/// Shared unknowns that the fit keeps at an end of their range. Like a law, with columns of their own: beside a law that
/// does what they were driven there for, they come back.
struct HeldUnknowns {
  std::vector<Eigen::Index> unknown;  ///< of the shared ones
  Eigen::VectorXd least, most;        ///< change that leaves each within its range
  Eigen::MatrixXd gram, across;       ///< of their projected columns, and of these with the laws'
  Eigen::VectorXd gradient;           ///< what is known beforehand included, as in the gram
  Eigen::MatrixXd shared_like = {};   ///< as shared_like_law
  std::vector<Eigen::MatrixXd> own_like = {};
};

struct Screening {
  std::vector<Candidate> candidates = {};
  std::vector<Candidate> not_asked = {};  ///< laws that have no finite value where the plant goes
  std::vector<Variant> variants = {};
  Eigen::MatrixXd gram = {};          ///< G, in usual sizes
  Eigen::VectorXd gradient = {};      ///< g
  Eigen::MatrixXd block_scores = {};  ///< blocks x columns: U_b
  std::vector<double> unit = {};      ///< usual size of each column, in the law's unit
  /// Changes of the fitted model's unknowns that together do what they can of a law at its usual size: shared x
  /// columns, and own x columns per recording.
  Eigen::MatrixXd shared_like_law = {};
  std::vector<Eigen::MatrixXd> own_like_law = {};
  HeldUnknowns held = {};
  double misfit = 0.0;            ///< of the model, once its own search has ended as its linear model promises
  double p_value = 1.0;           ///< that there is nothing but noise
  double effective_number = 1.0;  ///< of independent laws in the catalogue, points passed over included
  std::size_t best = 0;           ///< variant with the largest score
};

struct ScreeningOptions {
  double block_s = 0.5;
  int draws = 999;
  std::uint64_t seed = 1;
  int threads = 2;
  Laws laws = Laws::listed;
};

/// An Error when the model cannot be simulated at its estimates.
[[nodiscard]] Result<Screening> screen(const FittedModel& model, const Data& data, const ScreeningOptions& options);

/// The same of some laws alone, at the points of their grids.
[[nodiscard]] Result<Screening> screen_laws(const FittedModel& model, std::vector<Candidate> laws, const Data& data,
                                            const ScreeningOptions& options);

/// Linearised gain of two variants together; strengths within bounds.
[[nodiscard]] double pair_gain(const Screening& screening, const Variant& a, const Variant& b);

/// Cosine between two variants' projected columns: 1 means that this data cannot tell them apart.
[[nodiscard]] double similarity(const Screening& screening, const Variant& a, const Variant& b);

}  // namespace sealwatch::mismatch
