#include "services/common/fmi/fmu_host.hpp"

#include <algorithm>
#include <cmath>

namespace sealwatch::fmi {
namespace {

std::vector<Reference> references(const std::vector<Handle>& handles) {
  std::vector<Reference> result;
  for (const Handle& handle : handles) result.push_back(handle.reference);
  return result;
}

void put_outcome(Packer& answer, const EventOutcome& outcome) {
  answer.put(static_cast<std::uint64_t>(outcome.terminate));
  answer.put(static_cast<std::uint64_t>(outcome.values_changed));
  answer.put(outcome.next_time_s);
}

void copy(std::span<const double> from, std::vector<double>& to) { to.assign(from.begin(), from.end()); }

}  // namespace

FmuHost::FmuHost(Setup setup)
    : setup_(std::move(setup)),
      constants_(constants_of(setup_)),
      parameters_(setup_.parameters),
      inputs_(setup_.inputs),
      outputs_(setup_.outputs),
      continuous_inputs_(std::vector<Handle>(setup_.inputs.begin(), setup_.inputs.begin() + setup_.continuous_inputs)),
      states_(elements(setup_.states)),
      indicators_(setup_.event_indicators),
      state_references_(references(setup_.states)),
      derivative_references_(references(setup_.derivatives)),
      state_groups_(column_groups(setup_.dependencies, states_)),
      single_states_(single_columns(states_)),
      single_inputs_(single_columns(continuous_inputs_.size)),
      library_(setup_.library),
      make_(setup_.fmi3 != 0 ? fmi3_instances(library_, setup_) : fmi2_instances(library_, setup_)) {}

void FmuHost::serve(Operation operation, std::span<std::byte> heap) {
  // An answer is put over its request, which is read before.
  switch (operation) {
    case Operation::begin:
      return begin(Unpacker(heap), Packer(heap));
    case Operation::evaluate:
      return evaluate(Unpacker(heap), Packer(heap));
    case Operation::event:
      return event(Unpacker(heap), Packer(heap));
    case Operation::completed_step:
      return completed_step(Unpacker(heap), Packer(heap));
    case Operation::do_step:
      return do_step(Unpacker(heap), Packer(heap));
    case Operation::end:
      return slots_.clear();
    default:
      throw Failure{"unknown request"};
  }
}

void FmuHost::begin(Unpacker request, Packer answer) {
  const auto start_time = request.get<double>(), stop_time = request.get<double>();
  state_steps_ = request.list<double>();
  input_steps_ = request.list<double>();
  const std::vector<double> inputs = request.list<double>();
  const auto slots = request.get<std::uint64_t>();
  const std::vector<double> values = request.list<double>();
  slots_.clear();
  EventOutcome outcome;
  for (std::uint64_t slot = 0; slot < slots; ++slot) {
    slots_.push_back(make_());
    slots_.back()->set_constants(constants_);
    const EventOutcome its = slots_.back()->initialise(
        start_time, stop_time, parameters_, std::span(values).subspan(slot * parameters_.size, parameters_.size),
        inputs_, std::span(inputs).subspan(slot * inputs_.size, inputs_.size));
    if (slot == 0) outcome = its;
  }
  put_outcome(answer, outcome);
  const std::span<double> states = answer.room(states_), nominals = answer.room(states_);
  if (setup_.co_simulation != 0 || states_ == 0) return;
  slots_[0]->get_states(states);
  slots_[0]->get_nominals(nominals);
  for (std::size_t slot = 1; slot < slots_.size(); ++slot) slots_[slot]->get_states(answer.room(states_));
}

void FmuHost::place(FmiInstance& instance, double time, std::span<const double> states,
                    std::span<const double> inputs) {
  instance.set_time(time);
  if (states_ > 0) instance.set_states(states);
  instance.set(continuous_inputs_, inputs.first(continuous_inputs_.size));
}

void FmuHost::read(FmiInstance& instance, std::span<double> derivatives, std::span<double> outputs) {
  if (states_ > 0) instance.get_derivatives(derivatives);
  instance.get(outputs_, outputs);
}

void FmuHost::evaluate(Unpacker request, Packer answer) {
  const auto wanted = request.get<EvaluationRequest>();
  const auto time = request.get<double>();
  copy(request.numbers(states_), state_);
  copy(request.numbers(inputs_.size), input_);
  FmiInstance& model = *slots_.at(0);
  place(model, time, state_, input_);
  const std::span<double> f = answer.room(states_), y = answer.room(outputs_.size), z = answer.room(indicators_);
  read(model, f, y);
  if (indicators_ > 0) model.get_event_indicators(z);
  const auto part = [&](Known known, std::size_t columns) {
    const std::span<double> derivative_part = answer.room(states_ * columns);
    differentiate(known, time, derivative_part, answer.room(outputs_.size * columns));
  };
  grouped_ = wanted.by_state != kOneByOne;
  if (wanted.by_state != 0) part(Known::states, states_);
  if (wanted.by_input != 0) part(Known::inputs, continuous_inputs_.size);
  for (std::size_t slot = 1; wanted.by_parameter != 0 && slot < slots_.size(); ++slot) {
    place(*slots_[slot], time, state_, input_);
    const std::span<double> derivatives = answer.room(states_);
    read(*slots_[slot], derivatives, answer.room(outputs_.size));
  }
}

// A binary may have directional derivatives of some of its variables alone (not of an output that is a state): where it
// refuses, differences take their place from then on.
void FmuHost::differentiate(Known known, double time, std::span<double> by_derivative, std::span<double> by_output) {
  const auto given = [&](std::uint32_t& directional, const std::vector<Reference>& unknowns, std::size_t rows,
                         std::size_t first, std::span<double> part) {
    if (directional == 0) return false;
    try {
      by_directions(known, unknowns, rows, first, part);
    } catch (const Failure&) {
      directional = 0;
    }
    return directional != 0;
  };
  const bool derivatives = given(setup_.state_directional, derivative_references_, states_, 0, by_derivative);
  const bool outputs = given(setup_.output_directional, outputs_.references, outputs_.size, states_, by_output);
  if (!derivatives || (!outputs && outputs_.size > 0))
    by_differences(known, time, derivatives ? std::span<double>() : by_derivative,
                   outputs ? std::span<double>() : by_output);
}

const std::vector<ColumnGroup>& FmuHost::groups_of(Known known) const {
  if (known == Known::inputs) return single_inputs_;
  return grouped_ ? state_groups_ : single_states_;
}

// `first`: the first of these rows among those of all derivatives and outputs.
void FmuHost::by_directions(Known known, const std::vector<Reference>& unknowns, std::size_t rows, std::size_t first,
                            std::span<double> part) {
  const std::vector<Reference>& knowns = known == Known::states ? state_references_ : continuous_inputs_.references;
  const std::size_t columns = known == Known::states ? states_ : continuous_inputs_.size;
  seed_.assign(columns, 0.0);
  column_.assign(rows, 0.0);
  std::ranges::fill(part, 0.0);
  if (rows == 0) return;
  for (const ColumnGroup& group : groups_of(known)) {
    for (const std::uint32_t column : group.columns) seed_[column] = 1.0;
    slots_[0]->directional(unknowns, knowns, seed_, column_);
    for (const std::uint32_t column : group.columns) seed_[column] = 0.0;
    visit_places(group, first + rows, [&](std::size_t row, std::size_t column) {
      if (row >= first && row < first + rows) part[(row - first) * columns + column] = column_[row - first];
    });
  }
}

void FmuHost::by_differences(Known known, double time, std::span<double> derivative_part,
                             std::span<double> output_part) {
  FmiInstance& model = *slots_[0];
  std::vector<double>& point = known == Known::states ? state_ : input_;
  const std::vector<double>& steps = known == Known::states ? state_steps_ : input_steps_;
  const std::size_t columns = known == Known::states ? states_ : continuous_inputs_.size;
  upper_.assign(states_ + outputs_.size, 0.0);
  lower_.assign(states_ + outputs_.size, 0.0);
  const auto read_all = [&](std::vector<double>& values) {
    place(model, time, state_, input_);
    read(model, std::span(values).first(states_), std::span(values).subspan(states_));
  };
  std::ranges::fill(derivative_part, 0.0);
  std::ranges::fill(output_part, 0.0);
  here_ = point;
  width_.assign(columns, 0.0);
  for (const ColumnGroup& group : groups_of(known)) {
    constexpr double kLeast = 1e-7;  // of the value, so that rounding does not show
    const auto step = [&](std::uint32_t column) { return std::max(steps[column], kLeast * std::abs(here_[column])); };
    for (const std::uint32_t column : group.columns) point[column] = here_[column] + step(column);
    read_all(upper_);
    for (const std::uint32_t column : group.columns) {
      const double above = point[column];
      point[column] = here_[column] - step(column);
      width_[column] = above - point[column];
    }
    read_all(lower_);
    for (const std::uint32_t column : group.columns) point[column] = here_[column];
    visit_places(group, states_ + outputs_.size, [&](std::size_t row, std::size_t column) {
      const std::span<double> part = row < states_ ? derivative_part : output_part;
      const std::size_t at = row < states_ ? row : row - states_;
      if (!part.empty()) part[at * columns + column] = (upper_[row] - lower_[row]) / width_[column];
    });
  }
  place(model, time, state_, input_);
}

void FmuHost::event(Unpacker request, Packer answer) {
  const auto time = request.get<double>();
  copy(request.numbers(states_), state_);
  copy(request.numbers(inputs_.size), input_);
  EventOutcome outcome;
  for (std::size_t slot = 0; slot < slots_.size(); ++slot) {
    FmiInstance& model = *slots_[slot];
    model.set_time(time);
    if (states_ > 0) model.set_states(state_);
    model.enter_event_mode();
    model.set(inputs_, input_);
    const EventOutcome its = model.settle_event();
    if (slot == 0) outcome = its;
  }
  put_outcome(answer, outcome);
  const std::span<double> states = answer.room(states_);
  if (states_ > 0) slots_.at(0)->get_states(states);
}

void FmuHost::completed_step(Unpacker request, Packer answer) {
  const auto time = request.get<double>();
  copy(request.numbers(states_), state_);
  copy(request.numbers(inputs_.size), input_);
  place(*slots_.at(0), time, state_, input_);
  const StepOutcome outcome = slots_[0]->completed_step();
  answer.put(static_cast<std::uint64_t>(outcome.event));
  answer.put(static_cast<std::uint64_t>(outcome.terminate));
}

void FmuHost::do_step(Unpacker request, Packer answer) {
  const auto time = request.get<double>(), step = request.get<double>();
  copy(request.numbers(inputs_.size), input_);
  const std::span<const double> last = request.numbers(inputs_.size);
  const std::vector<double> input_at_end(last.begin(), last.end());
  std::span<double> end = answer.room(2);  // whether it ended, and when
  end[0] = 0.0, end[1] = time + step;
  for (std::size_t slot = 0; slot < slots_.size(); ++slot) {
    CoStep done{.terminate = false, .reached_s = time};
    if (step > 0.0) {
      slots_[slot]->set(inputs_, input_);
      done = slots_[slot]->do_step(time, step);
    }
    if (slot == 0) end[0] = done.terminate ? 1.0 : 0.0, end[1] = done.reached_s;
    if (!done.terminate) slots_[slot]->set(inputs_, input_at_end);
    slots_[slot]->get(outputs_, answer.room(outputs_.size));
  }
}

}  // namespace sealwatch::fmi
