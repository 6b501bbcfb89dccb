#include "services/common/model/runtime_system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "sealwatch/core/rate_unit.hpp"
#include "services/common/text/format.hpp"

namespace sealwatch {
namespace {

constexpr double kNotKnown = std::numeric_limits<double>::quiet_NaN();

/// The mean load, which every recording scales by a factor of its own; null: the plant has none.
const ParameterDescription* load_parameter(const PlantDescription& plant) {
  return plant.find_parameter(plant.load_parameter);
}

/// to += factor * from
void add(double factor, const double* from, std::size_t count, double* to) {
  if (factor == 0.0) return;
  for (std::size_t k = 0; k < count; ++k) to[k] += factor * from[k];
}

}  // namespace

FreeColumns free_columns(const PlantDescription& plant, const ModelValues& values, std::span<const FreeQuantity> free) {
  const ParameterDescription* load = load_parameter(plant);
  const auto load_index =
      load == nullptr ? plant.parameters.size() : static_cast<std::size_t>(load - plant.parameters.data());
  FreeColumns columns;
  columns.count = free.size();
  for (std::size_t k = 0; k < free.size(); ++k) {
    const FreeQuantity& quantity = free[k];
    if (quantity.kind == FreeQuantity::Kind::initial_state) continue;
    const bool factor_of_load = quantity.kind == FreeQuantity::Kind::load_factor;
    const std::size_t index = factor_of_load ? load_index : quantity.index;
    if (!factor_of_load && index >= plant.parameters.size()) {
      columns.of_law.push_back({k, index});
      continue;
    }
    double factor = 1.0;
    if (index == load_index) factor = factor_of_load ? values.parameters[index] : 1.0 + values.load_factor;
    const auto known = std::ranges::find(columns.differentiated, index);
    const auto place = static_cast<std::size_t>(known - columns.differentiated.begin());
    if (known == columns.differentiated.end()) columns.differentiated.push_back(index);
    columns.of_plant.push_back({k, place, factor});
  }
  return columns;
}

std::vector<double> effective_parameters(const PlantDescription& plant, const ModelValues& values) {
  std::vector<double> parameters(values.parameters.begin(),
                                 values.parameters.begin() + static_cast<std::ptrdiff_t>(plant.parameters.size()));
  if (const ParameterDescription* load = load_parameter(plant))
    parameters[static_cast<std::size_t>(load - plant.parameters.data())] *= 1.0 + values.load_factor;
  return parameters;
}

void RuntimeSystem::Rows::resize(std::size_t rows, std::size_t states, std::size_t free) {
  values.assign(rows, 0.0);
  by_state.resize(rows, states);
  by_free.resize(rows, free);
}

void RuntimeSystem::Rows::clear() {
  std::ranges::fill(values, 0.0);
  std::ranges::fill(by_state.values, 0.0);
  std::ranges::fill(by_free.values, 0.0);
}

RuntimeSystem::RuntimeSystem(const RuntimePlant& plant, std::unique_ptr<RuntimeEvaluator> evaluator,
                             const RecordedInput& input, const PhysicsTerms& terms, const ModelValues& values,
                             FreeColumns free, InjectedColumns* injected)
    : plant_(plant),
      evaluator_(std::move(evaluator)),
      input_(input),
      free_(std::move(free)),
      injected_(injected),
      plant_states_(plant.states.size()),
      hidden_states_(terms.hidden_names.size()),
      sites_(plant.description.sites.size()),
      columns_(1 + free_.count + (injected == nullptr ? 0 : injected->columns())),
      signals_see_added_(plant.equations->signals_see_added()),
      parameters_(effective_parameters(plant.description, values)),
      terms_at_site_(sites_),
      hidden_scales_(terms.hidden_scales),
      inputs_(plant.inputs.size(), 0.0),
      input_rates_(plant.inputs.size(), 0.0),
      hidden_(hidden_states_, 0.0),
      signal_values_(sites_ * kSiteSignals, 0.0),
      state_(static_cast<std::size_t>(states()), 0.0),
      outputs_(plant.outputs.size() * columns_, 0.0),
      last_rates_(static_cast<std::size_t>(states()), 0.0),
      weights_(injected) {
  for (const ActiveTerm& active : terms.active) {
    Term term{.active = &active, .parameters = {}, .free = {}};
    for (std::size_t k = 0; k < active.law->parameters.size(); ++k)
      term.parameters.push_back(values.parameters[active.first_parameter + k]);
    for (const FreeColumns::OfLaw& of_law : free_.of_law)
      if (of_law.parameter >= active.first_parameter &&
          of_law.parameter < active.first_parameter + term.parameters.size())
        term.free.push_back({of_law.parameter - active.first_parameter, of_law.column});
    for (const std::size_t site : active.sites) terms_at_site_[site].push_back(terms_.size());
    terms_.push_back(std::move(term));
  }
  added_.resize(sites_, state_.size(), free_.count);
  hidden_rates_.resize(hidden_states_, state_.size(), free_.count);
}

std::vector<double> RuntimeSystem::scale(double relative_tolerance) const {
  std::vector<double> scale;
  for (const RuntimeState& state : plant_.states) scale.push_back(state.scale);
  for (const double hidden : hidden_scales_) scale.push_back(kHiddenShare * hidden);
  for (double& value : scale) value *= relative_tolerance / 1e-6;
  return scale;
}

std::vector<bool> RuntimeSystem::settled() const {
  std::vector<bool> settles;
  for (const RuntimeState& state : plant_.states) settles.push_back(state.settles);
  settles.resize(state_.size(), false);
  for (const Term& term : terms_)
    if (term.active->hidden >= 0 && term.active->law->hidden->settled)
      settles[plant_states_ + static_cast<std::size_t>(term.active->hidden)] = true;
  return settles;
}

bool RuntimeSystem::start(std::span<const FreeQuantity> free, double* y, double* point, std::size_t stride) const {
  if (std::ranges::none_of(plant_.states, &RuntimeState::by_equations)) return true;
  RuntimeMatrix by_parameter;
  std::vector<double> states(y, y + plant_states_);
  if (!evaluator_->start(states, by_parameter)) return false;
  for (std::size_t row = 0; row < plant_states_; ++row) {
    const bool is_free = std::ranges::any_of(free, [&](const FreeQuantity& one) {
      return one.kind == FreeQuantity::Kind::initial_state && one.index == row;
    });
    if (!plant_.states[row].by_equations || is_free) continue;
    y[row] = states[row];
    for (const FreeColumns::OfPlant& of : free_.of_plant)
      point[row * stride + 1 + of.column] = of.factor * by_parameter.row(row)[of.differentiated];
  }
  return true;
}

std::string RuntimeSystem::trouble() const {
  if (std::string words = evaluator_->trouble(); !words.empty()) return words;
  const std::vector<double> sizes = scale(1e-6);
  std::size_t fastest = 0;
  for (std::size_t k = 0; k < plant_states_; ++k) {
    if (!std::isfinite(last_rates_[k])) return "d " + plant_.description.states[k].name + "/dt is not a finite number";
    if (std::abs(last_rates_[k]) / sizes[k] > std::abs(last_rates_[fastest]) / sizes[fastest]) fastest = k;
  }
  if (plant_states_ == 0) return {};
  const StateDescription& state = plant_.description.states[fastest];
  return text::format("{} moves fastest, by {:.3g} {}", state.name, last_rates_[fastest], rate_unit(state.unit));
}

void RuntimeSystem::set_segment(std::size_t segment) {
  segment_ = segment;
  weights_.forget();
}

void RuntimeSystem::note(std::span<const double> rates) const { std::ranges::copy(rates, last_rates_.begin()); }

void RuntimeSystem::locate(double t, const double* y, std::size_t segment) const {
  for (std::size_t k = 0; k < inputs_.size(); ++k) {
    inputs_[k] = input_.value(k, t, segment, cursor_);
    input_rates_[k] = input_.slope(k, t, cursor_);
  }
  std::copy(y + plant_states_, y + state_.size(), hidden_.begin());
  point_ = {.time_s = t,
            .states = {y, plant_states_},
            .inputs = inputs_,
            .input_rates = input_rates_,
            .parameters = parameters_,
            .added = added_.values};
}

// Values of all signals at the point, with their slopes where they are asked for; null: there are none.
const double* RuntimeSystem::signals(bool differentiate) const {
  if (differentiate) {
    const RuntimeDirections directions{
        .states = true, .parameters = !free_.of_plant.empty(), .added = signals_see_added_};
    signal_slopes_ = evaluator_->linearise(RuntimeFunction::signals, point_, directions);
    return signal_slopes_ == nullptr ? nullptr : signal_slopes_->values.data();
  }
  return evaluator_->evaluate(RuntimeFunction::signals, point_, signal_values_) ? signal_values_.data() : nullptr;
}

// What the laws in force add, site by site, as signals of a site may depend on what is added at earlier ones.
bool RuntimeSystem::add_laws(bool differentiate) const {
  added_.clear();
  hidden_rates_.clear();
  const double* seen = nullptr;
  for (std::size_t site = 0; site < sites_; ++site) {
    if (terms_at_site_[site].empty()) continue;
    if (seen == nullptr || signals_see_added_) seen = signals(differentiate);
    if (seen == nullptr) return false;
    for (const std::size_t index : terms_at_site_[site]) {
      const Term& term = terms_[index];
      const int hidden = term.active->hidden;
      const double memory = hidden < 0 ? 0.0 : hidden_[static_cast<std::size_t>(hidden)];
      const std::span at(seen + site * kSiteSignals, kSiteSignals);
      const LawOutput output =
          term.active->law->evaluate(law_input(at, memory, term.parameters, term.active->roundings));
      added_.values[site] += output.contribution.value;
      if (differentiate) add_law(output.contribution, term, site, added_, site);
      if (hidden < 0 || site != term.active->sites.back()) continue;
      hidden_rates_.values[static_cast<std::size_t>(hidden)] = output.rate.value;
      if (differentiate) add_law(output.rate, term, site, hidden_rates_, static_cast<std::size_t>(hidden));
    }
  }
  return true;
}

// Chain rule: what a law gives depends on the signals of its site, on its hidden state and on its parameters.
void RuntimeSystem::add_law(const LawScalar& law, const Term& term, std::size_t site, Rows& to, std::size_t row) const {
  double* by_state = to.by_state.row(row);
  double* by_free = to.by_free.row(row);
  for (std::size_t s = 0; s < kSiteSignals; ++s) {
    const double slope = law.derivative[s];
    if (slope == 0.0) continue;
    const std::size_t signal = site * kSiteSignals + s;
    add(slope, signal_slopes_->by_state.row(signal), plant_states_, by_state);
    for (const FreeColumns::OfPlant& free : free_.of_plant)
      by_free[free.column] += slope * free.factor * signal_slopes_->by_parameter.row(signal)[free.differentiated];
    for (std::size_t earlier = 0; signals_see_added_ && earlier < site; ++earlier) {
      const double through = slope * signal_slopes_->by_added.row(signal)[earlier];
      add(through, added_.by_state.row(earlier), state_.size(), by_state);
      add(through, added_.by_free.row(earlier), free_.count, by_free);
    }
  }
  if (term.active->hidden >= 0)
    by_state[plant_states_ + static_cast<std::size_t>(term.active->hidden)] += law.derivative[kSiteSignals];
  for (const Term::Free& free : term.free) by_free[free.column] += law.derivative[kSiteSignals + 1 + free.parameter];
}

bool RuntimeSystem::event_before(double t, const double* y) const {
  locate(t, y, segment_);
  return evaluator_->event_before(point_);
}

bool RuntimeSystem::accept(double t, const double* y) const {
  locate(t, y, segment_);
  return evaluator_->accept(point_);
}

RuntimeSystem::Passed RuntimeSystem::pass_event(double t, double* y) const {
  constexpr double kSmooth = 1e-6;  // of the rates
  const std::size_t count = state_.size();
  const std::vector<double> before(y, y + count);
  std::vector<double> rates_before(count), rates_after(count);
  evaluate(t, y, rates_before.data());
  locate(t, y, segment_);
  if (!evaluator_->pass_event(point_, {y, plant_states_})) return Passed::failed;
  evaluate(t, y, rates_after.data());
  bool smooth = std::equal(before.begin(), before.end(), y);
  for (std::size_t k = 0; k < count; ++k)
    smooth = smooth && std::abs(rates_after[k] - rates_before[k]) <=
                           kSmooth * std::max(std::abs(rates_after[k]), std::abs(rates_before[k]));
  return smooth ? Passed::smooth : Passed::jump;
}

void RuntimeSystem::evaluate(double t, const double* y, double* f) const {
  locate(t, y, segment_);
  const bool known =
      add_laws(false) && evaluator_->evaluate(RuntimeFunction::derivatives, point_, std::span(f, plant_states_));
  if (!known) return std::fill_n(f, state_.size(), kNotKnown), void();
  std::ranges::copy(hidden_rates_.values, f + plant_states_);
  note({f, state_.size()});
}

void RuntimeSystem::linearise(double t, const double* y, double* f, DynamicMatrix& jacobian) const {
  locate(t, y, segment_);
  const RuntimeDirections directions{.states = true, .parameters = false, .added = !terms_.empty()};
  const RuntimeLinearisation* slopes =
      add_laws(true) ? evaluator_->linearise(RuntimeFunction::derivatives, point_, directions) : nullptr;
  if (slopes == nullptr) return std::fill_n(f, state_.size(), kNotKnown), void();
  std::copy(slopes->values.begin(), slopes->values.end(), f);
  std::ranges::copy(hidden_rates_.values, f + plant_states_);
  note({f, state_.size()});
  for (std::size_t row = 0; row < plant_states_; ++row) {
    double* to = jacobian[row].data();
    std::fill_n(to, state_.size(), 0.0);
    std::copy_n(slopes->by_state.row(row), plant_states_, to);
    for (std::size_t site = 0; directions.added && site < sites_; ++site)
      add(slopes->by_added.row(row)[site], added_.by_state.row(site), state_.size(), to);
  }
  for (std::size_t row = 0; row < hidden_states_; ++row)
    std::copy_n(hidden_rates_.by_state.row(row), state_.size(), jacobian[plant_states_ + row].data());
}

void RuntimeSystem::add_parameter_derivatives(double t, const double* y, double factor, double* x,
                                              std::size_t stride) const {
  if (free_.of_plant.empty() && free_.of_law.empty() && injected_ == nullptr) return;
  locate(t, y, segment_);
  const bool added = !terms_.empty() || injected_ != nullptr;
  const RuntimeDirections directions{.states = false, .parameters = !free_.of_plant.empty(), .added = added};
  const RuntimeLinearisation* slopes = nullptr;
  std::span<const double> weights;
  if (add_laws(true)) {
    if (injected_ != nullptr) weights = weigh(t);
    slopes = evaluator_->linearise(RuntimeFunction::derivatives, point_, directions);
  }
  for (std::size_t row = 0; row < plant_states_; ++row) {
    double* to = x + row * stride + 1;
    if (slopes == nullptr) {
      std::fill_n(to, columns_ - 1, kNotKnown);
      continue;
    }
    for (const FreeColumns::OfPlant& free : free_.of_plant)
      to[free.column] += factor * free.factor * slopes->by_parameter.row(row)[free.differentiated];
    for (std::size_t site = 0; !terms_.empty() && site < sites_; ++site)
      add(factor * slopes->by_added.row(row)[site], added_.by_free.row(site), free_.count, to);
    for (std::size_t e = 0; e < weights.size(); ++e) {
      const auto [column, site] = injected_->entries()[e];
      to[free_.count + column] += factor * slopes->by_added.row(row)[site] * weights[e];
    }
  }
  for (std::size_t row = 0; row < hidden_states_; ++row)
    add(factor, hidden_rates_.by_free.row(row), free_.count, x + (plant_states_ + row) * stride + 1);
}

// Weights of the injected columns at the point.
std::span<const double> RuntimeSystem::weigh(double t) const {
  using Values = std::array<double, kSiteSignals>;
  std::vector<Values> of_site(sites_);
  const double* seen = signals(false);
  for (std::size_t site = 0; seen != nullptr && site < sites_; ++site)
    std::copy_n(seen + site * kSiteSignals, kSiteSignals, of_site[site].begin());
  return weights_.weigh(t, of_site);
}

// Without states no step was taken: they are known at the point alone.
std::span<const double> RuntimeSystem::weights_at(double t) const { return states() == 0 ? weigh(t) : weights_.at(t); }

// An output that a held input drives directly belongs to the input of its own sample, not to that of the sample before.
// Where there are events the sample comes after that of the jump, in the segment which begins there.
bool RuntimeSystem::linearise_outputs(double t, const double* point, std::size_t stride) const {
  const bool next = !has_events() && segment_ + 1 < input_.segment_count() && t >= input_.segment_end(segment_);
  for (std::size_t k = 0; k < state_.size(); ++k) state_[k] = point[k * stride];
  locate(t, state_.data(), next ? segment_ + 1 : segment_);
  const bool differentiate = columns_ > 1;
  if (!add_laws(differentiate)) return false;
  std::span<const double> weights;
  if (injected_ != nullptr) weights = weights_at(t);
  const RuntimeDirections directions{.states = differentiate,
                                     .parameters = !free_.of_plant.empty(),
                                     .added = differentiate && (!terms_.empty() || injected_ != nullptr)};
  const RuntimeLinearisation* slopes = evaluator_->linearise(RuntimeFunction::outputs, point_, directions);
  if (slopes == nullptr) return false;
  std::ranges::fill(outputs_, 0.0);
  for (std::size_t row = 0; row < plant_.outputs.size(); ++row) {
    double* to = outputs_.data() + row * columns_;
    to[0] = slopes->values[row];
    std::vector<double> by_state(state_.size(), 0.0);
    if (differentiate) std::copy_n(slopes->by_state.row(row), plant_states_, by_state.begin());
    for (std::size_t site = 0; directions.added && site < sites_; ++site) {
      const double by_added = slopes->by_added.row(row)[site];
      add(by_added, added_.by_state.row(site), state_.size(), by_state.data());
      add(by_added, added_.by_free.row(site), free_.count, to + 1);
    }
    for (std::size_t k = 0; k < by_state.size(); ++k) add(by_state[k], point + k * stride + 1, columns_ - 1, to + 1);
    for (const FreeColumns::OfPlant& free : free_.of_plant)
      to[1 + free.column] += free.factor * slopes->by_parameter.row(row)[free.differentiated];
    for (std::size_t e = 0; e < weights.size(); ++e) {
      const auto [column, site] = injected_->entries()[e];
      to[1 + free_.count + column] += slopes->by_added.row(row)[site] * weights[e];
    }
  }
  return true;
}

void RuntimeSystem::outputs(std::span<const int> which, double t, const double* point, std::size_t stride,
                            double* signals) const {
  if (!linearise_outputs(t, point, stride)) std::ranges::fill(outputs_, kNotKnown);
  for (const int row : which)
    signals = std::copy_n(outputs_.data() + static_cast<std::size_t>(row) * columns_, columns_, signals);
}

}  // namespace sealwatch
