// A plant as it is written (docs/tutorial-plant.md): plain data, read from a file by services/common/runtime, or made by
// a program. build_plant() understands its expressions, checks names and units and makes a RuntimePlant of it.
#pragma once

#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sealwatch/model/physics.hpp"
#include "sealwatch/model/runtime_equations.hpp"
#include "services/common/equations/formula.hpp"
#include "services/common/equations/site_table.hpp"

namespace sealwatch::equations {

struct TextInput {
  ChannelDescription channel;
  InputCourse course = InputCourse::as_recorded;
  double smoothing_s = 0.0;
};

struct TextOutput {
  ChannelDescription channel;
  std::string value;
};

struct TextState {
  StateDescription description;
  std::string rate;                ///< its time derivative
  std::vector<std::string> start;  ///< the first whose channels are recorded is taken
  std::optional<double> size;      ///< usual size; none: of the output that equals it, from its noise
  bool own = true;                 ///< its initial value is each recording's own
  bool settles = false;
};

struct TextSignal {
  std::string name;
  std::string value;
  std::string unit;                 ///< of a site of kind own
  std::optional<double> size = {};  ///< of a site of kind own, in its unit: how large it usually is
};

struct TextSite {
  std::string element;
  SiteKind kind = SiteKind::own;
  Feeds feeds = Feeds::anything;
  std::string symbol;               ///< in the equations; "": none
  std::string unit;                 ///< of a site of kind own
  std::optional<double> size = {};  ///< of a site of kind own, in its unit: how large what acts there usually is
  std::vector<TextSignal> signals;
  std::vector<std::pair<std::string, std::string>> adds_to;  ///< state and factor
  std::string key;                                           ///< where it stands: "elements.piston.sites[0]"
  [[nodiscard]] Site site() const {
    Site site{kept(element), kind, feeds};
    if (kind != SiteKind::own) {
      for (std::size_t k = 0; k < kSiteSignals; ++k)
        site.absent[k] =
            std::ranges::find(signals, names_of_site(kind).signals[k].name, &TextSignal::name) == signals.end();
      return site;
    }
    site.unit = kept(unit);
    for (std::size_t k = 0; k < std::min(signals.size(), kSiteSignals); ++k)
      site.signals[k] = {kept(signals[k].name), kept(signals[k].unit)};
    return site;
  }
};

struct TextLawParameter {
  std::string name, unit, meaning;
  std::vector<double> start;  ///< the first is usual
  double min = 0.0, max = 0.0;
  double significant = 0.0;
  bool strength = false;
};

struct TextLaw {
  std::string id, element, equation, meaning, energy;
  std::optional<SiteKind> kind;  ///< none: that of the element's only site
  std::vector<TextLawParameter> parameters;
  std::string hidden, hidden_unit, hidden_rate;  ///< "": no hidden state
  double hidden_size = 1.0;
  bool hidden_own = false, hidden_settles = false;
  std::string key;
};

struct TextTable {
  std::string name, x_unit, y_unit;
  std::vector<double> x, y;
};

struct TextPlant {
  std::string name, meaning, file;
  std::vector<TextInput> inputs;
  std::vector<TextOutput> outputs;
  std::vector<ParameterDescription> parameters;
  std::vector<std::pair<std::string, std::string>> definitions;
  std::vector<TextState> states;
  std::vector<ElementDescription> elements;
  std::vector<TextSite> sites;
  std::vector<TextLaw> laws;
  std::vector<TextTable> tables;
  std::map<std::string, double> law_sizes;
  double window_s = 0.0;
  std::string load, wears;
  std::string not_recorded, record;  ///< what drives it and stands in no recording, and what would show that
  int maximum_order = 5;
};

/// Takes a fault: the key under which it stands ("states.v.der") and what is wrong.
using Faults = std::function<void(const std::string& key, const Error& error)>;

struct BuiltPlant {
  RuntimePlant plant;
  std::vector<Law> laws;                  ///< of its own
  std::vector<std::string> remarks = {};  ///< of what is no fault, and may be one
};

/// Nothing where something is wrong, all of which went to `faults`.
[[nodiscard]] std::optional<BuiltPlant> build_plant(const TextPlant& text, const Faults& faults);

}  // namespace sealwatch::equations
