#include "services/common/fmi/fmu_equations.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "services/common/fmi/derivative_points.hpp"
#include "services/common/fmi/fmu_evaluator.hpp"

namespace sealwatch::fmi {

FmuEquations::FmuEquations(FmuBlock block, std::shared_ptr<const RuntimeEquations> frame, Counts counts,
                           bool outputs_see_added)
    : block_(std::move(block)),
      frame_(std::move(frame)),
      counts_(counts),
      outputs_see_added_(outputs_see_added),
      runs_(std::make_unique<HostedRuns>(block_.file->name(), block_.plant)) {}

// Instances of a run stand side by side in one process, which not every binary allows.
bool FmuEquations::runs_elsewhere() const {
  return !block_.plant.file.empty() && block_.setup.once_per_process == 0 && !local_hosts();
}

Result<std::unique_ptr<RuntimeEvaluator>> FmuEquations::evaluator(const RuntimePoint& first,
                                                                  std::span<const std::size_t> differentiated) const {
  auto frame = frame_->evaluator(first, differentiated);
  if (!frame) return fail(frame.error());
  const std::vector<double> added(block_.states.size() + block_.variables.size() + counts_.sites, 0.0);
  RuntimePoint inner = first;
  inner.added = added;
  const RuntimeLinearisation* at =
      (*frame)->linearise(RuntimeFunction::outputs, inner, {.states = false, .parameters = true, .added = false});
  if (at == nullptr) return fail("the FMU's inputs and parameters have no values", (*frame)->trouble());
  // Relative to the parameter: one-sided differences then err by some 1e-6 of themselves.
  constexpr double kStep = 1e-6;
  std::vector<double> steps;
  std::vector<BlockStart> starts{start_of(*at, 0, 0.0)};
  for (std::size_t k = 0; k < differentiated.size(); ++k) {
    const double size = std::abs(first.parameters[differentiated[k]]);
    steps.push_back(kStep * (size > 0.0 ? size : 1.0));
    starts.push_back(start_of(*at, k, steps.back()));
  }
  auto running = RunningBlock::begin(block_, pool_, first, starts, std::move(steps));
  if (!running) return fail(running.error());
  return std::make_unique<FmuEvaluator>(block_, std::move(*frame), std::move(*running), counts_.outputs, counts_.sites,
                                        differentiated.size(), frame_->signals_see_added());
}

BlockStart FmuEquations::start_of(const RuntimeLinearisation& at, std::size_t direction, double step) const {
  BlockStart start;
  const auto put = [&](std::size_t row, std::vector<double>& values) {
    values.push_back(at.values[row]);
    if (step != 0.0) values.back() += step * at.by_parameter.row(row)[direction];
  };
  const std::size_t inputs = block_.inputs.size();
  for (std::size_t k = 0; k < inputs; ++k) put(counts_.outputs + k, start.inputs);
  for (std::size_t k = 0; k < block_.parameters.size(); ++k) put(counts_.outputs + inputs + k, start.parameters);
  return start;
}

namespace {

/// One of the four Jacobians: what it is of and by, and where its numbers are.
struct JacobianPart {
  bool of_outputs, by_inputs;
  std::vector<double> Partials::*numbers;
};
constexpr std::array kParts = {
    JacobianPart{false, false, &Partials::derivatives_by_state}, JacobianPart{true, false, &Partials::outputs_by_state},
    JacobianPart{false, true, &Partials::derivatives_by_input}, JacobianPart{true, true, &Partials::outputs_by_input}};

class DerivativeCheck {
 public:
  explicit DerivativeCheck(const FmuBlock& block) : block_(block), points_(block) {}

  /// What is wrong at a point; "" where nothing is. Differences over two widths that differ from each other are no
  /// measure: there the model has a corner, or its values are rounded; nor are those of none where far wider ones show
  /// something.
  [[nodiscard]] std::string fault_at(const DerivativePoint& point, const Partials& said, const Partials& fine,
                                     const Partials& wide, const Partials& far) const {
    for (const JacobianPart& part : kParts) {
      const auto& values = part.of_outputs ? fine.outputs : fine.derivatives;
      const std::size_t rows = values.size();
      const auto &a = said.*part.numbers, &b = fine.*part.numbers, &c = wide.*part.numbers, &d = far.*part.numbers;
      const std::size_t columns = rows == 0 ? 0 : b.size() / rows;
      for (std::size_t row = 0; row < rows; ++row) {
        double largest = 0.0;
        for (std::size_t column = 0; column < columns; ++column)
          largest = std::max(largest, std::abs(b[row * columns + column]));
        for (std::size_t column = 0; column < columns; ++column) {
          const std::size_t k = row * columns + column;
          const double rounding = kRounding * std::abs(values[row]) / step(point, part.by_inputs, column);
          const auto apart = [&](double one, double other) {
            const double size = std::max({std::abs(one), std::abs(other), 1e-3 * largest});
            return !(std::abs(one - other) <= kTolerance * size + 1e-9 + rounding);
          };
          const bool swallowed = b[k] == 0.0 && c[k] == 0.0 && d[k] != 0.0;
          if (apart(a[k], b[k]) && !apart(b[k], c[k]) && !swallowed) return words(part, row, column, a[k], b[k]);
        }
      }
    }
    return "";
  }

  [[nodiscard]] DerivativePoints& points() { return points_; }

 private:
  static constexpr double kTolerance = 1e-3;
  static constexpr double kRounding = 1e-13;  // of a value: what its terms cancel to is rounded more than itself

  /// Of a difference, as the process takes it (fmu_host.cpp).
  [[nodiscard]] double step(const DerivativePoint& point, bool by_inputs, std::size_t column) const {
    const double value = by_inputs ? point.inputs[column] : point.states[column];
    return std::max(points_.step(by_inputs, column), 1e-7 * std::abs(value));
  }

  [[nodiscard]] std::string words(const JacobianPart& part, std::size_t row, std::size_t column, double said,
                                  double shown) const {
    const ModelDescription& description = block_.file->description();
    const std::string of = part.of_outputs ? element_of(description, block_.setup.outputs, row)
                                           : description.name_of(description.derivatives[row]);
    const std::string by = part.by_inputs ? element_of(description, block_.setup.inputs, column)
                                          : description.name_of(description.states[column]);
    return "d " + of + " / d " + by + " is said to be " + std::to_string(said) + ", where its " +
           (part.of_outputs ? "outputs" : "derivatives") + " change by " + std::to_string(shown);
  }

  const FmuBlock& block_;
  DerivativePoints points_;
};

}  // namespace

std::string element_of(const ModelDescription& description, std::span<const Handle> handles, std::size_t place) {
  for (const Handle& handle : handles) {
    if (place >= handle.size) {
      place -= handle.size;
      continue;
    }
    const auto variable = std::ranges::find_if(description.variables, [&](const Variable& one) {
      return one.reference == handle.reference && one.type == handle.type;
    });
    if (variable == description.variables.end()) break;
    return description.name_of({static_cast<std::size_t>(variable - description.variables.begin()), place});
  }
  return "?";
}

Status check_derivatives(FmuBlock& block) {
  if (block.setup.co_simulation != 0 || block.setup.state_directional == 0) return {};
  Setup differences = block.setup;
  differences.state_directional = differences.output_directional = 0;
  differences.dependencies.clear();
  auto honest = FmuProcess::start(block.file->name(), differences, 1);
  if (!honest) return fail(honest.error());
  DerivativeCheck check(block);
  constexpr double kWider = 10.0, kFar = 1e4;
  const auto fine = check.points().partials(**honest, 1.0);
  if (!fine) return fail(fine.error());
  const auto wide = check.points().partials(**honest, kWider);
  if (!wide) return fail(wide.error());
  const auto far = check.points().partials(**honest, kFar);
  if (!far) return fail(far.error());
  if (fine->empty() || wide->empty() || far->empty()) return {};  // nothing to measure by; a run says what fails
  auto claimed = FmuProcess::start(block.file->name(), block.setup, 1);
  if (!claimed) return fail(claimed.error());
  const auto said = check.points().partials(**claimed, 1.0);
  if (!said) return fail(said.error());
  if (said->empty()) return block.setup.state_directional = block.setup.output_directional = 0, Status();
  std::string fault;
  for (std::size_t k = 0; k < said->size(); ++k) {  // a corner can lie at one point, not at all of them
    fault = check.fault_at(check.points().all()[k], (*said)[k], (*fine)[k], (*wide)[k], (*far)[k]);
    if (fault.empty()) return {};
  }
  return fail(false_derivatives(*block.file, std::move(fault)));
}

Error false_derivatives(const FmuFile& file, std::string which) {
  return {.file = file.name(),
          .place = "directional derivatives",
          .value = std::move(which),
          .rule = "gives directional derivatives that are not the derivatives of its own values",
          .advice = "export it without them, or tell its maker"};
}

}  // namespace sealwatch::fmi
