#include "services/common/mismatch/criterion.hpp"

#include <algorithm>
#include <cmath>

namespace sealwatch::mismatch {
namespace {

// Of a parameter (Akaike), where so little is explained that ln(N / phi) is less.
constexpr double kLeastPenalty = 2.0;

// tau: how many neighbouring whitened residuals say the same.
double correlation_time(const FittedModel& model) {
  std::vector<const Linearisation*> parts;
  Eigen::Index longest = 0;
  for (const Linearisation& part : model.optimum.at_optimum) {
    parts.push_back(&part);
    longest = std::max(longest, part.simulated.rows());
  }
  double variance = 0.0, tau = 1.0;
  for (Eigen::Index lag = 0; lag < longest / 2; ++lag) {
    double products = 0.0;
    for (const Linearisation* part : parts) {
      const Eigen::Index pairs = part->residual.size() - lag * part->simulated.cols();
      if (pairs > 0) products += part->residual.head(pairs).dot(part->residual.tail(pairs));
    }
    if (lag == 0) variance = products;
    if (products <= 0.0) break;
    if (lag > 0) tau += 2.0 * products / variance;
  }
  return tau;
}

}  // namespace

double excess(const FittedModel& model) { return std::max(1.0, model.misfit / model.residuals); }

double dispersion(const FittedModel& best) {
  const double miss = excess(best);
  return miss > kGross ? miss * correlation_time(best) : miss;
}

bool differs(double p_value, const FittedModel& model, double false_alarm_rate) {
  return p_value <= false_alarm_rate || excess(model) > kGross;
}

double criterion(const FittedModel& model, double dispersion) {
  return model.misfit / dispersion +
         static_cast<double>(model.free_shared) * std::max(kLeastPenalty, std::log(model.residuals / dispersion));
}

}  // namespace sealwatch::mismatch
