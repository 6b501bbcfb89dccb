#include "services/cli/fit_table.hpp"

#include <algorithm>
#include <cmath>

#include "services/cli/terminal.hpp"
#include "services/common/text/format.hpp"
#include "services/common/text/readable.hpp"

namespace sealwatch::cli {
namespace {

constexpr int kEstimateWidth = 44;  // "(−17.9910 ± 0.0065)·10⁻¹² m³/(s·Pa)" and some blanks

std::string estimate_of(const EstimatedParameter& parameter) {
  const bool is_known = std::isfinite(parameter.std_error);
  return text::readable_with_error(parameter.value, parameter.std_error, parameter.unit) +
         (is_known ? "" : ", not identifiable");
}

}  // namespace

std::string estimates_table(const std::vector<EstimateRow>& rows) {
  std::size_t width = 18;
  for (const EstimateRow& row : rows) width = std::max(width, row.parameter.name.size());
  const int name_width = static_cast<int>(width);
  std::string out = "  " + padded("parameter", name_width) + "  estimate ± standard error\n";
  for (const auto& [parameter, recording] : rows) {
    const std::string remark = recording + (parameter.at_bound ? "  at its bound" : "");
    const std::string estimate = estimate_of(parameter);
    out += "  " + padded(parameter.name, name_width) + "  " +
           (remark.empty() ? estimate : padded(estimate, kEstimateWidth) + remark) + "\n";
  }
  return out;
}

std::string channels_table(const std::vector<ChannelFit>& channels) {
  std::string out = "  " + padded("channel", 22) + "  rms/noise    NRMSE %   whiteness p   independence p\n";
  for (const ChannelFit& channel : channels)
    out += text::format("  {} {:10.3f} {:10.2f}   {} {}\n", padded(channel.channel, 22), channel.noise_normalised_rms,
                        channel.nrmse_percent, padded(text::p_value_text(channel.whiteness_p), 13),
                        text::p_value_text(channel.independence_p));
  return out;
}

}  // namespace sealwatch::cli
