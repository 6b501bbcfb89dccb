#include "services/cli/session.hpp"

#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <utility>

#include "services/cli/commands.hpp"
#include "services/common/runtime/configuration_loader.hpp"
#include "services/common/transport/dds_bus.hpp"

namespace sealwatch::cli {
namespace {

std::atomic<bool> interrupt_seen{false};

}  // namespace

std::string default_config() {
  if (const char* chosen = std::getenv("SEALWATCH_CONFIG"); chosen != nullptr && *chosen != '\0') return chosen;
  if (std::filesystem::exists("/etc/sealwatch/sealwatch.yaml")) return "/etc/sealwatch";
  return "config";
}

void complain(const Error& error) { std::fprintf(stderr, "sealwatch: %s\n", error.describe().c_str()); }

std::optional<Configuration> load_or_explain(const std::string& path) {
  auto configuration = load_configuration(path);
  if (configuration) return std::move(*configuration);
  for (const Error& error : configuration.error()) complain(error);
  return std::nullopt;
}

std::optional<AssetConfig> load_asset_or_explain(const std::string& path) {
  auto asset = check_asset(path);
  if (asset) return std::move(*asset);
  for (const Error& error : asset.error()) complain(error);
  return std::nullopt;
}

std::optional<Session> open_session(const std::string& config) {
  std::optional<Configuration> configuration = load_or_explain(config);
  if (!configuration) return std::nullopt;
  Result<std::unique_ptr<DdsBus>> bus = open_dds_bus(*configuration, SlowReader::loses_oldest);
  if (!bus) {
    complain(bus.error());
    return std::nullopt;
  }
  return Session{std::move(*configuration), std::move(*bus)};
}

void catch_interrupts() {
  const auto remember = [](int) { interrupt_seen = true; };
  std::signal(SIGINT, remember);
  std::signal(SIGTERM, remember);
}

bool interrupted() { return interrupt_seen; }

std::string unique_name(const std::string& command) {
  std::random_device source;
  char text[16];
  std::snprintf(text, sizeof text, "%08x", source());
  return command + "-" + text;
}

}  // namespace sealwatch::cli
