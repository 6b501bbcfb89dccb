// A daemon from its command line to SIGTERM, in this process and with the bus in memory.
#include "services/common/runtime/daemon.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/mount.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <functional>
#include <future>
#include <optional>

#include "services/common/runtime/log.hpp"
#include "services/common/runtime/service_manager.hpp"
#include "services/common/store/journal.hpp"
#include "tests/integration/two_seconds.hpp"
#include "tests/unit/runtime/harness.hpp"
#include "tests/unit/runtime/yaml_place.hpp"

namespace sealwatch::testing {
namespace {

using ::testing::HasSubstr;

/// Plays systemd: receives what a daemon notifies.
class ServiceManager {
 public:
  explicit ServiceManager(const std::string& directory) : path_(directory + "/notify") {
    socket_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path_.copy(address.sun_path, sizeof address.sun_path - 1);
    EXPECT_EQ(::bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    const timeval patience{60, 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    ::setenv("NOTIFY_SOCKET", path_.c_str(), 1);
  }
  ~ServiceManager() {
    ::unsetenv("NOTIFY_SOCKET");
    ::close(socket_);
  }
  ServiceManager(const ServiceManager&) = delete;
  ServiceManager& operator=(const ServiceManager&) = delete;
  /// Waits until `state` is notified; false after a minute of silence.
  bool heard(const std::string& state) {
    char text[256];
    for (;;) {
      const ssize_t size = ::recv(socket_, text, sizeof text, 0);
      if (size <= 0) return false;
      if (std::string(text, static_cast<std::size_t>(size)) == state) return true;
    }
  }

 private:
  std::string path_;
  int socket_ = -1;
};

class DaemonTest : public ::testing::Test {
 protected:
  void SetUp() override {
    // The daemon waits for signals in a thread; in this process no other thread may take them.
    sigset_t signals;
    sigemptyset(&signals);
    sigaddset(&signals, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &signals, nullptr);
    place_.write("sealwatch.yaml", "logging: {directory: log}\n");
  }
  int run(const std::vector<std::string>& arguments) {
    std::vector<const char*> argv = {"sealwatch-data-acquisition"};
    for (const std::string& argument : arguments) argv.push_back(argument.c_str());
    return run_daemon(static_cast<int>(argv.size()), argv.data(), parts_);
  }
  std::vector<std::string> usual() const {
    return {"--config", place_.directory(), "--state", place_.directory() + "/state"};
  }

  YamlPlace place_;
  std::shared_ptr<InMemoryNetwork> network_ = std::make_shared<InMemoryNetwork>();
  DaemonParts parts_{.service = "data_acquisition",
                     .version_line = "sealwatch 1.2.3 (commit 123)",
                     .make_layer = [](const Configuration&, const Clock&) { return std::make_unique<CuttingLayer>(); },
                     .make_bus = [this](const Configuration&) -> Result<std::unique_ptr<Bus>> {
                       return std::make_unique<InMemoryBus>(network_);
                     }};
};

TEST_F(DaemonTest, RunsUntilSigtermAndTellsTheServiceManager) {
  ServiceManager manager(place_.directory());
  auto daemon = std::async(std::launch::async, [this] { return run(usual()); });
  ASSERT_TRUE(manager.heard("READY=1"));
  InMemoryBus listener(network_);
  constexpr std::array kFeatures = {Topic::test_features};
  ASSERT_TRUE(listener.subscribe(kFeatures));
  Feeder feeder(network_, blocks_of_tests(1, {"A"}));
  feeder.send(2);
  ASSERT_TRUE(step_until([&] { return feeder.beat(), feeder.all_received(); },
                         [] { std::this_thread::sleep_for(std::chrono::milliseconds(5)); }));
  // What is received is journaled; what it leads to may be concluded only after the next start.
  ASSERT_EQ(listener.receive(std::chrono::seconds(20)).size(), 1U);
  EXPECT_TRUE(manager.heard("WATCHDOG=1"));
  ::kill(::getpid(), SIGTERM);
  EXPECT_TRUE(manager.heard("STOPPING=1"));
  EXPECT_EQ(daemon.get(), 0);
  auto journal = Journal::open("sqlite3://" + place_.directory() + "/state/data_acquisition.db", "data_acquisition");
  ASSERT_TRUE(journal.has_value());
  EXPECT_EQ(journal->written().at(Topic::test_features), 1U);
  std::ifstream log(place_.directory() + "/state/log/data_acquisition.log");
  const std::string text{std::istreambuf_iterator<char>(log), {}};
  EXPECT_THAT(text, HasSubstr("concluded topic=test_features pst=\"A test 0\" asset=A"));
}

/// Computes for ever, at once or for later, once it has an input, and tells the log: it does so while the process ends.
class EndlessLayer final : public Layer {
 public:
  explicit EndlessLayer(bool later) : later_(later) {}
  std::string_view name() const override { return "data_acquisition"; }
  std::span<const Topic> inputs() const override { return kInputs; }
  std::span<const Topic> outputs() const override { return {}; }
  void restore(const Message&) override {}
  Conclusion receive(const Message&) override {
    const auto endless = [](const std::stop_token&) {
      for (volatile bool on = true; on;) log_event(LogLevel::info, "computes", {});
      return Conclusion();
    };
    if (!later_) return endless({});
    Conclusion conclusion;
    conclusion.later = endless;
    return conclusion;
  }

 private:
  static constexpr Topic kInputs[] = {Topic::raw_samples};
  bool later_;
};

/// One block without end, by a reader that cannot be stopped.
class LocalBlocks final : public LocalInputs {
 public:
  void look(const LayerAtRest&, const LayerAtRest&) override {}
  bool has_some() override { return true; }
  std::vector<Message> take() override { return {RawSamples()}; }
  bool stop(std::chrono::milliseconds) override { return false; }
};

TEST_F(DaemonTest, EndsAtSigtermWhateverItComputes) {
  ServiceManager manager(place_.directory());
  for (const bool later : {false, true}) {
    parts_.make_layer = [later](const Configuration&, const Clock&) { return std::make_unique<EndlessLayer>(later); };
    parts_.make_local_inputs = [](const Configuration&) { return std::make_shared<LocalBlocks>(); };
    const pid_t daemon = ::fork();
    if (daemon == 0) _exit(run(usual()));
    EXPECT_TRUE(manager.heard("READY=1"));
    std::this_thread::sleep_for(std::chrono::milliseconds(1500));
    ::kill(daemon, SIGTERM);
    int status = -1;
    const bool ended = happens_within_two_seconds([&] { return ::waitpid(daemon, &status, WNOHANG) == daemon; });
    EXPECT_TRUE(ended) << "runs on, later " << later;
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
    if (!ended) ::kill(daemon, SIGKILL), ::waitpid(daemon, &status, 0);
  }
}

/// With it a daemon ends its own wait for SIGTERM; from outside it is no reason to stop, and none to die.
TEST_F(DaemonTest, RunsOnAtTheSignalThatEndsItsOwnWait) {
  ServiceManager manager(place_.directory());
  const pid_t daemon = ::fork();
  if (daemon == 0) _exit(run(usual()));
  EXPECT_TRUE(manager.heard("READY=1"));
  ::kill(daemon, SIGUSR1);
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  int status = -1;
  EXPECT_EQ(::waitpid(daemon, &status, WNOHANG), 0) << "it has ended: " << status;
  ::kill(daemon, SIGTERM);
  EXPECT_EQ(::waitpid(daemon, &status, 0), daemon);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
}

TEST_F(DaemonTest, WithoutABusItEndsThoughNobodyStopsIt) {
  parts_.make_bus = [](const Configuration&) -> Result<std::unique_ptr<Bus>> {
    return fail(Error{.file = {}, .place = "domain 1", .value = {}, .rule = "no bus here", .advice = {}});
  };
  constexpr int kInternalFailure = 3;
  EXPECT_EQ(run(usual()), kInternalFailure);
}

TEST_F(DaemonTest, RefusesToRunTwiceOnOneState) {
  const auto lock = InstanceLock::take(place_.directory() + "/state", "data_acquisition");
  ASSERT_TRUE(lock.has_value());
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(run(usual()), 2);
  EXPECT_THAT(::testing::internal::GetCapturedStderr(),
              HasSubstr("another data_acquisition works in this directory, process " + std::to_string(::getpid())));
}

/// It was asked between the owner's lock and the owner's number, and named nobody, or one that had ended.
TEST_F(DaemonTest, NamesTheOwnerThatHasTheLockButHasNotWrittenItsNumberYet) {
  const std::string state = place_.directory() + "/state", file = state + "/data_acquisition.lock";
  std::filesystem::create_directories(state);
  for (const char* left_behind : {"", "999999999"}) {
    std::ofstream(file) << left_behind;
    const int owner = ::open(file.c_str(), O_RDWR | O_CLOEXEC);
    ASSERT_EQ(::flock(owner, LOCK_EX), 0);
    const std::future<void> writes = std::async(std::launch::async, [&file] {
      std::this_thread::sleep_for(std::chrono::milliseconds(200));
      std::ofstream(file) << ::getpid();
    });
    const auto refused = InstanceLock::take(state, "data_acquisition");
    writes.wait();
    ::close(owner);
    ASSERT_FALSE(refused.has_value());
    EXPECT_THAT(refused.error().rule, ::testing::EndsWith("in this directory, process " + std::to_string(::getpid())));
  }
}

/// Of a child process that runs with a full disk as its state directory; nothing where this user may not mount one.
std::optional<int> exit_status_on_full_disk(const std::string& directory, const std::function<int()>& run) {
  constexpr int kMayNot = 77;
  const pid_t child = ::fork();
  if (child == 0) {
    std::filesystem::create_directories(directory);
    const bool mounted = ::unshare(CLONE_NEWNS) == 0 &&
                         ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
                         ::mount("full", directory.c_str(), "tmpfs", 0, "size=4k,nr_inodes=2") == 0;
    std::ofstream(directory + "/filled") << std::string(8192, 'x');
    ::_exit(mounted ? run() : kMayNot);
  }
  int status = -1;
  ::waitpid(child, &status, 0);
  return WEXITSTATUS(status) == kMayNot ? std::nullopt : std::optional(WEXITSTATUS(status));
}

/// A first start on a full disk was for good: exit status 2 says that nothing but another configuration helps.
TEST_F(DaemonTest, AFullDiskIsNoBadConfiguration) {
  const auto on_full_disk = exit_status_on_full_disk(place_.directory() + "/state", [this] { return run(usual()); });
  EXPECT_EQ(run({"--config", place_.directory(), "--state", "/proc/sealwatch"}), 2) << "never to be made";
  if (!on_full_disk) GTEST_SKIP() << "may not mount";
  EXPECT_EQ(*on_full_disk, 3);
}

/// Else the first files that it opens are its standard streams, and a warning is written over its lock.
TEST_F(DaemonTest, StartedWithoutStandardStreamsItHasNone) {
  place_.write("sealwatch.yaml", "domain: 999\n");
  const pid_t child = ::fork();
  if (child == 0) {
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) ::close(stream);
    (void)run(usual());
    std::error_code none;
    const auto there = std::filesystem::read_symlink("/proc/self/fd/2", none);
    ::_exit(there == "/dev/null" ? 0 : 1);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
}

TEST_F(DaemonTest, RefusesABadConfigurationBeforeAnythingStarts) {
  place_.write("sealwatch.yaml", "domian: 1\nstate_directroy: x\n");
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(run(usual()), 2);
  const std::string text = ::testing::internal::GetCapturedStderr();
  EXPECT_THAT(text, HasSubstr("did you mean 'domain'?"));
  EXPECT_THAT(text, HasSubstr("did you mean 'state_directory'?"));
  EXPECT_FALSE(std::filesystem::exists(place_.directory() + "/state"));
}

TEST_F(DaemonTest, EndsWithInternalFailureWhenItsJournalIsNone) {
  std::filesystem::create_directories(place_.directory() + "/state/data_acquisition.db");
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(run(usual()), 3);
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), HasSubstr("data_acquisition.db"));
}

TEST_F(DaemonTest, AnswersQuestionsAndRefusesWhatItDoesNotKnow) {
  ::testing::internal::CaptureStdout();
  EXPECT_EQ(run({"--version"}), 0);
  EXPECT_THAT(::testing::internal::GetCapturedStdout(), "sealwatch 1.2.3 (commit 123)\n");
  ::testing::internal::CaptureStdout();
  EXPECT_EQ(run({"--help"}), 0);
  EXPECT_THAT(::testing::internal::GetCapturedStdout(), HasSubstr("--config"));
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(run({"--confg", "x"}), 2);
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), HasSubstr("--confg"));
}

TEST(InstanceLockTest, IsFreeAgainWhenItsHolderEnds) {
  const YamlPlace place;
  { ASSERT_TRUE(InstanceLock::take(place.directory(), "x").has_value()); }
  EXPECT_TRUE(InstanceLock::take(place.directory(), "x").has_value());
}

}  // namespace
}  // namespace sealwatch::testing
