#include "sealwatch/estimation/admissibility.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "sealwatch/model/plant_description.hpp"
#include "services/common/text/numbers.hpp"
#include "services/common/text/readable.hpp"

namespace sealwatch {
namespace {

// NRMSE that a perfect model would reach: with r = noise/spread, fit = 100 (1 - x r) where the fit's own is 100 (1 -
// r).
double attainable_nrmse_percent(const ChannelFit& channel) {
  if (!(channel.noise_normalised_rms > 0.0)) return 100.0;
  return 100.0 - (100.0 - channel.nrmse_percent) / channel.noise_normalised_rms;
}

}  // namespace

std::vector<std::string> reasons_of_channel(const ChannelFit& channel, const AdmissibilityOptions& options) {
  std::vector<std::string> reasons;
  if (!(channel.noise_normalised_rms <= options.largest_noise_normalised_rms))
    reasons.push_back("misfit of " + channel.channel + " is " + text::in_sentence(channel.noise_normalised_rms) +
                      " times its noise (at most " + text::significant(options.largest_noise_normalised_rms) + ")");
  if (channel.nrmse_percent < options.smallest_nrmse_percent &&
      attainable_nrmse_percent(channel) >= options.attainable_nrmse_percent)
    reasons.push_back("only " + text::in_sentence(channel.nrmse_percent) + " % of the course of " + channel.channel +
                      " is reproduced (at least " + text::significant(options.smallest_nrmse_percent) + " %)");
  return reasons;
}

namespace {

void judge_resistance(const EstimatedParameter& parameter, const AdmissibilityOptions& options,
                      std::vector<std::string>& reasons) {
  const double relative = parameter.std_error / parameter.value;
  if (!std::isfinite(relative))
    reasons.push_back(parameter.name + " cannot be identified from this recording");
  else if (relative > options.largest_relative_std_error)
    reasons.push_back("standard error of " + parameter.name + " is " + text::significant(100.0 * relative) +
                      " % of its value (at most " + text::significant(100.0 * options.largest_relative_std_error) +
                      " %)");
}

// A sample that is far beyond what the actuator can do, 1e300 Pa, makes infinities of the sums.
bool has_numbers(const FitReport& report) {
  return std::ranges::none_of(report.channels,
                              [](const ChannelFit& c) { return std::isnan(c.noise_normalised_rms); }) &&
         std::ranges::none_of(report.parameters, [](const EstimatedParameter& p) { return std::isnan(p.value); });
}

// Of plants and models that have a seal its leakage resistance is what the fit is for.
const std::optional<ConditionSetting>& seal_of(const std::string& model) { return plant_or_default(model).condition; }

}  // namespace

Status AdmissibilityOptions::validate() const {
  const auto check = [](bool good, const char* place, double value, const char* rule) -> Status {
    if (good) return {};
    return fail(Error{.file = {}, .place = place, .value = text::significant(value), .rule = rule, .advice = {}});
  };
  return check(largest_noise_normalised_rms > 1.0, "largest_noise_normalised_rms", largest_noise_normalised_rms,
               "must be above 1, the noise floor")
      .and_then([&] {
        return check(smallest_nrmse_percent < attainable_nrmse_percent && attainable_nrmse_percent <= 100.0,
                     "smallest_nrmse_percent", smallest_nrmse_percent,
                     "must be below attainable_nrmse_percent, at most 100");
      })
      .and_then([&] {
        return check(largest_relative_std_error > 0.0, "largest_relative_std_error", largest_relative_std_error,
                     "must be positive");
      });
}

void judge_admissibility(FitReport& report, const AdmissibilityOptions& options) {
  if (!has_numbers(report)) {
    report.reasons.emplace_back("no fit: a sample is far beyond what the actuator can do, and no number comes of it");
    report.admissible = false;
    return;
  }
  if (!report.converged) report.reasons.push_back("the fit did not converge: " + report.termination);
  if (report.channels.empty())
    report.reasons.emplace_back(
        "no channel shows its noise, so nothing was judged: give noise_std in the sidecar or under sensors");
  for (const ChannelFit& channel : report.channels)
    std::ranges::move(reasons_of_channel(channel, options), std::back_inserter(report.reasons));
  const std::optional<ConditionSetting>& seal = seal_of(report.model);
  bool has_resistance = false;
  for (const EstimatedParameter& parameter : report.parameters) {
    if (parameter.at_bound)
      report.reasons.push_back(parameter.name + " ended at its bound " +
                               text::with_unit(parameter.value, parameter.unit));
    if (!seal || parameter.name != seal->parameter || !parameter.free) continue;
    has_resistance = true;
    if (!parameter.at_bound) judge_resistance(parameter, options, report.reasons);
  }
  if (!has_resistance && report.reasons.empty() && seal)
    report.reasons.push_back(seal->parameter + " was not estimated");
  report.admissible = report.reasons.empty();
}

}  // namespace sealwatch
