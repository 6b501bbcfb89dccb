#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "sealwatch/core/text.hpp"
#include "services/common/equations/derived_sizes.hpp"
#include "services/common/equations/own_law.hpp"
#include "services/common/equations/plant_names.hpp"
#include "services/common/equations/reference_quantity.hpp"
#include "services/common/equations/site_curves.hpp"
#include "services/common/equations/site_table.hpp"
#include "services/common/equations/text_equations.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch::equations {
namespace {

Error fault(std::string value, std::string rule, std::string advice = {}) {
  return {.file = {}, .place = {}, .value = std::move(value), .rule = std::move(rule), .advice = std::move(advice)};
}

class Builder {
 public:
  Builder(const TextPlant& text, const Faults& faults)
      : text_(text),
        faults_([this, &faults](const std::string& key, const Error& error) {
          sound_ = false;
          faults(key, error);
        }),
        names_(text, parts_.expressions, faults_) {}

  std::optional<BuiltPlant> build() {
    names_.check_definitions();
    read_rates();
    read_sites();
    read_outputs();
    if (sound_) check_use();
    check_sizes();
    parts_.start = understand_starts(text_, faults_);
    BuiltPlant built;
    for (const TextLaw& law : text_.laws)
      if (auto made = build_law(law, text_, faults_)) built.laws.push_back(std::move(*made));
    if (sound_) std::ranges::move(curves_at_sites(text_, faults_), std::back_inserter(built.laws));
    if (!sound_) return std::nullopt;
    built.plant = plant();
    return built;
  }

 private:
  Expressions& e() { return parts_.expressions; }

  Node understood(const std::string& key, const std::string& text, const std::optional<Dimension>& unit) {
    const Result<Formula> formula = understand(text, e(), names_, unit);
    if (!formula) faults_(key, formula.error());
    return formula ? formula->node : e().constant(0.0);
  }

  // Nothing where it is no unit, which was told already.
  static std::optional<Dimension> per_second(const std::string& unit) {
    const Result<Dimension> found = find_dimension(unit);
    return found ? std::optional(multiply(*found, *find_dimension("s"), -1.0)) : std::nullopt;
  }

  void read_rates() {
    for (const TextState& state : text_.states) {
      const std::string key = "states." + state.description.name;
      rates_.push_back(understood(key + ".der", state.rate, per_second(state.description.unit)));
      if (state.start.empty())
        faults_(key, fault(state.description.name, "has no start",
                           "give start: an expression of parameters and of channels, whose first value is taken"));
    }
  }

  // What laws see at the sites; the rate of a command follows from the command.
  void read_sites() {
    for (std::size_t k = 0; k < text_.sites.size(); ++k) {
      const TextSite& site = text_.sites[k];
      const SiteNames& names = names_of_site(site.kind);
      std::array<Node, kSiteSignals> nodes{};
      nodes.fill(e().constant(0.0));
      for (std::size_t s = 0; s < site.signals.size(); ++s) {
        const TextSignal& signal = site.signals[s];
        std::size_t place = s;
        for (std::size_t known = 0; site.kind != SiteKind::own && known < kSiteSignals; ++known)
          if (names.signals[known].name == signal.name) place = known;
        const std::string key = site.key + ".signals." + signal.name;
        nodes[place] = understood(key, signal.value, names_.unit_at(key, signal.unit));
      }
      if (site.kind == SiteKind::voltage_command && e().is_constant(nodes[2], 0.0)) nodes[2] = rate_of(nodes[1]);
      for (std::size_t s = 0; s < kSiteSignals; ++s) signals_.push_back(nodes[s]);
      check_order(site, k, nodes);
      add_to_rates(site, k);
    }
  }

  // d/dt of what the inputs drive.
  Node rate_of(Node of) {
    const VariablePlaces& places = names_.places();
    Node sum = e().constant(0.0);
    for (std::size_t k = 0; k < text_.inputs.size(); ++k)
      sum = e().add(sum, e().multiply(e().derivative(of, places.inputs + k), e().variable(places.rates + k)));
    return sum;
  }

  void check_order(const TextSite& site, std::size_t index, const std::array<Node, kSiteSignals>& nodes) {
    const VariablePlaces& places = names_.places();
    const std::vector<bool> used = e().variables_of(nodes, places.count);
    for (std::size_t other = 0; other < text_.sites.size(); ++other) {
      if (!used[places.added + other]) continue;
      parts_.signals_see_added = true;
      if (other >= index)
        faults_(site.key + ".signals",
                fault(site.element, "sees what laws add at " + text_.sites[other].element + ", which comes no earlier",
                      "signals may depend on what is added at sites further up in the file alone"));
    }
  }

  void add_to_rates(const TextSite& site, std::size_t index) {
    const Node added = e().variable(names_.places().added + index);
    const Result<Dimension> unit = find_dimension(site.unit);
    for (const auto& [state, factor] : site.adds_to) {
      const std::string key = site.key + ".adds_to." + state;
      const auto row = std::ranges::find(text_.states, state, [](const TextState& s) { return s.description.name; });
      if (row == text_.states.end()) {
        std::vector<std::string> states;
        for (const TextState& known : text_.states) states.push_back(known.description.name);
        faults_(key, fault(state, "is not a state", suggest(state, states)));
        continue;
      }
      std::optional<Dimension> needed = per_second(row->description.unit);
      needed = needed && unit ? std::optional(multiply(*needed, *unit, -1.0)) : std::nullopt;
      Node& rate = rates_[static_cast<std::size_t>(row - text_.states.begin())];
      rate = e().add(rate, e().multiply(understood(key, factor, needed), added));
    }
  }

  void read_outputs() {
    for (const TextOutput& output : text_.outputs) {
      const std::string key = "outputs." + output.channel.name;
      const std::string& name = output.channel.name;
      if (std::ranges::any_of(text_.inputs, [&](const TextInput& input) { return input.channel.name == name; }))
        faults_(key, fault(name, "is the name of an input too, and a recording has one column for it",
                           "give one of them another name"));
      outputs_.push_back(understood(key + ".value", output.value, names_.unit_at(key + ".unit", output.channel.unit)));
    }
    if (text_.outputs.empty()) faults_("outputs", fault("", "must be given: what is recorded and simulated"));
  }

  // A parameter or a site that nothing depends on is a name that was forgotten.
  void check_use() {
    const VariablePlaces& places = names_.places();
    std::vector<Node> all = rates_;
    all.insert(all.end(), outputs_.begin(), outputs_.end());
    std::vector<Node> with_signals = all;
    with_signals.insert(with_signals.end(), signals_.begin(), signals_.end());
    const std::vector<bool> used = e().variables_of(with_signals, places.count);
    for (std::size_t k = 0; k < text_.parameters.size(); ++k)
      if (!used[places.parameters + k] && !in_start(text_.parameters[k].name))
        faults_("parameters." + text_.parameters[k].name,
                fault(text_.parameters[k].name, "stands in no equation", "use it or leave it out"));
    const std::vector<bool> moved = e().variables_of(all, places.count);
    for (std::size_t k = 0; k < text_.sites.size(); ++k)
      if (!moved[places.added + k])
        faults_(text_.sites[k].key, fault(text_.sites[k].element, "adds to no equation",
                                          "use the site's symbol in an equation, or say adds_to: {state: factor}"));
    for (std::size_t k = 0; k < text_.inputs.size(); ++k)
      if (used[places.inputs + k] || used[places.rates + k]) parts_.used_inputs.push_back(k);
  }

  [[nodiscard]] bool in_start(const std::string& name) const {
    return std::ranges::any_of(text_.states, [&](const TextState& state) {
      return std::ranges::any_of(state.start,
                                 [&](const std::string& start) { return start.find(name) != std::string::npos; });
    });
  }

  /// Sizes go by the unit as it is written: one that no law has would be of nothing.
  void check_units_of_sizes() {
    const std::vector<std::string> known = units_of_sizes();
    for (const auto& [unit, factor] : text_.law_sizes) {
      if (std::ranges::find(known, unit) != known.end()) continue;
      const Result<Dimension> dimension = find_dimension(unit);
      const auto same = std::ranges::find_if(known, [&](const std::string& other) {
        const Result<Dimension> its = find_dimension(other);
        return dimension && its && *its == *dimension;
      });
      faults_("law_sizes." + unit, fault(unit, "is not a unit of any law",
                                         same == known.end() ? suggest(unit, known) : "laws have it as " + *same));
    }
  }

  void check_sizes() {
    check_units_of_sizes();
    std::string missing, there;
    const std::vector<NeededSize> needed = needed_sizes(text_);
    std::vector<std::string> units;
    for (const NeededSize& size : needed) units.push_back(size.unit);
    for (const std::string& unit : sizes_to_give(text_.law_sizes, units)) {
      const NeededSize& size = *std::ranges::find(needed, unit, &NeededSize::unit);
      text::add_to_list(missing, unit);
      text::add_to_list(there, unit + ": " + in_words(reference_quantity(size, text_.sites), unit), "; ");
    }
    if (!missing.empty())
      faults_("law_sizes", fault(missing, "is missing: units of laws that fit the plant's sites",
                                 "divide your machine's usual value by that of the catalogue's actuator, which is " +
                                     there + "; 'sealwatch plant check' then shows the sizes of the laws"));
    for (std::size_t k = 0; k < text_.states.size(); ++k)
      if (!(scale_of(k) > 0.0))
        faults_("states." + text_.states[k].description.name,
                fault(text_.states[k].description.name, "has no size",
                      "give size: how large it usually is; an output that equals it may give its noise_std instead"));
  }

  // Allowed local error of a step: a share of the state's size; without one a share of the noise of the output that
  // shows it, and no more than adds up in a second to the error that a state may have whose derivative it is.
  [[nodiscard]] double scale_of(std::size_t state) const {
    constexpr double kSecond = 1.0;
    if (text_.states[state].size) return kErrorOfSize * *text_.states[state].size;
    double scale = scale_by_noise(state);
    for (std::size_t k = 0; k < rates_.size(); ++k) {
      const double of_integral = text_.states[k].size ? kErrorOfSize * *text_.states[k].size : scale_by_noise(k);
      if (state_at(rates_[k]) == static_cast<int>(state) && of_integral > 0.0)
        scale = std::min(scale, of_integral / kSecond);
    }
    return scale;
  }

  [[nodiscard]] double scale_by_noise(std::size_t state) const {
    constexpr double kOfNoise = 5e-4;
    for (std::size_t k = 0; k < outputs_.size(); ++k)
      if (state_at(outputs_[k]) == static_cast<int>(state)) return kOfNoise * text_.outputs[k].channel.noise_std;
    return 0.0;
  }

  /// The state that a node is; -1: it is none.
  [[nodiscard]] int state_at(Node node) const {
    const Expressions::Entry& entry = parts_.expressions.entries()[node];
    const VariablePlaces& places = names_.places();
    const bool state = entry.operation == Operation::variable && entry.a >= places.states && entry.a < places.inputs;
    return state ? static_cast<int>(entry.a - places.states) : -1;
  }

  RuntimePlant plant() {
    RuntimePlant plant;
    plant.description = description();
    plant.maximum_order = text_.maximum_order;
    plant.whole = {.inputs = {}, .window_s = 0.0, .not_recorded = text_.not_recorded, .record = text_.record};
    for (std::size_t k = 0; k < text_.states.size(); ++k)
      plant.states.push_back({.scale = scale_of(k), .slow = text_.states[k].own, .settles = text_.states[k].settles});
    for (std::size_t k = 0; k < text_.outputs.size(); ++k)
      plant.outputs.push_back({text_.outputs[k].channel.name, state_at(outputs_[k])});
    for (const std::size_t k : parts_.used_inputs) {
      const TextInput& input = text_.inputs[k];
      plant.inputs.push_back({input.channel.name, input.course, input.smoothing_s});
    }
    parts_.places = names_.places();
    const std::vector<bool> seen = e().variables_of(outputs_, parts_.places.count);
    parts_.outputs_see_added = std::any_of(seen.begin() + static_cast<std::ptrdiff_t>(parts_.places.added), seen.end(),
                                           [](bool one) { return one; });
    parts_.derivatives = differentiated(e(), rates_, parts_.places);
    parts_.signals = differentiated(e(), signals_, parts_.places);
    parts_.outputs = differentiated(e(), outputs_, parts_.places);
    plant.equations = std::make_shared<TextEquations>(std::move(parts_));
    return plant;
  }

  [[nodiscard]] PlantDescription description() const {
    PlantDescription plant{.name = text_.name,
                           .meaning = text_.meaning,
                           .channels = {},
                           .parameters = text_.parameters,
                           .states = {},
                           .elements = text_.elements};
    for (const TextInput& input : text_.inputs) plant.channels.push_back(input.channel);
    for (const TextOutput& output : text_.outputs) plant.channels.push_back(output.channel);
    for (const TextState& state : text_.states) plant.states.push_back(state.description);
    for (const TextOutput& output : text_.outputs)
      plant.elements.push_back({"sensor:" + output.channel.name, "measurement of " + output.channel.meaning});
    for (const TextSite& site : text_.sites) plant.sites.push_back(site.site());
    for (const auto& [unit, factor] : text_.law_sizes) plant.law_sizes.push_back({kept(unit), factor});
    plant.window_s = text_.window_s;
    plant.load_parameter = text_.load;
    plant.wear_parameter = text_.wears;
    plant.file = text_.file;
    return plant;
  }

  const TextPlant& text_;
  bool sound_ = true;
  Faults faults_;
  TextEquationsParts parts_;
  PlantNames names_;
  std::vector<Node> rates_, signals_, outputs_;
};

}  // namespace

std::optional<BuiltPlant> build_plant(const TextPlant& text, const Faults& faults) {
  return Builder(text, faults).build();
}

}  // namespace sealwatch::equations
