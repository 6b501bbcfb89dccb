// The verdict by what was found, and when laws explain a difference.
#include "services/common/mismatch/verdict.hpp"

#include <gtest/gtest.h>

namespace sealwatch::mismatch {
namespace {

TEST(VerdictTable, AReasonForNoLawDecidesBeforeAnythingElse) {
  EXPECT_EQ(verdict_of({.no_law_for_a_reason = true}), Verdict::undetermined);
  EXPECT_EQ(verdict_of({.no_law_for_a_reason = true, .differs = true, .explained = true}), Verdict::undetermined);
}

TEST(VerdictTable, WithoutADifferenceItIsConsistentWhereNothingCouldHide) {
  EXPECT_EQ(verdict_of({}), Verdict::consistent);
  EXPECT_EQ(verdict_of({.something_hides = true}), Verdict::undetermined);
  EXPECT_EQ(verdict_of({.all_compared = false}), Verdict::undetermined);
}

TEST(VerdictTable, ADifferenceIsAMismatchOnlyWhereItIsExplained) {
  EXPECT_EQ(verdict_of({.differs = true}), Verdict::undetermined);
  EXPECT_EQ(verdict_of({.differs = true, .explained = true}), Verdict::mismatch);
  EXPECT_EQ(verdict_of({.differs = true, .something_hides = true, .explained = true}), Verdict::mismatch);
}

TEST(LawsExplain, OnlyWhereTheyAreProven) {
  LawsFound laws{.any = true, .proven = true, .leave_nothing = true};
  EXPECT_TRUE(explains(laws));
  laws.proven = false;
  EXPECT_FALSE(explains(laws));
  EXPECT_FALSE(explains({.any = false, .proven = true, .leave_nothing = true}));
}

TEST(LawsExplain, ByHalfOfTheExcessOrNineTenthsOfTheEvidence) {
  EXPECT_TRUE(explains({.any = true, .proven = true, .share = 0.5}));
  EXPECT_FALSE(explains({.any = true, .proven = true, .share = 0.49}));
  EXPECT_TRUE(explains({.any = true, .proven = true, .as_searched = true, .p_before = 1e-30, .p_after = 2e-3}));
  EXPECT_FALSE(explains({.any = true, .proven = true, .as_searched = true, .p_before = 1e-30, .p_after = 5e-4}));
  EXPECT_FALSE(explains({.any = true, .proven = true, .as_searched = false, .p_before = 1e-30, .p_after = 2e-3}))
      << "that p-value is of other laws";
}

/// What is missed grossly is seen without any law, whatever a p-value of laws says.
TEST(LawsExplain, AGrossMisfitByHalfOfTheExcessOnHeldOutRecordingsToo) {
  EXPECT_TRUE(explains({.any = true, .proven = true, .share = 0.6, .share_held_out = 0.5, .leave_gross_misfit = true}));
  EXPECT_FALSE(explains({.any = true, .proven = true, .share = 0.6, .share_held_out = 0.3}));
  EXPECT_FALSE(explains({.any = true,
                         .proven = true,
                         .share = 0.4,
                         .as_searched = true,
                         .p_before = 1e-300,
                         .p_after = 1e-20,
                         .leave_gross_misfit = true}));
}

TEST(LawsExplain, NotWhereMuchIsLeftInAPlantThatHidesItsInside) {
  EXPECT_FALSE(explains({.any = true, .proven = true, .share = 0.9, .leave_what_is_within = true}));
}

TEST(LawsExplain, EvidenceBeyondTheSmallestDoubleCountsAsMuch) {
  EXPECT_TRUE(explains({.any = true, .proven = true, .as_searched = true, .p_before = 0.0, .p_after = 1e-30}));
  EXPECT_FALSE(explains({.any = true, .proven = true, .as_searched = true, .p_before = 0.0, .p_after = 1e-31}));
}

TEST(ShareExplained, IsOfTheMisfitAboveTheNoise) {
  EXPECT_DOUBLE_EQ(share_explained(5.0, 2.0), 0.75);
  EXPECT_DOUBLE_EQ(share_explained(5.0, 0.9), 1.0);
  EXPECT_DOUBLE_EQ(share_explained(5.0, 6.0), 0.0);
  EXPECT_DOUBLE_EQ(share_explained(0.9, 0.8), 0.0) << "nothing was above it";
}

}  // namespace
}  // namespace sealwatch::mismatch
