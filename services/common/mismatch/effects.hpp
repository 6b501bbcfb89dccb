// From refits to what is said of each effect: parameters with standard errors, probabilities, alternatives, places.
#pragma once

#include "sealwatch/mismatch/explanation.hpp"
#include "services/common/mismatch/carry_over.hpp"
#include "services/common/mismatch/naming.hpp"

namespace sealwatch::mismatch {

[[nodiscard]] LawAt law_at(const Effect& effect, const PlantDescription& plant);
/// "line resistance at valve 1"
[[nodiscard]] std::string law_in_words(const Effect& effect);
[[nodiscard]] bool same_effects(const std::vector<Effect>& a, const std::vector<Effect>& b);
/// The law's parameters in its order, as the asset has them; none where it does not hold the law.
[[nodiscard]] std::vector<double> parameters_in(const Effect& effect, const AssetConfig& asset);

/// Effects of the best model, most probable first. For each its alternatives are refitted in its place; with
/// `carry_over` the nearest of them are told apart only where they predict other recordings worse. The law that was
/// added last comes alone where it could sit anywhere, as the others are then asked without it.
[[nodiscard]] std::vector<FoundEffect> describe_effects(Naming& naming, const Trial& best, const Data& data,
                                                        const ExplainOptions& options,
                                                        const CarryOver* carry_over = nullptr);

[[nodiscard]] std::vector<Location> locate(const std::vector<FoundEffect>& effects);
/// Where the residual asks for something that no law gives: elements by the gain of their best law.
[[nodiscard]] std::vector<Location> locate_without_law(const Screening& screening);

/// The sensor of the channel that misses most: where no law asks for any of the misfit.
[[nodiscard]] std::vector<Location> locate_at_a_sensor(const PooledFit& fit);

[[nodiscard]] Rejected describe(const Forbidden& forbidden, const PlantDescription& plant);

[[nodiscard]] std::vector<ParameterShift> parameter_shifts(const AssetConfig& datasheet, const FittedModel& before,
                                                           const FittedModel& after);

[[nodiscard]] PrognosisShift prognosis_shift(const AssetConfig& asset, const std::vector<ParameterShift>& parameters);

}  // namespace sealwatch::mismatch
