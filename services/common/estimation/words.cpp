#include "services/common/estimation/words.hpp"

#include <array>
#include <cstdio>
#include <utility>

namespace sealwatch {

std::string in_words(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g", value);
  return text.data();
}

FitReport cannot_fit(std::string model, std::string reason) {
  FitReport report;
  report.model = std::move(model);
  report.termination = "not started";
  report.reasons.push_back(std::move(reason));
  return report;
}

}  // namespace sealwatch
