// The estimates of a fit, in the numbers and units of pages.
#include "services/cli/fit_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace sealwatch::cli {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

EstimatedParameter estimate(const char* name, const char* unit, double value, double error) {
  EstimatedParameter out;
  out.name = name, out.unit = unit, out.value = value, out.std_error = error;
  return out;
}

TEST(FitTable, EstimatesAreWrittenAsPagesWriteThem) {
  const EstimatedParameter leakage = estimate("R_CL", "Pa s/m3", 1.7991e13, 6.5e9);
  const EstimatedParameter friction = estimate("F_v", "N s/m", 2000.0, 7.4);
  const EstimatedParameter share = estimate("share", "1", 0.5, 0.01), count = estimate("count", "1", 1.8e6, 400.0);
  EstimatedParameter stuck = estimate("k_s", "N/m", 1000.0, std::numeric_limits<double>::infinity());
  stuck.at_bound = true;
  EXPECT_EQ(estimates_table({{leakage}, {friction}, {share}, {count}, {stuck, "a.csv"}}),
            "  parameter           estimate ± standard error\n"
            "  R_CL                (17.9910 ± 0.0065)·10¹² Pa·s/m³\n"
            "  F_v                 2000.0 ± 7.4 N·s/m\n"
            "  share               0.500 ± 0.010\n"
            "  count               (1.80000 ± 0.00040)·10⁶\n"
            "  k_s                 1000 N/m, not identifiable                  a.csv  at its bound\n");
}

TEST(FitTable, ProbabilitiesHaveNoExponents) {
  ChannelFit channel;
  channel.channel = "position", channel.noise_normalised_rms = 1.25, channel.nrmse_percent = 96.5;
  channel.whiteness_p = 1e-30, channel.independence_p = 0.25;
  EXPECT_THAT(channels_table({channel}), AllOf(HasSubstr("  position "), HasSubstr("1.250"), HasSubstr("96.50"),
                                               HasSubstr("< 10⁻⁹"), HasSubstr("0.25"), Not(HasSubstr("e-"))));
}

}  // namespace
}  // namespace sealwatch::cli
