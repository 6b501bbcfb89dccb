// `sealwatch plant export`: an asset's plant, with the laws that were found, as an FMU for the tool that models come from.
#include <cstdio>

#include "services/cli/commands.hpp"
#include "services/cli/session.hpp"
#include "services/common/fmi/export/fmu_writer.hpp"
#include "services/common/runtime/plant_file.hpp"

namespace sealwatch::cli {

int run_plant_export(const PlantExportOptions& options) {
  const auto asset = load_asset_or_explain(options.asset_file);
  if (!asset) return kBadInput;
  const auto plant = find_plant(asset->model);
  if (!plant) return complain(plant.error()), kBadInput;
  if ((*plant)->file.empty())
    return complain(Error{.file = options.asset_file,
                          .place = {},
                          .value = asset->model,
                          .rule = "is a plant that is built in, whose equations are compiled and cannot be written out",
                          .advice = "config/plants has some of them as text; name one with model: FILE.yaml"}),
           kBadInput;
  const auto read = read_plant_file((*plant)->file);
  if (!read) return complain(read.error().front()), kBadInput;
  const auto model = fmi::export_model(read->built.plant, *asset);
  if (!model) return complain(model.error()), kBadInput;
  const auto written = fmi::write_fmu(options.fmu, *model);
  if (!written) return complain(written.error()), kBadInput;
  std::printf("%s: FMI 2.0 for Model Exchange, with C source%s%s\n", options.fmu.c_str(),
              written->binary ? " and a binary for Linux on x86-64" : " alone: ", written->without_binary.c_str());
  for (const std::string& what : model->left_out) std::printf("left out: %s\n", what.c_str());
  return kOk;
}

}  // namespace sealwatch::cli
