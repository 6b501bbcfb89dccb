#include "services/common/fmi/export/laws_function.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <sstream>

#include "sealwatch/model/law_sizes.hpp"
#include "services/common/equations/dimension.hpp"
#include "services/common/fmi/export/c_expressions.hpp"
#include "services/common/fmi/export/law_formulas.hpp"

namespace sealwatch::fmi {
namespace {

/// One law at one site, whose place in e[] is `place`.
void put_law(std::ostringstream& out, const ActiveTerm& term, const LawText& formula, const std::string& equation,
             std::string_view element, std::size_t place, bool last) {
  out << "  { /* " << term.law->id << " at " << element << ": " << equation << " */\n";
  for (std::size_t k = 0; k < kSiteSignals; ++k)
    out << "    const double s" << k + 1 << " = s[" << kSiteSignals * place + k << "];\n";
  out << "    const double h = " << (term.hidden < 0 ? "0.0" : "x[PLANT_STATES + " + std::to_string(term.hidden) + "]")
      << ";\n";
  for (std::size_t k = 0; k < kLawParameters; ++k)
    out << "    const double p" << k + 1 << " = "
        << (k < term.law->parameters.size() ? "p[" + std::to_string(term.first_parameter + k) + "]" : "0.0") << ";\n";
  for (std::size_t k = 0; k < kLawRoundings; ++k)
    out << "    const double r" << k + 1 << " = " << c_number(term.roundings[k]) << ";\n";
  out << "    (void)s1, (void)s2, (void)s3, (void)s4, (void)h, (void)p1, (void)p2, (void)p3, (void)p4, (void)r1, "
         "(void)r2, (void)r3;\n"
      << "    e[" << place << "] += " << in_c(formula.contribution) << ";\n";
  if (term.hidden >= 0 && last) out << "    hidden_rates[" << term.hidden << "] = " << in_c(formula.rate) << ";\n";
  out << "  }\n";
}

}  // namespace

Result<std::string> laws_function(const PlantDescription& plant, const PhysicsTerms& terms, const LawsFrame& frame) {
  const std::size_t sites = plant.sites.size();
  std::ostringstream out;
  out << "#define SITES " << frame.first_site + sites << "\n#define PLANT_STATES " << plant.states.size()
      << "\n/* What laws add at the sites, e, and the rates of their hidden states. */\n"
      << frame.head << "  double s[4 * SITES + 1];\n"
      << "  memset(e, 0, (SITES + 1) * sizeof *e);\n  (void)hidden_rates;\n"
      << frame.signals;
  for (std::size_t site = 0; site < sites; ++site) {
    bool first = true;
    for (const ActiveTerm& term : terms.active) {
      if (std::ranges::find(term.sites, site) == term.sites.end()) continue;
      const auto formula = written(*term.law);
      if (!formula)
        return fail(Error{.file = plant.file,
                          .place = {},
                          .value = std::string(term.law->id),
                          .rule = "is a law that is not written in C",
                          .advice = "leave it out of the asset's physics"});
      if (first && frame.signals_see_added) out << frame.signals;
      first = false;
      put_law(out, term, *formula, in_sizes_of(plant, *term.law, term.law->equation), plant.sites[site].element,
              frame.first_site + site, site == term.sites.back());
    }
  }
  out << frame.end;
  return out.str();
}

namespace {

/// Whether a formula has the name, whole.
bool names(const std::string& formula, const std::string& name) {
  const auto is_part = [&](std::size_t at) {
    return at < formula.size() && (std::isalnum(static_cast<unsigned char>(formula[at])) != 0 || formula[at] == '_');
  };
  for (std::size_t at = formula.find(name); at != std::string::npos; at = formula.find(name, at + 1))
    if ((at == 0 || !is_part(at - 1)) && !is_part(at + name.size())) return true;
  return false;
}

}  // namespace

std::vector<equations::Node> signals_seen(equations::TextEquationsParts& parts, const PhysicsTerms& terms,
                                          std::size_t first_site) {
  std::vector<equations::Node> seen(parts.signals.values.size(), parts.expressions.constant(0.0));
  for (const ActiveTerm& term : terms.active) {
    const auto formula = written(*term.law);
    for (const std::size_t site : term.sites)
      for (std::size_t k = 0; k < kSiteSignals; ++k) {
        const std::string name = "s" + std::to_string(k + 1);
        const std::size_t at = kSiteSignals * (first_site + site) + k;
        if (!formula || names(formula->contribution, name) || names(formula->rate, name))
          seen[at] = parts.signals.values[at];
      }
  }
  return seen;
}

std::vector<std::string> left_out(const PhysicsTerms& terms) {
  std::vector<std::string> words;
  for (const RecordingTerm& term : terms.recording)
    words.push_back(term.input.empty() ? "the rate of the recording's clock"
                                       : "the law of the recorded input " + term.input);
  for (const SensorTerm& term : terms.sensors) words.push_back("the law of the sensor of " + term.channel);
  return words;
}

std::optional<std::vector<std::pair<std::string, int>>> whole_powers(const std::string& unit) {
  const auto dimension = equations::find_dimension(unit);
  if (!dimension || std::ranges::any_of(dimension->power, [](double p) { return p != std::round(p); }))
    return std::nullopt;
  constexpr std::array kBase = {"m", "kg", "s", "A", "K", "mol", "cd"};
  std::vector<std::pair<std::string, int>> powers;
  for (std::size_t k = 0; k < kBase.size(); ++k)
    if (dimension->power[k] != 0.0) powers.emplace_back(kBase[k], static_cast<int>(std::lround(dimension->power[k])));
  return powers;
}

}  // namespace sealwatch::fmi
