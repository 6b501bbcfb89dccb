// The bench against recordings of an independent bench program (another integrator, controller and sensor code).
#include <gtest/gtest.h>

#include <filesystem>

#include "services/common/recording/recording_file.hpp"
#include "tests/unit/virtual_bench/nominal.hpp"

namespace sealwatch::bench {
namespace {

constexpr double kPistonArea_m2 = 5.89e-3;
constexpr double kLoad_N = 6.0e4;

double load_factor_of(const Recording& recording) {
  const double drop =
      mean(between(recording, "pressure_a", 15.0, 16.0)) - mean(between(recording, "pressure_b", 15.0, 16.0));
  return kPistonArea_m2 * drop / kLoad_N - 1.0;
}

TEST(Reference, SteadySignalsAgreeWithAnIndependentBench) {
  const std::filesystem::path file = std::filesystem::path(SEALWATCH_SHARED_DATA) / "pst_life/xt03-mv2/2009-03.csv";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "the public recordings are not there: " << file;
  const Result<Recording> theirs = read_recording(file.string(), *find_plant("eha").value());
  ASSERT_TRUE(theirs) << theirs.error().describe();
  const Recording ours = run(nominal_asset(), {.load_factor = load_factor_of(*theirs)}, {.sample_rate_Hz = 50.0});
  // Their actuator has its own true parameters, some per cent off nominal; the pressures' level depends on the history
  // of make-up flow as well. Current is small against its friction part.
  struct Compared {
    const char* channel;
    double share;
  };
  for (const auto& [channel, share] : {Compared{"motor_voltage", 0.03},
                                       {"shaft_speed", 0.03},
                                       {"flow", 0.03},
                                       {"velocity", 0.02},
                                       {"motor_current", 0.06},
                                       {"pressure_a", 0.03}}) {
    for (const auto& [from_s, to_s] : {std::pair{6.0, 12.0}, {20.0, 27.0}}) {
      const double expected = mean(between(*theirs, channel, from_s, to_s));
      EXPECT_NEAR(mean(between(ours, channel, from_s, to_s)), expected, share * std::abs(expected))
          << channel << " from " << from_s << " s";
    }
  }
}

}  // namespace
}  // namespace sealwatch::bench
