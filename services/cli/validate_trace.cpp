// `sealwatch validate --simulated`: a trace of somebody's simulation beside a recording (docs/logs.md).
#include <cstdio>

#include "sealwatch/core/file.hpp"
#include "sealwatch/model/plant_description.hpp"
#include "services/cli/commands.hpp"
#include "services/cli/foreign_file.hpp"
#include "services/cli/recordings.hpp"
#include "services/cli/session.hpp"
#include "services/cli/terminal.hpp"
#include "services/cli/trace_page.hpp"
#include "services/cli/trace_words.hpp"
#include "services/common/runtime/asset_file.hpp"
#include "services/common/runtime/channel_map_file.hpp"
#include "services/common/text/numbers.hpp"
#include "services/common/text/readable.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch::cli {
namespace {

constexpr std::size_t kWidth = 110;
constexpr std::size_t kAlterationsShown = 6;
constexpr double kShareShown = 0.005;  ///< what removes less explains nothing

void print_alterations(const std::vector<trace::Alteration>& alterations) {
  std::size_t shown = 0;
  for (const trace::Alteration& alteration : alterations) {
    if (alteration.removed_share < kShareShown && !alteration.would_do) continue;
    if (++shown > kAlterationsShown) break;
    std::printf("    %6s  %-12s %s\n", text::percent_text(alteration.removed_share).c_str(),
                alteration.would_do ? "explains it" : "", alteration_text(alteration).c_str());
  }
  if (shown == 0) std::printf("      no alteration that was tried removes any of it\n");
}

void print_channel(const trace::ChannelComparison& channel) {
  std::printf("\n  %s: %s (p %s)\n", text::in_words(channel.name).c_str(),
              channel.differs ? "differs beyond noise" : "no difference beyond noise",
              text::p_value_text(channel.p_value).c_str());
  std::printf("    difference %s rms, %s of it unexplained by any alteration; %s effective samples of %zu; NRMSE %s\n",
              text::readable(channel.rms, channel.unit).c_str(),
              text::readable(channel.noise_std, channel.unit).c_str(),
              text::number_text(channel.effective_samples).c_str(), channel.recorded.size(),
              text::percent(channel.nrmse_percent / 100.0, 2).c_str());
  if (!channel.differs) return;
  std::printf("    shows as: %s\n", wrapped(text::separated(channel.by), kWidth, 4).c_str());
  for (const trace::MisfitInterval& interval : channel.intervals)
    std::printf("    %6s of the misfit between %s and %s s\n", text::percent_text(interval.misfit_share).c_str(),
                number(interval.begin_s).c_str(), number(interval.end_s).c_str());
  for (const trace::RegimeMisfit& regime : channel.regimes)
    std::printf("    %6s of the misfit when %s (%s of the time), %s rms\n",
                text::percent_text(regime.misfit_share).c_str(), regime.name.c_str(),
                text::percent_text(regime.time_share).c_str(), text::readable(regime.rms, channel.unit).c_str());
  if (channel.alterations.empty()) return;
  std::printf("  share of the misfit of %s that each would remove:\n", text::in_words(channel.name).c_str());
  print_alterations(channel.alterations);
}

void print_text(const trace::TraceComparison& comparison) {
  std::printf("%s\n", wrapped(trace_summary(comparison), kWidth, 0).c_str());
  for (const trace::ChannelComparison& channel : comparison.channels) print_channel(channel);
  if (!comparison.common.empty()) {
    std::printf("\n  share of all channels' misfit that one common cause would remove:\n");
    print_alterations(comparison.common);
  }
  const auto list = [](const char* where, const std::vector<std::string>& names) {
    if (!names.empty()) std::printf("  only in the %s, not compared: %s\n", where, text::joined(names).c_str());
  };
  std::printf("\n");
  for (const std::string& remark : comparison.remarks) std::printf("  %s\n", remark.c_str());
  list("recording", comparison.only_recorded);
  list("simulation", comparison.only_simulated);
  if (!comparison.consistent) std::printf("%s\n", wrapped(trace_limit(), kWidth, 0).c_str());
}

/// What is known of the recording: the asset's channels, or whatever the files' headers name.
struct Known {
  ChannelMap map;
  std::vector<std::string> inputs;
};

std::optional<Known> known_of(const ValidateOptions& options) {
  Known known;
  known.inputs = options.inputs;
  if (!options.asset_file.empty()) {
    const auto asset = load_asset_or_explain(options.asset_file, options.map_file);
    if (!asset) return std::nullopt;
    known.map = asset->channel_map;
    if (const Result<const PlantDescription*> plant = find_plant(asset->model); plant && known.inputs.empty())
      for (const ChannelDescription& channel : (*plant)->channels)
        if (channel.input) known.inputs.push_back(channel.name);
  } else if (!options.map_file.empty()) {
    const auto map = check_channel_map(options.map_file, nullptr);
    if (!map) return complain(combine(map.error())), std::nullopt;
    known.map = *map;
  }
  return known;
}

}  // namespace

int run_validate_trace(const ValidateOptions& options) {
  const std::optional<Known> known = known_of(options);
  if (!known) return kBadInput;
  if (options.recordings.size() != 1)
    return complain({.file = {},
                     .place = "--simulated",
                     .value = {},
                     .rule = "is held against one recording",
                     .advice = "sealwatch validate --simulated SIM.csv RECORDED.csv"}),
           kBadInput;
  const Result<Recording> recorded = read_any_channels(options.recordings.front(), known->map);
  const Result<Recording> simulated = recorded ? read_simulated_channels(options.simulated, known->map) : recorded;
  if (!simulated) return complain(simulated.error()), kBadInput;
  tell_warnings(*recorded), tell_warnings(*simulated);
  Progress progress("comparing", 1 + recorded->samples.channels.size(), "channels");
  trace::Options asked;
  asked.inputs = known->inputs;
  asked.progress = [&progress](std::size_t done, std::size_t) { progress.show(done); };
  const auto comparison = trace::compare_traces(recorded->samples, simulated->samples, asked);
  progress.finish();
  if (!comparison) {
    Error error = comparison.error();
    error.file = options.simulated + " beside " + options.recordings.front();
    return complain(error), kBadInput;
  }
  if (!options.page.empty()) {
    const std::string page = trace_page(*comparison, options.recordings.front(), options.simulated);
    if (const Status written = write_file(options.page, page); !written) return complain(written.error()), kBadInput;
  }
  if (options.json)
    std::printf("%s", trace_json(*comparison, options.recordings.front(), options.simulated).c_str());
  else
    print_text(*comparison);
  return comparison->consistent ? kOk : kAnswerIsNo;
}

}  // namespace sealwatch::cli
