// `sealwatch config check`: the whole configuration, every fault with file and line.
#include <cstdio>
#include <nlohmann/json.hpp>

#include "services/cli/commands.hpp"
#include "services/common/runtime/configuration_loader.hpp"

namespace sealwatch::cli {

int run_config_check(const ConfigCheckOptions& options) {
  const auto configuration = load_configuration(options.config);
  if (options.json) {
    nlohmann::ordered_json result = {{"schema", "sealwatch.config_check/1"},
                                     {"config", options.config},
                                     {"valid", configuration.has_value()},
                                     {"errors", nlohmann::ordered_json::array()}};
    if (!configuration)
      for (const Error& error : configuration.error())
        result["errors"].push_back({{"file", error.file},
                                    {"place", error.place},
                                    {"value", error.value},
                                    {"rule", error.rule},
                                    {"advice", error.advice}});
    std::printf("%s\n", result.dump(1).c_str());
  } else if (configuration) {
    std::printf("%s: valid: %zu assets, %zu sites, DDS domain %d, state in %s\n", options.config.c_str(),
                configuration->assets.size(), configuration->sites.size(), configuration->domain,
                configuration->state_directory.c_str());
  } else {
    for (const Error& error : configuration.error()) std::fprintf(stderr, "%s\n", error.describe().c_str());
    std::fprintf(stderr, "%zu fault%s found\n", configuration.error().size(),
                 configuration.error().size() == 1 ? "" : "s");
  }
  return configuration ? kOk : kBadInput;
}

}  // namespace sealwatch::cli
