// The stream protocol (docs/topics.md, Streams) as a small model, every reachable state of it explored.
//
// One writer with its journal, one reader with its own, between them messages that may be lost at any time, overtake
// each other and come again; both may be killed between any two steps, and the writer's journal may be replaced by a
// backup. The model is the protocol's rules with everything else left out; the code that keeps them is under test in
// stream_test, stream_simulation_test and kill_test.
//
//   safety    the reader's journal never holds a message twice; without a backup it is the beginning of the writer's
//   progress  from every reachable state one is reachable where the reader has all that the writer has
//
// Each rule is left out in turn in a model of its own, which must then break: a search that cannot find a fault proves
// nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <sstream>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace sealwatch {
namespace {

using Number = char;   // of a message in its stream: 1, 2, ...
using Content = char;  // what stands for a message id: 1, 2, ...

struct Rules {
  bool commits_before_publishing = true;
  bool tells_how_far_it_goes = true;     ///< heartbeat
  bool asks_for_what_is_missing = true;  ///< resend_request
  bool waits_beyond_a_gap = true;
  bool drops_known_numbers = true;
  bool drops_known_ids = true;
  bool claims_only_what_is_committed = true;  ///< in heartbeats, by which a sender without a journal forgets
  bool checks_after_a_start = true;           ///< the last messages read come again, their ids are compared
  bool checks_off_what_is_compared = true;    ///< which takes that the reader has committed it
  bool drops_what_is_held_at_a_start = true;
  bool proves_its_start = true;  ///< each message says it, and of a start that was not compared nothing is handed out
};

struct Bounds {
  Content contents = 3;
  std::size_t in_flight = 2;
  char writer_kills = 1;
  char reader_kills = 1;
  bool backup = false;          ///< taken once, restored once
  Number reach = 3;             ///< how far back what was read is compared after a start
  bool sender_forgets = false;  ///< what the reader claims to have
};

struct State {
  // the writer's journal, and its backup
  std::string log;
  std::string backup;
  char backups = 0;  ///< 0 none yet, 1 taken, 2 restored
  char forgotten = 0;
  // the writer's process
  bool writes = true;
  char starts = 1;
  Number published = 0;
  Content pending = 0;  ///< published before it is committed: only where that rule is left out
  char writer_kills = 0;
  struct Sent {
    Number number = 0;
    Content content = 0;
    char start = 0;  ///< of its writer
    friend auto operator<=>(const Sent&, const Sent&) = default;
  };
  std::vector<Sent> flight;  ///< sorted
  // the reader's journal
  std::string taken;
  std::string numbers;  ///< under which each of them came last
  Number position = 0;
  // the reader's process
  bool reads = true;
  Number received = 0;   ///< last one handed out in order
  Number committed = 0;  ///< as the process knows it
  std::vector<Sent> held;
  std::vector<Sent> ready;
  Number claimed = 0;  ///< how far the stream goes
  char checked = 0;    ///< start whose messages are handed out
  char checking = 0;   ///< one that is being compared; 0 none
  Number check_first = 1;
  Number check_last = 0;
  char reader_kills = 0;

  [[nodiscard]] std::string key() const {
    std::string text = log + '|' + backup + '|';
    for (const char value : {backups, forgotten, static_cast<char>(writes), starts, published, pending, writer_kills,
                             static_cast<char>(reads), position, received, committed, claimed, checked, checking,
                             check_first, check_last, reader_kills})
      text += value;
    for (const auto* all : {&flight, &held, &ready}) {
      text += '|';
      for (const auto& [number, content, start] : *all) text.append({number, content, start});
    }
    return text + '|' + taken + '|' + numbers;
  }
  /// For people.
  [[nodiscard]] std::string describe() const {
    std::ostringstream text;
    const auto digits = [&text](const char* name, const std::string& contents) {
      text << name << '[';
      for (const Content content : contents) text << int{content};
      text << "] ";
    };
    const auto in_order = [&text](const char* name, const std::vector<Sent>& all) {
      text << name << '[';
      for (const auto& [number, content, start] : all)
        text << ' ' << int{number} << '=' << int{content} << " of start " << int{start};
      text << " ] ";
    };
    digits(writes ? "writer " : "(dead) writer ", log);
    digits("backup ", backup);
    in_order("flight ", flight);
    digits(reads ? "reader " : "(dead) reader ", taken);
    text << "position " << int{position} << " received " << int{received} << " claimed " << int{claimed} << " check "
         << int{check_first} << ".." << int{check_last} << ' ';
    in_order("held ", held);
    in_order("ready ", ready);
    return text.str();
  }
  [[nodiscard]] Number written() const { return static_cast<Number>(log.size()); }
  [[nodiscard]] bool has(Content content) const { return taken.find(content) != std::string::npos; }
  [[nodiscard]] bool has(Content content, Number number) const {
    const std::size_t place = taken.find(content);
    return place != std::string::npos && numbers[place] == number;
  }
  void take(Content content, Number number, bool drops_known_ids) {
    const std::size_t place = taken.find(content);
    if (place != std::string::npos && drops_known_ids) {
      numbers[place] = number;
    } else {
      taken += content;
      numbers += number;
    }
  }
};

class Model {
 public:
  Model(Rules rules, Bounds bounds) : rules_(rules), bounds_(bounds) {}

  /// What the writer, the reader, the network and fate may do next.
  [[nodiscard]] std::vector<State> next(const State& now) {
    next_.clear();
    if (now.writes) writer_steps(now);
    if (!now.writes) restart_writer(now);
    if (now.reads) reader_steps(now);
    if (!now.reads) restart_reader(now);
    if (now.writes && now.reads) exchange(now);
    for (std::size_t k = 0; k < now.flight.size(); ++k) {  // lost
      State then = now;
      then.flight.erase(then.flight.begin() + static_cast<std::ptrdiff_t>(k));
      next_.push_back(std::move(then));
    }
    return std::move(next_);
  }

  [[nodiscard]] bool is_safe(const State& state) const {
    std::string sorted = state.taken;
    std::ranges::sort(sorted);
    if (std::ranges::adjacent_find(sorted) != sorted.end()) return false;
    return state.backups == 2 || state.log.starts_with(state.taken) || !rules_.commits_before_publishing;
  }
  [[nodiscard]] bool is_done(const State& state) const {
    return state.written() == bounds_.contents &&
           std::ranges::all_of(state.log, [&](Content c) { return state.has(c); });
  }

 private:
  void step(State then) { next_.push_back(std::move(then)); }
  /// A network that is full loses what is sent.
  void send(State& state, Number number, Content content) const {
    if (state.flight.size() >= bounds_.in_flight) return;
    state.flight.push_back({number, content, state.starts});
    std::ranges::sort(state.flight);
  }

  void writer_steps(const State& now) {
    for (Content content = 1; content <= bounds_.contents && now.pending == 0; ++content) {
      if (now.log.find(content) != std::string::npos) continue;
      State then = now;
      if (rules_.commits_before_publishing) {
        then.log += content;
      } else {
        then.pending = content;
        send(then, static_cast<Number>(now.written() + 1), content);
      }
      step(std::move(then));
    }
    if (now.pending != 0) {
      State then = now;
      then.log += std::exchange(then.pending, 0);
      then.published = then.written();
      step(std::move(then));
    }
    if (now.published < now.written()) {
      State then = now;
      ++then.published;
      send(then, then.published, now.log[static_cast<std::size_t>(now.published)]);
      step(std::move(then));
    }
    if (now.writer_kills < bounds_.writer_kills) {
      State then = now;
      ++then.writer_kills;
      then.writes = false;
      then.pending = 0;
      step(std::move(then));
    }
    if (bounds_.backup && now.backups == 0) {
      State then = now;
      then.backup = now.log;
      then.backups = 1;
      step(std::move(then));
    }
  }

  void restart_writer(const State& now) {
    State then = now;
    then.writes = true;
    ++then.starts;
    then.published = then.written();
    step(then);
    if (now.backups != 1) return;
    then.log = std::exchange(then.backup, {});
    then.backups = 2;
    then.published = then.written();
    then.flight.clear();  // a restore takes longer than messages are on their way
    step(std::move(then));
  }

  void reader_steps(const State& now) {
    for (std::size_t k = 0; k < now.flight.size(); ++k) {
      State then = now;
      const State::Sent sent = now.flight[k];
      then.flight.erase(then.flight.begin() + static_cast<std::ptrdiff_t>(k));
      accept(then, sent);
      step(std::move(then));
    }
    if (!now.ready.empty()) {
      State then = now;
      for (const auto& [number, content, start] : std::exchange(then.ready, {})) {
        then.take(content, number, rules_.drops_known_ids);
        then.position = then.committed = number;
      }
      step(std::move(then));
    }
    if (now.reader_kills < bounds_.reader_kills) {
      State then = now;
      ++then.reader_kills;
      then.reads = false;
      then.held.clear();
      then.ready.clear();
      then.received = then.committed = then.claimed = then.checked = then.checking = then.check_last = 0;
      then.check_first = 1;
      step(std::move(then));
    }
  }

  void restart_reader(const State& now) {
    State then = now;
    then.reads = true;
    then.received = then.committed = now.position;
    step(std::move(then));
  }

  void start_anew(State& state) const {
    state.received = state.committed = 0;
    state.held.clear();
    forget_check(state);
    state.checked = 0;
  }

  /// What a sender without a journal has forgotten nobody can compare.
  [[nodiscard]] bool compares() const { return rules_.checks_after_a_start && !bounds_.sender_forgets; }

  void begin_check(State& state, char start) const {
    if (start == state.checked || start == state.checking) return;
    state.checking = start;
    state.check_last = state.received;
    state.check_first = static_cast<Number>(std::max(0, state.received - bounds_.reach) + 1);
    end_check(state);
  }

  void forget_check(State& state) const {
    state.check_first = 1;
    state.check_last = state.checking = 0;
    if (!rules_.drops_what_is_held_at_a_start || !rules_.proves_its_start) return;
    std::erase_if(state.held, [&](const State::Sent& one) { return one.start != state.checked; });
  }

  /// What was handed out of the start before, meanwhile, is compared as well.
  void end_check(State& state) const {
    if (state.checking == 0 || state.check_first <= state.check_last) return;
    if (state.check_last < state.received) {
      state.check_last = state.received;
      return;
    }
    state.checked = state.checking;
    forget_check(state);
  }

  void hand_out(State& state) const {
    while (!state.held.empty() && state.held.front().number == state.received + 1) {
      if (compares() && rules_.proves_its_start && state.held.front().start != state.checked) return;
      state.ready.push_back(state.held.front());
      state.held.erase(state.held.begin());
      ++state.received;
    }
  }

  void compare(State& state, const State::Sent& sent) const {
    const auto [number, content, start] = sent;
    const bool is_compared = number <= state.committed;
    if (compares() && is_compared && !state.has(content, number)) return start_anew(state);
    if (rules_.proves_its_start && start != state.checking) return;
    const bool counts = is_compared || !rules_.checks_off_what_is_compared;
    if (counts && number == state.check_first && number <= state.check_last) ++state.check_first;
    end_check(state);
  }

  void accept(State& state, const State::Sent& sent) const {
    const auto [number, content, start] = sent;
    if (compares() && rules_.proves_its_start) {
      if (start == state.checked) forget_check(state);  // a heartbeat was older, or forged
      begin_check(state, start);
    }
    compare(state, sent);
    if (number <= state.received && rules_.drops_known_numbers) return hand_out(state);
    if (!rules_.waits_beyond_a_gap || number <= state.received) {
      state.received = std::max(state.received, number);
      state.ready.push_back(sent);
      return;
    }
    std::erase_if(state.held, [&](const auto& one) { return one.number == number; });
    state.held.push_back(sent);
    std::ranges::sort(state.held);
    hand_out(state);
  }

  /// Heartbeats of both, and requests with what answers them.
  void exchange(const State& now) {
    if (rules_.tells_how_far_it_goes) {
      State then = now;
      then.claimed = now.written();
      if (compares()) begin_check(then, now.starts);
      hand_out(then);
      step(then);
      if (now.written() < now.received) {  // and stays so
        start_anew(then);
        step(std::move(then));
      }
    }
    if (bounds_.sender_forgets) {
      State then = now;
      then.forgotten = std::max(now.forgotten, rules_.claims_only_what_is_committed ? now.committed : now.received);
      step(std::move(then));
    }
    if (!rules_.asks_for_what_is_missing) return;
    const Number gap_end = now.held.empty() ? now.claimed : static_cast<Number>(now.held.front().number - 1);
    for (Number number = 1; number <= now.published; ++number) {
      const bool missing = number > now.received && number <= gap_end;
      const bool checked = number >= now.check_first && number <= now.check_last;
      if (number <= now.forgotten || (!missing && !checked)) continue;
      State then = now;
      send(then, number, now.log[static_cast<std::size_t>(number - 1)]);
      step(std::move(then));
    }
  }

  Rules rules_;
  Bounds bounds_;
  std::vector<State> next_;
};

struct Finding {
  std::size_t states = 0;
  std::size_t unsafe = 0;  ///< something was doubled, or is out of order
  std::size_t stuck = 0;   ///< something is lost: whatever happens, the reader will not have it
  std::string how;         ///< the shortest way to lose something
};

/// Breadth first over all that can happen; then backwards from where the reader has everything.
Finding explore(Rules rules, Bounds bounds) {
  Model model(rules, bounds);
  std::unordered_map<std::string, std::uint32_t> known;
  std::vector<State> states = {State{}};
  std::vector<std::vector<std::uint32_t>> came_from(1);
  known.emplace(states[0].key(), 0);
  Finding finding;
  for (std::uint32_t at = 0; at < states.size(); ++at) {
    finding.unsafe += model.is_safe(states[at]) ? 0U : 1U;
    for (State& then : model.next(states[at])) {
      const auto [place, is_new] = known.try_emplace(then.key(), static_cast<std::uint32_t>(states.size()));
      if (is_new) {
        states.push_back(std::move(then));
        came_from.emplace_back();
      }
      came_from[place->second].push_back(at);
    }
  }
  finding.states = states.size();
  std::vector<bool> ends_well(states.size(), false);
  std::vector<std::uint32_t> to_look_at;
  for (std::uint32_t at = 0; at < states.size(); ++at)
    if (model.is_done(states[at])) ends_well[at] = true, to_look_at.push_back(at);
  while (!to_look_at.empty()) {
    const std::uint32_t at = to_look_at.back();
    to_look_at.pop_back();
    for (const std::uint32_t before : came_from[at])
      if (!ends_well[before]) ends_well[before] = true, to_look_at.push_back(before);
  }
  finding.stuck = static_cast<std::size_t>(std::ranges::count(ends_well, false));
  const auto lost = static_cast<std::uint32_t>(std::ranges::find(ends_well, false) - ends_well.begin());
  for (std::uint32_t at = lost; at != 0 && at < states.size(); at = came_from[at].front())
    finding.how = states[at].describe() + "\n" + finding.how;
  return finding;
}

void expect_nothing_lost_or_doubled(Bounds bounds, std::size_t at_least) {
  const Finding found = explore({}, bounds);
  EXPECT_EQ(found.unsafe, 0U);
  EXPECT_EQ(found.stuck, 0U) << found.how;
  EXPECT_GT(found.states, at_least) << "the model hardly moves";
  std::printf("%zu states\n", found.states);
}

constexpr Bounds kKills = {};
constexpr Bounds kRestore = {.in_flight = 1, .backup = true};
/// Fewer messages are compared after a start than were read before.
constexpr Bounds kShortReach = {.in_flight = 1, .backup = true, .reach = 2};
constexpr Bounds kForgetfulSender = {.sender_forgets = true};
/// Where a rule is left out two messages do.
constexpr Bounds kFewKills = {.contents = 2};
constexpr Bounds kFewRestore = {.contents = 2, .in_flight = 1, .backup = true};
constexpr Bounds kFewForgetful = {.contents = 2, .sender_forgets = true};

TEST(StreamModel, LosesAndDoublesNothingWhoeverIsKilledWhenever) { expect_nothing_lost_or_doubled(kKills, 10'000); }

TEST(StreamModel, LosesAndDoublesNothingWhenAWritersJournalIsRestoredFromABackup) {
  expect_nothing_lost_or_doubled(kRestore, 5'000);
}

TEST(StreamModel, WhatIsComparedAfterAStartAlwaysReachesBackToWhatWasReadBefore) {
  expect_nothing_lost_or_doubled(kShortReach, 5'000);
}

TEST(StreamModel, ASenderMayForgetWhatIsClaimed) { expect_nothing_lost_or_doubled(kForgetfulSender, 10'000); }

/// A rule that is left out must be missed.
struct LeftOut {
  const char* name;
  bool Rules::*rule;
  Bounds bounds;
  bool loses;  ///< else it doubles or confuses
};

class StreamModelWithout : public ::testing::TestWithParam<LeftOut> {};

TEST_P(StreamModelWithout, BreaksDown) {
  Rules rules;
  rules.*GetParam().rule = false;
  const Finding found = explore(rules, GetParam().bounds);
  EXPECT_GT(GetParam().loses ? found.stuck : found.unsafe, 0U);
}

INSTANTIATE_TEST_SUITE_P(
    Rules, StreamModelWithout,
    ::testing::Values(
        LeftOut{"commits_before_publishing", &Rules::commits_before_publishing, kFewForgetful, true},
        LeftOut{"tells_how_far_it_goes", &Rules::tells_how_far_it_goes, kFewKills, true},
        LeftOut{"asks_for_what_is_missing", &Rules::asks_for_what_is_missing, kFewKills, true},
        LeftOut{"waits_beyond_a_gap", &Rules::waits_beyond_a_gap, kFewKills, true},
        LeftOut{"claims_only_what_is_committed", &Rules::claims_only_what_is_committed, kFewForgetful, true},
        LeftOut{"checks_after_a_start", &Rules::checks_after_a_start, kFewRestore, true},
        LeftOut{"checks_off_what_is_compared", &Rules::checks_off_what_is_compared, kFewRestore, true},
        LeftOut{"drops_what_is_held_at_a_start", &Rules::drops_what_is_held_at_a_start, kFewRestore, true},
        LeftOut{"proves_its_start", &Rules::proves_its_start, kShortReach, true},
        LeftOut{"drops_known_ids", &Rules::drops_known_ids, kFewRestore, false}),
    [](const auto& left_out) { return left_out.param.name; });

}  // namespace
}  // namespace sealwatch
