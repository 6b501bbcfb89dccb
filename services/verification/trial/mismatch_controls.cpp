#include "services/verification/trial/mismatch_controls.hpp"

#include <algorithm>
#include <cmath>

#include "services/common/mismatch/naming.hpp"
#include "services/common/mismatch/noise.hpp"
#include "services/common/mismatch/proof.hpp"
#include "services/common/mismatch/ranking.hpp"
#include "services/common/mismatch/unrecorded_input.hpp"
#include "services/verification/trial/sparse_regression.hpp"

namespace sealwatch::verification {
namespace {

using mismatch::Data;
using mismatch::FittedModel;
using mismatch::LawStart;
using mismatch::Screening;
using mismatch::Trial;

constexpr std::size_t kBicRefits = 3;
constexpr double kFaint = 0.05;  // of a law's usual size: where a refit starts that the linear step gives no start for

Data data_of(std::span<const Recording> recordings) {
  Data data;
  for (const Recording& recording : recordings) {
    data.names.push_back(recording.recording_id);
    data.samples.push_back(recording.samples);
  }
  return data;
}

/// P(chi^2 > statistic) for many degrees of freedom (Wilson, Hilferty).
double chi_square_p(double statistic, double degrees) {
  const double spread = 2.0 / (9.0 * degrees);
  const double z = (std::cbrt(statistic / degrees) - (1.0 - spread)) / std::sqrt(spread);
  return 0.5 * std::erfc(z / std::sqrt(2.0));
}

double degrees_of(const FittedModel& model) {
  double own = 0.0;
  for (const PemRecording& recording : model.problem.recordings) own += static_cast<double>(recording.own.size());
  return model.residuals - static_cast<double>(model.problem.shared.size()) - own;
}

double bic(const FittedModel& model) {
  return model.misfit + static_cast<double>(model.free_shared) * std::log(model.residuals);
}

/// Starts of every form of a hidden law at its element: the screening's, or a faint one.
std::vector<LawStart> starts_of(const bench::TrialTruth& truth, const Screening& screening) {
  std::vector<LawStart> starts;
  for (const LawStart& start : mismatch::ranked_laws(screening, screening.variants.size()))
    if (start.effect.law->id == truth.id && start.effect.element == truth.element) starts.push_back(start);
  if (!starts.empty()) return starts;
  for (const mismatch::Candidate& candidate : screening.candidates) {
    if (candidate.law->id != truth.id || candidate.element != truth.element) continue;
    LawStart start{.effect = {candidate.law, candidate.element}, .parameters = candidate.grid.front()};
    for (const std::size_t k : mismatch::strengths_of(*candidate.law)) start.parameters[k] *= kFaint;
    starts.push_back(std::move(start));
  }
  return starts;
}

class Controls {
 public:
  Controls(const AssetConfig& asset, const bench::TrialRecordings& recordings, const bench::TrialPlan& plan,
           int threads)
      : asset_(asset),
        plan_(plan),
        threads_(threads),
        fit_(data_of(recordings.fit)),
        holdout_(data_of(recordings.holdout)) {}

  ControlRecord run() {
    if (std::ranges::find(plan_.channels, "motor_voltage") == plan_.channels.end()) return {};
    std::vector<std::string> outputs = plan_.channels;
    std::erase(outputs, "motor_voltage");
    mismatch::find_noise(fit_, outputs);
    mismatch::find_noise(holdout_, outputs);
    holdout_.colour.assign(holdout_.samples.size(), fit_.colour.front());
    auto model = mismatch::fit_model(asset_, fit_, nullptr, threads_);
    if (!model) return {};
    baseline_ = std::make_shared<const FittedModel>(std::move(*model));
    control_.known = true;
    control_.misfit = baseline_->misfit;
    control_.degrees = degrees_of(*baseline_);
    control_.chi_square_p = chi_square_p(control_.misfit, control_.degrees);
    auto screening = mismatch::screen(*baseline_, fit_, {.threads = threads_});
    if (screening) name(*screening);
    if (plan_.stratum == TrialStratum::concealed || plan_.stratum == TrialStratum::nominal_only) check_nominal();
    return control_;
  }

 private:
  void name(const Screening& screening) {
    std::vector<std::vector<LawStart>> singles;
    for (LawStart& start : mismatch::ranked_laws(screening, kBicRefits)) singles.push_back({std::move(start)});
    const std::vector<Trial> trials = mismatch::refit({{}, baseline_}, singles, fit_, threads_);
    choose_by_bic(trials);
    regress(screening);
    const auto truths = plan_.truths();
    const bool listed =
        std::ranges::none_of(truths, [](const bench::TrialTruth& truth) { return truth.id == "unlisted"; });
    if (listed) return fit_oracle(screening);
    const auto closed_forms =
        mismatch::screen(*baseline_, fit_, {.threads = threads_, .laws = mismatch::Laws::closed_forms});
    if (closed_forms) fit_oracle(*closed_forms);
  }

  void regress(const Screening& screening) {
    const std::vector<SparseTerm> kept = sparse_regression(asset_, fit_, screening.candidates);
    control_.sparse_terms = static_cast<int>(kept.size());
    if (kept.empty()) return;
    control_.sparse_id = kept.front().id;
    control_.sparse_element = kept.front().element;
    control_.sparse_gain = kept.front().gain;
  }

  void choose_by_bic(const std::vector<Trial>& trials) {
    for (const Trial& trial : trials) {
      const double gain = bic(*baseline_) - bic(*trial.model);
      if (gain <= control_.bic_gain) continue;
      control_.bic_gain = gain;
      control_.bic_id = trial.effects.front().law->id;
      control_.bic_element = trial.effects.front().element;
    }
  }

  /// The true laws' best forms, refitted with the residuals weighed as the analysis weighs them, so that both misfits
  /// are of one kind; for two laws every form of the one with the first of the other. For physics without a name the
  /// best closed form at its element.
  void fit_oracle(const Screening& screening) {
    const std::vector<bench::TrialTruth> truths = plan_.truths();
    std::vector<std::vector<LawStart>> tried;
    for (const bench::TrialTruth& truth : truths) {
      const std::vector<LawStart> starts = starts_of(truth, screening);
      if (starts.empty()) return;
      if (tried.empty()) {
        for (const LawStart& start : starts) tried.push_back({start});
      } else {
        for (auto& laws : tried) laws.push_back(starts.front());
      }
    }
    Data weighed = fit_;
    weighed.weight = mismatch::unrecorded_input(*baseline_, fit_).weight;
    Result<FittedModel> model = mismatch::fit_model(asset_, weighed, baseline_.get(), threads_);
    if (!model) return;
    const auto baseline = std::make_shared<const FittedModel>(std::move(*model));
    const FittedModel* best = baseline.get();
    std::vector<Trial> trials;
    if (!tried.empty()) {
      trials = mismatch::refit({{}, baseline}, tried, weighed, threads_);
      if (trials.empty()) return;
      const auto least = std::ranges::min_element(trials, {}, [](const Trial& trial) { return trial.model->misfit; });
      best = least->model.get();
      describe_oracle(*least, screening);
    }
    control_.oracle_fitted = true;
    control_.oracle_misfit = best->misfit;
    control_.oracle_held = held_out_rms(*best);
  }

  void describe_oracle(const Trial& trial, const Screening& screening) {
    const mismatch::Effect& effect = trial.effects.front();
    const LawParameter& strength = effect.law->parameters[mismatch::strengths_of(*effect.law).front()];
    control_.oracle_form = effect.law->form;
    control_.oracle_strength = strength.name;
    const std::string name = physics_parameter_name(effect.element, effect.law->id, strength.name);
    control_.oracle_value = mismatch::estimate_of(*trial.model, name).value_or(0.0);
    for (const mismatch::Variant& variant : screening.variants) {
      const mismatch::Candidate& candidate = screening.candidates[variant.candidate];
      if (candidate.law != effect.law || candidate.element != effect.element || variant.point != 0) continue;
      control_.minimum_detectable = variant.minimum_detectable;
      control_.absorbed = variant.absorbed;
    }
  }

  [[nodiscard]] double held_out_rms(const FittedModel& model) const {
    std::vector<mismatch::RecordingComparison> parts;
    const AssetConfig fixed = mismatch::with_fixed_parameters(model.asset);
    for (std::size_t k = 0; k < holdout_.samples.size(); ++k) {
      Data one{.names = {holdout_.names[k]}, .samples = {holdout_.samples[k]}, .colour = {holdout_.colour[k]}};
      auto predicted = mismatch::fit_model(fixed, one, nullptr, 1);
      if (predicted) {
        one.weight = mismatch::unrecorded_input(*predicted, one).weight;
        predicted = mismatch::fit_model(fixed, one, nullptr, 1);
      }
      if (!predicted) return 0.0;
      parts.push_back(mismatch::compare(*predicted, *predicted, one, 0));
      parts.back().holdout = true;
    }
    double squares = 0.0;
    const mismatch::PooledFit pooled = mismatch::pool(parts, true);
    for (const mismatch::ChannelComparison& channel : pooled.channels) squares += std::pow(channel.rms_after, 2);
    return pooled.channels.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(pooled.channels.size()));
  }

  /// The usual checks of the model fitted to the nominal tests alone: the first two of concealed sets, else all.
  void check_nominal() {
    Data nominal = fit_;
    const std::size_t tests = plan_.stratum == TrialStratum::concealed ? 2 : fit_.samples.size();
    nominal.names.resize(tests);
    nominal.samples.resize(tests);
    nominal.colour.resize(tests);
    const auto model = mismatch::fit_model(asset_, nominal, nullptr, threads_);
    if (!model) return;
    control_.nominal_checked = true;
    control_.nominal_chi_square_p = chi_square_p(model->misfit, degrees_of(*model));
    control_.nominal_whiteness_p = 1.0;
    control_.nominal_nrmse = 100.0;
    for (std::size_t k = 0; k < tests; ++k)
      for (const auto& channel : mismatch::compare(*model, *model, nominal, k).channels) {
        control_.nominal_whiteness_p = std::min(control_.nominal_whiteness_p, channel.whiteness_after);
        control_.nominal_nrmse = std::min(control_.nominal_nrmse, channel.nrmse_after);
      }
  }

  const AssetConfig& asset_;
  const bench::TrialPlan& plan_;
  int threads_;
  Data fit_, holdout_;
  std::shared_ptr<const FittedModel> baseline_;
  ControlRecord control_;
};

}  // namespace

ControlRecord run_controls(const AssetConfig& asset, const bench::TrialRecordings& recordings,
                           const bench::TrialPlan& plan, int threads) {
  return Controls(asset, recordings, plan, threads).run();
}

}  // namespace sealwatch::verification
