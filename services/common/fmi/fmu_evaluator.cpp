#include "services/common/fmi/fmu_evaluator.hpp"

#include <algorithm>

namespace sealwatch::fmi {
namespace {

/// result += a b, with the rows of a from `first`. Most of a is zero: what a unit gives goes to one row or none.
void add_product(const RuntimeMatrix& a, std::size_t first, const RuntimeMatrix& b, RuntimeMatrix& result) {
  const std::size_t columns = result.columns;
  for (std::size_t row = 0; row < result.rows; ++row) {
    const double* factors = a.row(first + row);
    double* sums = result.row(row);
    for (std::size_t k = 0; k < b.rows; ++k) {
      const double factor = factors[k];
      if (factor == 0.0) continue;
      const double* terms = b.row(k);
      for (std::size_t column = 0; column < columns; ++column) sums[column] += factor * terms[column];
    }
  }
}

/// Rows [first, first + rows) and columns from `skip` of a matrix.
void take(const RuntimeMatrix& from, std::size_t first, std::size_t rows, std::size_t skip, RuntimeMatrix& to) {
  to.rows = rows, to.columns = from.columns - skip;
  to.values.resize(rows * to.columns);
  for (std::size_t row = 0; row < rows; ++row)
    std::copy(from.row(first + row) + skip, from.row(first + row) + from.columns, to.row(row));
}

bool is_zero(const RuntimeMatrix& matrix) {
  return std::ranges::all_of(matrix.values, [](double value) { return value == 0.0; });
}

}  // namespace

FmuEvaluator::FmuEvaluator(const FmuBlock& block, std::unique_ptr<RuntimeEvaluator> frame,
                           std::unique_ptr<RunningBlock> running, std::size_t outputs, std::size_t sites,
                           std::size_t differentiated, bool signals_use_block)
    : block_(block),
      frame_(std::move(frame)),
      running_(std::move(running)),
      outputs_(outputs),
      sites_(sites),
      differentiated_(differentiated),
      z_count_(block.states.size() + block.variables.size()),
      signals_use_block_(signals_use_block),
      added_(z_count_ + sites, 0.0),
      frame_outputs_(outputs + block.inputs.size() + block.parameters.size() + z_count_, 0.0),
      frame_signals_((z_count_ + sites) * kSiteSignals, 0.0) {}

std::string FmuEvaluator::trouble() const {
  return running_->trouble().empty() ? frame_->trouble() : running_->trouble();
}

RuntimePoint FmuEvaluator::framed(const RuntimePoint& point) {
  std::ranges::copy(point.added, added_.begin() + static_cast<std::ptrdiff_t>(z_count_));
  RuntimePoint result = point;
  result.added = added_;
  return result;
}

std::span<const double> FmuEvaluator::inputs_at(const RuntimePoint& point) {
  static_cast<void>(frame_->evaluate(RuntimeFunction::outputs, framed(point), frame_outputs_));
  return std::span(frame_outputs_).subspan(outputs_, block_.inputs.size());
}

bool FmuEvaluator::event_before(const RuntimePoint& point) {
  return running_->event_before(point.time_s, point.states, inputs_at(point));
}

bool FmuEvaluator::accept(const RuntimePoint& point) {
  return running_->accept(point.time_s, point.states, inputs_at(point));
}

bool FmuEvaluator::pass_event(const RuntimePoint& point, std::span<double> states) {
  return running_->pass_event(point.time_s, states, inputs_at(point));
}

bool FmuEvaluator::evaluate(RuntimeFunction function, const RuntimePoint& point, std::span<double> values) {
  const RuntimePoint inner = framed(point);
  if (needs_block(function)) {
    if (!frame_->evaluate(RuntimeFunction::outputs, inner, frame_outputs_)) return false;
    const std::span<const double> inputs = std::span(frame_outputs_).subspan(outputs_, block_.inputs.size());
    const BlockValues* block = running_->at(point.time_s, point.states, inputs, {});
    if (block == nullptr) return false;
    std::ranges::copy(block->z, added_.begin());
  }
  if (function == RuntimeFunction::derivatives) return frame_->evaluate(function, inner, values);
  std::vector<double>& all = function == RuntimeFunction::outputs ? frame_outputs_ : frame_signals_;
  if (!frame_->evaluate(function, inner, all)) return false;
  std::copy_n(all.begin() + static_cast<std::ptrdiff_t>(first_row(function)), values.size(), values.begin());
  return true;
}

const RuntimeLinearisation* FmuEvaluator::linearise(RuntimeFunction function, const RuntimePoint& point,
                                                    RuntimeDirections directions) {
  const RuntimePoint inner = framed(point);
  const RuntimeDirections all{.states = directions.states, .parameters = directions.parameters, .added = true};
  const bool through_block = needs_block(function);
  if (through_block) {
    const RuntimeLinearisation* v = frame_->linearise(RuntimeFunction::outputs, inner, all);
    if (v == nullptr) return nullptr;
    const std::size_t inputs = block_.inputs.size();
    const std::span<const double> input_values(v->values.data() + outputs_, inputs);
    if (directions.states) take(v->by_state, outputs_, inputs, 0, v_by_state_);
    if (directions.parameters) take(v->by_parameter, outputs_, inputs, 0, v_by_parameter_);
    if (directions.added) take(v->by_added, outputs_, inputs, z_count_, v_by_added_);
    // Recorded inputs depend on nothing that is asked: then the FMU is spared its derivatives by them.
    const bool by_input = (directions.states && !is_zero(v_by_state_)) ||
                          (directions.parameters && !is_zero(v_by_parameter_)) ||
                          (directions.added && !is_zero(v_by_added_));
    const BlockValues* block = running_->at(point.time_s, point.states, input_values,
                                            {.by_state = directions.states ? 1U : 0U,
                                             .by_input = by_input ? 1U : 0U,
                                             .by_parameter = directions.parameters ? 1U : 0U});
    if (block == nullptr) return nullptr;
    std::ranges::copy(block->z, added_.begin());
    if (directions.states) z_by_state_ = block->by_state;
    if (directions.states && by_input) add_product(block->by_input, 0, v_by_state_, z_by_state_);
    if (directions.parameters) {
      z_by_parameter_ = block->by_parameter;
      if (z_by_parameter_.columns == 0) z_by_parameter_.resize(z_count_, differentiated_);
      if (by_input) add_product(block->by_input, 0, v_by_parameter_, z_by_parameter_);
    }
    if (directions.added) {
      z_by_added_.resize(z_count_, sites_);
      if (by_input) add_product(block->by_input, 0, v_by_added_, z_by_added_);
    }
  }
  const RuntimeLinearisation* frame = frame_->linearise(function, inner, all);
  if (frame == nullptr) return nullptr;
  const std::size_t first = first_row(function);
  const std::size_t rows = function == RuntimeFunction::outputs ? outputs_ : frame->values.size() - first;
  const auto begin = frame->values.begin() + static_cast<std::ptrdiff_t>(first);
  result_.values.assign(begin, begin + static_cast<std::ptrdiff_t>(rows));
  if (directions.states) take(frame->by_state, first, rows, 0, result_.by_state);
  if (directions.parameters) take(frame->by_parameter, first, rows, 0, result_.by_parameter);
  if (directions.added) take(frame->by_added, first, rows, z_count_, result_.by_added);
  if (!through_block) return &result_;
  if (directions.states) add_product(frame->by_added, first, z_by_state_, result_.by_state);
  if (directions.parameters) add_product(frame->by_added, first, z_by_parameter_, result_.by_parameter);
  if (directions.added) add_product(frame->by_added, first, z_by_added_, result_.by_added);
  return &result_;
}

}  // namespace sealwatch::fmi
