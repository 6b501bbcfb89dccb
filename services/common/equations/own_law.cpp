#include "services/common/equations/own_law.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "sealwatch/core/text.hpp"
#include "sealwatch/model/law_sizes.hpp"
#include "services/common/equations/site_table.hpp"
#include "services/common/equations/tape.hpp"

namespace sealwatch::equations {
namespace {

// Variables of a law: signals, hidden state, parameters; the directions of LawScalar.
constexpr std::size_t kHidden = kSiteSignals, kParameters = kSiteSignals + 1;

Error fault(std::string value, std::string rule, std::string advice = {}) {
  return {.file = {}, .place = {}, .value = std::move(value), .rule = std::move(rule), .advice = std::move(advice)};
}

class LawNames final : public Names {
 public:
  explicit LawNames(Expressions& expressions) : expressions_(expressions) {}
  void add(const std::string& name, const Dimension& unit, std::size_t variable) {
    known_[name] = {expressions_.variable(variable), unit, false};
    names_.push_back(name);
  }
  Result<Formula> quantity(const std::string& name) override {
    const auto known = known_.find(name);
    if (known != known_.end()) return known->second;
    return fail(fault(name, "is neither a signal of the site nor a parameter of the law", suggest(name, names_)));
  }
  std::optional<Result<Formula>> call(const std::string&, const std::vector<Syntax>&) override { return std::nullopt; }
  std::vector<std::string> functions() const override { return {}; }

 private:
  Expressions& expressions_;
  std::map<std::string, Formula> known_;
  std::vector<std::string> names_;
};

/// Contribution and rate with their slopes by all variables.
struct LawTape {
  Tape tape;
  void evaluate(const LawInput& in, LawOutput& out) const {
    thread_local std::vector<double> registers;
    registers = tape.registers();
    std::array<const LawScalar*, kLawDirections> inputs{};
    for (std::size_t k = 0; k < kSiteSignals; ++k) inputs[k] = &in.signal[k];
    inputs[kHidden] = &in.hidden;
    for (std::size_t k = 0; k < kLawParameters; ++k) inputs[kParameters + k] = &in.parameter[k];
    for (std::size_t k = 0; k < inputs.size(); ++k) registers[k] = inputs[k]->value;
    tape.run(registers);
    std::size_t result = 0;
    for (LawScalar* to : {&out.contribution, &out.rate}) {
      *to = LawScalar(tape.result(registers, result++));
      for (const LawScalar* input : inputs) {
        const double slope = tape.result(registers, result++);
        if (slope == 0.0) continue;
        for (std::size_t d = 0; d < to->derivative.size(); ++d) to->derivative[d] += slope * input->derivative[d];
      }
    }
  }
};

LawTape compile(Expressions& expressions, Node contribution, Node rate) {
  std::vector<Node> results;
  for (const Node of : {contribution, rate}) {
    results.push_back(of);
    for (std::size_t k = 0; k < kLawDirections; ++k) results.push_back(expressions.derivative(of, k));
  }
  return {Tape(expressions, results, std::vector<bool>(kLawDirections, false))};
}

const TextSite* site_of(const TextLaw& law, const TextPlant& plant, const Faults& faults) {
  const TextSite* found = nullptr;
  std::vector<std::string> elements;
  for (const TextSite& site : plant.sites) {
    elements.push_back(site.element);
    if (site.element != law.element || (law.kind && *law.kind != site.kind)) continue;
    if (found != nullptr && found->kind != site.kind) {
      faults(law.key + ".element", fault(law.element, "has sites of several kinds", "give the law's kind"));
      return nullptr;
    }
    found = &site;
  }
  if (found == nullptr)
    faults(law.key + ".element", fault(law.element, "has no site for the law", suggest(law.element, elements)));
  return found;
}

// At no strength a law is absent, and it grows with its strengths.
bool is_proportional(const Law& law) {
  std::array<double, kSiteSignals> signals{0.3, 0.7, 1.1, 1.3};
  std::vector<double> once, twice, none;
  for (const LawParameter& parameter : law.parameters) {
    const double start = parameter.start.front() == 0.0 ? 1.0 : parameter.start.front();
    once.push_back(start);
    twice.push_back(parameter.strength ? 2.0 * start : start);
    none.push_back(parameter.strength ? 0.0 : start);
  }
  const auto of = [&](const std::vector<double>& parameters) {
    return law.evaluate(law_input(signals, 0.5, parameters, {})).contribution.value;
  };
  const double a = of(once), b = of(twice), c = of(none);
  return std::abs(c) <= 1e-9 * std::abs(a) && std::abs(b - 2.0 * a) <= 1e-9 * std::abs(a);
}

void add_parameters(const TextLaw& text, Law& law) {
  for (const TextLawParameter& row : text.parameters)
    law.parameters.push_back({.name = kept(row.name),
                              .unit = kept(row.unit),
                              .meaning = kept(row.meaning),
                              .start = row.start,
                              .min = row.min,
                              .max = row.max,
                              .strength = row.strength,
                              .significant = row.significant,
                              .own_size = true});
}

}  // namespace

std::optional<Law> build_law(const TextLaw& text, const TextPlant& plant, const Faults& faults) {
  const TextSite* site = site_of(text, plant, faults);
  if (site == nullptr) return std::nullopt;
  bool sound = true;
  const auto refuse = [&](const std::string& key, const Error& error) {
    sound = false;
    faults(text.key + key, error);
  };
  const auto unit_of = [&](const std::string& key, const std::string& unit) {
    const Result<Dimension> found = find_dimension(unit);
    if (!found) refuse(key, found.error());
    return found.value_or(Dimension{});
  };
  Expressions expressions;
  LawNames names(expressions);
  const SiteNames& known = names_of_site(site->kind);
  for (std::size_t k = 0; k < site->signals.size(); ++k) {
    const TextSignal& signal = site->signals[k];
    std::size_t place = k;
    for (std::size_t s = 0; site->kind != SiteKind::own && s < kSiteSignals; ++s)
      if (known.signals[s].name == signal.name) place = s;
    names.add(signal.name, find_dimension(signal.unit).value_or(Dimension{}), place);
  }
  if (text.parameters.size() > kLawParameters)
    refuse(".parameters", fault(text.id, "has more than " + std::to_string(kLawParameters) + " parameters"));
  for (std::size_t k = 0; k < std::min(kLawParameters, text.parameters.size()); ++k)
    names.add(text.parameters[k].name, unit_of(".parameters." + text.parameters[k].name, text.parameters[k].unit),
              kParameters + k);
  if (!text.hidden.empty()) names.add(text.hidden, unit_of(".hidden.unit", text.hidden_unit), kHidden);
  if (!sound) return std::nullopt;
  const auto contribution = understand(text.equation, expressions, names, unit_of("", site->unit));
  if (!contribution) refuse(".equation", contribution.error());
  Result<Formula> rate = Formula{expressions.constant(0.0), Dimension{}, true};
  if (!text.hidden.empty())
    rate = understand(text.hidden_rate, expressions, names,
                      multiply(unit_of(".hidden.unit", text.hidden_unit), *find_dimension("s"), -1.0));
  if (!rate) refuse(".hidden.rate", rate.error());
  if (!sound) return std::nullopt;
  Law law{.id = kept(text.id),
          .form = "",
          .kind = site->kind,
          .equation = kept(text.equation),
          .meaning = kept(text.meaning),
          .energy = kept(text.energy),
          .source = kept("the plant's own"),
          .parameters = {},
          .evaluate = {},
          .plant = kept(plant.name),
          .element = kept(text.element)};
  add_parameters(text, law);
  if (!text.hidden.empty())
    law.hidden = HiddenState{.name = kept(text.hidden),
                             .unit = kept(text.hidden_unit),
                             .scale = text.hidden_size,
                             .free_initial = text.hidden_own,
                             .settled = text.hidden_settles};
  law.evaluate = [tape = compile(expressions, contribution->node, rate->node)](const LawInput& input) {
    LawOutput output;
    tape.evaluate(input, output);
    return output;
  };
  law.expressions =
      std::make_shared<const LawExpressions>(LawExpressions{std::move(expressions), contribution->node, rate->node});
  if (std::ranges::none_of(law.parameters, &LawParameter::strength))
    refuse(".parameters", fault(text.id, "has no strength", "say strength: true where the law is proportional to it"));
  else if (!is_proportional(law))
    refuse(".equation", fault(text.equation, "is not proportional to its strengths",
                              "with all strengths 0 the law has to be absent, with twice as much twice as strong"));
  std::vector<std::string> parameters;
  for (const TextLawParameter& parameter : text.parameters) parameters.push_back(parameter.name);
  if (find_law(text.id, parameters))
    refuse(".id", fault(text.id, "is a law of the catalogue with the same parameters", "give it another id"));
  return sound ? std::optional(std::move(law)) : std::nullopt;
}

std::vector<NeededSize> needed_sizes(const TextPlant& plant) {
  std::map<std::string_view, NeededSize> sizes;
  for (const TextSite& site : plant.sites)
    for (const Law& law : all_laws()) {
      if (!law.plant.empty() || !fits(law, site.site()) || is_inert(law, site.site())) continue;
      for (const LawParameter& parameter : law.parameters) {
        if (parameter.unit == "1") continue;
        NeededSize& size = sizes[parameter.unit];
        if (size.parameter == nullptr || (parameter.strength && !size.parameter->strength))
          size = {std::string(parameter.unit), &law, &parameter};
      }
    }
  std::vector<NeededSize> needed;
  for (auto& [unit, size] : sizes) needed.push_back(std::move(size));
  return needed;
}

}  // namespace sealwatch::equations
