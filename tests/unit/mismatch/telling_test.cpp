#include "services/common/mismatch/telling.hpp"

#include <gtest/gtest.h>

namespace sealwatch::mismatch {
namespace {

TEST(Summary, NamesWhichLawCannotBeToldFromWhich) {
  Explanation found;
  found.verdict = Verdict::mismatch;
  found.statistically_significant = true;
  FoundEffect load, friction;
  load.what = {"position_dependent_load", "", "piston", "k_q (x - x_q)^2", ""};
  load.indistinguishable = {{"position_dependent_load", "edge", "piston", "k_q |x - x_q|", ""}};
  friction.what = {"coulomb_friction", "", "piston", "F_c tanh(v / v_s)", ""};
  friction.indistinguishable = {{"presliding_friction", "", "piston", "sigma_0 z", ""}};
  found.effects = {load, friction};
  const std::string text = summary_of(found);
  EXPECT_NE(text.find("cannot tell position dependent load at the piston from another form of it (k_q |x - x_q|)."),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("cannot tell coulomb friction at the piston from presliding friction at the piston."),
            std::string::npos)
      << text;
}

TEST(Evidence, OfSeveralLawsIsSaidOfAllTogether) {
  FoundEffect drag;
  drag.what.law = "k v abs(v)";
  EXPECT_EQ(evidence_of(drag, 1, 12.0, 1.02).find("Adding k v abs(v) takes"), 0U);
  EXPECT_EQ(evidence_of(drag, 2, 12.0, 1.02).find("With the other laws found, k v abs(v) takes"), 0U);
}

}  // namespace
}  // namespace sealwatch::mismatch
