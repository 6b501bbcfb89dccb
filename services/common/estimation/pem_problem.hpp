// The least-squares problem behind fit_actuator: unknowns, whitened residuals and their Jacobian, one block a
// recording.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "sealwatch/model/simulation.hpp"

namespace sealwatch {

/// A known value lies within so many standard deviations: one in two thousand does not. Further off it is not what it is
/// known to be, and that wants a reason.
inline constexpr double kWithinTolerance = 3.5;

/// What is known of a value before anything is recorded: N(value, standard_deviation^2), in its own unit.
struct KnownValue {
  std::string name;
  double value = 0.0, standard_deviation = 0.0;
};

/// An unknown of the search: value = scale exp(unknown) for positive parameters, scale * unknown otherwise.
struct Unknown {
  std::string name, unit;
  FreeQuantity quantity;
  bool logarithmic = false;
  double scale = 1.0;
  double start = 0.0;                        ///< of the quantity
  double min = 0.0, max = 0.0;               ///< of the quantity
  int group = -1;                            ///< recordings that it belongs to; -1: all
  double prior_mean = 0.0, prior_std = 0.0;  ///< of the unknown, where the value is known beforehand; 0: it is not
  [[nodiscard]] bool is_known() const { return prior_std > 0.0; }
  /// What it adds to the residuals: whitened like them, recorded - simulated.
  [[nodiscard]] double prior_residual(double unknown) const { return (prior_mean - unknown) / prior_std; }
  [[nodiscard]] bool belongs_to(int recordings_group) const { return group < 0 || group == recordings_group; }
  [[nodiscard]] double to_unknown(double value) const;
  [[nodiscard]] double to_value(double unknown) const;
  [[nodiscard]] double slope(double unknown) const;  ///< d value / d unknown
};

/// Autoregressive noise of one channel, in units of its standard deviation: e_t = sum_j a_j e_(t-j) + innovation.
struct ChannelColour {
  std::vector<double> coefficients;  ///< a_1, a_2, ...; empty: white
  double innovation_std = 1.0;
};
/// Per channel; empty: all white.
using NoiseColour = std::vector<ChannelColour>;

/// One recording: its simulation, the noise of its channels and its own unknowns.
struct PemRecording {
  std::unique_ptr<PlantSimulation> simulation;
  Eigen::VectorXd noise_std;  ///< per channel; infinite: the channel is left out
  std::vector<double> time_s;
  int group = 0;                ///< windows of one recording share its load
  NoiseColour colour = {};      ///< by which residuals are whitened beside their standard deviation
  Eigen::VectorXd weight = {};  ///< of each residual, beside its noise; empty: all 1
  std::vector<Unknown> own;     ///< load, slow initial states
};

/// These samples do not count: their weights are 0 in all channels.
void leave_out(const std::vector<Eigen::Index>& samples, PemRecording& recording);
/// Of a channel's residuals, one for each sample.
[[nodiscard]] std::vector<double> weights_of(const PemRecording& recording, Eigen::Index channel);

struct PemProblem {
  std::vector<Unknown> shared;
  std::vector<PemRecording> recordings;
  SimulationOptions simulation_options;
};

/// Whitened residuals of one recording and what they came from. Residual row = sample * channels + channel.
struct Linearisation {
  RowMatrix simulated;       ///< samples x channels
  Eigen::VectorXd residual;  ///< (recorded - simulated) / noise
  RowMatrix jacobian;        ///< d residual / d unknown: shared first, then own; of those that were asked for
  bool has_kept = false;     ///< those by what is known beforehand are of another point (KeptDerivatives)
};

/// `groups`: for windows cut from longer recordings, which recording each comes from; its load is then one unknown for
/// all of them. Empty: each is a recording by itself. `own_parameter`: a parameter of the asset that differs from
/// recording to recording ("" for none): an unknown for each of them, whether the asset has it estimated or not.
/// `known`: of the asset's parameters that are not estimated, those that may be off within what is known of them.
[[nodiscard]] Result<PemProblem> make_pem_problem(const AssetConfig& asset, std::span<const TimeSeries> recordings,
                                                  std::span<const int> groups = {}, std::string_view own_parameter = {},
                                                  std::span<const KnownValue> known = {});

/// Name of the unknown of `parameter` in one recording, and the parameter that an unknown is of: "R_CL@2", "R_CL".
[[nodiscard]] std::string name_in_recording(std::string_view parameter, std::size_t recording);
[[nodiscard]] std::string parameter_of(const Unknown& unknown);

/// By which unknowns outputs are differentiated: all, or only those that are not known beforehand.
enum class Derivatives { by_all, by_what_is_not_known };

/// Quantities that one recording's outputs are differentiated by, with the slope of each to its unknown and its place
/// among the unknowns that were asked for (shared first, then the recording's own), and how many of these there are.
struct FreeOfRecording {
  std::vector<FreeQuantity> quantity;
  std::vector<double> slope;
  std::vector<Eigen::Index> column;
  Eigen::Index columns = 0;
};
[[nodiscard]] FreeOfRecording free_of(const PemProblem& problem, std::size_t recording,
                                      const std::vector<double>& shared, const std::vector<double>& own,
                                      Derivatives derivatives = Derivatives::by_all);

[[nodiscard]] ModelValues values_at(const PemProblem& problem, std::size_t recording, const std::vector<double>& shared,
                                    const std::vector<double>& own);

/// What turns differences of outputs and their derivatives into residuals and theirs, rows of sample * channels + channel.
struct RowsOfResiduals {
  const Eigen::VectorXd& noise_std;  ///< of each channel
  const NoiseColour& colour;         ///< of each channel; empty: white
  const Eigen::VectorXd& weight;     ///< of each row; empty: 1
  Eigen::RowVectorXd slopes;         ///< factors of the Jacobian's columns
};
/// In place: over the noise, or of coloured noise r_t - sum_j a_j r_(t-j) over the innovation's standard deviation (the
/// first samples, whose past is not known, as they are), times the weight. False where a number is not finite.
[[nodiscard]] bool whiten_and_weigh(const RowsOfResiduals& rows, Linearisation& at);

/// An Error when the simulation fails there.
[[nodiscard]] Result<Linearisation> linearise(const PemProblem& problem, std::size_t recording,
                                              const std::vector<double>& shared, const std::vector<double>& own,
                                              Derivatives derivatives = Derivatives::by_all);

/// Derivatives by the unknowns that are known beforehand, from another point. Such values hardly move, and where the
/// residuals are exact a search that uses them ends at the same point.
struct KeptDerivatives {
  RowMatrix jacobian;    ///< columns in the order of the unknowns
  Eigen::MatrixXd gram;  ///< jacobian' jacobian
  [[nodiscard]] bool any() const { return jacobian.cols() > 0; }
};
[[nodiscard]] KeptDerivatives kept_derivatives(const PemProblem& problem, const Linearisation& linearisation);

/// Of the derivatives by all unknowns those by what is not known, and the other way round, with those by what is known
/// beforehand from `kept`.
[[nodiscard]] RowMatrix not_known_jacobian(const PemProblem& problem, const RowMatrix& whole);
[[nodiscard]] RowMatrix whole_jacobian(const PemProblem& problem, const RowMatrix& not_known,
                                       const KeptDerivatives& kept);

/// J v and J'y, with `kept` where `at` has kept derivatives.
[[nodiscard]] Eigen::VectorXd jacobian_times(const PemProblem& problem, const Linearisation& at,
                                             const KeptDerivatives& kept, const Eigen::VectorXd& v);
[[nodiscard]] Eigen::VectorXd jacobian_transposed_times(const PemProblem& problem, const Linearisation& at,
                                                        const KeptDerivatives& kept, const Eigen::VectorXd& y);

/// Upper part U of [J r] with U'U = [J r]'[J r]: the same least-squares problem in as many rows as it has unknowns plus
/// one.
[[nodiscard]] Eigen::MatrixXd compress(const Linearisation& linearisation);
/// The same of a linearisation by what is not known, and of kept derivatives.
[[nodiscard]] Eigen::MatrixXd compress(const PemProblem& problem, const Linearisation& not_known,
                                       const KeptDerivatives& kept);

}  // namespace sealwatch
