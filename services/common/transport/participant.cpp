#include "services/common/transport/participant.hpp"

#include <pthread.h>
#include <time.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <sstream>
#include <utility>
#include <vector>

#include "dds/ddsrt/sync.h"
#include "services/common/transport/refusals.hpp"

// Cyclone 0.10 waits by the wall clock: set back by an hour during a wait, that clock keeps the thread that sends again
// what was lost, and tells others that this process lives, asleep for the hour. The library finds these definitions
// before its own, which differ in the clock alone.
extern "C" bool ddsrt_cond_waitfor(ddsrt_cond_t* condition, ddsrt_mutex_t* mutex, dds_duration_t time) {
  if (time == DDS_INFINITY) {
    ddsrt_cond_wait(condition, mutex);
    return true;
  }
  timespec until{};
  clock_gettime(CLOCK_MONOTONIC, &until);
  const dds_duration_t nanoseconds = until.tv_nsec + (time > 0 ? time % DDS_NSECS_IN_SEC : 0);
  until.tv_sec += (time > 0 ? time / DDS_NSECS_IN_SEC : 0) + nanoseconds / DDS_NSECS_IN_SEC;
  until.tv_nsec = nanoseconds % DDS_NSECS_IN_SEC;
  return pthread_cond_clockwait(&condition->cond, &mutex->mutex, CLOCK_MONOTONIC, &until) == 0;
}
extern "C" bool ddsrt_cond_waituntil(ddsrt_cond_t* condition, ddsrt_mutex_t* mutex, dds_time_t time) {
  return ddsrt_cond_waitfor(condition, mutex, time == DDS_NEVER ? DDS_INFINITY : time - dds_time());
}

namespace sealwatch::transport {
namespace {

/// Keeps to this machine, so that nothing listens on a network that nobody asked for. A process that died is noticed
/// after 2 s (Cyclone's default: 10 s), because until then its readers hold up their publishers.
constexpr const char* kLocalSettings =
    "<CycloneDDS><Domain Id=\"any\">"
    "<General><Interfaces><NetworkInterface name=\"lo\" multicast=\"true\"/></Interfaces></General>"
    "<Discovery><LeaseDuration>2s</LeaseDuration></Discovery>"
    "</Domain></CycloneDDS>";

/// The domains that this process made with settings of its own, by id; Cyclone allows each only once in a process.
class Domains {
 public:
  Status enter(dds_domainid_t id, const std::string& settings) {
    const std::lock_guard lock(mutex_);
    Use& use = uses_[id];
    if (use.count == 0 && !environment_decides()) {
      use.domain = dds_create_domain(id, settings.empty() ? kLocalSettings : settings.c_str());
      if (use.domain < 0 && use.domain != DDS_RETCODE_PRECONDITION_NOT_MET)  // that one: the program around us made it
        return dds_failure("domain " + std::to_string(id), std::exchange(use.domain, 0),
                           "check cyclonedds_uri; an unknown XML element is fatal, standard error has the details");
    }
    ++use.count;
    return {};
  }
  void leave(dds_domainid_t id) {
    const std::lock_guard lock(mutex_);
    Use& use = uses_[id];
    if (--use.count == 0 && use.domain > 0) dds_delete(std::exchange(use.domain, 0));
  }

 private:
  struct Use {
    int count = 0;
    dds_entity_t domain = 0;
  };
  static bool environment_decides() {
    const char* const uri = std::getenv("CYCLONEDDS_URI");
    return uri != nullptr && *uri != '\0';
  }
  std::mutex mutex_;
  std::map<dds_domainid_t, Use> uses_;
};

Domains& domains() {
  static Domains instance;
  return instance;
}

}  // namespace

tl::unexpected<Error> dds_failure(std::string what, dds_return_t code, std::string advice) {
  return fail(Error{.file = {},
                    .place = std::move(what),
                    .value = {},
                    .rule = std::string("DDS says: ") + dds_strretcode(code),
                    .advice = std::move(advice)});
}

namespace {

/// As Cyclone DDS reads them: fragments of XML and file://paths between commas.
std::string settings_of_cyclone(const Configuration& configuration) {
  const char* const uri = std::getenv("CYCLONEDDS_URI");
  return uri != nullptr && *uri != '\0' ? uri : configuration.cyclonedds_uri;
}

std::vector<std::filesystem::path> files_of(const std::string& settings) {
  constexpr std::string_view kFile = "file://";
  std::vector<std::filesystem::path> files;
  for (std::size_t begin = settings.find(kFile); begin != std::string::npos; begin = settings.find(kFile, begin + 1)) {
    const std::size_t path = begin + kFile.size();
    files.emplace_back(settings.substr(path, settings.find(',', path) - path));
  }
  return files;
}

// Cyclone DDS takes a directory for a file without settings, and would run without the security that was meant.
Status check_settings(const Configuration& configuration) {
  for (const std::filesystem::path& file : files_of(settings_of_cyclone(configuration))) {
    std::error_code unknown;
    if (std::filesystem::is_directory(file, unknown))
      return fail(Error{.file = file.string(),
                        .place = "CYCLONEDDS_URI",
                        .value = {},
                        .rule = "is a directory, not a file of settings",
                        .advice = "name the XML file in it"});
  }
  return {};
}

}  // namespace

bool is_secured(const Configuration& configuration) {
  const std::string settings = settings_of_cyclone(configuration);
  bool secured = settings.find("Security") != std::string::npos;
  for (const std::filesystem::path& file : files_of(settings)) {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    secured = secured || text.str().find("Security") != std::string::npos;
  }
  return secured;
}

Result<Participant> Participant::join(const Configuration& configuration) {
  if (Status settings = check_settings(configuration); !settings) return fail(settings.error());
  listen_to_cyclone();
  const auto id = static_cast<dds_domainid_t>(configuration.domain);
  if (Status entered = domains().enter(id, configuration.cyclonedds_uri); !entered) return fail(entered.error());
  const dds_entity_t handle = dds_create_participant(id, nullptr, nullptr);
  if (handle < 0) {
    domains().leave(id);
    return dds_failure("participant in domain " + std::to_string(configuration.domain), handle,
                       "check CYCLONEDDS_URI: the network interface exists, with DDS Security its files too; what is "
                       "wrong stands above, by Cyclone DDS itself");
  }
  return Participant(handle, id);
}

Participant::Participant(Participant&& other) noexcept
    : handle_(std::exchange(other.handle_, 0)), domain_(other.domain_) {}

Participant::~Participant() {
  if (handle_ <= 0) return;
  dds_delete(handle_);
  domains().leave(domain_);
}

}  // namespace sealwatch::transport
