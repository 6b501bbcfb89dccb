#include "services/verification/lives/run_lives.hpp"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace sealwatch::verification {
namespace {

/// What the threads share.
struct Work {
  const LifeSimulator& simulator;
  const LifeStore& store;
  std::span<const std::uint32_t> lives;
  const std::function<bool(std::size_t)>& proceed;
  std::size_t done_before = 0;
  std::atomic<std::size_t> next = 0;
  std::mutex lock = {};  // of what follows
  RunOutcome outcome = {};
  std::optional<Error> failed = std::nullopt;
};

void stop(Work& work) { work.next = work.lives.size(); }

void take_lives(Work& work) {
  while (true) {
    const std::size_t own = work.next++;
    if (own >= work.lives.size()) return;
    const Result<LifeRecord> record = work.simulator.run(work.lives[own]);
    const Status written = record ? work.store.write(*record) : Status{};
    const std::lock_guard guard(work.lock);
    if (!record || !written) {
      work.failed = record ? written.error() : record.error();
      return stop(work);
    }
    ++work.outcome.simulated;
    work.outcome.tests += record->tests.size();
    if (!work.proceed(work.done_before + work.outcome.simulated)) {
      work.outcome.interrupted = work.outcome.simulated < work.lives.size();
      return stop(work);
    }
  }
}

}  // namespace

Result<Shard> shard_named(const std::string& text) {
  const auto number = [](const std::string& digits) -> std::uint32_t {
    const bool plain =
        !digits.empty() && digits.size() <= 6 && digits.find_first_not_of("0123456789") == std::string::npos;
    return plain ? static_cast<std::uint32_t>(std::stoul(digits)) : 0;
  };
  const std::size_t slash = text.find('/');
  const Shard shard{number(text.substr(0, slash)), slash == std::string::npos ? 0 : number(text.substr(slash + 1))};
  if (shard.part >= 1 && shard.part <= shard.of) return shard;
  return fail(Error{.file = {},
                    .place = "--shard",
                    .value = text,
                    .rule = "must be k/n with 1 <= k <= n",
                    .advice = "for example 1/4, 2/4, 3/4 and 4/4 on four machines"});
}

std::vector<std::uint32_t> lives_of(const Shard& shard, int lives) {
  std::vector<std::uint32_t> own;
  for (std::uint32_t life = shard.part - 1; life < static_cast<std::uint32_t>(lives); life += shard.of)
    own.push_back(life);
  return own;
}

Result<RunOutcome> run_lives(const LifeSimulator& simulator, const LifeStore& store,
                             std::span<const std::uint32_t> lives, int threads,
                             const std::function<bool(std::size_t done)>& proceed) {
  std::vector<std::uint32_t> open;
  std::copy_if(lives.begin(), lives.end(), std::back_inserter(open),
               [&store](std::uint32_t life) { return !store.has(life); });
  const std::size_t before = lives.size() - open.size();
  Work work{.simulator = simulator, .store = store, .lives = open, .proceed = proceed, .done_before = before};
  work.outcome.found_before = before;
  std::vector<std::jthread> pool;
  for (int k = 1; k < std::clamp(threads, 1, 256); ++k) pool.emplace_back([&work] { take_lives(work); });
  take_lives(work);
  for (std::jthread& thread : pool) thread.join();
  if (work.failed) return fail(*work.failed);
  return work.outcome;
}

}  // namespace sealwatch::verification
