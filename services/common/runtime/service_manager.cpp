#include "services/common/runtime/service_manager.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <systemd/sd-daemon.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <thread>

namespace sealwatch {
namespace {

const std::string kAnother = "another ";
constexpr std::chrono::milliseconds kUntilOwnerIsWritten{1000}, kBetweenLooks{10};

/// The process that the locked file names; empty where none is said. Between its lock and its number an owner leaves the
/// file empty, or with the number of one that ended: it is read again until it names a process that lives.
std::string owner_of(int descriptor) {
  const auto end = std::chrono::steady_clock::now() + kUntilOwnerIsWritten;
  for (;; std::this_thread::sleep_for(kBetweenLooks)) {
    std::array<char, 32> text{};
    const bool said = ::pread(descriptor, text.data(), text.size() - 1, 0) > 0;
    const pid_t process = said ? static_cast<pid_t>(std::atol(text.data())) : 0;
    if (process > 0 && (::kill(process, 0) == 0 || errno == EPERM)) return text.data();
    if (std::chrono::steady_clock::now() >= end) return {};
  }
}

}  // namespace

void notify_service_manager(const std::string& state) { ::sd_notify(0, state.c_str()); }

Result<InstanceLock> InstanceLock::take(const std::string& directory, const std::string& service) {
  const std::string file = (std::filesystem::path(directory) / (service + ".lock")).string();
  const auto refuse = [&file](std::string rule, std::string advice) {
    return fail(Error{file, {}, {}, std::move(rule), std::move(advice)});
  };
  std::error_code failed;
  std::filesystem::create_directories(directory, failed);
  if (failed)
    return refuse("cannot be made: " + failed.message(), "name a state_directory that this user may write to");
  const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (descriptor < 0)
    return refuse(std::string("cannot be made: ") + std::strerror(errno),
                  "name a state_directory that this user may write to");
  InstanceLock lock(descriptor);
  if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
    const std::string process = owner_of(descriptor);
    return refuse(kAnother + service + " works in this directory" + (process.empty() ? "" : ", process " + process),
                  "stop it, or give this one a state directory of its own");
  }
  const std::string own = std::to_string(::getpid());
  if (::ftruncate(descriptor, 0) == 0) (void)!::pwrite(descriptor, own.data(), own.size(), 0);
  return lock;
}

InstanceLock::~InstanceLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

bool is_held_by_another(const Error& error) { return error.rule.starts_with(kAnother); }

bool is_for_want_of_space(const Error& error) {
  const auto says = [&](int code) { return error.rule.find(std::strerror(code)) != std::string::npos; };
  return says(ENOSPC) || says(EDQUOT);
}

}  // namespace sealwatch
