#include "sealwatch/trace/trace_comparison.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "sealwatch/estimation/residual_statistics.hpp"
#include "sealwatch/signal/noise_floor.hpp"
#include "sealwatch/signal/resampling.hpp"
#include "sealwatch/trace/smooth_course.hpp"
#include "services/common/text/numbers.hpp"
#include "services/common/text/words.hpp"
#include "services/common/trace/alterations.hpp"
#include "services/common/trace/difference_tests.hpp"
#include "services/common/trace/regimes.hpp"

namespace sealwatch::trace {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t kFewestSamples = 100;
constexpr std::size_t kMostMemory = 30;     // samples that noise may depend on (difference_tests.cpp)
constexpr double kShifted = 4.0;            // standard errors: what is nearer to nothing is nothing
constexpr double kFarMoreLikely = 10.0;     // of -2 log L: very strong evidence (Kass and Raftery 1995)
constexpr double kLeastOfTheSpread = 1e-9;  // rounding of the arithmetic, as a share of a channel's spread

/// One channel on the common times.
struct Pair {
  std::string name, unit;
  bool input = false;
  bool stands_still = false;  ///< the recording, while the simulation moves
  VectorXd recorded, simulated;
  VectorXd between;  ///< variance of what the simulation's samples leave open of it
  Course course;
  double least_variance = 0.0;  ///< rounding of the arithmetic
  double step_variance = 0.0;   ///< of the steps in which both are written
  double white_variance = 0.0;  ///< of the recording's noise from sample to sample
};

/// What may drive the simulation, as recorded.
struct Drive {
  std::string name;
  VectorXd values;
};

/// The misfit of a course and what a test says of it.
struct Judged {
  double squares = 0.0;
  NoiseTest test;
};

MatrixXd beside(const std::vector<VectorXd>& columns) {
  MatrixXd out(columns.front().size(), static_cast<Index>(columns.size()));
  for (std::size_t k = 0; k < columns.size(); ++k) out.col(static_cast<Index>(k)) = columns[k];
  return out;
}

/// Where a file has samples. One without a usual interval, as a solver of variable steps writes it, has no gaps.
constexpr const char* kMapThem =
    "say with --map MAP.yaml which columns of the log are which (`sealwatch asset new --from LOG` writes a map), or "
    "give "
    "both the same column names";

class Presence {
 public:
  explicit Presence(const std::vector<double>& time_s) : time_s_(time_s) {
    const signal::SamplingGrid grid = signal::find_grid(time_s);
    interval_s_ = grid.interval_s;
    has_gaps_ = grid.missing_count > 0 && grid.jitter_std_s < kRegular * grid.interval_s;
  }

  /// On a sample, or where the cubic between samples (smooth_course.hpp) needs none beyond a gap.
  [[nodiscard]] bool has(double time_s) const {
    if (!has_gaps_) return true;
    const auto after = static_cast<std::size_t>(std::ranges::upper_bound(time_s_, time_s) - time_s_.begin());
    const double rounding = 1e-9 * interval_s_;
    if (after > 0 && time_s - time_s_[after - 1] <= rounding) return true;
    if (after < time_s_.size() && time_s_[after] - time_s <= rounding) return true;
    for (std::size_t k = std::max<std::size_t>(after, 2) - 1; k <= std::min(after + 1, time_s_.size() - 1); ++k)
      if (time_s_[k] - time_s_[k - 1] > kGap * interval_s_) return false;
    return true;
  }

 private:
  static constexpr double kRegular = 0.1;  // of the interval
  static constexpr double kGap = 1.5;      // intervals: from there on a row is missing (signal/resampling.hpp)
  const std::vector<double>& time_s_;
  double interval_s_ = 0.0;
  bool has_gaps_ = false;
};

class Comparison {
 public:
  Comparison(const TimeSeries& recorded, const TimeSeries& simulated, const Options& options)
      : recorded_(recorded), simulated_(simulated), options_(options) {}

  Result<TraceComparison> run() {
    if (const Status units = check_units(); !units) return fail(units.error());
    if (const Status common = find_common(); !common) return fail(common.error());
    find_motion();
    for (Pair& pair : pairs_) pair.stands_still = stands_still(pair);
    for (const Pair& pair : pairs_) {
      if (options_.progress) options_.progress(out_.channels.size(), pairs_.size() + 1);
      out_.channels.push_back(compare(pair));
    }
    for (const ChannelComparison& channel : out_.channels) out_.consistent = out_.consistent && !channel.differs;
    if (!out_.consistent) {
      if (options_.progress) options_.progress(pairs_.size(), pairs_.size() + 1);
      ask_common();
      answer();
      find_equals();
    }
    return std::move(out_);
  }

 private:
  /// A gain would explain any two quantities. "1" is what a column without a unit has: it may be any.
  [[nodiscard]] Status check_units() const {
    for (const Series& channel : recorded_.channels) {
      const Series* simulated = simulated_.find(channel.name);
      if (simulated == nullptr || simulated->unit == channel.unit || simulated->unit == "1" || channel.unit == "1")
        continue;
      return fail(Error{.file = {},
                        .place = "column " + channel.name,
                        .value = channel.unit,
                        .rule = "is another quantity than the simulation's " + simulated->unit,
                        .advice = "give both the same quantity, or different names"});
    }
    return {};
  }

  Status find_common() {
    if (recorded_.time_s.size() < kFewestSamples || simulated_.time_s.size() < kFewestSamples)
      return fail("too few samples to tell noise from difference: at least " + std::to_string(kFewestSamples));
    const signal::SamplingGrid grid = signal::find_grid(recorded_.time_s);
    interval_s_ = grid.interval_s;
    std::size_t first = 0, last = grid.count;
    const double rounding = 1e-6 * grid.interval_s;
    while (first < last && grid.time_s(first) < simulated_.time_s.front() - rounding) ++first;
    while (last > first && grid.time_s(last - 1) > simulated_.time_s.back() + rounding) --last;
    if (last - first < std::max(kFewestSamples, grid.count / 4))
      return fail("the simulation covers less than a quarter of the recording: from " +
                      text::general(simulated_.time_s.front()) + " to " + text::general(simulated_.time_s.back()) +
                      " s, the recording from " + text::general(recorded_.time_s.front()) + " to " +
                      text::general(recorded_.time_s.back()) + " s",
                  "both times must count from the same moment");
    if (const Status taken = take_times(grid, first, last); !taken) return fail(taken.error());
    for (const Series& channel : recorded_.channels) take(channel);
    for (const Series& channel : simulated_.channels)
      if (!recorded_.has(channel.name)) out_.only_simulated.push_back(channel.name);
    if (pairs_.empty())
      return fail("the files share no channel: the recording has " + text::joined(out_.only_recorded) +
                      ", the simulation " + text::joined(out_.only_simulated),
                  kMapThem);
    // What the simulation was given is the same in both by itself: it agrees with nothing.
    const auto given = [](const Pair& pair) { return pair.input || pair.recorded == pair.simulated; };
    if (std::ranges::all_of(pairs_, given) && !out_.only_recorded.empty() && !out_.only_simulated.empty())
      return fail("the files share inputs alone: only the recording has " + text::joined(out_.only_recorded) +
                      ", only the simulation " + text::joined(out_.only_simulated),
                  kMapThem);
    return {};
  }

  /// The grid's times at which both have samples, and where these go on after a gap.
  Status take_times(const signal::SamplingGrid& grid, std::size_t first, std::size_t last) {
    const Presence recorded(recorded_.time_s), simulated(simulated_.time_s);
    for (std::size_t k = first; k < last; ++k) {
      grid_times_s_.push_back(grid.time_s(k));
      if (!recorded.has(grid.time_s(k)) || !simulated.has(grid.time_s(k))) continue;
      if (!present_.empty() && present_.back() + 1 != static_cast<Index>(k - first))
        joints_.push_back(static_cast<Index>(present_.size()));
      present_.push_back(static_cast<Index>(k - first));
      out_.time_s.push_back(grid.time_s(k));
    }
    if (present_.size() < kFewestSamples)
      return fail("too few samples outside of gaps to tell noise from difference: at least " +
                  std::to_string(kFewestSamples));
    if (const std::size_t missing = last - first - present_.size(); missing > 0)
      out_.remarks.push_back(std::to_string(missing) + " of " + std::to_string(last - first) +
                             " samples lie in gaps and are not compared");
    // Single lost rows everywhere: there is no other noise to learn from than that across them.
    if (2 * whole_windows(static_cast<Index>(present_.size()), kMostMemory, joints_).size() < present_.size())
      joints_.clear();
    return {};
  }

  /// d/dt at the common times; over a gap along a smooth course.
  [[nodiscard]] VectorXd slope_of(const VectorXd& values) const {
    if (present_.size() == grid_times_s_.size()) return smooth_slope(values, interval_s_);
    const Course between(out_.time_s, {values.begin(), values.end()});
    VectorXd whole(static_cast<Index>(grid_times_s_.size()));
    for (Index k = 0; k < whole.size(); ++k) whole(k) = between.at(grid_times_s_[static_cast<std::size_t>(k)]).first;
    return smooth_slope(whole, interval_s_)(present_);
  }

  void take(const Series& channel) {
    const Series* simulated = simulated_.find(channel.name);
    // Both between their samples in the same way, so that what is the same stays so.
    const Course between(recorded_.time_s, channel.values);
    VectorXd values(static_cast<Index>(out_.time_s.size()));
    for (Index k = 0; k < values.size(); ++k) values(k) = between.at(out_.time_s[static_cast<std::size_t>(k)]).first;
    const bool input = std::ranges::find(options_.inputs, channel.name) != options_.inputs.end();
    if (simulated == nullptr) {
      out_.only_recorded.push_back(channel.name);
      drives_.push_back({channel.name, values});
      return;
    }
    Pair pair{.name = channel.name,
              .unit = channel.unit,
              .input = input,
              .recorded = values,
              .simulated = values,
              .between = values,
              .course = Course(simulated_.time_s, simulated->values)};
    for (Index k = 0; k < values.size(); ++k) {
      const double time_s = out_.time_s[static_cast<std::size_t>(k)];
      pair.simulated(k) = pair.course.at(time_s).first;
      pair.between(k) = pair.course.variance_at(time_s);
    }
    const double spread = std::sqrt((values.array() - values.mean()).square().mean());
    pair.least_variance = std::max(std::pow(kLeastOfTheSpread * spread, 2), 1e-300);
    pair.white_variance =
        std::max(pair.least_variance, std::pow(signal::estimate_noise_floor(channel.values).standard_deviation, 2));
    for (const std::vector<double>* series : {&channel.values, &simulated->values})
      pair.step_variance += std::pow(signal::estimate_noise_floor(*series).quantisation_step, 2) / 12.0;
    if (input) drives_.push_back({channel.name, values});
    pairs_.push_back(std::move(pair));
  }

  /// A dead channel: its values scatter as its noise does and follow the simulation nowhere.
  [[nodiscard]] bool stands_still(const Pair& pair) const {
    constexpr double kOfTheNoise = 2.0;  // of the variance; a course that moves has many times that of its noise
    const auto variance = [](const VectorXd& values) { return (values.array() - values.mean()).square().mean(); };
    if (pair.recorded.minCoeff() == pair.recorded.maxCoeff())
      return pair.simulated.minCoeff() < pair.simulated.maxCoeff();
    const double moved = variance(pair.recorded);
    if (!(variance(pair.simulated) > moved) || moved > kOfTheNoise * (pair.white_variance + pair.step_variance))
      return false;
    const Freedom freedom{.gain = true, .offset = true};
    const auto fit = fit_alteration(out_.time_s, {altered(pair, freedom)}, freedom, joints_);
    return fit && follows_nothing(*fit, {.gain = true});
  }

  /// Of a gain that may be 0 nothing of the simulation is left to explain anything with.
  [[nodiscard]] static bool follows_nothing(const AlterationFit& fit, const Freedom& freedom) {
    return freedom.gain && std::abs(fit.gain) <= kShifted * fit.gain_std;
  }

  void find_motion() {
    for (const char* unit : {"m/s", "m", "rad/s", "rad"})
      for (const Pair& pair : pairs_)
        if (out_.motion.empty() && pair.unit == unit && !pair.input) {
          out_.motion = pair.name;
          const bool speed = std::string(unit).ends_with("/s");
          motion_ = speed ? pair.simulated : slope_of(pair.simulated);
        }
  }

  /// What a simulation's faults leave behind, of a channel's course on the common times. An input does not drive itself:
  /// as recorded it has the noise that is judged.
  [[nodiscard]] std::vector<RegressorGroup> groups_of(const std::string& channel, const VectorXd& s,
                                                      double effective_samples) const {
    const Index n = s.size();
    const VectorXd one = VectorXd::Ones(n), v = slope_of(s), a = slope_of(v);
    const double begin_s = out_.time_s.front(), length_s = out_.time_s.back() - begin_s;
    VectorXd t(n);
    for (Index k = 0; k < n; ++k) t(k) = 2.0 * (out_.time_s[static_cast<std::size_t>(k)] - begin_s) / length_s - 1.0;
    std::vector<RegressorGroup> groups;
    groups.push_back({"shift, scale, delay and clock", beside({one, s, v, t.cwiseProduct(v)})});
    std::vector<VectorXd> regimes{one};
    for (const Regime& regime : parts_of(v)) regimes.push_back(regime.indicator);
    for (const Regime& level : levels_of(s)) regimes.push_back(level.indicator);
    for (const VectorXd& saturated : saturations(motion_.size() > 0 ? motion_ : v)) regimes.push_back(saturated);
    groups.push_back({"motion and level", beside(regimes)});
    std::vector<VectorXd> shapes{one, a, s.cwiseProduct(s), v.cwiseProduct(v.cwiseAbs())};
    for (const Drive& drive : drives_)
      if (drive.name != channel) shapes.push_back(drive.values), shapes.push_back(slope_of(drive.values));
    groups.push_back({"curvature and drive", beside(shapes)});
    constexpr double kMostPieces = 8.0, kSamplesAPiece = 12.0;
    const auto pieces = static_cast<Index>(std::clamp(effective_samples / kSamplesAPiece, 1.0, kMostPieces));
    std::vector<VectorXd> windows{one};
    for (Index k = 0; k < pieces; ++k) {
      windows.push_back(VectorXd::Zero(n));
      windows.back().segment(k * n / pieces, (k + 1) * n / pieces - k * n / pieces).setOnes();
    }
    groups.push_back({"time", beside(windows)});
    return groups;
  }

  [[nodiscard]] std::vector<Regime> parts_of(const VectorXd& slope) const {
    return regimes_of(motion_.size() > 0 ? motion_ : slope);
  }

  /// tanh(v/v_k) and its square for several v_k: what rubs changes its sign with the speed, at whatever speed.
  [[nodiscard]] static std::vector<VectorXd> saturations(const VectorXd& velocity) {
    std::vector<VectorXd> out;
    const double fastest = velocity.cwiseAbs().maxCoeff();
    for (const double share : {0.003, 0.01, 0.03, 0.1, 0.3}) {
      if (!(fastest > 0.0)) break;
      out.emplace_back((velocity.array() / (share * fastest)).tanh());
      out.emplace_back(out.back().array().square());
    }
    return out;
  }

  [[nodiscard]] std::vector<RegressorGroup> partitions_of(const VectorXd& s) const {
    constexpr Index kPieces = 8;
    const Index n = s.size();
    std::vector<VectorXd> motion, pieces;
    for (const Regime& regime : parts_of(slope_of(s))) motion.push_back(regime.indicator);
    for (Index k = 0; k < kPieces; ++k) {
      pieces.push_back(VectorXd::Zero(n));
      pieces.back().segment(k * n / kPieces, (k + 1) * n / kPieces - k * n / kPieces).setOnes();
    }
    return {{"scatter in motion and at rest", beside(motion)}, {"scatter in time", beside(pieces)}};
  }

  /// `between`: variance of what the simulation's samples leave open of the course.
  [[nodiscard]] Judged judge(const Pair& pair, const VectorXd& course, const VectorXd& between, Index first,
                             Index count) const {
    const VectorXd left = (pair.recorded - course).segment(first, count);
    std::vector<RegressorGroup> groups = groups_of(pair.name, course, static_cast<double>(count));
    std::vector<RegressorGroup> partitions = partitions_of(course);
    for (std::vector<RegressorGroup>* list : {&groups, &partitions})
      for (RegressorGroup& group : *list) group.columns = MatrixXd(group.columns.middleRows(first, count));
    Judged judged{.squares = left.squaredNorm() / static_cast<double>(count), .test = {}};
    judged.test =
        test_noise(left, groups, partitions, {pair.least_variance, pair.step_variance, between.segment(first, count)},
                   joints_within(joints_, first, count));
    judged.test.noise_std = std::min(judged.test.noise_std, std::sqrt(judged.squares));
    return judged;
  }

  [[nodiscard]] double limit() const { return options_.significance / static_cast<double>(pairs_.size()); }

  ChannelComparison compare(const Pair& pair) {
    ChannelComparison out;
    out.name = pair.name, out.unit = pair.unit, out.input = pair.input;
    const VectorXd difference = pair.recorded - pair.simulated;
    const Judged judged = judge(pair, pair.simulated, pair.between, 0, difference.size());
    out.recorded.assign(pair.recorded.begin(), pair.recorded.end());
    out.simulated.assign(pair.simulated.begin(), pair.simulated.end());
    out.rms = std::sqrt(judged.squares);
    out.noise_std = judged.test.noise_std;
    out.effective_samples = judged.test.effective_samples;
    out.nrmse_percent = nrmse_percent(out.recorded, out.simulated);
    out.p_value = std::min(1.0, judged.test.p_value * static_cast<double>(pairs_.size()));
    out.differs = judged.test.p_value < limit();
    std::vector<GroupTest> telling = judged.test.groups;
    std::ranges::sort(telling, {}, &GroupTest::p_value);
    for (const GroupTest& group : telling)
      if (group.p_value * static_cast<double>(telling.size()) < limit()) out.by.push_back(group.name);
    std::vector<Regime> regimes = parts_of(slope_of(pair.simulated));
    std::ranges::move(levels_of(pair.simulated), std::back_inserter(regimes));
    out.regimes = misfit_by_regime(difference, regimes);
    out.intervals = misfit_by_time(out_.time_s, difference);
    out.stands_still = out.differs && pair.stands_still;
    if (out.differs && !out.stands_still) ask_alterations(pair, out);
    return out;
  }

  /// An altered time lies between samples, and so it may where it was on one.
  [[nodiscard]] static VectorXd between(const Pair& pair, const Freedom& freedom) {
    if (!freedom.delay && !freedom.clock) return pair.between;
    return VectorXd::Constant(pair.between.size(), pair.course.mean_variance());
  }

  [[nodiscard]] static AlteredChannel altered(const Pair& pair, const Freedom& freedom, double about = 0.0) {
    return {.recorded = pair.recorded,
            .simulated = &pair.course,
            .about = about,
            .least_variance = pair.least_variance + between(pair, freedom).mean()};
  }

  [[nodiscard]] static std::vector<AlteredParameter> parameters_of(const AlterationFit& fit, const Freedom& freedom,
                                                                   const std::string& unit) {
    std::vector<AlteredParameter> out;
    if (freedom.gain) out.push_back({"gain", fit.gain, fit.gain_std, "1"});
    if (!freedom.gain && freedom.fixed_gain < 0.0) out.push_back({"gain", freedom.fixed_gain, 0.0, "1"});
    if (freedom.offset) out.push_back({"offset", fit.offset, fit.offset_std, unit});
    if (freedom.delay) out.push_back({"delay", fit.delay_s, fit.delay_std_s, "s"});
    if (freedom.clock) out.push_back({"clock rate", fit.clock, fit.clock_std, "1"});
    return out;
  }

  /// Of several channels at once: the share removed of their misfits, each in units of its noise from sample to sample.
  [[nodiscard]] Alteration judged(std::string id, std::string where, const std::vector<const Pair*>& pairs,
                                  const AlterationFit& fit, const Freedom& freedom) const {
    Alteration out{.id = std::move(id), .where = std::move(where), .parameters = {}};
    out.parameters = parameters_of(fit, freedom, pairs.front()->unit);
    out.criterion = fit.criterion;
    out.would_do = true;
    double before = 0.0, after = 0.0;
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      const Judged left = judge(*pairs[k], fit.altered[k], between(*pairs[k], freedom), fit.first, fit.count);
      const double noise = pairs[k]->white_variance;
      const VectorXd raw = pairs[k]->recorded - pairs[k]->simulated;
      before += std::max(raw.squaredNorm() / static_cast<double>(raw.size()) / noise - 1.0, 0.0);
      after += std::max(left.squares / noise - 1.0, 0.0);
      out.would_do = out.would_do && !pairs[k]->stands_still && left.test.p_value >= limit();
    }
    out.removed_share = before > 0.0 ? std::clamp(1.0 - after / before, 0.0, 1.0) : 0.0;
    out.would_do = out.would_do && out.removed_share > 0.0;
    return out;
  }

  struct Way {
    const char* id;
    Freedom freedom;
  };

  /// One by one; two or three together only where no one of them would do.
  void ask_alterations(const Pair& pair, ChannelComparison& out) const {
    static const std::vector<std::vector<Way>> levels = {
        {{"sensor_gain", {.gain = true}},
         {"sensor_bias", {.offset = true}},
         {"sensor_lag", {.delay = true}},
         {"clock_rate", {.clock = true}},
         {"sign", {.fixed_gain = -1.0}}},
        {{"sensor_gain and sensor_bias", {.gain = true, .offset = true}},
         {"sensor_gain and sensor_lag", {.gain = true, .delay = true}},
         {"sensor_bias and sensor_lag", {.offset = true, .delay = true}},
         {"sign and sensor_bias", {.offset = true, .fixed_gain = -1.0}}},
        {{"sensor_gain, sensor_bias and sensor_lag", {.gain = true, .offset = true, .delay = true}}}};
    for (const std::vector<Way>& level : levels) {
      for (const Way& way : level) ask(way, pair, out);
      if (std::ranges::any_of(out.alterations, &Alteration::would_do)) break;
    }
    keep_the_likeliest(out.alterations);
    std::ranges::sort(out.alterations, [](const Alteration& a, const Alteration& b) {
      return a.would_do != b.would_do ? a.would_do
             : a.would_do             ? a.criterion < b.criterion
                                      : a.removed_share > b.removed_share;
    });
  }

  /// Smooth noise may hide what an alteration leaves; another that is far more likely shows that it is no noise.
  static void keep_the_likeliest(std::vector<Alteration>& alterations) {
    double best = std::numeric_limits<double>::infinity();
    for (const Alteration& alteration : alterations) best = std::min(best, alteration.criterion);
    for (Alteration& alteration : alterations)
      alteration.would_do = alteration.would_do && alteration.criterion <= best + kFarMoreLikely;
  }

  void ask(const Way& way, const Pair& pair, ChannelComparison& out) const {
    const std::vector<AlteredChannel> channels{altered(pair, way.freedom)};
    const std::optional<AlterationFit> fit = fit_alteration(out_.time_s, channels, way.freedom, joints_);
    if (!fit || follows_nothing(*fit, way.freedom)) return;
    std::string id = way.id;
    if (pair.input)
      for (const auto& [sensor, input] :
           {std::pair{"sensor_gain", "input_gain"}, {"sensor_bias", "input_bias"}, {"sensor_lag", "input_delay"}})
        if (const std::size_t at = id.find(sensor); at != std::string::npos)
          id.replace(at, std::string(sensor).size(), input);
    const std::string where = way.freedom.clock ? "clock" : (pair.input ? "input:" : "sensor:") + pair.name;
    out.alterations.push_back(judged(id, where, {&pair}, *fit, way.freedom));
  }

  /// One cause for all: a clock moves every channel, an input all that it drives.
  void ask_common() {
    std::vector<const Pair*> all, driven;
    for (const Pair& pair : pairs_) {
      all.push_back(&pair);
      if (!pair.input) driven.push_back(&pair);
    }
    ask_common("clock_rate", "clock", all, {.clock = true}, false);
    if (driven.empty()) return;
    ask_common("input_delay", "input", driven, {.delay = true}, false);
    ask_common("input_gain", "input", driven, {.gain = true}, true);
    ask_common("input_sign", "input", driven, {.fixed_gain = -1.0}, true);
    if (driven.size() > 1) ask_input_offset(driven);
    std::ranges::sort(out_.common,
                      [](const Alteration& a, const Alteration& b) { return a.removed_share > b.removed_share; });
  }

  void ask_common(const char* id, const char* where, const std::vector<const Pair*>& pairs, const Freedom& freedom,
                  bool about_start) {
    std::vector<AlteredChannel> channels;
    for (const Pair* pair : pairs) channels.push_back(altered(*pair, freedom, about_start ? pair->simulated(0) : 0.0));
    const std::optional<AlterationFit> fit = fit_alteration(out_.time_s, channels, freedom, joints_);
    if (fit && !follows_nothing(*fit, freedom)) out_.common.push_back(judged(id, where, pairs, *fit, freedom));
  }

  /// An offset of the input shifts all that it drives, each by a size of its own.
  void ask_input_offset(const std::vector<const Pair*>& driven) {
    Alteration all{.id = "input_bias", .where = "input", .parameters = {}, .removed_share = 1.0, .would_do = true};
    for (const Pair* pair : driven) {
      const Freedom freedom{.offset = true};
      const std::optional<AlterationFit> fit = fit_alteration(out_.time_s, {altered(*pair, freedom)}, freedom, joints_);
      if (!fit) return;
      Alteration one = judged(all.id, all.where, {pair}, *fit, freedom);
      one.parameters.front().name = "offset of " + pair->name;
      all.removed_share = std::min(all.removed_share, one.removed_share);
      all.criterion += one.criterion;
      all.would_do = all.would_do && one.would_do && std::abs(fit->offset) > kShifted * fit->offset_std;
      all.parameters.push_back(std::move(one.parameters.front()));
    }
    out_.common.push_back(std::move(all));
  }

  /// What would do alone in place of a single answer. Only of the same channels one may be the likelier.
  void find_equals() {
    if (out_.answer.size() != 1) return;
    const Alteration& answer = out_.answer.front();
    const bool one_driven = std::ranges::count(pairs_, false, &Pair::input) == 1;
    const auto add = [&](const Alteration& other, bool comparable) {
      if (answer.id.ends_with("sign") && other.id.ends_with("gain")) return;  // a sign is a gain
      const auto is_other = [&other](const Alteration& known) { return known.id == other.id; };
      if (!other.would_do || is_other(answer) || std::ranges::any_of(out_.equally, is_other)) return;
      if (!comparable || other.criterion <= answer.criterion + kFarMoreLikely) out_.equally.push_back(other);
    };
    const std::vector<const ChannelComparison*> differing = unexplained();
    if (differing.size() == 1)
      for (const Alteration& other : differing.front()->alterations) add(other, true);
    const bool of_an_input = std::ranges::any_of(differing, &ChannelComparison::input);
    for (const Alteration& common : out_.common)
      if (common.where != "input" || !of_an_input)
        add(common, common.where == "input" && (answer.where == "input" || one_driven));
  }

  [[nodiscard]] std::vector<const ChannelComparison*> unexplained() const {
    std::vector<const ChannelComparison*> differing;
    for (const ChannelComparison& channel : out_.channels)
      if (channel.differs && !channel.stands_still) differing.push_back(&channel);
    return differing;
  }

  /// One cause for all channels that differ before one for each.
  void answer() {
    const std::vector<const ChannelComparison*> differing = unexplained();
    if (differing.size() > 1)
      for (const Alteration& common : out_.common)
        if (common.would_do) {
          out_.answer = {common};
          return;
        }
    for (const ChannelComparison* channel : differing) {
      if (channel->alterations.empty() || !channel->alterations.front().would_do) {
        out_.answer.clear();
        return;
      }
      out_.answer.push_back(channel->alterations.front());
    }
  }

  const TimeSeries& recorded_;
  const TimeSeries& simulated_;
  const Options& options_;
  double interval_s_ = 0.0;
  std::vector<double> grid_times_s_;  ///< with the gaps
  std::vector<Index> present_;        ///< which of them are common times
  Joints joints_;                     ///< of the common times
  std::vector<Pair> pairs_;
  std::vector<Drive> drives_;  ///< inputs, and what only the recording has
  VectorXd motion_;
  TraceComparison out_;
};

}  // namespace

Result<TraceComparison> compare_traces(const TimeSeries& recorded, const TimeSeries& simulated,
                                       const Options& options) {
  return Comparison(recorded, simulated, options).run();
}

}  // namespace sealwatch::trace
