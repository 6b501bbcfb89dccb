// `sealwatch fleet fit`: a fleet's own ageing constants from its histories, for the configuration that forecasts read.
#include <cstdio>
#include <nlohmann/json.hpp>

#include "sealwatch/forecast/fleet_uncertainty.hpp"
#include "services/cli/commands.hpp"
#include "services/cli/session.hpp"
#include "services/cli/terminal.hpp"
#include "services/common/forecast/history.hpp"
#include "services/common/text/format.hpp"
#include "services/common/text/numbers.hpp"

namespace sealwatch::cli {
namespace {

using forecast::FleetErrors;
using forecast::FleetFit;
using forecast::FleetLife;

constexpr double kReferenceLives = 4.0;

Result<UtcTime> installed_at(const FleetFitOptions& options, std::size_t life, const FleetLife& read) {
  if (!options.installed.empty()) return parse_utc(options.installed[life]);
  return add_months(read.history.front().time, -1.0);  // tests are monthly: the first a month after installation
}

/// One life twice would count as two that are alike.
Status refuse_the_same(const std::vector<FleetLife>& fleet, const std::vector<std::string>& files) {
  for (std::size_t k = 1; k < fleet.size(); ++k)
    for (std::size_t before = 0; before < k; ++before)
      if (fleet[k].history == fleet[before].history)
        return fail(Error{.file = files[k],
                          .place = {},
                          .value = {},
                          .rule = "holds the same tests as " + files[before],
                          .advice = "give each life once"});
  return {};
}

Result<std::vector<FleetLife>> read_fleet(const FleetFitOptions& options) {
  if (!options.installed.empty() && options.installed.size() != options.histories.size())
    return fail(Error{.file = {},
                      .place = "--installed",
                      .value = std::to_string(options.installed.size()) + " dates",
                      .rule = "must be one for each of the " + std::to_string(options.histories.size()) + " histories",
                      .advice = {}});
  std::optional<ConditionSetting> seal;
  if (!options.asset_file.empty()) {
    const auto asset = load_asset_or_explain(options.asset_file);
    if (!asset)
      return fail(Error{.file = options.asset_file, .place = {}, .value = {}, .rule = "cannot be used", .advice = {}});
    seal = asset->condition;
  }
  std::vector<FleetLife> fleet;
  for (std::size_t k = 0; k < options.histories.size(); ++k) {
    Result<std::vector<forecast::ConditionSample>> history = forecast::read_history(options.histories[k], seal);
    if (!history) return fail(history.error());
    FleetLife life{.history = std::move(*history), .installed = {}};
    const Result<UtcTime> installed = installed_at(options, k, life);
    if (!installed) return fail(installed.error());
    life.installed = *installed;
    fleet.push_back(std::move(life));
  }
  if (const Status once = refuse_the_same(fleet, options.histories); !once) return fail(once.error());
  return fleet;
}

std::string yaml_of(const FleetConstants& constants) {
  std::string out = "services:\n  prognostic_assessment:\n    fleet:\n";
  FleetConstants::visit(
      [&out](std::string_view name, double value) { out += text::format("      {}: {:.6g}\n", name, value); },
      constants);
  return out;
}

std::string json_of(const FleetFit& fit, const FleetErrors& errors, const FleetConstants& constants) {
  nlohmann::ordered_json json = {{"schema", "sealwatch.fleet/1"},
                                 {"lives", fit.lives},
                                 {"passed_over", fit.passed_over},
                                 {"reference_lives", kReferenceLives},
                                 {"constants", nlohmann::ordered_json::object()},
                                 {"std_errors",
                                  {{"initial_rate", errors.initial_rate},
                                   {"steepening", errors.steepening},
                                   {"irregularity_std", errors.irregularity_std}}},
                                 {"limits", nlohmann::ordered_json::array()}};
  if (fit.irregularity_is_limit) {
    json["std_errors"]["irregularity_std"] = nullptr;
    json["limits"].push_back({{"name", "irregularity_std"}, {"at_most", fit.population.irregularity_std}});
  }
  FleetConstants::visit([&json](std::string_view name, double value) { json["constants"][std::string(name)] = value; },
                        constants);
  return json.dump(1) + "\n";
}

void print_text(const FleetFit& fit, const FleetErrors& errors, const FleetConstants& constants) {
  const forecast::FleetPopulation reference;
  std::printf("%d %s; the built-in population counts as %s more\n", fit.lives, fit.lives == 1 ? "life" : "lives",
              text::general(kReferenceLives).c_str());
  if (fit.passed_over > 0)
    std::printf("  left out, with fewer than %d tests: %d\n", forecast::kFewestTestsOfLife, fit.passed_over);
  std::printf("  %-22s %14s    %-12s %14s\n", "constant", "fleet", "std. error", "built-in");
  const auto row = [](const char* name, double value, double error, double usual) {
    std::printf("  %-22s %14s  ± %-12s %14s\n", name, number(value, 4).c_str(), number(error, 2).c_str(),
                number(usual, 4).c_str());
  };
  row("initial_rate", fit.population.initial_rate, errors.initial_rate, reference.initial_rate);
  row("steepening, a month", fit.population.steepening, errors.steepening, reference.steepening);
  if (fit.irregularity_is_limit)
    std::printf("  %-22s %14s    %-12s %14s\n", "irregularity_std",
                ("<= " + number(fit.population.irregularity_std, 4)).c_str(), "limit, 95 %",
                number(reference.irregularity_std, 4).c_str());
  else
    row("irregularity_std", fit.population.irregularity_std, errors.irregularity_std, reference.irregularity_std);
  std::printf("  an average seal fails (0.6) after %s months; with the built-in population, after %s\n",
              number(mean_remaining_months(fit.population.initial_condition, 0.6, fit.population), 3).c_str(),
              number(mean_remaining_months(reference.initial_condition, 0.6, reference), 3).c_str());
  if (fit.irregularity_is_limit)
    std::printf("  no irregularity beyond the standard errors of the tests: irregularity_std is an upper limit\n");
  std::printf("\nFor sealwatch.yaml (each _std includes the uncertainty of its mean):\n%s", yaml_of(constants).c_str());
}

}  // namespace

int run_fleet_fit(const FleetFitOptions& options) {
  const Result<std::vector<FleetLife>> fleet = read_fleet(options);
  if (!fleet) return complain(fleet.error()), kBadInput;
  const Result<FleetFit> fit = forecast::fit_population(*fleet, {}, kReferenceLives);
  if (!fit) return complain(fit.error()), kBadInput;
  const FleetErrors errors = forecast::fleet_errors(*fleet, *fit, {}, kReferenceLives);
  const FleetConstants constants = forecast::constants_for_forecasts(fit->population, errors);
  if (options.json)
    std::printf("%s", json_of(*fit, errors, constants).c_str());
  else
    print_text(*fit, errors, constants);
  return kOk;
}

}  // namespace sealwatch::cli
