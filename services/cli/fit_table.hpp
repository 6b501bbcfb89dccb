// The estimates of a fit as a table of text.
#pragma once

#include <string>
#include <vector>

#include "sealwatch/estimation/fit_report.hpp"

namespace sealwatch::cli {

struct EstimateRow {
  const EstimatedParameter& parameter;
  std::string recording = {};  ///< of a parameter that each recording has of its own
};

/// One line each, in the units and powers of ten in which pages write numbers; the value beside its standard error.
[[nodiscard]] std::string estimates_table(const std::vector<EstimateRow>& rows);

/// Of each channel how well it is reproduced.
[[nodiscard]] std::string channels_table(const std::vector<ChannelFit>& channels);

}  // namespace sealwatch::cli
