#include "services/data_acquisition/folder_reader.hpp"

#include <utility>

#include "services/data_acquisition/data_acquisition.hpp"
#include "services/data_acquisition/pst_id.hpp"

namespace sealwatch {
namespace {

/// A piece is one transaction of the journal, brought to the disk: some ten milliseconds.
constexpr std::size_t kBlocksOfAPiece = 16;

}  // namespace

FolderReader::FolderReader(std::filesystem::path directory, std::vector<AssetConfig> assets,
                           RecordingsFolder::Report report, std::chrono::milliseconds between_looks,
                           int looks_until_settled)
    : between_looks_(between_looks),
      folder_(
          std::move(directory), std::move(assets), [this](const RawSamples& first) { return is_concluded(first); },
          std::move(report), looks_until_settled) {}

FolderReader::~FolderReader() = default;

FolderReader::Test FolderReader::test_of(const RawSamples& first_block) {
  return {first_block.asset_id, make_pst_id(first_block)};
}

/// A test that the layer at rest has closed is a test that is stored. The thread starts with the first look: a service
/// that ends before has none to wait for.
void FolderReader::look(const LayerAtRest& at_rest) {
  std::vector<RawSamples> awaiting;
  {
    const std::lock_guard lock(mutex_);
    awaiting = awaiting_;
  }
  std::set<Test> concluded;
  for (const RawSamples& first : awaiting) {
    const auto* const layer = dynamic_cast<const DataAcquisition*>(at_rest(first.asset_id));
    if (layer != nullptr && layer->is_closed(first)) concluded.insert(test_of(first));
  }
  const std::lock_guard lock(mutex_);
  concluded_ = std::move(concluded);
  if (thread_.joinable()) return;
  ended_ = false;
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
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
