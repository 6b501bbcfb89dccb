#include "services/common/fmi/declared_dependencies.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "services/common/fmi/column_groups.hpp"
#include "services/common/fmi/derivative_points.hpp"

namespace sealwatch::fmi {
namespace {

class Declared {
 public:
  explicit Declared(const ModelDescription& description) : description_(description) {}

  /// Adds a row; false: it may depend on anything.
  bool add_derivative(const Element& derivative) { return add_listed(description_.variables[derivative.variable]); }
  bool add_output(const Element& output) {
    const Variable& variable = description_.variables[output.variable];
    if (!moves(variable)) return put({}), true;
    for (std::size_t k = 0; k < description_.states.size(); ++k) {
      const Element &state = description_.states[k], &derivative = description_.derivatives[k];
      if (is_same(state, output)) return put({static_cast<std::uint32_t>(k)}), true;
      if (is_same(derivative, output)) return add_derivative(derivative);
    }
    return add_listed(variable);
  }
  [[nodiscard]] const std::vector<std::uint32_t>& numbers() const { return numbers_; }

 private:
  /// Whether it may change between events without being set.
  static bool moves(const Variable& variable) {
    return variable.variability == FmiVariability::continuous && variable.causality != FmiCausality::input &&
           variable.causality != FmiCausality::independent && variable.causality != FmiCausality::parameter;
  }
  [[nodiscard]] bool is_same(const Variable& one, const Variable& other) const {
    return one.reference == other.reference && one.type == other.type;
  }
  [[nodiscard]] bool is_same(const Element& one, const Element& other) const {
    return one.element == other.element &&
           is_same(description_.variables[one.variable], description_.variables[other.variable]);
  }

  bool add_listed(const Variable& variable) {
    const auto listed = std::ranges::find_if(description_.dependencies, [&](const auto& one) {
      return is_same(description_.variables[one.first], variable);
    });
    if (listed == description_.dependencies.end()) return false;
    std::vector<std::uint32_t> states;
    for (const std::size_t known : listed->second) {
      const Variable& of = description_.variables[known];
      if (!moves(of)) continue;
      const std::size_t before = states.size();
      for (std::size_t k = 0; k < description_.states.size(); ++k)
        if (is_same(description_.variables[description_.states[k].variable], of))
          states.push_back(static_cast<std::uint32_t>(k));
      if (states.size() == before) return false;  // no state: what it depends on in turn is not said
    }
    return put(std::move(states)), true;
  }
  void put(std::vector<std::uint32_t> states) {
    std::ranges::sort(states);
    states.erase(std::ranges::unique(states).begin(), states.end());
    numbers_.push_back(static_cast<std::uint32_t>(states.size()));
    numbers_.insert(numbers_.end(), states.begin(), states.end());
  }

  const ModelDescription& description_;
  std::vector<std::uint32_t> numbers_;
};

}  // namespace

std::vector<std::uint32_t> declared_dependencies(const ModelDescription& description,
                                                 std::span<const std::size_t> outputs) {
  Declared declared(description);
  for (const Element& derivative : description.derivatives)
    if (!declared.add_derivative(derivative)) return {};
  for (const std::size_t output : outputs)
    for (std::size_t element = 0; element < description.variables[output].size; ++element)
      if (!declared.add_output({output, element})) return {};
  const std::size_t states = description.states.size();
  return column_groups(declared.numbers(), states).size() < states ? declared.numbers() : std::vector<std::uint32_t>();
}

namespace {

/// The first row of which something moves with a state that it is not declared to depend on, and that state.
std::optional<MatrixPlace> undeclared(const FmuBlock& block, const Partials& fine, const Partials& wide) {
  constexpr double kNothing = 1e-6;  // of what all states do to the row
  constexpr double kAgree = 0.1;     // differences over two widths, where they show more than rounding
  const std::size_t states = block.states.size();
  std::uint32_t row = 0;
  const std::vector<std::uint32_t>& all = block.setup.dependencies;
  for (std::size_t at = 0; at < all.size(); at += 1 + all[at], ++row) {
    const std::span declared = std::span(all).subspan(at + 1, all[at]);
    const bool of_outputs = row >= states;
    const std::size_t first = (of_outputs ? row - states : row) * states;
    const auto moved = [&](const Partials& by, std::size_t k) {
      const auto& matrix = of_outputs ? by.outputs_by_state : by.derivatives_by_state;
      return matrix[first + k] * block.state_sizes[k] / block.states[k].factor;
    };
    double together = 0.0;
    for (std::size_t k = 0; k < states; ++k) together += std::abs(moved(fine, k));
    for (std::uint32_t k = 0; k < states; ++k) {
      const double by_fine = moved(fine, k), by_wide = moved(wide, k);
      if (std::ranges::binary_search(declared, k) || !(std::abs(by_fine) > kNothing * together)) continue;
      if (std::abs(by_fine - by_wide) <= kAgree * std::abs(by_fine)) return MatrixPlace{row, k};
    }
  }
  return std::nullopt;
}

}  // namespace

Result<std::string> check_dependencies(FmuBlock& block) {
  if (block.setup.dependencies.empty()) return std::string();
  Setup one_by_one = block.setup;
  one_by_one.dependencies.clear();
  one_by_one.state_directional = one_by_one.output_directional = 0;
  auto process = FmuProcess::start(block.file->name(), one_by_one, 1);
  if (!process) return fail(process.error());
  DerivativePoints points(block);
  constexpr double kWider = 10.0;
  const auto fine = points.partials(**process, 1.0);
  if (!fine) return fail(fine.error());
  const auto wide = points.partials(**process, kWider);
  if (!wide) return fail(wide.error());
  for (std::size_t k = 0; k < std::min(fine->size(), wide->size()); ++k) {
    const auto place = undeclared(block, (*fine)[k], (*wide)[k]);
    if (!place) continue;
    block.setup.dependencies.clear();
    const ModelDescription& description = block.file->description();
    const std::size_t states = block.states.size();
    const std::string of = place->row < states ? description.name_of(description.derivatives[place->row])
                                               : element_of(description, block.setup.outputs, place->row - states);
    return of + " depends on " + description.name_of(description.states[place->column]) +
           ", which ModelStructure does not declare: its dependencies are not used, and the unit is slower than it "
           "could be; tell its maker";
  }
  return std::string();
}

}  // namespace sealwatch::fmi
