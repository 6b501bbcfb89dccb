// `sealwatch laws`: the catalogue of physics that a model may lack, as the program has it.
#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "sealwatch/core/text.hpp"
#include "services/cli/columns.hpp"
#include "services/cli/commands.hpp"
#include "services/cli/plant_laws.hpp"
#include "services/cli/session.hpp"
#include "services/cli/terminal.hpp"
#include "services/common/mismatch/site_words.hpp"
#include "services/common/text/numbers.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch::cli {
namespace {

/// Where laws of a kind act, by the elements' names in reports: those of the built-in plants with such a site.
std::vector<std::string> elements_of(SiteKind kind) {
  if (is_sensor(kind)) return {"sensor:CHANNEL"};
  if (kind == SiteKind::clock_rate) return {"clock"};
  if (is_of_recording(kind)) return {"input:CHANNEL"};
  std::vector<std::string> names;
  for (const PlantDescription& plant : all_plants())
    for (const Site& site : plant.sites)
      if (site.kind == kind && std::ranges::find(names, site.element) == names.end()) names.emplace_back(site.element);
  return names;
}

/// Of those, the elements at which this law is asked.
std::vector<std::string> elements_of(const Law& law) {
  if (law.kind >= SiteKind::sensor_bias) return elements_of(law.kind);
  std::vector<std::string> names;
  for (const PlantDescription& plant : all_plants())
    for (const Site& site : plant.sites)
      if (fits(law, site) && std::ranges::find(names, site.element) == names.end()) names.emplace_back(site.element);
  return names;
}

/// Whether somebody who writes `asked` means this law: its id, the kind of its site, or an element that it may act at.
bool is_meant(const Law& law, const std::string& asked) {
  if (asked.empty() || asked == law.id || asked == name_of(law.kind)) return true;
  const std::string group = asked.substr(0, asked.find(':') + 1);
  return std::ranges::any_of(elements_of(law), [&](const std::string& element) {
    return element == asked || (!group.empty() && element == group + "CHANNEL");
  });
}

std::vector<const Law*> laws_meant(const std::string& asked) {
  std::vector<const Law*> found;
  for (const Law& law : all_laws())
    if (is_meant(law, asked)) found.push_back(&law);
  std::ranges::stable_sort(found, {}, [](const Law* law) { return std::pair(law->kind, law->closed_form); });
  return found;
}

Error nothing_meant(const std::string& asked) {
  std::vector<std::string> known;
  const auto add = [&](std::string_view name) {
    if (std::ranges::find(known, name) == known.end()) known.emplace_back(name);
  };
  for (const Law& law : all_laws()) {
    add(law.id);
    add(name_of(law.kind));
    for (const std::string& element : elements_of(law.kind)) add(element);
  }
  const std::string near = nearest(asked, known);
  return {.file = {},
          .place = {},
          .value = asked,
          .rule = "is neither a law's id nor an element nor a kind of site",
          .advice = near.empty() ? "`sealwatch laws` lists them all" : "did you mean '" + near + "'?"};
}

std::string sizes_of(const LawParameter& parameter) {
  std::vector<std::string> start;
  for (const double value : parameter.start) start.push_back(text::general(value));
  std::string text = (parameter.strength ? "usual " : "tried ") + text::joined(start, ", ");
  if (parameter.significant > 0.0) text += ", matters from " + text::general(parameter.significant);
  return text + ", range " + text::general(parameter.min) + " to " + text::general(parameter.max);
}

/// Whether laws of both kinds are shown under one heading: the four of a sensor, the three of an input.
bool same_heading(SiteKind a, SiteKind b) {
  return &mismatch::words_of(a) == &mismatch::words_of(b) && elements_of(a) == elements_of(b);
}

void print_heading(SiteKind kind) {
  const mismatch::SiteWords& words = mismatch::words_of(kind);
  std::string heading = "== " + text::joined(elements_of(kind), ", ") + ": " + std::string(words.quantity);
  if (!words.unit.empty()) heading.append(" [").append(words.unit).append("] (").append(name_of(kind)).append(")");
  std::printf("\n");
  print_wrapped(heading, 0);
  std::vector<std::string> seen;
  for (const mismatch::SignalWords& signal : words.signals)
    if (!signal.name.empty())
      seen.push_back((signal.symbol == signal.name ? "" : std::string(signal.symbol) + " ") + std::string(signal.name) +
                     " [" + std::string(signal.unit) + "]");
  if (!seen.empty()) print_wrapped("laws see: " + text::joined(seen, ", "), 3);
}

void print_law(const Law& law, bool whole) {
  std::string name(law.id);
  if (!law.form.empty()) name.append(", ").append(law.form);
  if (law.closed_form) name += " (closed form: tried only where the other laws leave something)";
  std::printf("\n");
  print_wrapped(name, 0);
  print_wrapped(std::string(law.equation), 4);
  print_wrapped(std::string(law.meaning), 4);
  std::vector<TableRow> rows;
  for (const LawParameter& parameter : law.parameters)
    rows.push_back({std::string(parameter.name), "[" + std::string(parameter.unit) + "]",
                    std::string(parameter.meaning) + ": " + sizes_of(parameter)});
  if (law.hidden)
    rows.push_back({std::string(law.hidden->name), "[" + std::string(law.hidden->unit) + "]",
                    std::string("hidden state, starts ") + (law.hidden->free_initial ? "anywhere (estimated)"
                                                            : law.hidden->settled    ? "at its equilibrium"
                                                                                     : "at 0")});
  print_columns(rows, 4);
  if (!whole) return;
  if (law.feeds != Feeds::anything) print_wrapped("only where it feeds a " + std::string(name_of(law.feeds)), 4);
  print_wrapped("physical while: " + std::string(law.energy), 4);
  print_wrapped("source: " + std::string(law.source), 4);
}

nlohmann::ordered_json law_as_json(const Law& law) {
  nlohmann::ordered_json json = {{"id", law.id},
                                 {"form", law.form},
                                 {"site", name_of(law.kind)},
                                 {"elements", elements_of(law)},
                                 {"unit", mismatch::words_of(law.kind).unit},
                                 {"equation", law.equation},
                                 {"meaning", law.meaning},
                                 {"energy", law.energy},
                                 {"source", law.source},
                                 {"closed_form", law.closed_form},
                                 {"hidden", nullptr},
                                 {"parameters", nlohmann::ordered_json::array()}};
  if (law.hidden) json["hidden"] = {{"name", law.hidden->name}, {"unit", law.hidden->unit}};
  for (const LawParameter& parameter : law.parameters)
    json["parameters"].push_back({{"name", parameter.name},
                                  {"unit", parameter.unit},
                                  {"meaning", parameter.meaning},
                                  {"strength", parameter.strength},
                                  {"usual", parameter.start.front()},
                                  {"tried", parameter.start},
                                  {"significant", parameter.significant},
                                  {"min", parameter.min},
                                  {"max", parameter.max}});
  return json;
}

}  // namespace

int run_laws(const LawsOptions& options) {
  const std::vector<const Law*> laws = laws_meant(options.asked);
  if (laws.empty()) return complain(nothing_meant(options.asked)), kBadInput;
  if (options.json) {
    nlohmann::ordered_json result = {{"schema", "sealwatch.laws/1"}, {"laws", nlohmann::ordered_json::array()}};
    for (const Law* law : laws) result["laws"].push_back(law_as_json(*law));
    std::printf("%s\n", result.dump(1).c_str());
    return kOk;
  }
  print_wrapped(
      "Physics that a model may lack. Usual sizes, and those from which an engineer would care (\"matters from\"), are "
      "of plant eha; law_sizes scales them in other plants. SI units; losses are positive.",
      0);
  for (std::size_t k = 0; k < laws.size(); ++k) {
    if (k == 0 || !same_heading(laws[k]->kind, laws[k - 1]->kind)) print_heading(laws[k]->kind);
    print_law(*laws[k], !options.asked.empty());
  }
  if (options.asked.empty())
    std::printf("\n%zu laws. sealwatch laws ID adds the source and the condition that keeps a law physical.\n",
                laws.size());
  return kOk;
}

}  // namespace sealwatch::cli
