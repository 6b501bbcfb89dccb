#include "services/cli/explain_command.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>

#include "sealwatch/core/file.hpp"
#include "sealwatch/model/plant_description.hpp"
#include "services/cli/recordings.hpp"
#include "services/cli/session.hpp"
#include "services/cli/terminal.hpp"
#include "services/common/fmi/export/law_code.hpp"
#include "services/common/report/explanation_html.hpp"
#include "services/common/report/explanation_json.hpp"
#include "services/common/report/explanation_sections.hpp"
#include "services/common/runtime/asset_file.hpp"
#include "services/common/runtime/large_blocks.hpp"
#include "services/common/text/estimates.hpp"
#include "services/common/text/format.hpp"
#include "services/common/text/law_words.hpp"
#include "services/common/text/numbers.hpp"
#include "services/common/text/readable.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch::cli {
namespace {

using mismatch::Explanation;
using mismatch::FoundEffect;
using mismatch::FoundParameter;

constexpr std::size_t kWidth = 110;

struct Files {
  std::string json, html, asset, laws_c, laws_modelica;
};

Files files_in(const std::string& directory) {
  const std::filesystem::path place(directory);
  return {(place / "report.json").string(), (place / "report.html").string(), (place / "asset.explained.yaml").string(),
          (place / "laws.c").string(), (place / "laws.mo").string()};
}

/// The same bytes twice are no second test; a recording that took part in the fit proves nothing.
Status all_different(const std::vector<Recording>& fit, const std::vector<Recording>& holdout) {
  std::map<std::string, const Recording*> seen;
  for (const std::vector<Recording>* list : {&fit, &holdout})
    for (const Recording& recording : *list) {
      const auto [other, is_new] = seen.emplace(recording.content_hash, &recording);
      if (is_new) continue;
      const bool crossed = list == &holdout && other->second >= fit.data() && other->second < fit.data() + fit.size();
      return fail(Error{
          .file = recording.file,
          .place = {},
          .value = {},
          .rule = (crossed ? "is held out, but has the same content as the fitted " : "has the same content as ") +
                  other->second->file,
          .advice = "give each recording once"});
    }
  return {};
}

/// Made before the analysis, so that a place that cannot be written to costs no waiting; taken away again where nothing
/// came to be written.
class Directory {
 public:
  explicit Directory(std::string name) : name_(std::move(name)) {}
  Directory(const Directory&) = delete;
  Directory& operator=(const Directory&) = delete;
  ~Directory() {
    std::error_code ignored;
    if (made_) std::filesystem::remove(name_, ignored);  // an empty one only
  }

  Status make() {
    std::error_code error;
    made_ = std::filesystem::create_directories(name_, error);
    std::error_code none;
    if (!std::filesystem::is_directory(name_, none))
      return fail(Error{.file = name_,
                        .place = "--out",
                        .value = {},
                        .rule = "is not a directory and cannot be made",
                        .advice = error.message()});
    return {};
  }

 private:
  std::string name_;
  bool made_ = false;
};

/// The laws as code for the tool that the model comes from; none of an earlier run are left where there are none.
Status write_laws(const AssetConfig& explained, const Files& files) {
  std::error_code ignored;
  for (const std::string& file : {files.laws_c, files.laws_modelica}) std::filesystem::remove(file, ignored);
  const auto plant = find_plant(explained.model);
  if (explained.physics.empty() || !plant) return {};
  const fmi::LawCode code = fmi::law_code(**plant, explained);
  if (Status status = write_file(files.laws_c, code.c); !status) return status;
  return write_file(files.laws_modelica, code.modelica);
}

double error_of(const Explanation& explanation, const std::string& name) {
  const auto shift = std::ranges::find(explanation.parameters, name, &mismatch::ParameterShift::name);
  return shift == explanation.parameters.end() ? 0.0 : shift->after_std;
}

double error_of(const Explanation& explanation, const PhysicsTerm& physics, const std::string& name) {
  for (const FoundEffect& effect : explanation.effects) {
    if (effect.what.id != physics.id || effect.what.element != physics.element) continue;
    const auto found = std::ranges::find(effect.parameters, name, &FoundParameter::name);
    if (found != effect.parameters.end()) return found->std_error;
  }
  return 0.0;
}

/// As people read it: estimates without the digits that the recordings do not tell; what was given stays as it is.
AssetConfig written_asset(const Explanation& explanation, const AssetConfig& given) {
  AssetConfig asset = explanation.explained;
  for (auto& [name, setting] : asset.parameters) {
    const auto before = given.parameters.find(name);
    if (before == given.parameters.end() || before->second.value != setting.value)
      setting.value = text::rounded_to_error(setting.value, error_of(explanation, name));
  }
  for (PhysicsTerm& physics : asset.physics)
    for (auto& [name, setting] : physics.parameters)
      setting.value = text::rounded_to_error(setting.value, error_of(explanation, physics, name));
  return asset;
}

Status write_all(const Explanation& explanation, const AssetConfig& asset, const std::string& json,
                 const Files& files) {
  if (Status status = write_file(files.json, json); !status) return status;
  if (Status status = write_file(files.html, report::explanation_to_html(explanation)); !status) return status;
  if (Status status = write_laws(asset, files); !status) return status;
  return save_asset(asset, files.asset);
}

std::string parameter_text(const FoundParameter& parameter) {
  return parameter.name + " = " + report::found_value(parameter);
}

std::string law_of(const mismatch::LawAt& law) {
  return text::law_at(text::in_words(law.id), law.element, report::the_element(law.element), "of");
}

void print_effect(const FoundEffect& effect) {
  std::printf("\n  %s (%s)\n", law_of(effect.what).c_str(), text::percent_text(effect.probability).c_str());
  std::printf("    %s\n", wrapped(effect.what.law, kWidth, 4).c_str());
  for (const FoundParameter& parameter : effect.parameters) std::printf("    %s\n", parameter_text(parameter).c_str());
  if (!effect.regime.empty()) std::printf("    acts: %s\n", wrapped(effect.regime, kWidth, 4).c_str());
  std::string others;
  for (const mismatch::LawAt& other : effect.indistinguishable)
    text::add_to_list(others, effect.is_another_form(other) ? "another form of it (" + other.law + ")" : law_of(other));
  if (!others.empty()) std::printf("    %s\n", wrapped("indistinguishable from: " + others, kWidth, 4).c_str());
}

void print_channels(const char* which, const mismatch::PooledFit& fit, bool changed) {
  if (fit.channels.empty()) return;
  std::printf("\n  %-24s %14s %14s %12s %12s\n", which, "misfit/noise", changed ? "after" : "", "fit %",
              changed ? "after" : "");
  for (const mismatch::ChannelComparison& channel : fit.channels) {
    std::printf("  %-24s %14s ", channel.channel.c_str(), text::misfit_text(channel.rms_before).c_str());
    std::printf("%14s %12s", changed ? text::misfit_text(channel.rms_after).c_str() : "",
                text::format("{:.2f}", channel.nrmse_before).c_str());
    std::printf("%s\n", changed ? text::format(" {:12.2f}", channel.nrmse_after).c_str() : "");
  }
}

void print_prognosis(const Explanation& explanation) {
  const std::optional<ConditionSetting>& scale = explanation.explained.condition;
  const auto leakage =
      std::ranges::find(explanation.parameters, scale ? scale->parameter : "", &mismatch::ParameterShift::name);
  if (!explanation.prognosis.known || leakage == explanation.parameters.end()) return;
  std::printf("\n  %s %s → %s\n  %s\n", leakage->name.c_str(),
              text::readable_with_error(leakage->before, leakage->before_std, leakage->unit).c_str(),
              text::readable_with_error(leakage->after, leakage->after_std, leakage->unit).c_str(),
              wrapped(explanation.prognosis.sentence, kWidth, 2).c_str());
}

/// A parameter that wants to go further than its range allows stands in for something: said before all figures.
void print_bounds(const Explanation& explanation) {
  const bool changed = explanation.changed();
  std::string text;
  for (const mismatch::ParameterShift& shift : explanation.parameters) {
    if (!shift.before_at_bound && !shift.after_at_bound) continue;
    const double value = shift.after_at_bound ? shift.after : shift.before;
    text::add_to_list(text, shift.name + " " + text::readable(value, shift.unit) + " (datasheet ", "; ");
    text.append(text::readable(shift.datasheet, shift.unit));
    if (changed && !shift.after_at_bound) text.append("; before anything was added");
    if (changed && !shift.before_at_bound) text.append("; with what was found");
    text.append(")");
  }
  if (!text.empty()) std::printf("\n  %s\n", wrapped("at a bound of their range: " + text, kWidth, 4).c_str());
}

/// With the power of ten that `other` is shown with, as the two are compared.
std::string readable_beside(double value, double other, const std::string& unit) {
  const text::DisplayUnit display = text::display_unit(unit, other);
  const double shown = value * display.factor, size = std::abs(shown);
  if (!display.text.starts_with("10") || size < 1e-2 || size >= 1e5) return text::readable(value, unit);
  return text::number_text(shown).append("·").append(display.text);
}

/// Where nothing was found, what the fit came to beside what the asset file has.
void print_estimates(const Explanation& explanation) {
  constexpr double kShown = 0.02;  // of the asset file's value
  std::string text, near;
  for (const mismatch::ParameterShift& shift : explanation.parameters) {
    if (!std::isfinite(shift.after_std) || shift.after_at_bound) continue;
    if (!(std::abs(shift.after - shift.datasheet) > kShown * std::abs(shift.datasheet))) {
      text::add_to_list(near, shift.name);
      continue;
    }
    text::add_to_list(text,
                      shift.name + " " + text::readable_with_error(shift.after, shift.after_std, shift.unit) +
                          " (asset file " + readable_beside(shift.datasheet, shift.after, shift.unit) + ")",
                      "; ");
  }
  if (!near.empty())
    text::add_to_list(text, near + " within " + text::percent_text(kShown) + " of the asset file", "; ");
  if (!text.empty()) std::printf("\n  %s\n", wrapped("fitted: " + text, kWidth, 4).c_str());
}

void print_steps(const std::vector<std::string>& steps) {
  if (!steps.empty()) std::printf("\n");
  for (std::size_t k = 0; k < steps.size(); ++k) {
    const std::string number = steps.size() > 1 ? std::to_string(k + 1) + ". " : "";
    std::printf("  %s%s\n", k == 0 ? "next: " : "      ", wrapped(number + steps[k], kWidth - 6, 8).c_str());
  }
}

void print_text(const Explanation& explanation, const Files& files) {
  std::printf("%s: %s\n  %s\n", explanation.asset_id.c_str(), std::string(name_of(explanation.verdict)).c_str(),
              wrapped(explanation.summary, kWidth, 2).c_str());
  for (const FoundEffect& effect : explanation.effects) print_effect(effect);
  const bool as_well =
      !explanation.effects.empty() && !explanation.asset_values.empty() && !explanation.values_beside_effects();
  if (as_well) std::printf("    indistinguishable from: a value of the asset file (above)\n");
  const bool changed = explanation.changed();
  if (changed) print_prognosis(explanation);
  print_bounds(explanation);
  if (!changed) print_estimates(explanation);
  print_channels(explanation.holdout_recordings.empty() ? "left out in turn" : "held out", explanation.holdout,
                 changed);
  print_channels("fitted", explanation.fit, changed);
  print_steps(report::steps_of(explanation));
  std::printf("\n  look at %s\n  scripts read %s\n  the asset with %s: %s\n", files.html.c_str(), files.json.c_str(),
              !explanation.effects.empty() ? "what was found"
              : changed                    ? "the value that explains as much"
                                           : "the fitted parameters",
              files.asset.c_str());
}

Result<Explanation> analyse(const ExplainEngine& engine, const ExplainOptions& options, const AssetConfig& asset,
                            const std::vector<Recording>& fit, const std::vector<Recording>& holdout,
                            Deadline::Clock::time_point begin) {
  mismatch::ExplainOptions settings;
  settings.seed = options.seed;
  settings.threads = options.threads;
  settings.time_limit_s = options.time_limit_s;
  settings.time_used_s = std::chrono::duration<double>(Deadline::Clock::now() - begin).count();
  Progress progress("explain", 100, "%");
  return engine(asset, fit, holdout, settings, [&progress](std::string_view step, double share) {
    progress.show(static_cast<std::size_t>(std::lround(100.0 * share)), step);
  });
}

/// Whether `status` is good; says on standard error why not.
bool good(const Status& status) {
  if (!status) complain(status.error());
  return status.has_value();
}

}  // namespace

int explain_with(const ExplainEngine& engine, const ExplainOptions& options) {
  keep_blocks_of_a_search();
  const std::optional<AssetConfig> asset = load_asset_of_known_plant(options.asset_file, options.map_file);
  if (!asset) return kBadInput;
  const Result<const PlantDescription*> plant = find_plant(asset->model);
  const auto fit = read_recordings(options.fit, *asset, **plant);
  if (!fit) return kBadInput;
  const auto holdout = read_recordings(options.holdout, *asset, **plant);
  Directory directory(options.directory);
  if (!holdout || !good(all_different(*fit, *holdout)) || !good(directory.make())) return kBadInput;
  const auto begin = Deadline::Clock::now();
  Deadline deadline;
  deadline.set_in(options.time_limit_s);
  tell_runaway(*fit, *asset, &deadline);

  const Files files = files_in(options.directory);
  const Result<Explanation> explanation = analyse(engine, options, *asset, *fit, *holdout, begin);
  if (!explanation) {
    complain(explanation.error());
    std::error_code none;
    if (std::filesystem::exists(files.json, none))
      std::fprintf(stderr, "sealwatch: %s is of an earlier run\n", files.json.c_str());
    return kBadInput;
  }
  const std::string json = report::explanation_to_json(*explanation);
  if (!good(write_all(*explanation, written_asset(*explanation, *asset), json, files))) return kBadInput;
  options.json ? static_cast<void>(std::fputs(json.c_str(), stdout)) : print_text(*explanation, files);
  return explanation->verdict == mismatch::Verdict::undetermined ? kAnswerIsNo : kOk;
}

}  // namespace sealwatch::cli
