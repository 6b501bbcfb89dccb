// The time limit of an analysis: how much of it a step may use, and what it cut off.
#pragma once

#include <algorithm>
#include <chrono>
#include <limits>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "sealwatch/core/deadline.hpp"

namespace sealwatch::mismatch {

// Shares of the time limit.
/// For the search, before what it found is proven and told.
inline constexpr double kSearchShare = 0.75;
/// Where the search was cut: by then it is settled what of it stands, and whether a fixed value does as well;
inline constexpr double kSettledBy = 0.9;
/// in a gross misfit also which explanation carries over best. The proof of that one has the rest.
inline constexpr double kChosenBy = 0.9;

class TimeBudget {
 public:
  /// `used_s`: of the limit, before.
  TimeBudget(double limit_s, std::stop_token cancel, double used_s = 0.0)
      : limit_s_(limit_s), used_s_(used_s), deadline_(std::move(cancel)) {}

  /// Work may go on until this share of the limit is over.
  void allow(double share) {
    const std::chrono::duration<double> elapsed = Deadline::Clock::now() - begin_;
    deadline_.set_in(share * limit_s_ - used_s_ - elapsed.count());
  }
  /// What the report rests on is done whatever time it takes.
  void allow_what_is_needed() { deadline_.set_in(std::numeric_limits<double>::infinity()); }

  /// Whether there is time for a step; one that comes too late is among those not asked.
  [[nodiscard]] bool in_time(std::string step) {
    if (!deadline_.passed()) return true;
    not_asked_.push_back(std::move(step));
    return false;
  }
  void add_not_asked(const std::vector<std::string>& steps) {
    for (const std::string& step : steps)
      if (std::ranges::find(not_asked_, step) == not_asked_.end()) not_asked_.push_back(step);
  }
  [[nodiscard]] const std::vector<std::string>& not_asked() const { return not_asked_; }
  [[nodiscard]] const Deadline& deadline() const { return deadline_; }

 private:
  double limit_s_, used_s_;
  Deadline deadline_;
  Deadline::Clock::time_point begin_ = Deadline::Clock::now();
  std::vector<std::string> not_asked_;
};

}  // namespace sealwatch::mismatch
