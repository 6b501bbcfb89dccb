// A runner with its layer, bus, journal and clock, as a daemon has them, and a feeder that speaks the stream protocol.
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "services/common/runtime/layer_runner.hpp"
#include "tests/unit/port/in_memory_bus.hpp"
#include "tests/unit/runtime/fake_layers.hpp"
#include "tests/unit/store/place.hpp"

namespace sealwatch::testing {

/// Raised in place of a SIGKILL: everything of the process is gone but its journal and what it published.
struct Killed {};

/// Counts the steps of one process and kills it at a chosen one, in whichever of its threads that is.
class Fate {
 public:
  explicit Fate(int fatal_step = -1) : fatal_step_(fatal_step) {}
  Fate(const Fate& other) : fatal_step_(other.fatal_step_) {}
  void step() {
    if (dead_ || ++steps_ == fatal_step_) die();
  }
  [[nodiscard]] int steps() const { return steps_; }
  [[nodiscard]] bool is_dead() const { return dead_; }

 private:
  void die() {
    dead_ = true;
    throw Killed();
  }
  int fatal_step_;
  std::atomic<int> steps_ = 0;
  std::atomic<bool> dead_ = false;
};

class MortalBus final : public Bus {
 public:
  MortalBus(std::shared_ptr<InMemoryNetwork> network, Fate& fate) : bus_(std::move(network)), fate_(fate) {}
  Status subscribe(std::span<const Topic> topics) override { return bus_.subscribe(topics); }
  Status subscribe_service_topics() override { return bus_.subscribe_service_topics(); }
  Status publish(const Message& message) override {
    fate_.step();  // committed, not published
    return bus_.publish(message);
  }
  Status publish(const ServiceStatus& status) override { return bus_.publish(status); }
  Status publish(const ResendRequest& request) override { return bus_.publish(request); }
  std::vector<BusItem> receive(std::chrono::milliseconds timeout, std::size_t most) override {
    auto items = bus_.receive(timeout, most);
    if (!items.empty() || fate_.is_dead()) fate_.step();  // taken from the bus, not journaled
    return items;
  }
  void wake() override { bus_.wake(); }

 private:
  InMemoryBus bus_;
  Fate& fate_;
};

class MortalLayer final : public Layer {
 public:
  MortalLayer(std::unique_ptr<Layer> layer, Fate& fate) : layer_(std::move(layer)), fate_(fate) {}
  std::string_view name() const override { return layer_->name(); }
  std::span<const Topic> inputs() const override { return layer_->inputs(); }
  std::span<const Topic> outputs() const override { return layer_->outputs(); }
  void restore(const Message& own) override { layer_->restore(own); }
  bool tells_all(const Message& last_of_test) const override { return layer_->tells_all(last_of_test); }
  Conclusion receive(const Message& input) override { return receive_until(input, {}); }
  Conclusion receive_until(const Message& input, const std::stop_token& stop) override {
    fate_.step();  // taken, before the conclusion
    Conclusion conclusion = layer_->receive_until(input, stop);
    fate_.step();  // concluded, not journaled
    return conclusion;
  }
  std::size_t held() const override { return layer_->held(); }
  std::vector<Refusal> waiting() const override { return layer_->waiting(); }
  Conclusion tick(UtcTime now) override { return layer_->tick(now); }

 private:
  std::unique_ptr<Layer> layer_;
  Fate& fate_;
};

/// Time stands still but for the tests that move it.
class TestClock final : public Clock {
 public:
  UtcTime now() const override { return {now_ns_.load()}; }
  void set(UtcTime time) { now_ns_ = time.nanoseconds; }

 private:
  std::atomic<std::int64_t> now_ns_{1'900'000'000'000'000'000};
};

/// Everything a hundred times faster than in a daemon.
inline RunnerOptions fast_options() {
  RunnerOptions options;
  options.heartbeat.interval = std::chrono::milliseconds(5);
  options.heartbeat.shortest = std::chrono::milliseconds(1);
  options.records_wait = std::chrono::milliseconds(30);
  options.settling = std::chrono::milliseconds(0);
  options.batch_pause = std::chrono::milliseconds(0);
  options.batch_time = std::chrono::seconds(5);  // on a busy machine too, a step concludes from what it took
  options.resent_at_once = std::chrono::milliseconds(5);
  options.streams.patience_s = 0.003;
  options.streams.retry_s = 0.01;
  return options;
}

class Process {
 public:
  using LayerFactory = std::function<std::unique_ptr<Layer>()>;
  Process(std::shared_ptr<InMemoryNetwork> network, const LayerFactory& make_layer, const std::string& connection,
          Fate fate = Fate(), RunnerOptions options = fast_options())
      : fate_(fate),
        bus_(network, fate_),
        heartbeat_bus_(network),
        journal_(std::move(*Journal::open(connection, std::string(make_layer()->name())))),
        runner_([this, make_layer](
                    const std::string& /*asset_id*/) { return std::make_unique<MortalLayer>(make_layer(), fate_); },
                bus_, heartbeat_bus_, journal_, clock_, std::move(options)) {}

  void start() {
    const Status started = runner_.start();
    ASSERT_TRUE(started) << started.error().describe();
  }
  void step() {
    const Status stepped = try_step();
    ASSERT_TRUE(stepped) << stepped.error().describe();
  }
  Status try_step(std::chrono::milliseconds timeout = std::chrono::milliseconds(1)) { return runner_.step(timeout); }
  [[nodiscard]] Journal& journal() { return journal_; }
  [[nodiscard]] int steps() const { return fate_.steps(); }
  /// What the layer concluded.
  [[nodiscard]] std::vector<Message> outputs() {
    std::vector<Message> found;
    EXPECT_TRUE(journal_.for_each_output([&](const Message& m) {
      if (topic_of(m) != Topic::act_record) found.push_back(m);
      return Status();
    }));
    return found;
  }
  TestClock& clock() { return clock_; }

 private:
  Fate fate_;
  TestClock clock_;
  MortalBus bus_;
  InMemoryBus heartbeat_bus_;
  Journal journal_;
  LayerRunner runner_;
};

/// Publishes blocks as a replay does: numbered, with a heartbeat, serving requests.
class Feeder {
 public:
  Feeder(std::shared_ptr<InMemoryNetwork> network, std::vector<RawSamples> blocks)
      : bus_(std::move(network)), blocks_(std::move(blocks)) {
    EXPECT_TRUE(bus_.subscribe_service_topics());
    for (std::size_t k = 0; k < blocks_.size(); ++k) {
      blocks_[k].header.writer_id = "feeder";
      blocks_[k].header.stream_sequence = k + 1;
    }
  }
  void send(std::size_t count) {
    for (; count != 0 && sent_ < blocks_.size(); --count) EXPECT_TRUE(bus_.publish(Message(blocks_[sent_++])));
  }
  /// One beat: tells how far the stream goes, answers what was asked.
  void beat() {
    ServiceStatus status;
    status.service = status.writer_id = "feeder";
    status.written = {{"raw_samples", "feeder", sent_}};
    EXPECT_TRUE(bus_.publish(status));
    for (const BusItem& item : bus_.receive(std::chrono::milliseconds(0), 1000)) {
      if (const auto* answer = std::get_if<ServiceStatus>(&item))
        for (const StreamPosition& position : answer->received)
          if (position.writer_id == "feeder") received_ = position.sequence;
      const auto* request = std::get_if<ResendRequest>(&item);
      if (request == nullptr || request->writer_id != "feeder") continue;
      for (std::uint64_t k = request->first_sequence; k <= request->last_sequence && k <= sent_; ++k)
        EXPECT_TRUE(bus_.publish(Message(blocks_[k - 1])));
    }
  }
  [[nodiscard]] bool all_received() const { return received_ == blocks_.size(); }

 private:
  InMemoryBus bus_;
  std::vector<RawSamples> blocks_;
  std::size_t sent_ = 0;
  std::uint64_t received_ = 0;
};

/// Steps until `done`, for at most `limit`, which only a failure waits for; false when it never was.
inline bool step_until(const std::function<bool()>& done, const std::function<void()>& step,
                       std::chrono::seconds limit = std::chrono::seconds(60)) {
  const auto deadline = std::chrono::steady_clock::now() + limit;
  while (!done()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    step();
  }
  return true;
}

/// Steps for so long and once more: what is done each second is done then, however rarely a busy machine lets it step.
inline void step_for(std::chrono::milliseconds time, const std::function<void()>& step) {
  const auto end = std::chrono::steady_clock::now() + time;
  while (std::chrono::steady_clock::now() < end) step();
  step();
}

}  // namespace sealwatch::testing
