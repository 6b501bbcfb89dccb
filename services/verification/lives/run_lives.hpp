// Runs lives on several threads and stores them. Which thread runs which life changes nothing.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "services/verification/lives/life_simulator.hpp"
#include "services/verification/lives/life_store.hpp"

namespace sealwatch::verification {

/// Part k of n of a run: lives whose number leaves k - 1 when divided by n.
struct Shard {
  std::uint32_t part = 1;
  std::uint32_t of = 1;
};
/// "2/8". An Error for anything that is not a part of a whole.
[[nodiscard]] Result<Shard> shard_named(const std::string& text);
[[nodiscard]] std::vector<std::uint32_t> lives_of(const Shard& shard, int lives);

struct RunOutcome {
  std::size_t simulated = 0;
  std::size_t tests = 0;         ///< of the simulated lives
  std::size_t found_before = 0;  ///< whole records of an earlier run
  bool interrupted = false;
};

/// `proceed(done)` is called under a lock after each life; false stops.
[[nodiscard]] Result<RunOutcome> run_lives(const LifeSimulator& simulator, const LifeStore& store,
                                           std::span<const std::uint32_t> lives, int threads,
                                           const std::function<bool(std::size_t done)>& proceed);

}  // namespace sealwatch::verification
