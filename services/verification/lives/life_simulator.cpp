#include "services/verification/lives/life_simulator.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "services/verification/lives/estimate_test.hpp"
#include "services/virtual_bench/random.hpp"

namespace sealwatch::verification {
namespace {

// Of 1/R_CL at 50 Hz and the mean load, whatever R_CL is: what the estimator reports on the cylinder circuit. The
// pressure difference that the leak has to show itself against is proportional to the load.
constexpr double kConductanceStd_m3_Pa_s = 1.04e-16;

RecordedAnswer recorded(const Forecast& forecast, const std::optional<forecast::PredictiveDistribution>& distribution,
                        double true_rul_months) {
  RecordedAnswer answer{.state = forecast.state};
  if (forecast.state == ForecastState::past_threshold) {
    answer.pit = 1.0F;
    answer.crps = static_cast<float>(true_rul_months);
  }
  if (forecast.state != ForecastState::ok || !distribution) return answer;
  answer.rul = static_cast<float>(forecast.rul_months);
  answer.interval_95_low = static_cast<float>(forecast.interval_95_low_months);
  answer.interval_95_high = static_cast<float>(forecast.interval_95_high_months);
  answer.p10 = static_cast<float>(forecast.rul_p10_months);
  answer.p90 = static_cast<float>(forecast.rul_p90_months);
  answer.pit = static_cast<float>(distribution->cdf(true_rul_months));
  answer.crps = static_cast<float>(distribution->crps(true_rul_months));
  answer.mass_within_alpha = static_cast<float>(distribution->cdf((1.0 + kAlphaLambdaAlpha) * true_rul_months) -
                                                distribution->cdf((1.0 - kAlphaLambdaAlpha) * true_rul_months));
  return answer;
}

RecordedAnswer oracle_answer(const forecast::TrueState& state, double threshold,
                             const forecast::DegradationSetting& law, double true_rul_months) {
  const auto distribution = forecast::oracle_distribution(state, threshold, law);
  if (!distribution) return {};
  Forecast forecast;
  forecast.state = ForecastState::ok;
  forecast.rul_months = distribution->quantile(0.5);
  forecast.interval_95_low_months = distribution->quantile(0.025);
  forecast.interval_95_high_months = distribution->quantile(0.975);
  forecast.rul_p10_months = distribution->quantile(0.10);
  forecast.rul_p90_months = distribution->quantile(0.90);
  return recorded(forecast, *distribution, true_rul_months);
}

}  // namespace

Result<LifeSimulator> LifeSimulator::make(VerificationSetting setting) {
  if (const Status ok = validate(setting); !ok) return fail(ok.error());
  auto truth = CircuitTruth::make(setting.asset, setting.sample_rate_Hz);  // checks the asset for every kind of truth
  if (!truth) return fail(truth.error());
  // What is known of the fleet beforehand: its constants.
  for (forecast::ForecasterSettings& forecaster : setting.forecasters)
    forecaster.population = forecast::reference_population(setting.degradation);
  auto panel = forecast::ForecastPanel::make(setting.forecasters);
  if (!panel) return fail(panel.error());
  return LifeSimulator(std::move(setting), std::move(*truth), std::move(*panel));
}

Result<std::optional<forecast::ConditionSample>> LifeSimulator::estimate(const bench::LifeSetting& life,
                                                                         const bench::PlannedTest& test) const {
  const AssetConfig& asset = setting_.asset;
  if (setting_.truth == TruthKind::condition) {
    const double conductance_std = kConductanceStd_m3_Pa_s / (1.0 + test.load_factor);
    const double resistance_std = conductance_std * test.resistance_Pa_s_m3 * test.resistance_Pa_s_m3;
    const double condition_std = asset.condition->condition_std(test.resistance_Pa_s_m3, resistance_std);
    bench::NormalRandom noise(test.seed);
    return forecast::ConditionSample{test.start_time, test.condition + condition_std * noise.next(), condition_std};
  }
  TimeSeries samples;
  if (setting_.truth == TruthKind::circuit) {
    samples = truth_.simulate(test.resistance_Pa_s_m3, test.load_factor, test.seed);
    bench::cut(samples, test.recorded_share);
  } else {
    auto recording = bench::simulate_planned(
        asset, life, test, {.sample_rate_Hz = setting_.sample_rate_Hz, .channels = circuit_channels()});
    if (!recording) return fail(recording.error());
    samples = std::move(recording->samples);
  }
  return setting_.through_layers ? estimate_through_layers(asset, samples, test.start_time)
                                 : estimate_condition(asset, samples, test.start_time);
}

Status LifeSimulator::add_answers(const forecast::ForecastRequest& request, const SealLife& seal, int month,
                                  LifeRecord& record) const {
  const double true_rul_months = record.true_rul_months(record.tests.size() - 1);
  const Result<forecast::ForecastPanel::Answer> answer = panel_.forecast(request);
  if (!answer) return fail(answer.error());
  for (std::size_t k = 0; k < answer->forecasts.size(); ++k)
    record.answers[k].push_back(recorded(answer->forecasts[k], answer->distributions[k], true_rul_months));
  record.answers.back().push_back(
      oracle_answer(seal.months[static_cast<std::size_t>(month)], request.threshold, seal.law, true_rul_months));
  return {};
}

bench::LifeSetting LifeSimulator::calendar(std::uint32_t number) const {
  const ScenarioShares shares = shares_of(setting_.scenario);
  return {.seed = bench::sub_seed(setting_.seed, "life " + std::to_string(number)),
          .months = setting_.months,
          .day_scatter = 0.0,
          .load_range = setting_.load_range,
          .missing_share = std::max(setting_.missing_share, shares.missing),
          .cut_share = std::max(setting_.cut_share, shares.cut),
          // The seal is seal_life's; here nothing ages, so that every month of service is planned.
          .degradation = {.initial_gamma = {0.0, 0.0}, .steepening_limit = {0.0, 0.0}, .irregularity = {0.0, 0.0}}};
}

Result<LifeRecord> LifeSimulator::run(std::uint32_t number) const {
  bench::LifeSetting life = calendar(number);
  const double threshold = setting_.asset.condition->threshold;
  const SealLife seal = seal_life(life.seed, setting_.degradation, threshold, setting_.scenario);
  life.months += static_cast<int>(seal.installed_months);  // months of service of the seal that fails
  const auto plan = bench::plan_life(setting_.asset, life);
  if (!plan) return fail(plan.error());
  LifeRecord record;
  record.life = number;
  record.end_of_life_months = seal.end_of_life_months;
  record.censored = seal.end_of_life_months > life.months;
  record.answers.resize(setting_.forecasters.size() + 1);
  forecast::ForecastRequest request{.threshold = threshold, .installed = life.installed};
  for (const bench::PlannedTest& planned : *plan) {
    const double time_months = months_between(life.installed, planned.start_time);
    if (time_months >= seal.end_of_life_months) break;
    if (planned.recorded_share <= 0.0) continue;
    const bench::PlannedTest test = as_it_comes(planned, *setting_.asset.condition, seal, life.seed, setting_.scenario);
    const auto estimated = estimate(life, test);
    if (!estimated) return fail(estimated.error());
    if (*estimated) request.history.push_back(**estimated);
    if (time_months < seal.scored_from_months) continue;
    RecordedTest& kept =
        record.tests.emplace_back(RecordedTest{.time_months = time_months,
                                               .condition = seal.months[static_cast<std::size_t>(test.month)].condition,
                                               .usable = estimated->has_value()});
    if (*estimated) {
      kept.estimate = (*estimated)->condition;
      kept.estimate_std = (*estimated)->condition_std;
    }
    request.now = test.start_time;
    if (const Status added = add_answers(request, seal, test.month, record); !added) return fail(added.error());
  }
  return record;
}

}  // namespace sealwatch::verification
