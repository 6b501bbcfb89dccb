// Which laws are refitted, by what they promise on the linearised model.
#include "services/common/mismatch/ranking.hpp"

#include <gtest/gtest.h>

namespace sealwatch::mismatch {
namespace {

// One law at as many elements, each with this gain.
Screening screening_of(const std::vector<double>& gains) {
  static const Law law;
  Screening screening;
  for (const double gain : gains) {
    Variant& variant = screening.variants.emplace_back();
    variant.candidate = screening.candidates.size();
    variant.gain = gain;
    Candidate& candidate = screening.candidates.emplace_back();
    candidate.law = &law;
    candidate.element = std::to_string(variant.candidate);
  }
  return screening;
}

TEST(NearlyAsPromising, AtLeastThreeAndAllThatPromiseHalfAsMuch) {
  EXPECT_EQ(nearly_as_promising(screening_of({1000.0, 10.0, 9.0, 8.0}), 8), 3U);
  EXPECT_EQ(nearly_as_promising(screening_of({1000.0, 900.0, 800.0, 600.0, 400.0}), 8), 4U);
  EXPECT_EQ(nearly_as_promising(screening_of({30.0, 20.0, 15.0, 10.0, 5.0}), 8), 4U) << "less by twice what decides";
  EXPECT_EQ(nearly_as_promising(screening_of({1000.0, 900.0, 800.0}), 2), 2U);
}

TEST(NearlyAsPromising, NoneThatCannotWinButForTheBest) {
  EXPECT_EQ(nearly_as_promising(screening_of({1000.0, 900.0, 800.0}), 8, 850.0), 2U);
  EXPECT_EQ(nearly_as_promising(screening_of({1000.0, 900.0, 800.0}), 8, 5000.0), 1U);
}

TEST(RankedPairs, AreOfPhysicsAloneUnlessAskedForMore) {
  const Law *drag = *find_law("quadratic_drag", {"k"}), *leak = *find_law("external_leakage", {"G"});
  Screening screening;
  screening.gram = Eigen::MatrixXd::Identity(4, 4);
  screening.gradient = Eigen::VectorXd::Constant(4, 20.0);  // each brings 400, two of them 800
  screening.unit = {1.0, 1.0, 1.0, 1.0};
  for (const Law* law : {drag, leak, *find_law("sensor_gain", {"g"}), *find_law("clock_rate", {"c"})}) {
    const std::size_t k = screening.candidates.size();
    Candidate& candidate = screening.candidates.emplace_back();
    candidate.law = law;
    candidate.element = std::string(law->id);
    candidate.grid = {{1.0}};
    Variant& variant = screening.variants.emplace_back();
    variant.candidate = k;
    variant.columns = {static_cast<Eigen::Index>(k)};
    variant.strength = {1.0};
    variant.gain = 400.0;
  }
  const auto physics = ranked_pairs(screening, 1000.0, false);
  ASSERT_EQ(physics.size(), 1U);
  EXPECT_EQ(physics.front()[0].effect.law, drag);
  EXPECT_EQ(physics.front()[1].effect.law, leak);
  EXPECT_GT(ranked_pairs(screening, 1000.0, true).size(), 1U);
}

}  // namespace
}  // namespace sealwatch::mismatch
