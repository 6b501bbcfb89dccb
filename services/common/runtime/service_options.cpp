#include "services/common/runtime/service_options.hpp"

#include <type_traits>

#include "sealwatch/forecast/configured.hpp"
#include "sealwatch/forecast/fleet_uncertainty.hpp"

namespace sealwatch {
namespace {

constexpr NumberRule kWindow{.min = 2, .max = 600, .words = "must be a whole number of months from 2 to 600"};
constexpr NumberRule kTests{.min = 1, .max = 60, .words = "must be a whole number of tests from 1 to 60"};

ForecasterConfig read_forecaster(YamlMap& map) {
  ForecasterConfig config;
  if (!map.read("method", config.method) && !map.has("method")) map.fault("method", {}, "must be given");
  map.read("window_months", config.window_months, kWindow);
  std::size_t index = 0;
  for (const YAML::Node& node : map.list("members")) {
    YamlMap member = map.inside(node, "members", index++);
    config.members.push_back(read_forecaster(member));
  }
  map.finish();
  return config;
}

void read_forecasters(YamlMap& service, Configuration& configuration) {
  std::size_t index = 0;
  for (const YAML::Node& node : service.list("forecasters")) {
    YamlMap map = service.inside(node, "forecasters", index++);
    const ForecasterConfig config = read_forecaster(map);
    const auto made = forecast::make_forecaster(forecast::configured_forecaster(config));
    if (!made && map.has("method")) map.fault("method", made.error().value, made.error().rule, made.error().advice);
    configuration.forecasters.push_back(config);
  }
}

/// All constants, and a population that they make.
void read_fleet(YamlMap& service, Configuration& configuration) {
  auto map = service.map("fleet");
  if (!map) return;
  FleetConstants constants;
  bool complete = true;
  FleetConstants::visit(
      [&](std::string_view name, double& value) {
        const std::string key(name);
        if (map->read(key, value)) return;
        if (!map->has(key)) map->fault(key, {}, "must be given", "sealwatch fleet fit prints all of them");
        complete = false;
      },
      constants);
  map->finish();
  if (!complete) return;
  if (const Status valid = forecast::population_of(constants).validate(); !valid)
    map->fault(valid.error().place, valid.error().value, valid.error().rule, valid.error().advice);
  configuration.fleet = constants;
}

struct OptionReader {
  YamlMap& map;
  template <class Number>
  void operator()(std::string_view name, Number& value) const {
    if constexpr (std::is_same_v<Number, double>) {
      map.read(std::string(name), value);
    } else {
      std::int32_t count = 0;
      if (map.read(std::string(name), count, kTests)) value = static_cast<Number>(count);
    }
  }
};

void read_advice(YamlMap& service, AdviceOptions& advice) {
  auto map = service.map("advice");
  if (!map) return;
  AdviceOptions::visit(OptionReader{*map}, advice);
  map->finish();
  if (const Status valid = advice.validate(); !valid) {
    const Error& error = valid.error();
    map->fault(error.place, error.value, error.rule, error.advice);
  }
}

}  // namespace

void read_service_options(const std::string& service, YamlMap& map, Configuration& configuration) {
  if (service == "prognostic_assessment") {
    read_forecasters(map, configuration);
    read_fleet(map, configuration);
  }
  if (service == "advisory_generation") read_advice(map, configuration.advice);
}

}  // namespace sealwatch
