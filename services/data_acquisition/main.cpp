// Daemon of layer 1, with the folder in which recordings are dropped.
#include "services/common/runtime/daemon.hpp"
#include "services/common/runtime/log.hpp"
#include "services/common/transport/dds_bus.hpp"
#include "services/data_acquisition/data_acquisition.hpp"
#include "services/data_acquisition/recordings_folder.hpp"

namespace {

using namespace sealwatch;

/// A test that the layer at rest has closed is a test that is stored.
decltype(RunnerOptions::local_inputs) watch_folder(const Configuration& configuration) {
  const std::string& directory = configuration.services.at("data_acquisition").recordings_directory;
  if (directory.empty()) return {};
  const auto layers = std::make_shared<RunnerOptions::LayerAtRest>();
  const auto is_closed = [layers](const RawSamples& first) {
    const auto* const layer = dynamic_cast<const DataAcquisition*>((*layers)(first.asset_id));
    return layer != nullptr && layer->is_closed(first);
  };
  const auto folder =
      std::make_shared<RecordingsFolder>(directory, configuration.assets, is_closed, [](const Error& error) {
        log_event(LogLevel::error, "recording", {{"error", error.describe()}});
      });
  return [folder, layers](const RunnerOptions::LayerAtRest& now) {
    *layers = now;
    return folder->look();
  };
}

}  // namespace

int main(int argc, char** argv) {
  return run_daemon(argc, argv,
                    {.service = "data_acquisition",
                     .make_layer = [](const Configuration& configuration,
                                      const Clock&) { return std::make_unique<DataAcquisition>(configuration.assets); },
                     .make_bus = make_dds_bus,
                     .make_local_inputs = watch_folder,
                     .refused_by_bus = refused_by_security});
}
