// Daemon of layer 1, with the folder in which recordings are dropped.
#include "services/common/core/build_version.hpp"
#include "services/common/runtime/daemon.hpp"
#include "services/common/runtime/log.hpp"
#include "services/common/transport/dds_bus.hpp"
#include "services/data_acquisition/data_acquisition.hpp"
#include "services/data_acquisition/folder_reader.hpp"

namespace {

using namespace sealwatch;

std::shared_ptr<LocalInputs> watch_folder(const Configuration& configuration) {
  const ServiceConfig& service = configuration.services.at("data_acquisition");
  if (service.recordings_directory.empty()) return nullptr;
  const auto report = [](const Error& error) {
    log_event(LogLevel::error, "recording", {{"error", error.describe()}});
  };
  constexpr int kLooksUntilSettled = 10;
  return std::make_shared<FolderReader>(service.recordings_directory, configuration.assets, report,
                                        std::chrono::seconds(1), kLooksUntilSettled, service.recordings_retention);
}

}  // namespace

int main(int argc, char** argv) {
  return run_daemon(argc, argv,
                    {.service = "data_acquisition",
                     .version_line = version_line(),
                     .make_layer = [](const Configuration& configuration,
                                      const Clock&) { return std::make_unique<DataAcquisition>(configuration.assets); },
                     .make_bus = make_dds_bus,
                     .make_local_inputs = watch_folder,
                     .refused_by_bus = refused_by_dds});
}
