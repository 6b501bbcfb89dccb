// One long recording is two, a correlation time apart; a short one is one.
#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "services/common/estimation/rows_of.hpp"
#include "services/common/mismatch/pieces.hpp"

namespace sealwatch::mismatch {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr double kRate_Hz = 10.0;

/// A first-order autoregression of that correlation from sample to sample.
Recording drifting(double rho, std::size_t samples) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  Recording recording;
  recording.recording_id = "long";
  Series level{"level", "m", 0.0, {}};
  for (std::size_t k = 0; k < samples; ++k) {
    recording.samples.time_s.push_back(static_cast<double>(k) / kRate_Hz);
    level.values.push_back((k == 0 ? 0.0 : rho * level.values.back()) + normal(random));
  }
  recording.samples.channels.push_back(std::move(level));
  return recording;
}

const std::vector<std::string> kOutputs = {"level"};

TEST(Pieces, CorrelationTimeOfAnAutoregression) {
  const double rho = 0.9, tau_s = (1.0 + rho) / (1.0 - rho) / kRate_Hz;
  EXPECT_NEAR(correlation_time_s(drifting(rho, 4000).samples, kOutputs), tau_s, 0.3 * tau_s);
}

TEST(Pieces, ALongRecordingIsTwoHalvesACorrelationTimeApart) {
  const Recording whole = drifting(0.9, 4000);
  const std::vector<Recording> halves = in_halves(whole, kOutputs);
  ASSERT_THAT(halves, SizeIs(2));
  const double gap_s = halves[1].samples.time_s.front() - halves[0].samples.time_s.back();
  EXPECT_NEAR(gap_s, correlation_time_s(whole.samples, kOutputs), 2.0 / kRate_Hz);
  EXPECT_NEAR(static_cast<double>(halves[0].samples.time_s.size()),
              static_cast<double>(halves[1].samples.time_s.size()), 1.0);
  EXPECT_EQ(halves[0].samples.time_s.front(), whole.samples.time_s.front());
  EXPECT_EQ(halves[1].samples.channels[0].values.back(), whole.samples.channels[0].values.back());
  EXPECT_THAT(halves[0].recording_id, HasSubstr("long, 0 to"));
  EXPECT_NE(halves[0].recording_id, halves[1].recording_id);
  EXPECT_EQ(halves[0].start_time, halves[1].start_time) << "nothing ages between them";
}

TEST(Pieces, AShortRecordingOrOneAtRestStaysOne) {
  Recording out_and_back = drifting(0.0, 1000);
  for (std::size_t k = 0; k < 1000; ++k)
    out_and_back.samples.channels[0].values[k] = std::abs(500.0 - static_cast<double>(k));
  EXPECT_THAT(in_halves(out_and_back, kOutputs), IsEmpty()) << "each half is the other's mirror";
  Recording rest = drifting(0.0, 1000);
  for (double& value : rest.samples.channels[0].values) value = 1.0;
  EXPECT_THAT(in_halves(rest, kOutputs), IsEmpty());
}

TEST(Pieces, OfMoreNumbersThanAreAnalysedEveryFewRowsAreLeft) {
  Recording slow, fast;
  slow.file = "slow.csv";
  fast.file = "fast.csv";
  for (int k = 0; k < 300'000; ++k) fast.samples.time_s.push_back(1e-4 * k);
  fast.samples.channels.push_back({"position", "m", 0.0, fast.samples.time_s});
  slow.samples = rows_of(fast.samples, 0, 1000);
  std::vector<std::string> notes;
  const std::vector<Recording> kept = thinned(std::vector{slow, fast}, notes);
  EXPECT_EQ(kept[0].samples, slow.samples);
  EXPECT_EQ(kept[1].samples.time_s.size(), 100'000U);
  EXPECT_DOUBLE_EQ(kept[1].samples.channels[0].values[2], 6e-4);
  EXPECT_THAT(notes, testing::ElementsAre("fast.csv: one row in 3 was analysed, as its 600000 numbers are more than "
                                          "250000."));
}

}  // namespace
}  // namespace sealwatch::mismatch
