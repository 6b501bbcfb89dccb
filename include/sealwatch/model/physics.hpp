// The catalogue of physics that a plant's model may lack: typed laws, each of which adds one contribution to one
// balance.
//
//   balance of the plant:  ... + contribution(signals, hidden state, parameters),   hidden:  dh/dt = rate(...)
//
// A plant offers sites (model/<plant>.hpp): places in its balances, each of a kind with stated signals and unit. A law
// is written for a kind, so that the same Coulomb friction serves every piston. At strength 0 a law is absent and its
// contribution is zero. `evaluate` works on dual numbers over signals, hidden state and parameters; the simulation
// chains them to whatever it differentiates by.
//
// Signs: losses are positive. A force opposes +x, a torque opposes +omega, a voltage is lost before the winding, a flow
// leaves (chamber) or passes from the first port to the second (pump: 1 to 2, seal: A to B), a drop opposes the flow
// into the chamber.
#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sealwatch/core/result.hpp"
#include "sealwatch/model/dual.hpp"
#include "sealwatch/model/sites.hpp"

namespace sealwatch {

inline constexpr std::size_t kLawParameters = 4;
inline constexpr std::size_t kLawRoundings = 3;
/// Signals, hidden state, parameters: one direction each.
inline constexpr int kLawDirections = static_cast<int>(kSiteSignals + 1 + kLawParameters);
using LawScalar = Dual<kLawDirections>;

/// Widths over which a law rounds its corners, in the sizes of the plant (law_sizes.hpp).
using Roundings = std::array<double, kLawRoundings>;

struct LawInput {
  std::array<LawScalar, kSiteSignals> signal;
  LawScalar hidden;
  std::array<LawScalar, kLawParameters> parameter;
  Roundings rounding{};
};

struct LawOutput {
  LawScalar contribution;  ///< unit of the site
  LawScalar rate;          ///< d hidden / dt
};

struct LawParameter {
  std::string_view name;  ///< "F_c"
  std::string_view unit;
  std::string_view meaning;
  /// Start values: the first is usual. For a strength: its usual size; for a shape: the grid that is searched.
  std::vector<double> start;
  double min = 0.0;  ///< bounds; a strength whose min is 0 can only dissipate (or whatever `energy` says)
  double max = 0.0;
  bool strength = false;  ///< the contribution is proportional to it (all strengths 0: the law is absent)
  /// Size of a strength from which an engineer would care: about 1 % of what the element carries.
  double significant = 0.0;
  bool own_size = false;  ///< of a plant's own law: its numbers are that plant's already
  bool place = false;     ///< around which something acts: a plant of one's own may have it below zero, too
};

/// A width over which a corner is rounded, as large as `eha` has it.
struct LawRounding {
  std::string_view unit;
  double width = 0.0;
  /// The size that a power law measures its signal by, as its texts write it: "1 mm/s". The width is a fixed share of it.
  std::string_view reference = {};
};

struct LawExpressions;  // services/common/equations/own_law.hpp

struct HiddenState {
  std::string_view name;  ///< "bristle"
  std::string_view unit;
  double scale = 1.0;         ///< its usual size
  bool free_initial = false;  ///< each recording's own, estimated (a shaft angle, bristles that were left bent)
  double least = -std::numeric_limits<double>::infinity(), most = std::numeric_limits<double>::infinity();  ///< of that
  bool settled = false;      ///< starts at its equilibrium; otherwise at 0
  bool shaft_angle = false;  ///< integral of the site's speed; the law's second parameter counts periods in a turn
};

struct Law {
  std::string_view id;    ///< of docs/laws.md; several forms may share one id
  std::string_view form;  ///< which form: "laminar"; "" where there is one
  SiteKind kind = SiteKind::piston_force;
  std::string_view equation;  ///< "F_c tanh(v / v_s)"
  std::string_view meaning;   ///< for an engineer: what it is
  std::string_view energy;    ///< the condition that keeps it physical
  std::string_view source;
  bool closed_form = false;  ///< searched only where the other laws leave something beyond the noise
  std::vector<LawParameter> parameters;
  std::optional<HiddenState> hidden = {};
  std::function<LawOutput(const LawInput&)> evaluate = {};  ///< empty where the simulation applies the law itself
  Feeds feeds = Feeds::anything;
  std::vector<LawRounding> roundings = {};
  /// Id of the plainer law that it comes to where its way is too short or its extra strength too small to be seen.
  std::string_view limit = {};
  std::string_view plant = {};                             ///< that brings the law and alone has it; "": all
  std::string_view element = {};                           ///< of that plant, where the law acts
  std::shared_ptr<const LawExpressions> expressions = {};  ///< of a law that is written as text
};

/// All laws, in the order of their files (services/common/model/laws), then those that plants bring.
[[nodiscard]] const std::deque<Law>& all_laws();

/// The law of that id whose parameters have these names, for a plant; an Error with the nearest id or name otherwise.
[[nodiscard]] Result<const Law*> find_law(std::string_view id, const std::vector<std::string>& parameter_names,
                                          std::string_view plant = {});

/// Whether a plant has the law: the catalogue's are all plants'.
[[nodiscard]] inline bool is_of_plant(const Law& law, std::string_view plant) {
  return law.plant.empty() || law.plant == plant;
}

/// Whether a law is asked at a site.
[[nodiscard]] inline bool fits(const Law& law, const Site& site) {
  return law.kind == site.kind && (law.element.empty() || law.element == site.element) &&
         (law.feeds == site.feeds || law.feeds == Feeds::anything || site.feeds == Feeds::anything);
}

/// Makes a law known, before other threads run.
void add_law(Law law);

/// The same text, kept for the program's life: names of laws and sites that are read from files.
[[nodiscard]] std::string_view kept(std::string_view text);

/// Plain numbers, each a direction of differentiation.
[[nodiscard]] LawInput law_input(std::span<const double> signals, double hidden, std::span<const double> parameters,
                                 const Roundings& roundings);

}  // namespace sealwatch
