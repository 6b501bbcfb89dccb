#include "services/common/runtime/service_manager.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <systemd/sd-daemon.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>

namespace sealwatch {

void notify_service_manager(const std::string& state) { ::sd_notify(0, state.c_str()); }

Result<InstanceLock> InstanceLock::take(const std::string& directory, const std::string& service) {
  const std::string file = (std::filesystem::path(directory) / (service + ".lock")).string();
  const auto refuse = [&file](std::string rule, std::string advice) {
    return fail(Error{file, {}, {}, std::move(rule), std::move(advice)});
  };
  std::error_code failed;
  std::filesystem::create_directories(directory, failed);
  const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (descriptor < 0)
    return refuse(std::string("cannot be made: ") + std::strerror(errno),
                  "name a state_directory that this user may write to");
  InstanceLock lock(descriptor);
  if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
    std::array<char, 32> owner{};
    const bool known = ::read(descriptor, owner.data(), owner.size() - 1) > 0;
    return refuse("another " + service + " works in this directory" +
                      (known ? ", process " + std::string(owner.data()) : std::string()),
                  "stop it, or give this one a state directory of its own");
  }
  const std::string process = std::to_string(::getpid());
  const bool noted = ::ftruncate(descriptor, 0) == 0 &&
                     ::pwrite(descriptor, process.data(), process.size(), 0) == static_cast<ssize_t>(process.size());
  if (!noted) return refuse(std::string("cannot be written: ") + std::strerror(errno), "free some space on the disk");
  return lock;
}

InstanceLock::~InstanceLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

}  // namespace sealwatch
