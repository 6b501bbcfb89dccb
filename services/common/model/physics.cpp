#include "sealwatch/model/physics.hpp"

#include <algorithm>
#include <mutex>
#include <set>

#include "sealwatch/core/process_copy.hpp"
#include "sealwatch/core/text.hpp"

namespace sealwatch {
namespace {

bool has_parameters(const Law& law, const std::vector<std::string>& names) {
  return names.size() == law.parameters.size() && std::ranges::all_of(law.parameters, [&](const LawParameter& known) {
           return std::ranges::find(names, known.name) != names.end();
         });
}

std::string parameter_list(const Law& law) {
  std::string text;
  for (const LawParameter& parameter : law.parameters) {
    if (!text.empty()) text += ", ";
    text += parameter.name;
  }
  return text;
}

}  // namespace

std::deque<Law>& law_catalogue();  // made by the build

const std::deque<Law>& all_laws() { return law_catalogue(); }

void add_law(Law law) { law_catalogue().push_back(std::move(law)); }

std::string_view kept(std::string_view text) {
  static FreeInCopies mutex;
  const std::scoped_lock lock(mutex);
  static std::set<std::string, std::less<>> texts;  // made under the lock: a copy would wait for who makes it
  const auto known = texts.find(text);
  return known != texts.end() ? *known : *texts.emplace(text).first;
}

Result<const Law*> find_law(std::string_view id, const std::vector<std::string>& parameter_names,
                            std::string_view plant) {
  std::vector<std::string> ids;
  std::string forms;
  for (const Law& law : all_laws()) {
    if (!law.plant.empty() && law.plant != plant) continue;
    ids.emplace_back(law.id);
    if (law.id != id) continue;
    if (has_parameters(law, parameter_names)) return &law;
    if (!forms.empty()) forms += " or ";
    forms += parameter_list(law);
  }
  if (forms.empty())
    return fail(Error{.file = {},
                      .place = "physics",
                      .value = std::string(id),
                      .rule = "is not a law of the catalogue",
                      .advice = suggest(id, ids)});
  std::string rule = "needs exactly the parameters ";
  rule += forms;
  return fail(Error{.file = {}, .place = "physics", .value = std::string(id), .rule = std::move(rule), .advice = {}});
}

LawInput law_input(std::span<const double> signals, double hidden, std::span<const double> parameters,
                   const Roundings& roundings) {
  LawInput input;
  input.rounding = roundings;
  auto set = [direction = std::size_t{0}](LawScalar& variable, double value) mutable {
    variable.value = value;  // in place: this runs in every evaluation of every law
    variable.derivative[direction++] = 1.0;
  };
  for (std::size_t k = 0; k < kSiteSignals; ++k) set(input.signal[k], k < signals.size() ? signals[k] : 0.0);
  set(input.hidden, hidden);
  for (std::size_t k = 0; k < parameters.size(); ++k) set(input.parameter[k], parameters[k]);
  return input;
}

}  // namespace sealwatch
