#include "services/verification/lives/setting.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "sealwatch/core/text.hpp"
#include "services/common/runtime/asset_file.hpp"
#include "services/common/text/numbers.hpp"

namespace sealwatch::verification {
namespace {

constexpr std::array<std::pair<TruthKind, std::string_view>, 3> kTruths = {
    {{TruthKind::circuit, "circuit"}, {TruthKind::actuator, "actuator"}, {TruthKind::condition, "condition"}}};
constexpr int kLineWindow_months = 36;
constexpr int kWholeLife_months = 240;  // forecasters with a law of their own forget by themselves

/// Constants of the degradation by name, in the order in which they are written.
template <class Degradation>
auto constants(Degradation& d) {
  return std::array{std::pair{"n_0", &d.n_0},
                    std::pair{"initial_gamma_min", &d.initial_gamma.min},
                    std::pair{"initial_gamma_max", &d.initial_gamma.max},
                    std::pair{"steepening_limit_min", &d.steepening_limit.min},
                    std::pair{"steepening_limit_max", &d.steepening_limit.max},
                    std::pair{"irregularity_min", &d.irregularity.min},
                    std::pair{"irregularity_max", &d.irregularity.max}};
}

/// As settings of earlier versions have it: all 17 digits.
std::string exact(double value) { return text::significant(value, 17); }

Error wrong(std::string place, std::string value, std::string rule, std::string advice = {}) {
  return {.file = {},
          .place = std::move(place),
          .value = std::move(value),
          .rule = std::move(rule),
          .advice = std::move(advice)};
}

Status check_degradation(const forecast::DegradationSetting& d) {
  const auto ordered = [](const char* name, const forecast::Range& range) -> Status {
    if (std::isfinite(range.min) && std::isfinite(range.max) && range.min <= range.max) return {};
    return fail(wrong(std::string("degradation ") + name, exact(range.min) + " .. " + exact(range.max),
                      "must go from a smaller to a larger number"));
  };
  if (Status ok = ordered("initial_gamma", d.initial_gamma); !ok) return ok;
  if (Status ok = ordered("steepening_limit", d.steepening_limit); !ok) return ok;
  if (Status ok = ordered("irregularity", d.irregularity); !ok) return ok;
  if (!(d.n_0 > 0.0)) return fail(wrong("degradation n_0", exact(d.n_0), "must be positive"));
  if (d.steepening_limit.min < 0.0)
    return fail(wrong("degradation steepening_limit_min", exact(d.steepening_limit.min), "must not be negative"));
  return {};
}

std::uint64_t fingerprint(const std::string& text) {  // FNV-1a
  std::uint64_t hash = 14695981039346656037ULL;
  for (const char letter : text) hash = (hash ^ static_cast<unsigned char>(letter)) * 1099511628211ULL;
  return hash;
}

}  // namespace

forecast::DegradationSetting published_ln_t() {
  return {.initial_condition = 1.0,
          .n_0 = 6.0,
          .initial_gamma = {0.03, 0.06},
          .steepening_limit = {0.0022, 0.0036},
          .irregularity = {-0.26, 0.28}};
}

forecast::DegradationSetting published_t() {
  return {.initial_condition = 1.0,
          .n_0 = 17.0,
          .initial_gamma = {0.003, 0.015},
          .steepening_limit = {0.0037, 0.0067},
          .irregularity = {-0.62, 0.70}};
}

std::string_view name_of(TruthKind kind) {
  for (const auto& [truth, name] : kTruths)
    if (truth == kind) return name;
  return "unknown";
}

Result<TruthKind> truth_named(const std::string& name) {
  std::vector<std::string> known;
  for (const auto& [truth, its_name] : kTruths) {
    if (its_name == name) return truth;
    known.emplace_back(its_name);
  }
  return fail(wrong("--truth", name, "is not known", suggest(name, known)));
}

Status validate(const VerificationSetting& setting) {
  const auto range = [](const char* place, double value, double low, double high, const char* rule) -> Status {
    if (value >= low && value <= high) return {};
    return fail(wrong(place, exact(value), rule));
  };
  if (setting.lives < 1)
    return fail(
        wrong("lives", std::to_string(setting.lives), "an empty fleet verifies nothing", "give at least one life"));
  if (Status ok = range("lives", setting.lives, 1, 10'000'000, "must be at most ten million"); !ok) return ok;
  if (Status ok = range("months", setting.months, 12, 600, "must be 12 to 600"); !ok) return ok;
  if (Status ok = range("sample rate", setting.sample_rate_Hz, 10, 1000, "must be 10 to 1000 Hz"); !ok) return ok;
  if (Status ok = range("load range", setting.load_range, 0, 0.5, "must be 0 to 0.5"); !ok) return ok;
  if (Status ok = range("missing share", setting.missing_share, 0, 0.9, "must be 0 to 0.9"); !ok) return ok;
  if (Status ok = range("cut share", setting.cut_share, 0, 1, "must be 0 to 1"); !ok) return ok;
  if (!setting.asset.condition)
    return fail(wrong("asset " + setting.asset.asset_id + ", key seal", {}, "is needed to simulate a life",
                      "give resistance_100 and resistance_60"));
  if (setting.forecasters.empty()) return fail("at least one forecaster is needed");
  std::vector<std::string> labels = method_labels(setting);
  std::sort(labels.begin(), labels.end());
  if (const auto twice = std::adjacent_find(labels.begin(), labels.end()); twice != labels.end())
    return fail(wrong("forecaster", *twice, "is there twice"));
  return check_degradation(setting.degradation);
}

std::vector<forecast::ForecasterSettings> all_forecasters() {
  std::vector<forecast::ForecasterSettings> all = forecast::default_forecasters();
  const auto add = [&all](const std::string& method, int window_months) {
    if (std::none_of(all.begin(), all.end(),
                     [&](const auto& known) { return known.method == method && known.window_months == window_months; }))
      all.push_back({.method = method, .window_months = window_months});
  };
  for (const std::string method : {"ols", "ols_log_time", "ols_drift"})
    for (const int window_months : {24, 36, 48}) add(method, window_months);
  for (const std::string& method : forecast::forecast_methods())
    add(method, method.starts_with("ols") ? kLineWindow_months : kWholeLife_months);
  return all;
}

Result<forecast::ForecasterSettings> forecaster_named(const std::string& text) {
  const std::size_t colon = text.find(':');
  forecast::ForecasterSettings settings{.method = text.substr(0, colon)};
  const std::vector<forecast::ForecasterSettings> all = all_forecasters();
  const auto usual =
      std::find_if(all.begin(), all.end(), [&](const auto& one) { return one.method == settings.method; });
  if (usual != all.end()) settings = *usual;
  if (colon != std::string::npos) {
    const std::string window = text.substr(colon + 1);
    if (window.empty() || window.size() > 3 || window.find_first_not_of("0123456789") != std::string::npos)
      return fail(wrong("forecaster", text, "must be METHOD or METHOD:MONTHS", "for example ols:36"));
    settings.window_months = std::stoi(window);
  }
  if (const auto made = forecast::make_forecaster(settings); !made) return fail(made.error());
  return settings;
}

std::string label_of(const forecast::ForecasterSettings& forecaster) {
  return forecaster.method + " " + std::to_string(forecaster.window_months);
}

std::vector<std::string> method_labels(const VerificationSetting& setting) {
  std::vector<std::string> labels;
  for (const auto& forecaster : setting.forecasters) labels.push_back(label_of(forecaster));
  labels.emplace_back("oracle");
  return labels;
}

Status set_constant(forecast::DegradationSetting& degradation, const std::string& assignment) {
  std::vector<std::string> known;
  for (const auto& [name, set] : {std::pair{"published_ln_t", published_ln_t()},
                                  {"published_t", published_t()},
                                  {"bench", forecast::DegradationSetting{}}}) {
    known.emplace_back(name);
    if (assignment != name) continue;
    degradation = set;
    return {};
  }
  const std::size_t equals = assignment.find('=');
  const std::string name = assignment.substr(0, equals);
  for (auto& [constant, value] : constants(degradation)) {
    known.emplace_back(constant);
    if (name != constant) continue;
    const std::string number = equals == std::string::npos ? "" : assignment.substr(equals + 1);
    char* end = nullptr;
    const double parsed = std::strtod(number.c_str(), &end);
    if (number.empty() || *end != '\0' || !std::isfinite(parsed))
      return fail(wrong("degradation constant", assignment, "must be NAME=NUMBER"));
    *value = parsed;
    return {};
  }
  return fail(wrong("degradation constant", name, "is not known", suggest(name, known)));
}

std::string describe(const VerificationSetting& setting) {
  std::string text = "format = sealwatch verification 2\n";
  const auto line = [&text](const std::string& key, const std::string& value) {
    text.append(key).append(" = ").append(value).append("\n");
  };
  line("asset", setting.asset.asset_id);
  line("asset_fingerprint", std::to_string(fingerprint(asset_to_yaml(setting.asset))));
  line("lives", std::to_string(setting.lives));
  line("seed", std::to_string(setting.seed));
  line("months", std::to_string(setting.months));
  line("truth", std::string(name_of(setting.truth)));
  line("sample_rate_Hz", exact(setting.sample_rate_Hz));
  line("through_layers", setting.through_layers ? "yes" : "no");
  line("load_range", exact(setting.load_range));
  line("missing_share", exact(setting.missing_share));
  line("cut_share", exact(setting.cut_share));
  line("scenario", std::string(name_of(setting.scenario)));
  for (const auto& [name, value] : constants(setting.degradation)) line(name, exact(*value));
  for (const std::string& label : method_labels(setting)) line("method", label);
  return text;
}

}  // namespace sealwatch::verification
