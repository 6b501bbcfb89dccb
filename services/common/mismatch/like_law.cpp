#include "services/common/mismatch/like_law.hpp"

#include <cmath>

#include "sealwatch/model/law_sizes.hpp"

namespace sealwatch::mismatch {
namespace {

// Shapes to try: the form's grid, and where it has but one, many between its bounds.
std::vector<std::vector<double>> shapes_of(const Candidate& form, std::size_t strength, const PlantDescription& plant) {
  constexpr int kPoints = 24;
  std::vector<std::vector<double>> shapes = form.grid;
  if (form.law->parameters.size() != 2) return shapes;
  const std::size_t shape = 1 - strength;
  const LawBounds bounds = law_bounds(plant, form.law->parameters[shape]);
  for (int k = 0; k <= kPoints; ++k) {
    shapes.push_back(form.grid.front());
    shapes.back()[shape] = bounds.min + (bounds.max - bounds.min) * k / kPoints;
  }
  return shapes;
}

// Sums over all paths, weighed by the length of the steps: of f c, f f and c c.
struct Products {
  double across = 0.0, form = 0.0, law = 0.0;
};

Products products_of(const Law& form, const std::vector<double>& parameters, const Roundings& roundings,
                     const std::vector<TermPath>& paths) {
  Products sum;
  for (const TermPath& path : paths)
    for (std::size_t k = 1; k < path.time_s.size(); ++k) {
      const double weight = path.time_s[k] - path.time_s[k - 1], c = path.contribution[k],
                   f = form.evaluate(law_input(path.signals[k], 0.0, parameters, roundings)).contribution.value;
      sum.across += weight * f * c;
      sum.form += weight * f * f;
      sum.law += weight * c * c;
    }
  return sum;
}

}  // namespace

std::optional<LikeLaw> most_like(const Candidate& form, const Effect& law, const std::vector<TermPath>& paths,
                                 const PlantDescription& plant) {
  const std::vector<std::size_t> strengths = strengths_of(*form.law);
  const bool here = form.element == law.element && form.law->kind == law.law->kind && form.law->evaluate;
  if (paths.empty() || !here || form.law->hidden || law.law->hidden || strengths.size() != 1) return std::nullopt;
  const std::size_t strength = strengths.front();
  const LawBounds bounds = law_bounds(plant, form.law->parameters[strength]);
  const Roundings roundings = roundings_of(plant, *form.law);
  std::optional<LikeLaw> most;
  for (std::vector<double>& parameters : shapes_of(form, strength, plant)) {
    parameters[strength] = 1.0;
    const Products sum = products_of(*form.law, parameters, roundings, paths);
    const double k = sum.across / sum.form;
    const double lacks = 1.0 - sum.across * k / sum.law;
    if (!std::isfinite(lacks) || k <= bounds.min || k >= bounds.max || (most && lacks >= most->lacks)) continue;
    parameters[strength] = k;
    most = LikeLaw{.parameters = parameters, .lacks = lacks};
  }
  return most;
}

}  // namespace sealwatch::mismatch
