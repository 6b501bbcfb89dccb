// Units as people write them, against values from their definitions.
#include "services/common/units/unit_conversion.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <string>
#include <thread>
#include <vector>

namespace sealwatch {
namespace {

using ::testing::HasSubstr;

constexpr double kRelative = 1e-12;  // rounding of a product or two
constexpr double kInch_m = 0.0254;
constexpr double kGallon_m3 = 231 * kInch_m * kInch_m * kInch_m;
constexpr double kPsi_Pa = 0.45359237 * 9.80665 / (kInch_m * kInch_m);
constexpr double kAtmosphere_Pa = 101325.0;

struct Example {
  const char* unit;
  const char* si_unit;
  double value;
  double in_si;
};

class Known : public ::testing::TestWithParam<Example> {};

TEST_P(Known, IsConverted) {
  const Example& example = GetParam();
  const Result<UnitConversion> found = convert_unit(example.unit, example.si_unit);
  ASSERT_TRUE(found) << example.unit << ": " << found.error().describe();
  EXPECT_NEAR(found->to_si(example.value), example.in_si, kRelative * std::abs(example.in_si)) << example.unit;
}

INSTANTIATE_TEST_SUITE_P(
    Units, Known,
    ::testing::Values(
        Example{"", "Pa", 3.0, 3.0}, Example{"bar", "Pa", 2.0, 2e5}, Example{"psi", "Pa", 100.0, 100.0 * kPsi_Pa},
        Example{"PSI", "Pa", 100.0, 100.0 * kPsi_Pa}, Example{"psig", "Pa", 0.0, kAtmosphere_Pa},
        Example{"barg", "Pa", 1.0, 1e5 + kAtmosphere_Pa}, Example{"kPag", "Pa", 1.0, 1e3 + kAtmosphere_Pa},
        Example{"bara", "Pa", 1.0, 1e5}, Example{"mbar", "Pa", 1.0, 100.0},
        Example{"psi(g)", "Pa", 0.0, kAtmosphere_Pa}, Example{"bar (g)", "Pa", 1.0, 1e5 + kAtmosphere_Pa},
        Example{"bar g", "Pa", 1.0, 1e5 + kAtmosphere_Pa}, Example{"BARG", "Pa", 1.0, 1e5 + kAtmosphere_Pa},
        Example{"mbar gauge", "Pa", 0.0, kAtmosphere_Pa}, Example{"bar abs", "Pa", 1.0, 1e5},
        Example{"psi(a)", "Pa", 1.0, kPsi_Pa}, Example{"psid", "Pa", 1.0, kPsi_Pa}, Example{"PSID", "Pa", 1.0, kPsi_Pa},
        Example{"bar(d)", "Pa", 1.0, 1e5}, Example{"kPa", "Pa", 1.0, 1e3}, Example{"kg/cm2", "Pa", 1.0, 9.80665e4},
        Example{"kgf/cm2(g)", "Pa", 1.0, 9.80665e4 + kAtmosphere_Pa}, Example{"lbs", "N", 1.0, 0.45359237 * 9.80665},
        Example{"ft-lb", "N m", 1.0, 12 * kInch_m * 0.45359237 * 9.80665}, Example{"kg", "kg", 2.0, 2.0},
        Example{"USgpm", "m3/s", 1.0, kGallon_m3 / 60.0}, Example{"VDC", "V", 24.0, 24.0},
        Example{"ºC", "K", 0.0, 273.15}, Example{"mmH2O", "Pa", 1.0, 9.80665},
        Example{"inH2O(g)", "Pa", 1.0, 1000 * 9.80665 * kInch_m + kAtmosphere_Pa},
        Example{"gpm", "m3/s", 1.0, kGallon_m3 / 60.0}, Example{"m3/h", "m3/s", 3600.0, 1.0},
        Example{"cm3/s", "m3/s", 1.0, 1e-6}, Example{"ft", "m", 1.0, 12 * kInch_m}, Example{"in", "m", 1.0, kInch_m},
        Example{"%", "1", 50.0, 0.5}, Example{"counts", "1", 4095.0, 4095.0},
        Example{"lbf", "N", 1.0, 0.45359237 * 9.80665}, Example{"degF", "K", 32.0, 273.15},
        Example{"°C", "K", 0.0, 273.15}, Example{"C", "K", 20.0, 293.15}, Example{"F", "K", 32.0, 273.15},
        Example{"deg C", "K", 20.0, 293.15}, Example{"C", "A s", 2.0, 2.0}, Example{"F", "A s/V", 2.0, 2.0},
        Example{"rpm", "rad/s", 60.0, 2 * std::numbers::pi}, Example{"rev/min", "rad/s", 60.0, 2 * std::numbers::pi},
        Example{"1/min", "rad/s", 60.0, 2 * std::numbers::pi}, Example{"min-1", "rad/s", 60.0, 2 * std::numbers::pi},
        Example{"min^-1", "rad/s", 60.0, 2 * std::numbers::pi}, Example{"1/min", "1/s", 60.0, 1.0},
        Example{"deg/s", "rad/s", 180.0, std::numbers::pi}, Example{"rev", "rad", 1.0, 2 * std::numbers::pi},
        Example{"min", "s", 1.0, 60.0}, Example{"µs", "s", 1.0, 1e-6}, Example{"mV", "V", 1.0, 1e-3},
        Example{"N s/mm", "N s/m", 1.0, 1e3}));

struct Refused {
  const char* unit;
  const char* si_unit;
  const char* words;
};

class Unknown : public ::testing::TestWithParam<Refused> {};

TEST_P(Unknown, IsRefusedWithWhatWouldDo) {
  const auto found = convert_unit(GetParam().unit, GetParam().si_unit);
  ASSERT_FALSE(found) << GetParam().unit;
  EXPECT_THAT(found.error().describe(), HasSubstr(GetParam().words));
}

INSTANTIATE_TEST_SUITE_P(
    Units, Unknown,
    ::testing::Values(
        Refused{"mpa", "Pa", "did you mean 'MPa'?"},
        Refused{"mm", "Pa", "cannot be converted to Pa; units of this channel: Pa"},
        Refused{"%", "W", "is a share, not W; in the map: unit: W, and as scale what 1 % is"},
        Refused{"Hz", "rad/s", "cannot be converted to rad/s"},
        Refused{"1/s", "rad/s", "cannot be converted to rad/s; where it counts revolutions: rev/min (rpm) or rev/s"},
        Refused{"1/min", "rad", "cannot be converted to rad"},
        Refused{"counts", "m", "are a plain number, not m; in the map: unit: m, scale: what one count is"},
        Refused{"furlong/x", "m", "is not a known unit; units of this channel: m, mm"},
        Refused{"kPaa", "m", "cannot be converted to m"}, Refused{"Hz", "s", "cannot be converted to s"},
        Refused{"rad", "1", "cannot be converted to 1"}, Refused{"nonsense", "m", "is not a known unit"},
        Refused{"V V", "V", "cannot be converted to V"}));

TEST(Conversion, MayBeAskedFromAnyThread) {
  std::vector<std::thread> threads;
  for (int k = 0; k < 4; ++k)
    threads.emplace_back([] {
      for (int i = 0; i < 200; ++i) ASSERT_TRUE(convert_unit("ft/min", "m/s")) << i;
    });
  for (std::thread& thread : threads) thread.join();
}

}  // namespace
}  // namespace sealwatch
