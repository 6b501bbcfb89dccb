#include "services/cli/session.hpp"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <map>
#include <random>
#include <set>
#include <utility>

#include "sealwatch/core/visible_text.hpp"
#include "services/cli/commands.hpp"
#include "services/cli/visible_bus.hpp"
#include "services/common/runtime/channel_map_file.hpp"
#include "services/common/runtime/configuration_loader.hpp"
#include "services/common/runtime/process_end.hpp"
#include "services/common/text/format.hpp"
#include "services/common/text/words.hpp"
#include "services/common/transport/dds_bus.hpp"

namespace sealwatch::cli {
namespace {

std::atomic<bool> interrupt_seen{false};
std::chrono::milliseconds patience_after_interrupt{};  ///< set before the first signal is caught

// Once in a command, which may load many assets of one plant.
void warn_of(const PlantDescription& plant) {
  static std::set<std::string> told;
  for (const std::string& remark : plant.remarks)
    if (const std::string words = plant.file + ": " + remark; told.insert(words).second)
      std::fprintf(stderr, "sealwatch: warning: %s\n", visible(words, false).c_str());
}

}  // namespace

std::string default_config() {
  if (const char* chosen = std::getenv("SEALWATCH_CONFIG"); chosen != nullptr && *chosen != '\0') return chosen;
  if (std::filesystem::exists("/etc/sealwatch/sealwatch.yaml")) return "/etc/sealwatch";
  return "config";
}

void complain(const Error& error) { std::fprintf(stderr, "sealwatch: %s\n", visible(error.describe()).c_str()); }

std::optional<Configuration> load_or_explain(const std::string& path) {
  auto configuration = load_configuration(path);
  if (configuration) return std::move(*configuration);
  for (const Error& error : configuration.error()) complain(error);
  return std::nullopt;
}

int with_output_written(int status) {
  errno = 0;
  std::cout.flush();
  const bool is_flushed = std::fflush(stdout) == 0;
  const int why = errno;
  if (is_flushed && std::ferror(stdout) == 0 && std::cout.good()) return status;
  complain(Error{
      .file = "standard output",
      .place = {},
      .value = {},
      .rule =
          std::string("could not be written").append(why == 0 ? "" : ": ").append(why == 0 ? "" : std::strerror(why)),
      .advice = "what was printed is not all: make room, or print elsewhere, and run it again"});
  return status == kInternalFailure ? status : kBadInput;
}

std::optional<AssetConfig> load_asset_of_known_plant(const std::string& path, const std::string& map_file) {
  std::optional<AssetConfig> asset = load_asset_or_explain(path, map_file);
  const Result<const PlantDescription*> plant = asset ? find_plant(asset->model) : nullptr;
  if (plant) return asset;
  complain(plant.error());
  return std::nullopt;
}

std::optional<AssetConfig> load_asset_or_explain(const std::string& path, const std::string& map_file) {
  auto asset = check_asset(path);
  if (!asset) {
    for (const Error& error : asset.error()) complain(error);
    return std::nullopt;
  }
  const Result<const PlantDescription*> plant = find_plant(asset->model);
  if (plant) warn_of(**plant);
  if (map_file.empty()) return std::move(*asset);
  auto map = check_channel_map(map_file, plant ? *plant : nullptr);
  if (!map) {
    for (const Error& error : map.error()) complain(error);
    return std::nullopt;
  }
  asset->channel_map = std::move(*map);
  return std::move(*asset);
}

std::optional<Session> open_session(const std::string& config) {
  std::optional<Configuration> configuration = load_or_explain(config);
  if (!configuration) return std::nullopt;
  Result<std::unique_ptr<DdsBus>> bus = open_dds_bus(*configuration, SlowReader::loses_oldest);
  if (!bus) {
    complain(bus.error());
    return std::nullopt;
  }
  return Session{std::move(*configuration), std::make_unique<VisibleBus>(std::move(*bus))};
}

std::string running_services(Session& session, const std::vector<std::string>& wanted) {
  constexpr std::chrono::milliseconds kTwoHeartbeats{2000};
  if (const Status joined = session.bus->subscribe_service_topics(); !joined) return {};
  std::map<std::string, std::string> running;
  const auto begin = std::chrono::steady_clock::now();
  auto end = begin + kTwoHeartbeats;
  while (!interrupted() && std::chrono::steady_clock::now() < end) {
    if (!running.empty()) end = std::min(end, begin + kTwoHeartbeats / 2);  // the others are heard as soon
    for (const BusItem& item : session.bus->receive(std::chrono::milliseconds(100)))
      if (const auto* status = std::get_if<ServiceStatus>(&item))
        if (status->state != "stopping" && std::ranges::find(wanted, status->service) != wanted.end())
          running[status->service] = status->service + " (process " + std::to_string(status->process_id) + ")";
  }
  std::string text;
  for (const auto& [service, words] : running) text::add_to_list(text, words);
  return text;
}

bool free_to_start(Session& session, const std::vector<std::string>& wanted) {
  const std::string running = running_services(session, wanted);
  if (running.empty()) return true;
  complain(Error{.file = {},
                 .place = "DDS domain " + std::to_string(session.configuration.domain),
                 .value = running,
                 .rule = "runs here already: two sets of services would answer each other's messages",
                 .advice = "use those that run, stop them first, or give this set another domain or discovery tag"});
  return false;
}

void catch_interrupts(std::chrono::milliseconds patience) {
  prepare_process_end();
  patience_after_interrupt = patience;
  const auto remember = [](int signal) {
    interrupt_seen = true;
    end_process_in(patience_after_interrupt, 128 + signal);
  };
  std::signal(SIGINT, remember);
  std::signal(SIGTERM, remember);
  std::signal(SIGHUP, remember);  // the terminal was closed
}

bool interrupted() { return interrupt_seen; }

std::string unique_name(const std::string& command) {
  std::random_device source;
  return text::format("{}-{:08x}", command, source());
}

}  // namespace sealwatch::cli
