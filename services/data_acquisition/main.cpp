// Daemon of layer 1, with the folder in which recordings are dropped.
#include "services/common/runtime/daemon.hpp"
#include "services/common/runtime/log.hpp"
#include "services/common/transport/dds_bus.hpp"
#include "services/data_acquisition/data_acquisition.hpp"
#include "services/data_acquisition/recordings_folder.hpp"

namespace {

using namespace sealwatch;

/// A layer concludes and its runner stores in one transaction, and the folder is looked at between transactions: a test
/// that the layer has closed is a test that is stored.
std::function<std::vector<Message>()> watch_folder(const Configuration& configuration, const DataAcquisition& layer) {
  const std::string& directory = configuration.services.at("data_acquisition").recordings_directory;
  if (directory.empty()) return {};
  const auto folder = std::make_shared<RecordingsFolder>(
      directory, configuration.assets, [&layer](const RawSamples& first) { return layer.is_closed(first); },
      [](const Error& error) {
        log_event(LogLevel::error, "recording", {{"error", error.describe()}});
      });
  return [folder] { return folder->look(); };
}

}  // namespace

int main(int argc, char** argv) {
  const DataAcquisition* layer = nullptr;  // owned by the daemon, which makes it before its local inputs
  return run_daemon(argc, argv,
                    {.service = "data_acquisition",
                     .make_layer =
                         [&layer](const Configuration& configuration, const Clock&) {
                           auto made = std::make_unique<DataAcquisition>(configuration.assets);
                           layer = made.get();
                           return made;
                         },
                     .make_bus = make_dds_bus,
                     .make_local_inputs =
                         [&layer](const Configuration& configuration) { return watch_folder(configuration, *layer); }});
}
