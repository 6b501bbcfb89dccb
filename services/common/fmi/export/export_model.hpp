// A plant that is written as text, with the laws of an asset in it, as a model in C and its modelDescription.xml: an FMU
// of FMI 2.0 or 3.0 for Model Exchange once it is packed (fmu_writer.hpp). A plant whose equations are an FMU's: export_wrapper.hpp.
//
//   states      the plant's, then the laws' hidden states       parameters  the plant's, then the laws'
//   inputs      the plant's; where equations or laws need the rate of an input, that rate is an input of its own
//
// The asset's values are the start values. Sensors' laws and low-passes belong to the recording, not to the plant, and
// stay out; so does a recording's own load factor.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sealwatch/config/asset.hpp"
#include "services/common/equations/text_equations.hpp"
#include "services/common/fmi/model_description.hpp"

namespace sealwatch::fmi {

struct ExportedModel {
  Version version = Version::fmi2;
  std::string identifier;   ///< "spring_return"
  std::string source;       ///< model.c, whole
  std::string description;  ///< modelDescription.xml
  std::vector<std::string> left_out;
  std::string carried;  ///< an FMU that goes into resources/inner; "": none
};

/// An Error where something cannot be written in C: tables. FMI 2.0 where no version is asked for; an imported FMU is
/// handed back by its own version alone.
[[nodiscard]] Result<ExportedModel> export_model(const RuntimePlant& plant, const AssetConfig& asset,
                                                 std::optional<Version> version = {});

}  // namespace sealwatch::fmi
