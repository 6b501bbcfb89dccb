// Standard normal distribution.
#pragma once

namespace sealwatch::forecast {

[[nodiscard]] double normal_density(double z);
/// Probability of a value of at most z.
[[nodiscard]] double normal_probability(double z);
/// 0 < probability < 1.
[[nodiscard]] double normal_quantile(double probability);

}  // namespace sealwatch::forecast
