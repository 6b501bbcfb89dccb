#include "services/cli/supervisor.hpp"

#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <thread>

#include "services/cli/commands.hpp"
#include "services/common/runtime/configuration_loader.hpp"
#include "services/common/runtime/daemon.hpp"

extern char** environ;

namespace sealwatch::cli {
namespace {

/// A service ends by itself within kServiceStops.
constexpr std::chrono::milliseconds kPatience{1400};

constexpr std::string_view kDdsSettings = "CYCLONEDDS_URI=";

std::string with_hyphens(std::string service) {
  std::ranges::replace(service, '_', '-');
  return service;
}

std::string program_name(const std::string& service) { return "sealwatch-" + with_hyphens(service); }

std::string ending(int status) {
  if (WIFSIGNALED(status)) return std::string("was killed by signal ") + strsignal(WTERMSIG(status));
  return "ended with exit status " + std::to_string(WEXITSTATUS(status));
}

}  // namespace

std::string program_path(const std::string& program) {
  std::error_code error;
  const std::filesystem::path here = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
  for (const auto& candidate : {here / program, here / ".." / "libexec" / "sealwatch" / program})
    if (!error && std::filesystem::exists(candidate)) return std::filesystem::weakly_canonical(candidate).string();
  return program;
}

bool enabled(const Configuration& configuration, const std::string& service) {
  const auto named = configuration.services.find(service);
  return named == configuration.services.end() || named->second.enabled;
}

std::string explain_disabled(const Configuration& configuration) {
  std::string text;
  for (const std::string& service : service_names())
    if (!enabled(configuration, service)) text.append(text.empty() ? "services." : ", services.").append(service);
  return text.empty() ? "" : text.append(" disabled here (enabled: false): the services after it get nothing");
}

std::vector<ServiceProgram> service_programs(const std::string& config, const std::string& state_directory,
                                             const Configuration& configuration) {
  std::vector<ServiceProgram> programs;
  for (const std::string& service : service_names()) {
    if (!enabled(configuration, service)) continue;
    ServiceProgram program{.name = service, .arguments = {program_path(program_name(service)), "--config", config}};
    if (!state_directory.empty()) program.arguments.insert(program.arguments.end(), {"--state", state_directory});
    programs.push_back(std::move(program));
  }
  return programs;
}

Result<std::string> identity_settings(const std::string& directory, const std::string& name) {
  const std::filesystem::path file = std::filesystem::absolute(directory) / with_hyphens(name) / "cyclonedds.xml";
  std::error_code error;
  if (std::filesystem::exists(file, error)) return "file://" + file.string();
  return fail(Error{.file = file.string(),
                    .place = {},
                    .value = {},
                    .rule = "is not there: " + name + " has no identity",
                    .advice = "deploy/security/make_identities.sh " + directory + " makes it"});
}

std::vector<std::string> names_of(const std::vector<ServiceProgram>& programs) {
  std::vector<std::string> names;
  names.reserve(programs.size());
  for (const ServiceProgram& program : programs) names.push_back(program.name);
  return names;
}

Result<std::optional<InstanceLock>> take_supervisor_lock(const std::string& state_directory,
                                                         const Configuration& configuration) {
  auto lock =
      InstanceLock::take(state_directory.empty() ? configuration.state_directory : state_directory, "supervisor");
  if (lock) return std::optional(std::move(*lock));
  if (is_held_by_another(lock.error())) return fail(lock.error());
  return std::optional<InstanceLock>();
}

Supervisor::Supervisor(std::vector<ServiceProgram> programs, std::chrono::milliseconds restart_pause)
    : restart_pause_(restart_pause) {
  for (ServiceProgram& program : programs)
    children_.push_back({.program = std::move(program), .process = -1, .started = {}, .starts = 0, .refused = false});
}

Supervisor::~Supervisor() { stop(); }

Status Supervisor::launch(Child& child) {
  std::vector<char*> arguments;
  for (std::string& argument : child.program.arguments) arguments.push_back(argument.data());
  arguments.push_back(nullptr);
  std::string supervisor = std::string(kSupervisor) + "=" + std::to_string(::getpid());
  std::string settings = std::string(kDdsSettings) + child.program.dds_settings;
  const bool own_settings = !child.program.dds_settings.empty();
  std::vector<char*> environment;
  for (char** variable = environ; *variable != nullptr; ++variable)
    if (!own_settings || !std::string_view(*variable).starts_with(kDdsSettings)) environment.push_back(*variable);
  environment.push_back(supervisor.data());
  if (own_settings) environment.push_back(settings.data());
  environment.push_back(nullptr);
  // A group of its own, so that Ctrl-C in the terminal reaches the supervisor alone, which then stops the services in
  // order.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  const int error =
      posix_spawnp(&child.process, arguments[0], nullptr, &attributes, arguments.data(), environment.data());
  posix_spawnattr_destroy(&attributes);
  child.started = std::chrono::steady_clock::now();
  ++child.starts;
  if (error == 0) return {};
  child.process = -1;
  return fail(Error{.file = child.program.arguments[0],
                    .place = {},
                    .value = {},
                    .rule = std::string("cannot be started: ") + std::strerror(error),
                    .advice = "build it (deploy/build.sh) or install the package"});
}

Status Supervisor::start() {
  for (Child& child : children_)
    if (Status launched = launch(child); !launched) return launched;
  return {};
}

std::vector<std::string> Supervisor::tend() {
  std::vector<std::string> events;
  for (Child& child : children_) {
    int status = 0;
    if (child.process > 0 && waitpid(child.process, &status, WNOHANG) == child.process) {
      events.push_back(child.program.name + " " + ending(status));
      child.process = -1;
      child.refused = child.starts == 1 && WIFEXITED(status) && WEXITSTATUS(status) == kBadInput;
    }
    if (child.process > 0 || child.refused || std::chrono::steady_clock::now() - child.started < restart_pause_)
      continue;
    const Status launched = launch(child);
    events.push_back(launched ? child.program.name + " started again" : launched.error().describe());
  }
  return events;
}

void Supervisor::stop() {
  for (const Child& child : children_)
    if (child.process > 0) kill(child.process, SIGTERM);
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  for (Child& child : children_) {
    while (child.process > 0) {
      int status = 0;
      if (waitpid(child.process, &status, WNOHANG) != 0) {
        child.process = -1;
      } else if (std::chrono::steady_clock::now() > deadline) {
        kill(child.process, SIGKILL);
        waitpid(child.process, &status, 0);
        child.process = -1;
      } else {
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
      }
    }
  }
}

bool Supervisor::refused() const {
  return std::any_of(children_.begin(), children_.end(), [](const Child& child) { return child.refused; });
}

pid_t Supervisor::process_of(const std::string& name) const {
  for (const Child& child : children_)
    if (child.program.name == name) return child.process;
  return -1;
}

}  // namespace sealwatch::cli
