// Which columns of somebody's log are probably which channels of a plant, by their units, names and values.
#pragma once

#include <string>
#include <vector>

#include "sealwatch/model/plant_description.hpp"
#include "services/cli/log_offer.hpp"

namespace sealwatch::cli {

struct ChannelGuess {
  std::string channel;
  std::size_t column = 0;  ///< of the offer
  std::string unit;        ///< for the map
  double score = 0.0;      ///< how much speaks for it
  bool sure = true;        ///< false: another channel would fit this column as well, or its unit alone tells
};

/// The unit in which a column may be a channel's: the one that is said; else the header's last word, "Speed_rpm", where
/// it is a unit of that channel and no letter, which may be a chamber's; "1" where the channel is a plain number and
/// what is said is no unit: [on/off].
[[nodiscard]] std::string unit_for(const OfferedColumn& column, const ChannelDescription& channel);

/// Whether the column's name and the channel's share most of their words.
[[nodiscard]] bool is_named_like(const OfferedColumn& column, const ChannelDescription& channel);

/// Columns in a unit of the channel that no guess has taken, whatever they are called; without `time_column`.
[[nodiscard]] std::vector<std::size_t> columns_of_unit(const Offer& offer, const ChannelDescription& channel,
                                                       std::size_t time_column,
                                                       const std::vector<ChannelGuess>& guesses);

/// Columns of plain numbers, counts or percent, that no guess has taken: those first whose name is the channel's or its
/// quantity's.
[[nodiscard]] std::vector<std::size_t> plain_columns(const Offer& offer, const ChannelDescription& channel,
                                                     std::size_t time_column, const std::vector<ChannelGuess>& guesses);

/// Each channel and each column at most once, the most likely first taken; then those that only their unit tells, with
/// score 0. Without `time_column`.
[[nodiscard]] std::vector<ChannelGuess> guess_channels(const Offer& offer, const PlantDescription& plant,
                                                       std::size_t time_column);

/// The plant of all that there are which the most speaks for.
[[nodiscard]] const PlantDescription& guess_plant(const Offer& offer, std::size_t time_column);

}  // namespace sealwatch::cli
