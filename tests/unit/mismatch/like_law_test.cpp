#include "services/common/mismatch/like_law.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace sealwatch::mismatch {
namespace {

/// Speeds of both signs, and a drag by their square.
std::vector<TermPath> quadratic_drag_path() {
  constexpr double kDrag_N_s2_m2 = 3e8;
  TermPath path;
  for (int k = 0; k <= 200; ++k) {
    const double v = 2e-3 * std::sin(0.1 * k);
    path.time_s.push_back(0.01 * k);
    path.signals.push_back({v, 0.05});
    path.contribution.push_back(kDrag_N_s2_m2 * v * std::abs(v));
  }
  return {path};
}

Candidate power_of_speed(const std::string& element) {
  return {.law = *find_law("unlisted", {"k_v", "a_v"}),
          .element = element,
          .sites = {},
          .channel = {},
          .grid = {{1e3, 1.5}, {1e3, 0.5}}};
}

TEST(LikeLaw, APowerOfSpeedStartsAsTheQuadraticDragThatWasFound) {
  const PlantDescription& plant = **find_plant("eha");
  const Effect drag{*find_law("quadratic_drag", {"k"}), "piston"};
  const auto like = most_like(power_of_speed("piston"), drag, quadratic_drag_path(), plant);
  ASSERT_TRUE(like);
  EXPECT_LT(like->lacks, 1e-3);
  EXPECT_NEAR(like->parameters[0], 300.0, 3.0);  // N at 1 mm/s
  EXPECT_NEAR(like->parameters[1], 2.0, 0.01);
}

TEST(LikeLaw, AFormElsewhereOrAgainstItsSignIsNone) {
  const PlantDescription& plant = **find_plant("eha");
  const Effect drag{*find_law("quadratic_drag", {"k"}), "piston"};
  std::vector<TermPath> paths = quadratic_drag_path();
  EXPECT_FALSE(most_like(power_of_speed("stem"), drag, paths, plant));
  EXPECT_FALSE(most_like(power_of_speed("piston"), drag, {}, plant));
  for (double& value : paths.front().contribution) value = -value;
  EXPECT_FALSE(most_like(power_of_speed("piston"), drag, paths, plant));
}

}  // namespace
}  // namespace sealwatch::mismatch
