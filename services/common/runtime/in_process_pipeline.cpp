#include "services/common/runtime/in_process_pipeline.hpp"

#include <algorithm>
#include <chrono>

#include "sealwatch/message/id_part.hpp"
#include "services/common/runtime/identity.hpp"

namespace sealwatch {
namespace {

constexpr std::chrono::milliseconds kLook{20};

/// What a layer concluded of one asset, as far as it takes it back (Layer::restore): not the samples of tests that have
/// ended, which are most of it.
void remember(std::vector<Message>& past, const Message& output) {
  past.push_back(output);
  if (auto* const window = std::get_if<TestWindow>(&past.back())) window->samples = {};
  const auto* const end = std::get_if<SampleBlock>(&past.back());
  if (end == nullptr || (end->boundary != BlockBoundary::end && end->boundary != BlockBoundary::whole)) return;
  const std::string pst_id = end->header.pst_id;
  for (Message& message : past)
    if (auto* const block = std::get_if<SampleBlock>(&message); block != nullptr && block->header.pst_id == pst_id)
      block->samples = {};
}

}  // namespace

struct InProcessPipeline::Reader {
  /// What the journal is to a service: of each asset its past, and its inputs that are not consumed, in order.
  struct OfAsset {
    std::vector<Message> past;
    std::vector<std::shared_ptr<const Message>> open;
    std::set<std::string> set_aside;  ///< tests
  };

  Reader(const LayerMaker& make, const AssetLanes::Options& options)
      : kind(make({})),
        lanes(
            make, [this](const std::string& message_id) { return open(message_id); }, [] {}, options) {}

  [[nodiscard]] std::optional<Message> open(const std::string& message_id) const {
    for (const auto& [asset_id, of_asset] : assets)
      for (const auto& input : of_asset.open)
        if (header_of(*input).message_id == message_id) return *input;
    return std::nullopt;
  }

  std::unique_ptr<Layer> kind;
  std::map<std::string, std::string> received;                           ///< asset by message id
  std::map<std::pair<Topic, std::string>, std::string> last_unnumbered;  ///< message id by topic and asset
  std::map<std::string, OfAsset> assets;
  AssetLanes lanes;
};

InProcessPipeline::InProcessPipeline(const std::vector<LayerMaker>& layers, Observer observer, OnSetAside on_set_aside,
                                     const AssetLanes::Options& options)
    : observer_(std::move(observer)), on_set_aside_(std::move(on_set_aside)) {
  for (const LayerMaker& make : layers) readers_.push_back(std::make_unique<Reader>(make, options));
}

InProcessPipeline::~InProcessPipeline() = default;

void InProcessPipeline::push(const Message& message) {
  waiting_.push_back(without_stamps(message));
  name_replacement(waiting_.back());
  while (!waiting_.empty() && !is_over_()) {
    const Message next = std::move(waiting_.front());
    waiting_.pop_front();
    for (const auto& reader : readers_) {
      const auto inputs = reader->kind->inputs();
      if (std::ranges::find(inputs, topic_of(next)) != inputs.end()) deliver(*reader, next);
    }
  }
}

void InProcessPipeline::deliver(Reader& reader, const Message& message) {
  const std::string asset_id = asset_of(message);
  if (const auto known = reader.received.find(header_of(message).message_id);
      known != reader.received.end() && known->second != asset_id) {
    Message renamed = message;
    header_of(renamed).message_id = id_beside_another_asset(message);
    return deliver(reader, renamed);
  }
  const auto last = std::pair{topic_of(message), asset_id};
  const auto id = identify(message, {.has = [&](const std::string& known) { return reader.received.contains(known); },
                                     .last_unnumbered =
                                         [&](Topic, const std::string&) {
                                           const auto found = reader.last_unnumbered.find(last);
                                           return found == reader.last_unnumbered.end() ? std::string() : found->second;
                                         }});
  if (!id) return;
  reader.received[*id] = asset_id;
  reader.last_unnumbered[last] = *id;
  Reader::OfAsset& of_asset = reader.assets[asset_id];
  if (of_asset.set_aside.contains(header_of(message).pst_id)) return;
  Message input = message;
  header_of(input).message_id = *id;
  of_asset.open.push_back(std::make_shared<const Message>(std::move(input)));
  reader.lanes.add(asset_id, *id, of_asset.open.back());
  conclude(reader, asset_id);
}

void InProcessPipeline::conclude(Reader& reader, const std::string& asset_id) {
  while (reader.lanes.open() > 0) {
    if (const Status advanced = reader.lanes.advance(); !advanced) {
      hangs_ = true;
      begin_anew(reader, asset_id);
    }
    for (LaneResult& result : reader.lanes.take_results()) take(reader, std::move(result));
    if (reader.lanes.open() == 0) return;
    if (is_over_()) {
      hangs_ = true;
      return;
    }
    reader.lanes.wait(kLook);
  }
}

void InProcessPipeline::take(Reader& reader, LaneResult result) {
  Reader::OfAsset& of_asset = reader.assets[result.asset_id];
  for (Message& output : result.conclusion.outputs) {
    std::string& id = header_of(output).message_id;
    const auto owner = concluded_.find(id);
    if (owner != concluded_.end() && owner->second != result.asset_id) id = id_beside_another_asset(output);
    if (!concluded_.emplace(id, result.asset_id).second) continue;
    if (observer_) observer_(output);
    remember(of_asset.past, output);
    waiting_.push_back(std::move(output));
  }
  const auto drop = [&of_asset](const auto& condition) { std::erase_if(of_asset.open, condition); };
  for (const std::string& consumed : result.conclusion.consumed)
    drop([&](const auto& input) { return header_of(*input).message_id == consumed; });
  if (result.failure.empty()) return;
  if (result.is_message_s_fault) {
    const Header& header = header_of(*result.input);
    if (!header.pst_id.empty()) of_asset.set_aside.insert(header.pst_id);
    drop([&](const auto& input) {
      return input == result.input || (!header.pst_id.empty() && header_of(*input).pst_id == header.pst_id);
    });
    if (on_set_aside_) on_set_aside_(reader.kind->name(), *result.input, result.failure);
  }
  begin_anew(reader, result.asset_id);
}

void InProcessPipeline::begin_anew(Reader& reader, const std::string& asset_id) {
  reader.lanes.begin_anew(asset_id);
  const Reader::OfAsset& of_asset = reader.assets[asset_id];
  for (const Message& output : of_asset.past) reader.lanes.restore(output);
  for (const auto& input : of_asset.open) reader.lanes.add(asset_id, header_of(*input).message_id, input);
}

}  // namespace sealwatch
