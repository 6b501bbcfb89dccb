#include "services/common/mismatch/baseline.hpp"

#include <algorithm>
#include <iterator>

#include "sealwatch/model/driving_channels.hpp"
#include "services/common/estimation/unseen_samples.hpp"
#include "services/common/mismatch/averaged_inputs.hpp"
#include "services/common/mismatch/criterion.hpp"
#include "services/common/mismatch/explain_input.hpp"
#include "services/common/mismatch/held_out.hpp"
#include "services/common/mismatch/noise.hpp"
#include "services/common/mismatch/pieces.hpp"
#include "services/common/mismatch/telling.hpp"
#include "services/common/mismatch/tolerance.hpp"
#include "services/common/mismatch/unrecorded_input.hpp"
#include "services/common/mismatch/usual_ranges.hpp"
#include "services/common/mismatch/windows.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr double kFarOff = 1e4;         // mean square of a hundred times the noise: evidence abounds
constexpr double kEnoughRows = 8000.0;  // of windows, where it is far off

class BaselineFit {
 public:
  BaselineFit(const AssetConfig& asset, Data& fit, Data& holdout, const ExplainOptions& options, TimeBudget& time)
      : asset_(asset), fit_(fit), holdout_(holdout), options_(options), time_(time) {}

  Result<Baseline> run() {
    const auto simulation = PlantSimulation::create(asset_, fit_.samples.front());
    if (!simulation) return fail(simulation.error());
    const std::vector<std::string> channels((*simulation)->channels().begin(), (*simulation)->channels().end());
    const NoiseColour of_inputs = noise_of_inputs();
    find_noise(fit_, channels);
    find_noise(holdout_, channels);  // its standard deviations; its colour is that of the others
    holdout_.colour.assign(holdout_.samples.size(), fit_.colour.front());
    baseline_.window_s = window_of(asset_, fit_.samples.front());
    Result<FittedModel> model = fit_by_averaged_inputs(asset_, prepared(fit_), nullptr, options_.threads);
    baseline_.notes = colours_in_words(fit_, channels);
    if (model && by_measurements(asset_, fit_)) {
      const InputNoise noise = input_noise(*model, prepared(fit_), of_inputs, options_.seed);
      for (Data* data : {&holdout_, &fit_}) add_input_noise(*data, asset_, channels, noise);
      model = fit_model(model->asset, prepared(fit_), &*model, options_.threads);
    }
    if (!model && !time_.deadline().cancelled() &&
        !time_.in_time("the model's parameters: they stay as the asset file has them")) {
      time_.allow_what_is_needed();
      const FittedModel nowhere;
      model = fit_model(asset_, prepared(fit_), &nowhere, options_.threads, 0);
      time_.allow(0.0);
    }
    if (!model) {
      Error error = model.error();
      const bool has_advice = !error.file.empty() && !error.advice.empty();  // an FMU's, of itself
      if (error.file.empty()) error.file = first_not_simulated();
      if (!has_advice)
        error.advice =
            "the model cannot be simulated at the start values: check the asset's parameters against the recording";
      return fail(std::move(error));
    }
    model = of_fewer_windows(std::move(*model));
    if (!model) return fail(model.error());
    if (!time_.deadline().passed()) model = with_tolerances(std::move(*model));
    if (!time_.deadline().passed()) model = with_colour_of_residuals(std::move(*model), channels);
    if (!time_.deadline().passed()) model = beyond_usual_ranges(std::move(*model), prepared(fit_), options_.threads);
    if (std::string note = unseen_in_words(); !note.empty()) baseline_.notes.push_back(std::move(note));
    std::ranges::move(wider_ranges_in_words(model->asset, asset_), std::back_inserter(baseline_.notes));
    if (!windowed() && !time_.deadline().passed()) model = weighed_by_what_is_recorded(std::move(*model));
    baseline_.model = std::make_shared<const FittedModel>(std::move(*model));
    return std::move(baseline_);
  }

 private:
  // Colours of the measured channels that drive the simulation. What a law does must be more than what they feign.
  NoiseColour noise_of_inputs() {
    const std::vector<std::string> inputs = simulated_part(asset_, fit_.samples.front()).inputs;
    if (inputs.empty()) return {};
    fit_.resolution = holdout_.resolution = kMeasuredInputResolution;
    find_noise(fit_, inputs);
    fit_.of_inputs = holdout_.of_inputs = fit_.colour.front();
    return fit_.of_inputs;
  }

  // What does not count where the driving input reverses; "": all samples count.
  [[nodiscard]] std::string unseen_in_words() const {
    double unseen = 0.0, all = 0.0;
    for (const TimeSeries& samples : fit_.samples) {
      unseen += static_cast<double>(unseen_samples(asset_, samples).size());
      all += static_cast<double>(samples.time_s.size());
    }
    if (unseen == 0.0) return {};
    const PlantPart part = simulated_part(asset_, fit_.samples.front());
    return "The recordings do not show " + part.not_recorded + ": where the " + in_words(part.inputs.front()) +
           " reverses, samples do not count (" + number(100.0 * unseen / all, 2) +
           " %). To see what happens there, record " + part.record + ".";
  }

  // Fitted again where its residuals refute the colour of the noise.
  FittedModel with_colour_of_residuals(FittedModel model, const std::vector<std::string>& channels) {
    const std::vector<NoiseColour> before = fit_.colour;
    if (!take_colour_of_residuals(model, fit_)) return model;
    Result<FittedModel> again = fit_model(model.asset, prepared(fit_), &model, options_.threads);
    if (!again) {  // time is up
      fit_.colour = before;
      return model;
    }
    baseline_.notes = colours_in_words(fit_, channels);
    holdout_.colour.assign(holdout_.samples.size(), fit_.colour.front());
    return std::move(*again);
  }

  // Far off, the model's error decides, and some of the windows show it as well as all.
  Result<FittedModel> of_fewer_windows(FittedModel model) {
    double rows = 0.0;
    for (const TimeSeries& samples : fit_.samples) rows += static_cast<double>(samples.time_s.size());
    const auto step = static_cast<std::size_t>(rows / kEnoughRows);
    if (!windowed() || excess(model) <= kFarOff || step < 2 || time_.deadline().passed()) return model;
    fit_.window_step = step;
    return fit_model(model.asset, prepared(fit_), nullptr, options_.threads);
  }

  // Fitted again with every fixed value that shows as an unknown within its tolerance.
  FittedModel with_tolerances(FittedModel model) {
    const PlantDescription& plant = model.problem.recordings.front().simulation->plant();
    std::vector<KnownValue> known = known_values(asset_, plant);
    std::ranges::copy(known_inputs(asset_, model.problem), std::back_inserter(known));
    fit_.known = that_show(known, model, prepared(fit_), options_.threads);
    if (fit_.known.empty()) return model;
    Result<FittedModel> again = fit_by_averaged_inputs(model.asset, prepared(fit_), &model, options_.threads);
    if (again) return std::move(*again);
    fit_.known.clear();
    return model;
  }

  // The recording on which the model fails by itself, at the start values or while it is fitted; "" where none does.
  [[nodiscard]] std::string first_not_simulated() const {
    for (std::size_t k = 0; k < fit_.samples.size(); ++k)
      if (!fit_model(asset_, prepared(only(fit_, k)), nullptr, options_.threads)) return fit_.names[k];
    return {};
  }

  // Fitted again with less weight where the input's course between its samples decides.
  FittedModel weighed_by_what_is_recorded(FittedModel model) {
    if (!holdout_.samples.empty())
      if (const auto held_out = fit_model(with_fixed_parameters(model.asset), holdout_, nullptr, options_.threads))
        holdout_.weight = unrecorded_input(*held_out, holdout_).weight;
    UnrecordedInput unrecorded = unrecorded_input(model, fit_);
    fit_.weight = std::move(unrecorded.weight);
    fit_.resolution = std::max(fit_.resolution, unrecorded.resolution);
    baseline_.input_swings = unrecorded.resolution > 0.0;
    if (fit_.weight.empty()) return model;
    Result<FittedModel> again = fit_model(model.asset, fit_, &model, options_.threads);
    if (!again) {  // time is up
      fit_.weight.clear();
      holdout_.weight.clear();
      return model;
    }
    if (std::string note = unrecorded_input_in_words(*again); !note.empty()) {
      if (unrecorded.resolution > 0.0)
        note += " That may feign laws: below " + number(100.0 * unrecorded.resolution) +
                " % of a size that matters none is asked for.";
      baseline_.notes.push_back(std::move(note));
    }
    return std::move(*again);
  }

  [[nodiscard]] bool windowed() const { return baseline_.window_s > 0.0; }
  [[nodiscard]] Data prepared(const Data& data) const { return in_windows(data, baseline_.window_s); }

  const AssetConfig& asset_;
  Data &fit_, &holdout_;
  const ExplainOptions& options_;
  TimeBudget& time_;
  Baseline baseline_;
};

}  // namespace

bool by_measurements(const AssetConfig& asset, const Data& fit) {
  return !simulated_part(asset, fit.samples.front()).inputs.empty();
}

Result<Baseline> fit_baseline(const AssetConfig& asset, Data& fit, Data& holdout, const ExplainOptions& options,
                              TimeBudget& time) {
  return BaselineFit(asset, fit, holdout, options, time).run();
}

}  // namespace sealwatch::mismatch
