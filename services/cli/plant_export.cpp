// `sealwatch plant export`: an asset's plant, with the laws that were found, as an FMU for the tool that models come from.
#include <cstdio>
#include <fstream>
#include <optional>

#include "services/cli/commands.hpp"
#include "services/cli/session.hpp"
#include "services/common/fmi/export/fmu_writer.hpp"
#include "services/common/fmi/temporary_folder.hpp"
#include "services/common/runtime/built_in_texts.hpp"
#include "services/common/runtime/plant_file.hpp"

namespace sealwatch::cli {
namespace {

Error without_text(const PlantDescription& plant) {
  return {.file = {},
          .place = {},
          .value = plant.name,
          .rule = "is a built-in plant whose equations are compiled and have no text form",
          .advice = "write it as text (docs/tutorial-plant.md) and name that with model: FILE.yaml"};
}

/// The plant's equations: those of its file, or of the text that a built-in plant is written as too.
Checked<ReadPlant> equations_of(const PlantDescription& plant) {
  if (!plant.file.empty()) return read_plant_file(plant.file);
  const std::string_view text = text_of_built_in(plant.name);
  if (text.empty()) return tl::unexpected(std::vector{without_text(plant)});
  const auto folder = fmi::TemporaryFolder::create();
  if (!folder) return tl::unexpected(std::vector{folder.error()});
  const std::string file = (folder->path() / (plant.name + ".yaml")).string();
  std::ofstream(file) << text;
  return read_plant_file(file);
}

}  // namespace

int run_plant_export(const PlantExportOptions& options) {
  const auto asset = load_asset_or_explain(options.asset_file);
  if (!asset) return kBadInput;
  const auto plant = find_plant(asset->model);
  if (!plant) return complain(plant.error()), kBadInput;
  const auto read = equations_of(**plant);
  if (!read) return complain(read.error().front()), kBadInput;
  std::optional<fmi::Version> version;
  if (options.fmi) version = *options.fmi == 3 ? fmi::Version::fmi3 : fmi::Version::fmi2;
  const auto model = fmi::export_model(read->built.plant, *asset, version);
  if (!model) return complain(model.error()), kBadInput;
  const auto written = fmi::write_fmu(options.fmu, *model);
  if (!written) return complain(written.error()), kBadInput;
  std::printf("%s: FMI %d.0 for Model Exchange, with C source%s%s\n", options.fmu.c_str(),
              model->version == fmi::Version::fmi3 ? 3 : 2,
              written->binary ? " and a binary for Linux on x86-64" : " alone: ", written->without_binary.c_str());
  for (const std::string& what : model->left_out) std::printf("left out: %s\n", what.c_str());
  return kOk;
}

}  // namespace sealwatch::cli
