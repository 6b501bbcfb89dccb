// What a file of somebody's own offers: its columns with some of their cells, and which of them is the time.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sealwatch/config/channel_map.hpp"
#include "sealwatch/core/result.hpp"
#include "services/common/recording/log_columns.hpp"
#include "services/common/recording/log_layout.hpp"

namespace sealwatch::cli {

struct Offer {
  std::vector<OfferedColumn> columns;
  std::vector<std::vector<std::string>> cells;  ///< the first ones of each column that hold a value; of vectors none
  std::vector<std::vector<std::size_t>> rows;   ///< of the file, in which those cells stand
  FoundLayout layout;
  std::optional<double> step_s = {};      ///< between two rows, as the preamble says it
  std::optional<std::size_t> names = {};  ///< the column of names where each row seems to have one value
  bool text = true;                       ///< false: vectors of numbers, HDF5 or MATLAB
};

[[nodiscard]] Result<Offer> offer_of(const std::string& file, const LogLayout& given);

/// Whether all cells of a column that hold a value are numbers, and there are any.
[[nodiscard]] bool has_numbers(const Offer& offer, std::size_t column);

/// Whether its numbers go up by one from row to row, as a count does and seconds may.
[[nodiscard]] bool counts_by_one(const Offer& offer, std::size_t column);

/// Its header cell; its place where another column has the same.
[[nodiscard]] std::string name_of_column(const Offer& offer, std::size_t column);

/// The column called time, t, Timestamp, Zeit or Date; else the first whose cells are times; else the first that rises.
[[nodiscard]] bool has_time(
    const Offer& offer);  ///< whether one of these is there; else the first column stands for it
/// kNoColumn: none holds times, and the preamble says how far the rows are apart.
[[nodiscard]] std::size_t time_column(const Offer& offer);
[[nodiscard]] ColumnMapping guess_time(const Offer& offer);

}  // namespace sealwatch::cli
