#include "services/data_acquisition/data_acquisition.hpp"

#include <algorithm>
#include <cassert>

#include "services/common/text/format.hpp"
#include "services/common/text/numbers.hpp"
#include "services/data_acquisition/pst_id.hpp"
#include "services/data_acquisition/recording_blocks.hpp"

namespace sealwatch {
namespace {

/// Of what people say it wants retractions, for who judges the dates of its tests (runtime/admission.hpp).
constexpr Topic kInputs[] = {Topic::raw_samples, Topic::maintenance_event};
constexpr Topic kOutputs[] = {Topic::sample_block};
constexpr const char* kProducer = "data_acquisition 0.1.0";
/// Time passes tick by tick, about once a second. A clock that is set, forwards or backwards, ends no test that goes
/// on.
constexpr double kLongestTickSeconds = 5.0;
constexpr const char* kCut = "cut: another test began before this one ended";

/// What all blocks of one test share. Neither content nor block number: a block in the middle must be known by it.
std::string identity(const std::string& asset_id, const std::string& source_id, const std::string& recording_id,
                     bool start_known, std::int64_t start_ns) {
  return asset_id + '\n' + source_id + '\n' + recording_id + '\n' + (start_known ? std::to_string(start_ns) : "");
}
std::string identity(const RawSamples& raw) {
  return identity(raw.asset_id, raw.source_id, raw.recording_id, raw.start_time_known, raw.start_time_ns);
}
std::string identity(const SampleBlock& block) {
  return identity(block.asset_id, block.source_id, block.recording_id, block.header.event_time_known,
                  block.header.event_time_ns);
}

std::optional<UtcTime> start_of(const RawSamples& raw) {
  return raw.start_time_known ? std::optional(UtcTime{raw.start_time_ns}) : std::nullopt;
}
std::optional<UtcTime> start_of(const SampleBlock& block) {
  return block.header.event_time_known ? std::optional(UtcTime{block.header.event_time_ns}) : std::nullopt;
}

template <class Block>
bool comes_whole(const Block& block) {
  return block.header.replay || block.source_id == kFolderSource;
}

bool begins(const RawSamples& raw) {
  return raw.boundary == BlockBoundary::begin || raw.boundary == BlockBoundary::whole || raw.block_number == 0;
}

bool ends(BlockBoundary boundary) { return boundary == BlockBoundary::end || boundary == BlockBoundary::whole; }

/// Block 0 begins a test, whether its sender says so or not.
BlockBoundary boundary_of(const RawSamples& raw) {
  if (raw.block_number != 0) return raw.boundary;
  return ends(raw.boundary) ? BlockBoundary::whole : BlockBoundary::begin;
}

}  // namespace

Status DataAcquisitionOptions::validate() const {
  const auto check = [](bool good, const char* option, double value, const char* rule) -> Status {
    if (good) return {};
    return fail(Error{.file = {}, .place = option, .value = text::general(value), .rule = rule, .advice = {}});
  };
  if (Status s = check(time_out_s > 0.0, "time_out_s", time_out_s, "must be positive"); !s) return s;
  if (Status s = check(least_frozen_s > 0.0, "least_frozen_s", least_frozen_s, "must be positive"); !s) return s;
  if (Status s = check(gap_factor > 1.0, "gap_factor", gap_factor, "must be above 1"); !s) return s;
  if (Status s = check(failed_share >= 0.0 && failed_share <= 1.0, "failed_share", failed_share, "must be 0 to 1"); !s)
    return s;
  return check(unknown_missing_share >= 0.0 && unknown_missing_share <= 1.0, "unknown_missing_share",
               unknown_missing_share, "must be 0 to 1");
}

DataAcquisition::DataAcquisition(std::vector<AssetConfig> assets, DataAcquisitionOptions options)
    : assets_(std::move(assets)), options_(options) {
  assert(options_.validate());
}

std::span<const Topic> DataAcquisition::inputs() const { return kInputs; }
std::span<const Topic> DataAcquisition::outputs() const { return kOutputs; }

bool DataAcquisition::is_closed(const RawSamples& first_block) const {
  return finished_.contains(make_pst_id(first_block));
}

std::vector<SampleBlock> DataAcquisition::closing_blocks(const std::string& source_id,
                                                         const std::string& reason) const {
  std::vector<SampleBlock> blocks;
  for (const auto& [identity, running] : running_)
    if (running.source_id == source_id) blocks.push_back(running.test.closing_block(reason));
  return blocks;
}

OpenTest DataAcquisition::open(const std::string& asset_id) const {
  for (const AssetConfig& asset : assets_) {
    if (asset.asset_id != asset_id) continue;
    const Result<const PlantDescription*> plant = find_plant(asset.model);
    return {asset_id, &asset, plant ? *plant : nullptr, options_};
  }
  return {asset_id, nullptr, nullptr, options_};
}

void DataAcquisition::restore(const Message& own_output) {
  const auto* block = std::get_if<SampleBlock>(&own_output);
  if (!block || finished_.contains(block->header.pst_id)) return;
  const auto found = running_.find(identity(*block));
  Running& running = found == running_.end() ? begin(*block, block->header.pst_id) : found->second;
  running.test.absorb(*block);
  if (ends(block->boundary)) finish(identity(*block));
}

template <class Block>
DataAcquisition::Running& DataAcquisition::begin(const Block& block, const std::string& pst_id) {
  Running running{.pst_id = pst_id, .test = open(block.asset_id)};
  running.asset_id = block.asset_id;
  running.source_id = block.source_id;
  running.start = start_of(block);
  running.comes_whole = comes_whole(block);
  return running_.emplace(identity(block), std::move(running)).first->second;
}

bool DataAcquisition::tells_all(const Message& last_of_test) const {
  const auto* block = std::get_if<SampleBlock>(&last_of_test);
  return block != nullptr && ends(block->boundary);
}

Conclusion DataAcquisition::receive(const Message& input) {
  Conclusion conclusion;
  if (const auto* raw = std::get_if<RawSamples>(&input)) take_raw(*raw, conclusion);
  conclusion.consumed.push_back(header_of(input).message_id);
  return conclusion;
}

void DataAcquisition::take_raw(const RawSamples& raw, Conclusion& conclusion) {
  Running* running = running_test(raw, conclusion);
  if (!running || running->test.seen(raw.block_number)) return;
  running->silent_s = 0.0;
  if (const auto beyond = running->test.beyond_limits(raw)) return refuse(raw, "refused: " + *beyond, conclusion);
  SampleBlock block = stamp(raw, running->pst_id);
  running->test.complete(raw, block);
  if (ends(block.boundary)) finish(identity(raw));
  conclusion.outputs.emplace_back(std::move(block));
}

/// The open test that the block belongs to, opened if need be; null for a block of a test that is over.
DataAcquisition::Running* DataAcquisition::running_test(const RawSamples& raw, Conclusion& conclusion) {
  const auto found = running_.find(identity(raw));
  const bool is_open = found != running_.end();
  if (is_open && !begins(raw)) return &found->second;
  if (!begins(raw) && finished_identities_.contains(identity(raw))) return nullptr;
  const std::string pst_id = make_pst_id(raw);
  if (is_open && found->second.pst_id == pst_id) return &found->second;
  if (finished_.contains(pst_id)) return nullptr;
  if (is_open) close(identity(raw), kCut, conclusion);
  if (begins(raw) && !comes_whole(raw)) cut_earlier_tests(raw, conclusion);
  return &begin(raw, pst_id);
}

/// An actuator does one stroke at a time: of a sender that begins the next, the last is over. What another source says
/// of it does not end the test, nor does a test of the past that is sent late.
void DataAcquisition::cut_earlier_tests(const RawSamples& raw, Conclusion& conclusion) {
  std::vector<std::string> cut;
  for (const auto& [identity, running] : running_) {
    const bool is_other = running.asset_id != raw.asset_id || running.source_id != raw.source_id || running.comes_whole;
    const bool is_later = start_of(raw) && running.start && *start_of(raw) < *running.start;
    if (!is_other && !is_later) cut.push_back(identity);
  }
  for (const std::string& identity : cut) close(identity, kCut, conclusion);
}

SampleBlock DataAcquisition::stamp(const RawSamples& raw, const std::string& pst_id) const {
  SampleBlock block;
  block.asset_id = raw.asset_id;
  block.header.message_id = "sample_block/" + pst_id + "/" + std::to_string(raw.block_number);
  block.header.pst_id = pst_id;
  if (!raw.header.message_id.empty()) block.header.source_ids = {raw.header.message_id};
  block.header.producer = kProducer;
  block.header.event_time_known = raw.start_time_known;
  block.header.event_time_ns = raw.start_time_known ? raw.start_time_ns : 0;
  block.header.replay = raw.header.replay;
  block.source_id = raw.source_id;
  block.block_number = raw.block_number;
  block.boundary = boundary_of(raw);
  block.recording_id = raw.recording_id;
  block.test_kind = raw.test_kind.empty() ? "pst" : raw.test_kind;
  block.aborted = raw.aborted;
  block.abort_reason = raw.abort_reason;
  return block;
}

/// Ends the test that would be more than one test may be: what came of it before is kept, with the reason, and what
/// comes after is passed over.
void DataAcquisition::refuse(const RawSamples& raw, const std::string& reason, Conclusion& conclusion) {
  Running& running = running_.at(identity(raw));
  if (running.test.begun()) return close(identity(raw), reason, conclusion);
  SampleBlock block = stamp(raw, running.pst_id);
  block.boundary = BlockBoundary::whole;
  block.aborted = true;
  block.abort_reason = reason;
  finish(identity(raw));
  conclusion.outputs.emplace_back(std::move(block));
}

void DataAcquisition::close(const std::string& identity, const std::string& reason, Conclusion& conclusion) {
  conclusion.outputs.emplace_back(running_.at(identity).test.closing_block(reason));
  finish(identity);
}

void DataAcquisition::finish(const std::string& identity) {
  finished_.insert(running_.at(identity).pst_id);
  finished_identities_.insert(identity);
  running_.erase(identity);
}

Conclusion DataAcquisition::tick(UtcTime now) {
  Conclusion conclusion;
  std::vector<std::string> silent;
  const double passed_s = last_tick_ ? std::clamp(seconds_between(*last_tick_, now), 0.0, kLongestTickSeconds) : 0.0;
  last_tick_ = now;
  for (auto& [identity, running] : running_) {
    if (running.comes_whole) continue;
    running.silent_s += passed_s;
    if (running.silent_s >= options_.time_out_s) silent.push_back(identity);
  }
  const std::string reason = text::format("cut: no samples for {:.0f} s", options_.time_out_s);
  for (const std::string& identity : silent) close(identity, reason, conclusion);
  return conclusion;
}

}  // namespace sealwatch
