// What a plant says about itself in one table, which code, configuration, documents and error messages share: its
// recorded channels, its parameters with units, bounds and meaning, its elements.
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sealwatch/config/condition.hpp"
#include "sealwatch/core/result.hpp"
#include "sealwatch/core/time_series.hpp"
#include "sealwatch/model/roles.hpp"
#include "sealwatch/model/sites.hpp"

namespace sealwatch {

struct ChannelDescription {
  std::string name;
  std::string unit;  ///< SI
  std::string meaning;
  bool input = false;            ///< drives the simulation
  double noise_std = 0.0;        ///< default of the nominal asset, SI
  double time_constant_s = 0.0;  ///< default first-order low-pass
  double range_min = 0.0;        ///< plausible range, SI; no range when max <= min
  double range_max = 0.0;
  bool hold = false;          ///< an input that is held between samples, whatever the recording says
  bool band_limited = false;  ///< an input without anything above half the sampling rate: its samples say all of it
  ChannelRole role = ChannelRole::none;
};

/// What drawings and datasheets give, machined and catalogue parts alike, is seldom off by more than twice this.
inline constexpr double kUsualTolerance = 0.005;

struct ParameterDescription {
  std::string name;
  std::string unit;    ///< SI
  double value = 0.0;  ///< default of the nominal asset
  double min = 0.0;    ///< psi_min
  double max = 0.0;    ///< psi_max
  std::string meaning;
  bool positive = true;   ///< a positive scale: estimated as its logarithm
  bool estimate = false;  ///< estimated by default where the channels allow it
  /// Standard deviation of a datasheet's value about the plant's, as a share of it.
  double tolerance = kUsualTolerance;
  ParameterRole role = ParameterRole::none;
};

struct StateDescription {
  std::string name;  ///< "p_A"
  std::string unit;  ///< SI
  std::string meaning;
};

struct ElementDescription {
  std::string name;  ///< as reports name it: "piston_seal"
  std::string meaning;
};

/// How many times larger than in `eha` a plant's forces, ways or speeds are: laws give their usual sizes, grids and
/// what matters to an engineer for `eha`.
struct LawSize {
  std::string_view unit;  ///< of a law's parameter: "N", "N s/m"
  double factor = 1.0;
};

struct PlantDescription {
  std::string name;  ///< "eha", "eha_switched", "emps", "cascaded_tanks"
  std::string meaning;
  std::vector<ChannelDescription> channels;  ///< without `time`, which every plant has
  std::vector<ParameterDescription> parameters;
  std::vector<StateDescription> states;
  std::vector<ElementDescription> elements;
  std::vector<Site> sites = {};  ///< where laws of the catalogue may act
  std::vector<LawSize> law_sizes = {};
  /// Where nothing pulls the plant back to its place, what its model lacks adds up and a whole recording ends anywhere:
  /// the mismatch analysis then looks at pieces of this length, each from an initial state of its own. 0: at the whole.
  double window_s = 0.0;
  /// The mean load phi where recordings differ in a load: phi (1 + Phi), Phi each recording's own; "": no load.
  std::string load_parameter = {};
  /// The parameter by which the plant wears, so that its change from test to test is no missing physics; "": none.
  std::string wear_parameter = {};
  std::optional<ConditionSetting> condition = {};  ///< what `seal:` in an asset's file says the anchors of
  bool judged = false;                             ///< an asset that says nothing of it has that condition
  bool hides_states = false;              ///< a unit that integrates by itself (Co-Simulation): it can have no sites
  std::string file = {};                  ///< that it was read from; "": it is built in
  std::vector<std::string> remarks = {};  ///< on what in that file is no fault, and may be one

  [[nodiscard]] const ChannelDescription* find_channel(std::string_view channel) const;
  [[nodiscard]] const ParameterDescription* find_parameter(std::string_view parameter) const;
  [[nodiscard]] const StateDescription* find_state(std::string_view state) const;
  /// The first channel of that role; null: the plant has none.
  [[nodiscard]] const ChannelDescription* find_channel(ChannelRole role) const;
  [[nodiscard]] const ParameterDescription* find_parameter(ParameterRole role) const;
  [[nodiscard]] bool has_load() const { return !load_parameter.empty(); }
};

/// The recorded channel of that role; null: the plant has none, or it was not recorded.
[[nodiscard]] const Series* find_series(const TimeSeries& recorded, const PlantDescription& plant, ChannelRole role);
/// Its name, whether it was recorded or not; "": the plant has none.
[[nodiscard]] std::string channel_name(const PlantDescription& plant, ChannelRole role);

/// The plants that sealwatch knows, in a fixed order; one's own come last (docs/tutorial-plant.md).
[[nodiscard]] const std::deque<PlantDescription>& all_plants();

/// The plant of that name; an Error naming the nearest one otherwise.
[[nodiscard]] Result<const PlantDescription*> find_plant(std::string_view name);

/// The plant of that name, or where there is none that of assets whose file names none.
[[nodiscard]] const PlantDescription& plant_or_default(std::string_view name);

}  // namespace sealwatch
