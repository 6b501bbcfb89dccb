// A plant that runs away by itself, as a pendulum that stands: errors in its start grow exponentially, and no simulation
// over a whole test can follow a recording of the machine, which something holds.
//
// The test is cut into pieces, each of which starts anew where the recording is:
//   product over the pieces of |dy(end)/dx_0|      y an output that shows the state x
// The pieces keep near the recording, where one simulation of the whole would fall once and stay down. What swings or
// comes to rest gives a product below 1, an integrator 1.
#pragma once

#include <optional>
#include <string>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/core/deadline.hpp"
#include "sealwatch/core/time_series.hpp"

namespace sealwatch {

struct Runaway {
  std::string channel;
  double decades = 0.0;  ///< by which an error in its start grows over the test
};

/// The output that runs away most, of a plant that came as a file; nothing where none does or no piece can be simulated,
/// which is told elsewhere; nor where the deadline comes first.
[[nodiscard]] std::optional<Runaway> find_runaway(const AssetConfig& asset, const TimeSeries& recorded,
                                                  const Deadline* deadline = nullptr);

/// What it means for whoever simulates it over a whole test, and what to do, in two sentences.
[[nodiscard]] std::string in_words(const Runaway& runaway);
[[nodiscard]] std::string advice_for_runaway();

}  // namespace sealwatch
