// An imported FMU with the laws of an asset in it, handed back as an FMU of the same version of FMI for Model Exchange,
// with C source. It carries the imported one, as it came, and adds the laws to its derivatives and inputs
// (fmi2_wrapper.c, fmi3_wrapper.c).
//
// Its description is the imported one's, so that it takes that one's place in the tool where it is used:
//
//   variables   as they were; behind them the laws' parameters and hidden states, and what the plant has of its own
//   starts      of parameters: the asset's values; of settings: the plant file's
//   inputs      one that is a recorded channel, with laws or without, stays; one that is another expression of channels
//               becomes local, and the channels become inputs. Parameters of the plant likewise.
#pragma once

#include "services/common/fmi/export/export_model.hpp"
#include "services/common/fmi/fmu_equations.hpp"

namespace sealwatch::fmi {

/// An Error for an FMU for Co-Simulation, which has no derivatives to add to, and for one of FMI 3.0 whose arrays
/// or types (integers other than Int32, Float32) the plant file uses.
[[nodiscard]] Result<ExportedModel> export_wrapper(const RuntimePlant& plant, const FmuEquations& equations,
                                                   const AssetConfig& asset);

}  // namespace sealwatch::fmi
