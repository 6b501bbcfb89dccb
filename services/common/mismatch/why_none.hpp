// What is said in place of a law: why none is named though recordings and simulation differ, or why nothing can be seen
// in the recordings.
#pragma once

#include <string>

#include "sealwatch/mismatch/explanation.hpp"
#include "sealwatch/model/driving_channels.hpp"
#include "services/common/mismatch/between_tests.hpp"
#include "services/common/mismatch/fitted_model.hpp"

namespace sealwatch::mismatch {

struct WhyNone {
  std::string summary, next_test;
  std::string element = {};  ///< where it is, if that is known
};

/// The model follows the recordings, but its sensitivities cannot be simulated.
[[nodiscard]] WhyNone cannot_be_asked(const Error& why);
/// The time limit came before the first question.
[[nodiscard]] WhyNone time_was_up(double limit_s);
[[nodiscard]] std::string more_time_than(double limit_s);
[[nodiscard]] WhyNone nothing_moves();
/// `part`: driven by something that is not recorded.
[[nodiscard]] WhyNone drives_unseen(const PlantPart& part);
[[nodiscard]] WhyNone something_changed(const ChangeBetweenTests& change);

/// `course`: what wears from test to test, in words; `part`: what it is, and which element of the plant ("": none).
[[nodiscard]] WhyNone part_changed_but_not_by_wear(const std::string& course, const std::string& part,
                                                   const std::string& element);
[[nodiscard]] WhyNone part_aged_and_no_more(const std::string& course, const std::string& part,
                                            const std::string& element);
/// `course`: of another parameter.
[[nodiscard]] WhyNone differed_and_no_more(const std::string& course);
/// Behind one of these; `worst`: of the held-out channels, further off than its noise.
[[nodiscard]] std::string missed_by_trend(const ChannelComparison& worst);

/// `values`: of the asset file (`several`: more than one), and what would explain the recordings instead, in words;
/// `beside`: laws that are needed with them ("" for none); `instead_of`: what they stand for ("" where no law was
/// found); `holdout`: before and after on recordings that took no part.
[[nodiscard]] WhyNone value_of_the_asset_file(const std::string& values, bool several, const std::string& beside,
                                              const std::string& instead_of, const PooledFit& holdout);

/// Time was up before values of the asset file were asked in place of `laws`, in words, all of sensors or the recording.
[[nodiscard]] WhyNone values_not_asked(const std::string& laws, double limit_s);

/// `far`: the channel that is missed most with the laws, `before`: without. Tests of different days may also differ
/// from one another.
[[nodiscard]] WhyNone nowhere_near(const ChannelComparison& far, const Data& fit, const PooledFit& before);

/// In one sentence; `worse`: a channel of recordings that took no part.
[[nodiscard]] std::string does_not_carry_over(const ChannelComparison& worse);

/// The fitted recordings agree with the model; `worst`: of the held-out ones.
[[nodiscard]] WhyNone those_kept_aside_differ(const ChannelComparison& worst);

/// What follows no machine over a whole test names nothing that is missing in it. `runaway`: in words; `advice`: on it.
[[nodiscard]] WhyNone runs_away(const std::string& runaway, const std::string& advice);

}  // namespace sealwatch::mismatch
