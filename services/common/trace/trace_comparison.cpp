#include "sealwatch/trace/trace_comparison.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "sealwatch/estimation/residual_statistics.hpp"
#include "sealwatch/signal/noise_floor.hpp"
#include "sealwatch/signal/resampling.hpp"
#include "sealwatch/trace/smooth_course.hpp"
#include "services/common/text/numbers.hpp"
#include "services/common/text/words.hpp"
#include "services/common/trace/alterations.hpp"
#include "services/common/trace/difference_tests.hpp"
#include "services/common/trace/drafts.hpp"
#include "services/common/trace/fault_regressors.hpp"
#include "services/common/trace/regimes.hpp"

namespace sealwatch::trace {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr std::size_t kFewestSamples = 100;
constexpr std::size_t kMostMemory = 30;     // samples that noise may depend on (difference_tests.cpp)
constexpr double kFarMoreLikely = 10.0;     // of -2 log L: very strong evidence (Kass and Raftery 1995)
constexpr double kEven = 0.01;              // of the interval
constexpr double kLeastOfTheSpread = 1e-9;  // rounding of the arithmetic, as a share of a channel's spread

/// The misfit of a course and what a test says of it.
struct Judged {
  double squares = 0.0;
  NoiseTest test;
};

constexpr const char* kMapThem =
    "say with --map MAP.yaml which columns of the log are which (`sealwatch asset new --from LOG` writes a map), or "
    "give both the same column names";

/// Where a file has samples. One without a usual interval, as a solver of variable steps writes it, has no gaps.
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
    for (Pair& pair : pairs_) {
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

  /// At the common times; over a gap along a smooth course.
  [[nodiscard]] FaultRegressors::Shape shape_of(const VectorXd& values) const {
    if (present_.size() == grid_times_s_.size()) {
      SmoothCourse smooth = smooth_course(values, interval_s_);
      VectorXd curvature = smooth.curvature(interval_s_);
      return {std::move(smooth.beside), std::move(smooth.slope), std::move(curvature)};
    }
    const Course between(out_.time_s, {values.begin(), values.end()});
    VectorXd whole(static_cast<Index>(grid_times_s_.size()));
    for (Index k = 0; k < whole.size(); ++k) whole(k) = between.at(grid_times_s_[static_cast<std::size_t>(k)]).first;
    const SmoothCourse smooth = smooth_course(whole, interval_s_);
    return {smooth.beside(present_), smooth.slope(present_), smooth.curvature(interval_s_)(present_)};
  }

  /// Without its own white noise, which a delay between samples would seem to lessen. One whose samples are not evenly
  /// spaced is a solver's, and has none.
  [[nodiscard]] static std::optional<Course> without_noise(const std::vector<double>& time_s,
                                                           const std::vector<double>& values) {
    const signal::SamplingGrid grid = signal::find_grid(time_s);
    if (grid.missing_count > 0 || grid.jitter_std_s > kEven * grid.interval_s) return {};
    const Eigen::Map<const VectorXd> written(values.data(), static_cast<Index>(values.size()));
    const SmoothCourse smooth = smooth_course(written, grid.interval_s);
    if (smooth.half_window == 1) return {};
    return Course(time_s, {smooth.values.begin(), smooth.values.end()});
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
      faults_.add_drive(channel.name, values);
      return;
    }
    Pair pair{.name = channel.name,
              .unit = channel.unit,
              .input = input,
              .recorded = values,
              .simulated = values,
              .noise = VectorXd::Zero(values.size()),
              .between = values,
              .course = Course(simulated_.time_s, simulated->values),
              .smooth = without_noise(simulated_.time_s, simulated->values)};
    for (Index k = 0; k < values.size(); ++k) {
      const double time_s = out_.time_s[static_cast<std::size_t>(k)];
      pair.simulated(k) = pair.course.at(time_s).first;
      if (pair.smooth) pair.noise(k) = pair.simulated(k) - pair.smooth->at(time_s).first;
      pair.between(k) = (pair.smooth ? *pair.smooth : pair.course).variance_at(time_s);
    }
    const double spread = std::sqrt((values.array() - values.mean()).square().mean());
    pair.least_variance = std::max(std::pow(kLeastOfTheSpread * spread, 2), 1e-300);
    pair.white_variance =
        std::max(pair.least_variance, std::pow(signal::estimate_noise_floor(channel.values).standard_deviation, 2));
    for (const std::vector<double>* series : {&channel.values, &simulated->values})
      pair.step_variance += std::pow(signal::estimate_noise_floor(*series).quantisation_step, 2) / 12.0;
    if (input) faults_.add_drive(channel.name, values);
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
    const AlteredChannel channel{.recorded = pair.recorded,
                                 .simulated = &pair.course,
                                 .about = 0.0,
                                 .least_variance = pair.least_variance + pair.between.mean()};
    const auto fit = fit_alteration(out_.time_s, {channel}, freedom, joints_);
    return fit && follows_nothing(*fit, {.gain = true});
  }

  void find_motion() {
    for (const char* unit : {"m/s", "m", "rad/s", "rad"})
      for (const Pair& pair : pairs_)
        if (out_.motion.empty() && pair.unit == unit && !pair.input) {
          out_.motion = pair.name;
          const bool speed = std::string(unit).ends_with("/s");
          faults_.set_motion(speed ? pair.simulated - pair.noise : shape_of(pair.simulated).slope);
        }
  }

  /// `between`: variance of what the simulation's samples leave open of the course.
  [[nodiscard]] Judged judge(const Pair& pair, const VectorXd& course, const VectorXd& between, Index first,
                             Index count) const {
    const VectorXd left = (pair.recorded - course).segment(first, count);
    Judged judged{.squares = left.squaredNorm() / static_cast<double>(count), .test = {}};
    judged.test = test_noise(
        left, faults_.groups_of(pair.name, course, {first, count}), faults_.partitions_of(course, {first, count}),
        {pair.least_variance, pair.step_variance, between.segment(first, count)}, joints_within(joints_, first, count));
    judged.test.noise_std = std::min(judged.test.noise_std, std::sqrt(judged.squares));
    return judged;
  }

  [[nodiscard]] double limit() const { return options_.significance / static_cast<double>(pairs_.size()); }

  ChannelComparison compare(Pair& pair) {
    ChannelComparison out;
    out.name = pair.name, out.unit = pair.unit, out.input = pair.input;
    const VectorXd difference = pair.recorded - pair.simulated;
    const Judged judged = judge(pair, pair.simulated, pair.between, 0, difference.size());
    const double white = signal::estimate_noise_floor(span_of(difference)).standard_deviation;
    pair.noise_variance = std::max(std::pow(std::min(white, judged.test.noise_std), 2), pair.least_variance);
    out.recorded.assign(pair.recorded.begin(), pair.recorded.end());
    out.simulated.assign(pair.simulated.begin(), pair.simulated.end());
    out.rms = std::sqrt(judged.squares);
    out.noise_std = judged.test.noise_std;
    out.effective_samples = judged.test.effective_samples;
    out.nrmse_percent = nrmse_percent(out.recorded, out.simulated);
    const double odds = judged.test.p_value < limit() ? 1.0 : odds_of_waves(pair);
    out.p_value = std::min(odds, judged.test.p_value * static_cast<double>(pairs_.size()));
    out.differs = judged.test.p_value < limit() || odds < 1.0;
    std::vector<GroupTest> telling = judged.test.groups;
    std::ranges::sort(telling, {}, &GroupTest::p_value);
    for (const GroupTest& group : telling)
      if (group.p_value * static_cast<double>(telling.size()) < limit()) out.by.push_back(group.name);
    std::vector<Regime> regimes = faults_.regimes_of_course(pair.simulated);
    std::ranges::move(levels_of(pair.simulated), std::back_inserter(regimes));
    out.regimes = misfit_by_regime(difference, regimes);
    out.intervals = misfit_by_time(out_.time_s, difference);
    out.stands_still = out.differs && pair.stands_still;
    if (out.differs && !out.stands_still) ask_alterations(pair, out);
    constexpr double kMost = 0.5;  // turned round, it misses by less than half of what it does
    out.sign_reversed = std::ranges::any_of(out.alterations, [](const Alteration& alteration) {
      return alteration.id.starts_with("sign") && alteration.removed_share > kMost;
    });
    return out;
  }

  /// A few waves are what noise of some colour may be, too, of which no regressor tells; with the other sign, or
  /// another clock, there is none of it left. How much less likely such noise is, 1 where it is not by far.
  [[nodiscard]] double odds_of_waves(const Pair& pair) const {
    constexpr double kFarWiderSearched = 30.0;  // of -2 log L: what is free is looked for over a whole range
    constexpr double kMost = 0.5;               // of the misfit
    const double unaltered = unaltered_criterion(times(), {&pair});
    const auto gain_by = [&](const Freedom& freedom, bool searched) {
      const std::optional<Draft> asked = draft("", pair.name, {&pair}, freedom);
      const double gain = asked ? unaltered - asked->told.criterion : 0.0;
      if (!searched) return gain > kFarMoreLikely ? gain : 0.0;
      return gain > kFarWiderSearched && asked->told.removed_share > kMost && leaves_noise(*asked) ? gain : 0.0;
    };
    double gain = gain_by({.offset = true, .fixed_gain = -1.0}, false);
    for (const Freedom& freedom : {Freedom{.gain = true}, Freedom{.delay = true}, Freedom{.clock = true}})
      if (gain == 0.0) gain = gain_by(freedom, true);
    return std::exp(-0.5 * gain);
  }

  [[nodiscard]] CommonTimes times() const { return {out_.time_s, joints_}; }

  [[nodiscard]] std::optional<Draft> draft(const std::string& id, const std::string& where,
                                           const std::vector<const Pair*>& pairs, const Freedom& freedom,
                                           bool about_start = false) const {
    std::optional<Draft> out = draft_of(times(), pairs, freedom, about_start);
    if (out) out->told.id = id, out->told.where = where;
    return out;
  }

  /// Whether what an alteration leaves of its channels is noise.
  [[nodiscard]] bool leaves_noise(const Draft& draft) const {
    const AlterationFit& fit = draft.fit;
    if (std::ranges::any_of(draft.pairs, &Pair::stands_still)) return false;
    for (std::size_t k = 0; k < draft.pairs.size(); ++k) {
      const Pair& pair = *draft.pairs[k];
      const Judged left =
          judge(pair, fit.altered[k], open_variance(pair, draft.freedom, draft.smooth), fit.first, fit.count);
      if (left.test.p_value < limit()) return false;
    }
    return true;
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
    // Smooth noise may hide what an alteration leaves; another that is far more likely shows that it is no noise.
    double best = unaltered_criterion(times(), {&pair}) - kFarMoreLikely;
    for (const std::vector<Way>& level : levels) {
      std::vector<Draft> drafts;
      for (const Way& way : level)
        if (std::optional<Draft> asked = ask(way, pair)) drafts.push_back(std::move(*asked));
      // A gain may lessen the simulation's own noise, and so be likelier, without coming nearer to the recording.
      const auto comes_nearer = [](const Draft& asked) { return asked.told.removed_share > 0.0; };
      for (const Draft& asked : drafts)
        if (comes_nearer(asked)) best = std::min(best, asked.told.criterion);
      for (Draft& asked : drafts) {
        asked.told.would_do =
            comes_nearer(asked) && asked.told.criterion <= best + kFarMoreLikely && leaves_noise(asked);
        out.alterations.push_back(std::move(asked.told));
      }
      if (std::ranges::any_of(out.alterations, &Alteration::would_do)) break;
    }
    std::ranges::sort(out.alterations, [](const Alteration& a, const Alteration& b) {
      return a.would_do != b.would_do ? a.would_do
             : a.would_do             ? a.criterion < b.criterion
                                      : a.removed_share > b.removed_share;
    });
  }

  [[nodiscard]] std::optional<Draft> ask(const Way& way, const Pair& pair) const {
    std::string id = way.id;
    if (pair.input)
      for (const auto& [sensor, input] :
           {std::pair{"sensor_gain", "input_gain"}, {"sensor_bias", "input_bias"}, {"sensor_lag", "input_delay"}})
        if (const std::size_t at = id.find(sensor); at != std::string::npos)
          id.replace(at, std::string(sensor).size(), input);
    const std::string where = way.freedom.clock ? "clock" : (pair.input ? "input:" : "sensor:") + pair.name;
    return draft(id, where, {&pair}, way.freedom);
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
    std::optional<Draft> asked = draft(id, where, pairs, freedom, about_start);
    if (!asked) return;
    asked->told.would_do = asked->told.criterion < unaltered_criterion(times(), pairs) && leaves_noise(*asked);
    out_.common.push_back(std::move(asked->told));
  }

  /// An offset of the input shifts all that it drives, each by a size of its own.
  void ask_input_offset(const std::vector<const Pair*>& driven) {
    Alteration all{.id = "input_bias", .where = "input", .parameters = {}, .removed_share = 1.0, .would_do = true};
    for (const Pair* pair : driven) {
      std::optional<Draft> one = draft(all.id, all.where, {pair}, {.offset = true});
      if (!one) return;
      Alteration& told = one->told;
      told.parameters.front().name = "offset of " + pair->name;
      all.removed_share = std::min(all.removed_share, told.removed_share);
      all.criterion += told.criterion;
      all.would_do = all.would_do && std::abs(one->fit.offset) > kShifted * one->fit.offset_std && leaves_noise(*one);
      all.parameters.push_back(std::move(told.parameters.front()));
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
  TraceComparison out_;
  FaultRegressors faults_{out_.time_s, [this](const VectorXd& values) { return shape_of(values); }};
};

}  // namespace

Result<TraceComparison> compare_traces(const TimeSeries& recorded, const TimeSeries& simulated,
                                       const Options& options) {
  return Comparison(recorded, simulated, options).run();
}

}  // namespace sealwatch::trace
