// Student's t distribution with `degrees_of_freedom` >= 1.
#pragma once

namespace sealwatch::forecast {

/// T_q: the value that a t-distributed variable stays below with probability `probability` (0 < probability < 1).
[[nodiscard]] double student_t_quantile(double probability, int degrees_of_freedom);

/// Probability that a t-distributed variable is at most `value`.
[[nodiscard]] double student_t_probability(double value, int degrees_of_freedom);

}  // namespace sealwatch::forecast
