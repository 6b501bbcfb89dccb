#include "services/common/mismatch/criterion.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <unsupported/Eigen/FFT>

#include "sealwatch/model/physics.hpp"

namespace sealwatch::mismatch {
namespace {

// Of a parameter (Akaike), where so little is explained that ln(N / phi) is less.
constexpr double kLeastPenalty = 2.0;

// -2 ln(prior odds): an error of the recorded input or of the clock is taken for a third as likely as physics of the plant.
// It decides where both do the same (a constant force, or an offset of the voltage that makes the force).
constexpr double kOfRecording = 2.2;

// Sums of products of a channel's residuals so many samples apart, of all channels and recordings, by their spectra
// (Wiener and Khinchin): a slow course has thousands of lags that count.
Eigen::VectorXd lagged_products(const std::vector<Linearisation>& parts, Eigen::Index longest) {
  Eigen::Index size = 1;
  while (size < 2 * longest) size *= 2;
  Eigen::FFT<double> transform;
  Eigen::VectorXcd spectrum, power = Eigen::VectorXcd::Zero(size);
  for (const Linearisation& part : parts) {
    const Eigen::Index channels = part.simulated.cols(), rows = part.simulated.rows();
    for (Eigen::Index c = 0; c < channels; ++c) {
      Eigen::VectorXd padded = Eigen::VectorXd::Zero(size);
      padded.head(rows) = part.residual(Eigen::seqN(c, rows, channels));
      transform.fwd(spectrum, padded);
      power += spectrum.cwiseAbs2();
    }
  }
  Eigen::VectorXd products;
  transform.inv(products, power);
  return products;
}

// tau: how many neighbouring whitened residuals say the same.
double correlation_time(const FittedModel& model) {
  Eigen::Index longest = 0;
  for (const Linearisation& part : model.optimum.at_optimum) longest = std::max(longest, part.simulated.rows());
  const Eigen::VectorXd products = lagged_products(model.optimum.at_optimum, longest);
  double tau = 1.0;
  for (Eigen::Index lag = 1; lag < longest / 2 && products(lag) > 0.0; ++lag) tau += 2.0 * products(lag) / products(0);
  return tau;
}

}  // namespace

NoiseColour residual_colour(const FittedModel& model) {
  constexpr double kMost = 0.98;
  const Eigen::Index channels = model.optimum.at_optimum.front().simulated.cols();
  Eigen::ArrayXd together = Eigen::ArrayXd::Zero(channels), alone = Eigen::ArrayXd::Constant(channels, 1e-300);
  for (std::size_t k = 0; k < model.optimum.at_optimum.size(); ++k) {
    const RowMatrix left = model.problem.recordings[k].simulation->recorded() - model.optimum.at_optimum[k].simulated;
    const Eigen::Index rows = left.rows();
    together += (left.topRows(rows - 1).array() * left.bottomRows(rows - 1).array()).colwise().sum().transpose();
    alone += left.array().square().colwise().sum().transpose();
  }
  NoiseColour colour;
  for (Eigen::Index c = 0; c < channels; ++c) {
    const double rho = std::clamp(together(c) / alone(c), 0.0, kMost);
    colour.push_back({.coefficients = {rho}, .innovation_std = std::sqrt(1.0 - rho * rho)});
  }
  return colour;
}

double excess(const FittedModel& model) { return std::max(1.0, model.misfit / model.residuals); }

double dispersion(const FittedModel& best) {
  const double miss = excess(best);
  return miss > kGross ? miss * correlation_time(best) : miss;
}

double largest_excess(const FittedModel& model) {
  struct Sum {
    double squares = 0.0, count = 0.0;
  };
  std::map<std::string, Sum> sums;  // of channels: recordings need not have the same
  for (std::size_t k = 0; k < model.optimum.at_optimum.size(); ++k) {
    const PemRecording& recording = model.problem.recordings[k];
    const Linearisation& at = model.optimum.at_optimum[k];
    const Eigen::Index channels = at.simulated.cols(), rows = at.simulated.rows();
    for (Eigen::Index c = 0; c < channels; ++c) {
      if (!std::isfinite(recording.noise_std(c))) continue;
      Sum& sum = sums[recording.simulation->channels()[static_cast<std::size_t>(c)]];
      sum.squares += at.residual(Eigen::seqN(c, rows, channels)).squaredNorm();
      sum.count += static_cast<double>(rows);
    }
  }
  double largest = excess(model);
  for (const auto& [channel, sum] : sums) largest = std::max(largest, sum.squares / sum.count);
  return largest;
}

bool differs(double p_value, const FittedModel& model, double false_alarm_rate) {
  return p_value <= false_alarm_rate || largest_excess(model) > kGross;
}

namespace {

// Initial values of laws' hidden states, which a model without these laws has not: told by the first seconds of a
// recording, whatever its length. Those of the plant's states every model has.
double initial_values_of_laws(const PemProblem& problem) {
  constexpr std::string_view kInitial = "initial:";
  std::ptrdiff_t count = 0;
  for (const PemRecording& recording : problem.recordings)
    count += std::ranges::count_if(recording.own, [&](const Unknown& unknown) {
      const std::string_view name = unknown.name;
      return name.starts_with(kInitial) &&
             recording.simulation->plant().find_state(name.substr(kInitial.size())) == nullptr;
    });
  return static_cast<double>(count);
}

}  // namespace

double criterion(const FittedModel& model, double dispersion) {
  const auto laws = model.problem.recordings.front().simulation->physics_parameters();
  const auto of_recording = std::ranges::count_if(
      laws, [](const PhysicsParameter& parameter) { return is_of_recording(parameter.law->kind); });
  return model.misfit / dispersion + kOfRecording * static_cast<double>(of_recording) +
         kLeastPenalty * initial_values_of_laws(model.problem) +
         static_cast<double>(model.free_shared) * std::max(kLeastPenalty, std::log(model.residuals / dispersion));
}

double criterion_behind(const FittedModel& model, const FittedModel& other) {
  const double phi = std::min(dispersion(model), dispersion(other));
  return criterion(model, phi) - criterion(other, phi);
}

}  // namespace sealwatch::mismatch
