// What a report says beside verdict and laws: into its summary, its advice and its notes.
#pragma once

#include <string>

#include "sealwatch/mismatch/explanation.hpp"
#include "sealwatch/model/plant_description.hpp"
#include "services/common/mismatch/why_none.hpp"

namespace sealwatch::mismatch {

/// In place of everything that laws would say.
void remark_why_none(const WhyNone& why, Explanation& result);

/// `course`: R_CL from test to test, in words.
void remark_ageing(const std::string& course, Explanation& result);

/// `course`: of another parameter from test to test, in words.
void remark_difference(const std::string& course, Explanation& result);

/// Values of the asset file that would do the same as the laws found.
void remark_asset_values(Explanation& result);
/// The laws found, and beside them values of the asset file that are off. In their place `instead` does as well, or less.
void remark_values_beside(const std::string& instead, bool as_well, Explanation& result);

/// The input's course between its samples may account for what is left.
void remark_faster_sampling(Explanation& result);

/// `by_size`: the law that is nothing beside the plant file's law_sizes, in words.
void remark_law_sizes(const std::string& by_size, Explanation& result);

/// Far from the noise, and no law asks for any of it: outliers, or what a cable picks up, at the first place.
void remark_disturbed_signal(Explanation& result);

/// Whether laws can be asked within the plant: not where its description has no site for them.
[[nodiscard]] bool asks_within(const PlantDescription& plant);
/// Of such a plant, whose sensors, inputs and values alone were asked: they must not stand for what it may lack.
/// `has_reason`: why no law is named is told already.
void remark_nothing_asked_within(const PlantDescription& plant, bool has_reason, Explanation& result);

/// A law of the leak past the piston takes a part of what R_CL alone had told: the rest is no healthier seal.
void remark_leak_in_two_parts(Explanation& result);
/// Fixed values that the fit moved as far as their tolerances allow; "" where there is none.
[[nodiscard]] std::string values_at_their_end(const FittedModel& model, const AssetConfig& asset);
/// Of a law that has no finite value where the plant goes.
[[nodiscard]] std::string gives_no_number(const LawAt& law);

}  // namespace sealwatch::mismatch
