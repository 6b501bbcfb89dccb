// The code that keeps the stream protocol (StreamReader, Outbox, ResendQueue), run thousands of times under a virtual
// clock with seeded faults: messages lost, late and doubled, a bus that refuses, readers whose inbox is full, kills of
// all sides at any moment, a writer's journal replaced by a backup. Whatever happened, once the faults end every reader
// has everything, once, and in the order of the writer's stream where no backup was restored. A failure names its seed.
#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "services/common/runtime/outbox.hpp"
#include "services/common/runtime/resend_queue.hpp"
#include "services/common/runtime/stream_reader.hpp"

namespace sealwatch {
namespace {

constexpr const char* kWriter = "writer";
constexpr std::array kTopics = {Topic::advisory, Topic::test_window};
constexpr std::size_t kMessages = 60;  // of each topic: several windows' worth of test_window
constexpr std::size_t kReaders = 2;
constexpr double kFaultsEnd_s = 60.0;
constexpr double kPatience_s = 900.0;

/// What is done wrong on purpose, to see that it would be found.
enum class Mistake { none, asks_for_nothing, claims_before_it_commits, believes_every_writer };

struct Random {
  explicit Random(std::uint32_t seed) : engine(seed) {}
  bool chance(double probability) { return std::uniform_real_distribution<>(0.0, 1.0)(engine) < probability; }
  std::size_t below(std::size_t count) { return std::uniform_int_distribution<std::size_t>(0, count - 1)(engine); }
  std::mt19937 engine;
};

Message message_of(Topic topic, const std::string& id, std::uint64_t sequence) {
  const auto fill = [&](auto content) {
    content.asset_id = "A";
    content.header.message_id = id;
    content.header.writer_id = kWriter;
    content.header.stream_sequence = sequence;
    return Message(content);
  };
  return topic == Topic::advisory ? fill(Advisory()) : fill(TestWindow());
}

using Journal = std::map<Topic, std::vector<std::string>>;  // message ids in the order of their numbers

/// How the runner's side of a writer goes about its streams.
class Writer {
 public:
  Writer(Journal& journal, std::int64_t started_ns) : journal_(journal), started_ns_(started_ns) {}

  /// The inputs' order differs between lives, as it does between assets.
  void conclude(Random& random) {
    const Topic topic = kTopics[random.below(kTopics.size())];
    const std::string id = "message " + std::to_string(random.below(kMessages));
    std::vector<std::string>& log = journal_[topic];
    if (std::ranges::find(log, id) != log.end()) return;
    log.push_back(id);
    outbox_.add(message_of(topic, id, log.size()));
  }
  void conclude_all() {
    for (const Topic topic : kTopics)
      for (std::size_t k = 0; k < kMessages; ++k) {
        const std::string id = "message " + std::to_string(k);
        std::vector<std::string>& log = journal_[topic];
        if (std::ranges::find(log, id) != log.end()) continue;
        log.push_back(id);
        outbox_.add(message_of(topic, id, log.size()));
      }
  }
  void take(const ResendRequest& request, Outbox::Time now) {
    const Topic topic = *value_of<Topic>(request.topic);
    const std::uint64_t sent = outbox_.first(topic).value_or(journal_[topic].size() + 1) - 1;
    (void)resends_.add({topic, request.first_sequence, request.last_sequence}, sent, request.requested_by, now);
  }
  template <class Publish>
  void send(Outbox::Time now, const Publish& publish) {
    const auto attempt = [&](Message message) {
      header_of(message).writer_started_ns = started_ns_;
      const bool taken = publish(message);
      outbox_.note(topic_of(message), taken, now);
      return taken;
    };
    outbox_.send(now, attempt);
    const auto whom = resends_.next(now);
    const auto range = whom ? resends_.take(*whom, 64) : std::nullopt;
    if (!range || outbox_.pauses(range->topic, now)) return;
    for (std::uint64_t k = range->first; k <= range->last; ++k)
      if (!attempt(message_of(range->topic, journal_[range->topic][k - 1], k))) break;
    resends_.note_sent(*whom, now, now + std::chrono::milliseconds(3), true);
  }
  [[nodiscard]] ServiceStatus status() const {
    ServiceStatus status;
    status.writer_id = kWriter;
    status.started_ns = started_ns_;
    for (const auto& [topic, log] : journal_)
      status.written.push_back({std::string(name_of(topic)), kWriter, log.size()});
    return status;
  }

 private:
  Journal& journal_;
  std::int64_t started_ns_;
  Outbox outbox_;
  ResendQueue resends_;
};

/// A reader's journal.
struct Taken {
  Journal ids;
  std::map<Topic, std::map<std::string, std::uint64_t>> numbers;
  std::map<Topic, std::uint64_t> positions;
  [[nodiscard]] bool has(Topic topic, const std::string& id) const {
    const auto found = ids.find(topic);
    return found != ids.end() && std::ranges::find(found->second, id) != found->second.end();
  }
  [[nodiscard]] std::vector<StreamPosition> as_positions() const {
    std::vector<StreamPosition> all;
    for (const auto& [topic, sequence] : positions) all.push_back({std::string(name_of(topic)), kWriter, sequence});
    return all;
  }
};

/// How the runner's side of a reader goes about a stream.
class Reader {
 public:
  Reader(Taken& journal, Mistake mistake)
      : journal_(journal),
        mistake_(mistake),
        streams_("reader", journal.as_positions(), limits(compares())),
        committed_(journal.positions) {}

  void take(Message message, double now_s) {
    const Header& header = header_of(message);
    const Topic topic = topic_of(message);
    const StreamReader::Key key{name_of(topic), kWriter};
    if (const auto committed = committed_.find(topic);
        committed != committed_.end() && header.stream_sequence <= committed->second) {
      if (journal_.has(topic, header.message_id) &&
          journal_.numbers[topic][header.message_id] == header.stream_sequence)
        streams_.note_known(message);
      else if (compares() && streams_.read_again(key, now_s))
        start_anew(topic);
    }
    for (Message& next : streams_.accept(std::move(message))) {
      if (mistake_ == Mistake::claims_before_it_commits) journal_.positions[topic] = header_of(next).stream_sequence;
      ready_.push_back(std::move(next));
    }
  }
  void take(const ServiceStatus& status, double now_s) {
    if (compares())
      for (Message& next : streams_.note_start(status.writer_id, status.started_ns, now_s))
        ready_.push_back(std::move(next));
    for (const StreamPosition& written : status.written)
      if (streams_.note_written(written, now_s)) start_anew(*value_of<Topic>(written.topic));
  }
  void commit() {
    for (; !ready_.empty(); ready_.pop_front()) {
      const Topic topic = topic_of(ready_.front());
      const Header& header = header_of(ready_.front());
      if (!journal_.has(topic, header.message_id)) journal_.ids[topic].push_back(header.message_id);
      journal_.numbers[topic][header.message_id] = header.stream_sequence;
      journal_.positions[topic] = committed_[topic] = header.stream_sequence;
    }
  }
  [[nodiscard]] std::vector<ResendRequest> requests(double now_s) {
    if (!ready_.empty() || mistake_ == Mistake::asks_for_nothing) return {};
    return streams_.requests(now_s);
  }

 private:
  /// What is claimed too early, too, is found when it is compared.
  [[nodiscard]] bool compares() const {
    return mistake_ != Mistake::believes_every_writer && mistake_ != Mistake::claims_before_it_commits;
  }
  [[nodiscard]] static StreamReader::Limits limits(bool compares) {
    StreamReader::Limits limits;
    limits.compares = compares;
    return limits;
  }
  void start_anew(Topic topic) {
    committed_.erase(topic);
    std::erase_if(ready_, [topic](const Message& message) { return topic_of(message) == topic; });
  }

  Taken& journal_;
  Mistake mistake_;
  StreamReader streams_;
  std::map<Topic, std::uint64_t> committed_;
  std::deque<Message> ready_;
};

class Simulation {
 public:
  Simulation(std::uint32_t seed, Mistake mistake, bool restores)
      : random_(seed), mistake_(mistake), restores_(restores), taken_(kReaders) {
    rate_ = 0.02 + 0.2 * static_cast<double>(random_.below(100)) / 100.0;
    readers_.resize(kReaders);
  }

  /// What went wrong, or "".
  std::string run() {
    while (now_s_ < kFaultsEnd_s) round();
    calm_ = true;
    while (now_s_ < kPatience_s && !complete()) round();
    for (std::size_t k = 0; k < kReaders; ++k)
      for (const Topic topic : kTopics)
        if (const std::string fault = fault_of(taken_[k].ids[topic], log_[topic]); !fault.empty())
          return "reader " + std::to_string(k) + ", " + std::string(name_of(topic)) + ": " + fault;
    return {};
  }

 private:
  struct Flight {
    double arrives_s;
    std::size_t reader;
    Message message;
  };
  bool fault(double share = 1.0) { return !calm_ && random_.chance(share * rate_); }

  void round() {
    now_s_ += calm_ ? 0.05 : 0.001 * static_cast<double>(1 + random_.below(200));
    now_ = Outbox::Time{} + std::chrono::microseconds(static_cast<std::int64_t>(1e6 * now_s_));
    live();
    if (writer_) {
      if (calm_)
        writer_->conclude_all();
      else
        writer_->conclude(random_);
      writer_->send(now_, [this](const Message& message) { return publish(message); });
    }
    deliver();
    beat();
    for (auto& reader : readers_)
      if (reader && !fault()) reader->commit();
    for (auto& reader : readers_) {
      if (!reader) continue;
      for (const ResendRequest& request : reader->requests(now_s_))
        if (writer_ && !fault()) writer_->take(request, now_);
    }
  }

  /// Kills, restarts, backups.
  void live() {
    if (!writer_ && (calm_ || random_.chance(0.3))) writer_.emplace(log_, ++starts_);
    for (std::size_t k = 0; k < kReaders; ++k)
      if (!readers_[k] && (calm_ || random_.chance(0.3))) readers_[k].emplace(taken_[k], mistake_);
    if (fault(0.2)) writer_.reset();
    for (auto& reader : readers_)
      if (fault(0.2)) reader.reset();
    if (restores_ && fault(0.3)) backup_ = log_;
    if (restores_ && backup_ && fault(0.05)) {
      writer_.reset();
      flights_.clear();  // a restore takes longer than messages are on their way
      log_ = *backup_;
    }
  }

  bool publish(const Message& message) {
    if (fault()) return false;
    for (std::size_t k = 0; k < kReaders; ++k) {
      if (fault()) continue;  // its inbox is full
      const double delay_s = fault() ? 0.001 * static_cast<double>(random_.below(500)) : 0.0;
      flights_.push_back({now_s_ + delay_s, k, message});
      if (fault()) flights_.push_back({now_s_ + 0.1, k, message});
    }
    return true;
  }

  void deliver() {
    std::deque<Flight> later;
    for (Flight& flight : flights_) {
      if (flight.arrives_s > now_s_)
        later.push_back(std::move(flight));
      else if (auto& reader = readers_[flight.reader])
        reader->take(std::move(flight.message), now_s_);
    }
    flights_ = std::move(later);
  }

  void beat() {
    if (!writer_ || now_s_ - beaten_s_ < 1.0) return;
    beaten_s_ = now_s_;
    for (auto& reader : readers_)
      if (reader && !fault()) reader->take(writer_->status(), now_s_);
  }

  [[nodiscard]] bool complete() {
    return std::ranges::all_of(kTopics, [&](Topic topic) {
      return log_[topic].size() == kMessages &&
             std::ranges::all_of(taken_, [&](Taken& taken) { return taken.ids[topic].size() >= kMessages; });
    });
  }

  [[nodiscard]] std::string fault_of(const std::vector<std::string>& got, const std::vector<std::string>& sent) const {
    const std::set<std::string> once(got.begin(), got.end());
    if (once.size() != got.size()) return "a message was doubled";
    for (const std::string& id : sent)
      if (!once.contains(id)) return "'" + id + "' was lost";
    if (!restores_ && got != sent) return "out of order";
    return {};
  }

  Random random_;
  Mistake mistake_;
  bool restores_;
  double rate_ = 0.0;
  double now_s_ = 0.0;
  double beaten_s_ = 0.0;
  bool calm_ = false;
  Outbox::Time now_{};
  Journal log_;
  std::optional<Journal> backup_;
  std::vector<Taken> taken_;
  std::int64_t starts_ = 0;
  std::optional<Writer> writer_;
  std::vector<std::optional<Reader>> readers_;
  std::deque<Flight> flights_;
};

/// The first seed that goes wrong, and how.
std::string search(std::uint32_t seeds, Mistake mistake, bool restores) {
  for (std::uint32_t seed = 1; seed <= seeds; ++seed)
    if (const std::string fault = Simulation(seed, mistake, restores).run(); !fault.empty())
      return "seed " + std::to_string(seed) + ": " + fault;
  return {};
}

TEST(StreamSimulation, LosesAndDoublesNothingInTwoThousandLivesUnderFaults) {
  EXPECT_EQ(search(2000, Mistake::none, false), "");
}

TEST(StreamSimulation, LosesAndDoublesNothingWhereBackupsAreRestored) {
  EXPECT_EQ(search(1000, Mistake::none, true), "");
}

TEST(StreamSimulation, FindsAReaderThatDoesNotAsk) { EXPECT_NE(search(20, Mistake::asks_for_nothing, false), ""); }

TEST(StreamSimulation, FindsAReaderThatClaimsBeforeItCommits) {
  EXPECT_NE(search(200, Mistake::claims_before_it_commits, false), "");
}

TEST(StreamSimulation, FindsAReaderThatBelievesAWriterThatWasSetBack) {
  EXPECT_NE(search(200, Mistake::believes_every_writer, true), "");
}

}  // namespace
}  // namespace sealwatch
