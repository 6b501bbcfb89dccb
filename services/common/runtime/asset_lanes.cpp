#include "services/common/runtime/asset_lanes.hpp"

#include <algorithm>
#include <exception>
#include <utility>

namespace sealwatch {
namespace {

/// Tests of one asset that may wait to be concluded from: each holds its samples, some hundred kilobytes.
constexpr std::size_t kMostLater = 4;
/// Messages that wait and are kept in memory.
constexpr std::size_t kMostKept = 64;
/// Failures in the service of a message that ended well on trial, after which it is set aside all the same; and deaths of
/// the service, for which it may not be to blame.
constexpr unsigned kMostFailures = 5;
constexpr unsigned kMostDeaths = 50;

}  // namespace

AssetLanes::AssetLanes(LayerMaker make, Load load, std::function<void()> on_result, const Options& options)
    : make_(std::move(make)),
      load_(std::move(load)),
      on_result_(std::move(on_result)),
      options_(options),
      workers_(options.workers) {}

Status AssetLanes::prepare() { return options_.try_record.empty() ? Status() : record_.keep_in(options_.try_record); }

AssetLanes::Lane& AssetLanes::lane(const std::string& asset_id) {
  Lane& found = lanes_[asset_id];
  if (!found.layer) found.layer = make_(asset_id);
  return found;
}

void AssetLanes::know(const std::string& asset_id) { lane(asset_id); }

void AssetLanes::restore(const Message& own_output) {
  Lane& of_asset = lane(asset_of(own_output));
  of_asset.layer->restore(own_output);
}

void AssetLanes::add(const std::string& asset_id, const std::string& message_id,
                     std::shared_ptr<const Message> message) {
  lane(asset_id).waiting.push_back({message_id, std::move(message)});
  ++waiting_;
  ready_.insert(asset_id);
}

void AssetLanes::save_memory() {
  if (waiting_ <= kMostKept) return;
  std::size_t kept = 0;
  for (auto& [asset_id, of_asset] : lanes_)
    for (Input& input : of_asset.waiting)
      if (input.message && ++kept > kMostKept) input.message.reset();
}

Status AssetLanes::advance() {
  look_at_trials();
  if (const auto stuck = workers_.look_after()) {
    record_.fail(*stuck);
    return sealwatch::fail(Error{
        .file = {},
        .place = *stuck,
        .value = {},
        .rule = "is not done within " + in_seconds(options_.workers.deadline) + " of processor time, and does not stop",
        .advice = "the service starts again, and sets the message aside if it is to blame"});
  }
  while (!ready_.empty())
    for (const std::string& asset_id : std::exchange(ready_, {}))
      if (Status begun = begin_next(asset_id, lanes_.at(asset_id)); !begun) return begun;
  return {};
}

Status AssetLanes::begin_next(const std::string& asset_id, Lane& lane) {
  if (lane.failed || lane.receiving || lane.waiting.empty() || lane.later.size() >= kMostLater) return {};
  Input next = std::move(lane.waiting.front());
  lane.waiting.pop_front();
  --waiting_;
  if (!next.message) {
    Result<std::optional<Message>> loaded = load_(next.message_id);
    if (!loaded) return sealwatch::fail(loaded.error());
    if (!*loaded) {  // consumed meanwhile: nothing waits for it
      ready_.insert(asset_id);
      return {};
    }
    next.message = std::make_shared<const Message>(std::move(**loaded));
  }
  lane.receiving = std::move(next);
  ++receiving_;
  const Tries tries = record_.tries(lane.receiving->message_id);
  if (tries.failures == 0 && tries.deaths == 0)
    receive(asset_id, lane);
  else if (tries.failures < kMostFailures && tries.deaths < kMostDeaths)
    try_first(asset_id, lane);
  else
    fail_without_a_try(asset_id, *lane.receiving,
                       "its service ended or failed " + std::to_string(tries.failures + tries.deaths) +
                           " times while it worked on it");
  return {};
}

void AssetLanes::try_first(const std::string& asset_id, Lane& lane) {
  const auto work = [layer = lane.layer, input = lane.receiving->message] { (void)completed(layer->receive(*input)); };
  lane.trial = Trial::begin(work, {.deadline = options_.workers.deadline, .by_clock = options_.workers.by_clock});
  if (lane.trial)
    trials_.insert(asset_id);
  else
    receive(asset_id, lane);
}

void AssetLanes::look_at_trials() {
  for (const std::string& asset_id : std::set<std::string>(trials_)) {
    Lane& of_asset = lanes_.at(asset_id);
    const auto ended = of_asset.trial->result();
    if (!ended) continue;
    trials_.erase(asset_id);
    of_asset.trial.reset();
    if (ended->empty())
      receive(asset_id, of_asset);
    else
      fail_without_a_try(asset_id, *of_asset.receiving, *ended);
  }
}

void AssetLanes::fail_without_a_try(const std::string& asset_id, const Input& input, const std::string& why) {
  Raw raw{.result = {.asset_id = asset_id, .input = input.message, .conclusion = {}, .failure = why},
          .generation = lanes_.at(asset_id).generation};
  raw.result.is_message_s_fault = true;
  post(std::move(raw));
}

void AssetLanes::receive(const std::string& asset_id, Lane& lane) {
  const auto input = lane.receiving->message;
  compute(asset_id, lane, input, false,
          [layer = lane.layer, input](const std::stop_token& stop) { return layer->receive_until(*input, stop); });
}

void AssetLanes::do_later(const std::string& asset_id, Lane& lane) {
  compute(asset_id, lane, lane.later.front().input, true, lane.later.front().work);
}

void AssetLanes::compute(const std::string& asset_id, Lane& lane, std::shared_ptr<const Message> input, bool of_later,
                         Compute work) {
  Workers::Work task{.name = header_of(*input).message_id, .is_long = of_later, .run = {}, .stop = {}};
  if (of_later) lane.stop = task.stop;
  task.run = [this, asset_id, generation = lane.generation, layer = lane.layer, input = std::move(input), of_later,
              work = std::move(work)](const std::stop_token& stop) {
    const std::string& id = header_of(*input).message_id;
    Raw raw{.result = {.asset_id = asset_id, .input = input, .conclusion = {}, .failure = {}},
            .generation = generation,
            .of_later = of_later};
    record_.begin(id);
    try {
      raw.result.conclusion = work(stop);
      if (!of_later) raw.held = layer->held();
      if (stop.stop_requested()) raw.result.failure = "it did not end within " + in_seconds(options_.workers.deadline);
    } catch (const std::bad_alloc&) {
      raw.result.failure = "it took more memory than there is";
    } catch (const std::exception& raised) {
      raw.result.failure = raised.what();
    } catch (...) {
      raw.result.failure = "it raised an exception";
    }
    if (!raw.result.failure.empty()) raw.result.conclusion = {};
    if (raw.result.failure.empty() && !raw.result.conclusion.later)
      record_.end(id);
    else
      record_.leave(id);
    post(std::move(raw));
    on_result_();
  };
  workers_.add(std::move(task));
}

void AssetLanes::post(Raw raw) {
  {
    const std::lock_guard lock(mutex_);
    results_.push_back(std::move(raw));
  }
  arrived_.notify_all();
}

std::vector<LaneResult> AssetLanes::take_results() {
  std::vector<Raw> raw;
  {
    const std::lock_guard lock(mutex_);
    raw = std::exchange(results_, {});
  }
  std::vector<LaneResult> results;
  for (Raw& one : raw)
    if (settle(one)) results.push_back(std::move(one.result));
  return results;
}

bool AssetLanes::settle(Raw& raw) {
  const std::string& asset_id = raw.result.asset_id;
  Lane& of_asset = lanes_.at(asset_id);
  if (of_asset.failed || raw.generation != of_asset.generation) return false;
  ready_.insert(asset_id);
  if (raw.of_later) {
    of_asset.later.pop_front();
    --later_;
  } else {
    of_asset.receiving.reset();
    --receiving_;
    of_asset.held = raw.held;
  }
  if (!raw.result.failure.empty()) {
    record_.fail(header_of(*raw.result.input).message_id);
    of_asset.failed = true;
    return true;
  }
  const std::vector<std::string>& again = raw.result.conclusion.again;
  for (auto id = again.rbegin(); id != again.rend(); ++id, ++waiting_) of_asset.waiting.push_front({*id, nullptr});
  bool may_begin = raw.of_later && !of_asset.later.empty();
  if (auto work = std::exchange(raw.result.conclusion.later, {})) {
    Later later{raw.result.input, std::move(work)};
    may_begin = raw.of_later || of_asset.later.empty();
    if (raw.of_later)
      of_asset.later.push_front(std::move(later));  // the rest of the same
    else
      of_asset.later.push_back(std::move(later));
    ++later_;
  }
  if (may_begin) do_later(asset_id, of_asset);
  return true;
}

void AssetLanes::wait(std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  arrived_.wait_for(lock, timeout, [this] { return !results_.empty(); });
}

void AssetLanes::begin_anew(const std::string& asset_id) {
  Lane& of_asset = lanes_[asset_id];
  of_asset.stop.request_stop();
  waiting_ -= of_asset.waiting.size();
  receiving_ -= of_asset.receiving ? 1 : 0;
  later_ -= of_asset.later.size();
  trials_.erase(asset_id);
  const std::uint64_t generation = of_asset.generation + 1;
  of_asset = Lane{};
  of_asset.generation = generation;
  of_asset.layer = make_(asset_id);
}

bool AssetLanes::is_receiving(const std::string& asset_id) const {
  const auto found = lanes_.find(asset_id);
  return found != lanes_.end() && !found->second.trial && !found->second.failed &&
         (found->second.receiving || !found->second.waiting.empty()) && found->second.later.size() < kMostLater;
}

std::size_t AssetLanes::held() const {
  std::size_t held = 0;
  for (const auto& [asset_id, of_asset] : lanes_) held += of_asset.held;
  return held;
}

Layer* AssetLanes::at_rest(const std::string& asset_id) {
  const auto found = lanes_.find(asset_id);
  if (found == lanes_.end()) return nullptr;
  Lane& of_asset = found->second;
  return of_asset.failed || of_asset.receiving || !of_asset.waiting.empty() || !of_asset.later.empty()
             ? nullptr
             : of_asset.layer.get();
}

std::vector<std::string> AssetLanes::assets() const {
  std::vector<std::string> ids;
  for (const auto& [asset_id, of_asset] : lanes_) ids.push_back(asset_id);
  return ids;
}

bool AssetLanes::stop(std::chrono::milliseconds patience) {
  record_.stop_in_order();
  return workers_.stop(patience);
}

}  // namespace sealwatch
