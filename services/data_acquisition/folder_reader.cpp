#include "services/data_acquisition/folder_reader.hpp"

#include <algorithm>
#include <utility>

#include "services/data_acquisition/data_acquisition.hpp"
#include "services/data_acquisition/pst_id.hpp"
#include "services/data_acquisition/recording_blocks.hpp"

namespace sealwatch {
namespace {

/// A piece is one transaction of the journal, brought to the disk: some ten milliseconds.
constexpr std::size_t kBlocksOfAPiece = 16;
/// What is replaced is gone for a moment: times as long as a copy in progress is left alone.
constexpr int kPatience = 6;
constexpr const char* kRemoved = "cut: the recording was removed from the folder before all of it was taken";

std::vector<std::string> names_of(const std::vector<AssetConfig>& assets) {
  std::vector<std::string> names;
  for (const AssetConfig& asset : assets) names.push_back(asset.asset_id);
  return names;
}

}  // namespace

FolderReader::FolderReader(std::filesystem::path directory, std::vector<AssetConfig> assets,
                           RecordingsFolder::Report report, std::chrono::milliseconds between_looks,
                           int looks_until_settled, const RetentionConfig& kept)
    : assets_(names_of(assets)),
      report_(report),
      between_looks_(between_looks),
      looks_until_removed_(kPatience * looks_until_settled),
      folder_(
          std::move(directory), std::move(assets), [this](const RawSamples& first) { return is_concluded(first); },
          std::move(report), looks_until_settled, kept) {}

FolderReader::~FolderReader() = default;

FolderReader::Test FolderReader::test_of(const RawSamples& first_block) {
  return {first_block.asset_id, make_pst_id(first_block)};
}

/// A test that the layer at rest has closed is a test that is stored. The thread starts with the first look: a service
/// that ends before has none to wait for.
void FolderReader::look(const LayerAtRest& woken, const LayerAtRest& awake) {
  std::vector<RawSamples> awaiting;
  {
    const std::lock_guard lock(mutex_);
    awaiting = awaiting_;
  }
  std::set<Test> concluded;
  for (const RawSamples& first : awaiting) {
    const auto* const layer = dynamic_cast<const DataAcquisition*>(woken(first.asset_id));
    if (layer != nullptr && layer->is_closed(first)) concluded.insert(test_of(first));
  }
  const std::vector<SampleBlock> open = open_tests(awake);
  const std::lock_guard lock(mutex_);
  concluded_ = std::move(concluded);
  end_removed(open);
  if (thread_.joinable()) return;
  ended_ = false;
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

std::vector<SampleBlock> FolderReader::open_tests(const LayerAtRest& awake) const {
  std::vector<SampleBlock> open;
  for (const std::string& asset_id : assets_)
    if (const auto* const layer = dynamic_cast<const DataAcquisition*>(awake(asset_id)))
      for (SampleBlock& block : layer->closing_blocks(kFolderSource, kRemoved)) open.push_back(std::move(block));
  return open;
}

/// Nobody else ends them: what comes whole goes on when it is given again, however late.
void FolderReader::end_removed(const std::vector<SampleBlock>& open) {
  if (!all_taken_ || !blocks_.empty()) return;
  const std::map<Test, int> before = std::exchange(missed_, {});
  for (const SampleBlock& closing : open) {
    const Test test{closing.asset_id, closing.header.pst_id};
    if (std::ranges::any_of(awaiting_, [&](const RawSamples& first) { return test_of(first) == test; })) continue;
    const auto missed = before.find(test);
    const int looks = missed_[test] = missed == before.end() ? 1 : missed->second + 1;
    if (looks != looks_until_removed_) continue;
    report_(Error{.file = closing.recording_id,
                  .place = "asset " + closing.asset_id,
                  .value = {},
                  .rule = "was removed before it was read completely: its test ends there",
                  .advice = "retract " + closing.header.pst_id + ", if it should not count"});
    blocks_.push_back(end_of(closing));
  }
  has_some_ = !blocks_.empty();
  if (has_some_) on_some_();
}

std::vector<Message> FolderReader::take() {
  std::vector<Message> piece;
  const std::lock_guard lock(mutex_);
  for (; !blocks_.empty() && piece.size() < kBlocksOfAPiece; blocks_.pop_front())
    piece.emplace_back(std::move(blocks_.front()));
  has_some_ = !blocks_.empty();
  if (blocks_.empty()) changed_.notify_all();
  return piece;
}

std::vector<ServiceAlarm> FolderReader::alarms() {
  const std::lock_guard lock(mutex_);
  return alarms_;
}

bool FolderReader::stop(std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  thread_.request_stop();
  return changed_.wait_for(lock, patience, [this] { return ended_; });
}

void FolderReader::run(const std::stop_token& stop) {
  auto next_look = std::chrono::steady_clock::now();
  while (!stop.stop_requested()) {
    const auto now = std::chrono::steady_clock::now();
    if (now >= next_look) {
      next_look = now + between_looks_;
      look_at_folder();
    }
    auto blocks = folder_.read_next();
    if (blocks && hand_over(std::move(*blocks), stop)) continue;
    std::unique_lock lock(mutex_);
    changed_.wait_until(lock, stop, next_look, [] { return false; });
  }
  const std::lock_guard lock(mutex_);
  ended_ = true;
  changed_.notify_all();
}

void FolderReader::look_at_folder() {
  folder_.look();
  const std::lock_guard lock(mutex_);
  awaiting_ = folder_.awaiting();
  alarms_ = folder_.alarms();
  all_taken_ = folder_.all_taken();
}

bool FolderReader::is_concluded(const RawSamples& first_block) {
  const std::lock_guard lock(mutex_);
  return concluded_.contains(test_of(first_block));
}

bool FolderReader::hand_over(std::vector<RawSamples> blocks, const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  for (RawSamples& block : blocks) blocks_.push_back(std::move(block));
  has_some_ = !blocks_.empty();
  if (has_some_) on_some_();
  return changed_.wait(lock, stop, [this] { return blocks_.empty(); });
}

}  // namespace sealwatch
