#include "services/common/fmi/lost_processes.hpp"

#include <mutex>
#include <string>

namespace sealwatch::fmi {

std::optional<Error> LostProcesses::given_up(Clock::time_point now) {
  const std::scoped_lock lock(mutex_);
  if (given_up_ && now - since_ > kForgotten) given_up_.reset(), crashes_ = 0;
  return given_up_;
}

void LostProcesses::note(const HostProcess& process, Clock::time_point now) {
  const std::scoped_lock lock(mutex_);
  if (!process.loss()) return crashes_ = 0, void();
  const auto& [hung, error] = *process.loss();
  if (given_up_ || (!hung && ++crashes_ < kMostCrashes)) return;
  given_up_ = error, since_ = now;
  if (!hung) given_up_->rule += ", " + std::to_string(kMostCrashes) + " times one after the other";
}

}  // namespace sealwatch::fmi
