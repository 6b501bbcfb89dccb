#include "services/common/estimation/cannot_fit.hpp"

#include <utility>

namespace sealwatch {

FitReport cannot_fit(std::string model, std::string reason) {
  FitReport report;
  report.model = std::move(model);
  report.termination = "not started";
  report.reasons.push_back(std::move(reason));
  return report;
}

}  // namespace sealwatch
