// Recorded tests through the real six processes: live and offline agree, deaths change nothing, late subscribers are
// served.
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>

#include <fstream>
#include <iomanip>
#include <iostream>
#include <nlohmann/json.hpp>
#include <random>
#include <regex>
#include <sstream>
#include <thread>

#include "services/common/runtime/configuration_loader.hpp"
#include "services/common/runtime/service_manager.hpp"
#include "tests/integration/six_services.hpp"
#include "tests/integration/two_seconds.hpp"

namespace sealwatch::testing {
namespace {

std::vector<std::string> with(std::vector<std::string> arguments, const std::vector<std::string>& more) {
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

// Empty for a process that ended meanwhile: an istreambuf_iterator would throw there.
std::string file_text(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

void expect_same(const StoredResults& one, const StoredResults& other) {
  ASSERT_EQ(one.size(), other.size());
  for (const auto& [service, outputs] : one) {
    const auto& others = other.at(service);
    ASSERT_EQ(outputs.size(), others.size()) << service;
    for (std::size_t k = 0; k < outputs.size(); ++k) {
      ASSERT_EQ(outputs[k].first, others[k].first) << service << " output " << k;
      ASSERT_EQ(outputs[k].second, others[k].second) << service << " " << outputs[k].first;
    }
  }
}

class Replay : public SixServices {
 protected:
  /// The undisturbed run that others are compared with.
  Finished undisturbed(const std::string& state) {
    return run(with({"sealwatch", "replay", "--config", config(), "--with-services", "--state",
                     state_directory(state).string(), "--results", (folder_ / "live").string(), "--quiet"},
                    recordings()));
  }
};

TEST_F(Replay, LiveAndOfflineConcludeTheSame) {
  const Finished live = undisturbed("state");
  ASSERT_EQ(live.status, 0) << live.output;
  EXPECT_NE(live.output.find("remaining life"), std::string::npos) << live.output;
  // Given in another order: tests are played by their start times.
  std::vector<std::string> reversed(recordings().rbegin(), recordings().rend());
  const Finished offline = run(with({"sealwatch", "replay", "--config", config(), "--offline", "--results",
                                     (folder_ / "offline").string(), "--quiet"},
                                    reversed));
  ASSERT_EQ(offline.status, 0) << offline.output;
  for (const char* topic : {"test_features", "state_report", "health_report", "leakage_estimate", "remaining_life",
                            "pst_request", "advisory"}) {
    const std::string file = std::string(topic) + ".jsonl";
    const std::string text = file_text(folder_ / "live" / file);
    EXPECT_GE(std::count(text.begin(), text.end(), '\n'), static_cast<long>(recordings().size())) << topic;
    const std::string offline_text = file_text(folder_ / "offline" / file);
    EXPECT_TRUE(text == offline_text)
        << topic << ": first difference at byte "
        << std::mismatch(text.begin(), text.end(), offline_text.begin(), offline_text.end()).first - text.begin()
        << " of " << text.size() << " and " << offline_text.size();
  }
}

TEST_F(Replay, ASecondReplayChangesNothing) {
  ASSERT_EQ(undisturbed("state").status, 0);
  const StoredResults first = stored_results("state");
  const Finished again = undisturbed("state");
  ASSERT_EQ(again.status, 0) << again.output;
  EXPECT_NE(again.output.find("known already"), std::string::npos) << again.output;
  expect_same(first, stored_results("state"));
}

TEST_F(Replay, ALateSubscriberGetsTheLastStateOfTheAsset) {
  cli::Supervisor services(programs("state"));
  ASSERT_TRUE(services.start().has_value());
  ASSERT_EQ(run(with({"sealwatch", "replay", "--config", config(), "--quiet"}, recordings())).status, 0);
  const Finished status = run({"sealwatch", "status", "--config", config(), "--json"});
  ASSERT_EQ(status.status, 0) << status.output;
  const auto result = nlohmann::json::parse(status.output);
  EXPECT_EQ(result["services"].size(), 6U);
  const std::string last_test = result["assets"]["XT03-MV2"]["leakage_estimate"]["header"]["pst_id"];
  const StoredResults stored = stored_results("state");
  EXPECT_NE(stored.at("prognostic_assessment").back().first.find(last_test), std::string::npos) << last_test;
  for (const std::string& service : service_names())
    EXPECT_NE(file_text(state_directory("state") / "log" / (service + ".log")).find("pst=" + last_test),
              std::string::npos)
        << "the test can be followed through " << service;
  // A restarted writer serves later subscribers too: its journal is all it needs.
  ASSERT_EQ(kill(services.process_of("advisory_generation"), SIGKILL), 0);
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(3);
  while (std::chrono::steady_clock::now() < end) {
    (void)services.tend();
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  const Finished later = run({"sealwatch", "status", "--config", config(), "--json"});
  EXPECT_EQ(nlohmann::json::parse(later.output)["assets"]["XT03-MV2"]["advisory"]["header"]["pst_id"], last_test);
}

TEST_F(Replay, KilledAtRandomMomentsEachServiceEndsWithTheSameResults) {
  ASSERT_EQ(undisturbed("undisturbed").status, 0);

  constexpr int kDeathsOfEach = 3;
  const unsigned seed = std::random_device{}();
  std::cout << "seed " << seed << "\n";
  std::mt19937 random(seed);
  std::vector<std::string> victims;
  for (const cli::ServiceProgram& service : programs("killed"))
    for (int k = 0; k < kDeathsOfEach; ++k) victims.push_back(service.name);
  std::shuffle(victims.begin(), victims.end(), random);

  cli::Supervisor services(programs("killed"), std::chrono::milliseconds(50));
  ASSERT_TRUE(services.start().has_value());
  const pid_t replay =
      start(with({"sealwatch", "replay", "--config", config(), "--quiet"}, recordings()), folder_ / "replay.log");
  std::uniform_int_distribution<int> pause_ms(20, 400);
  auto next_death = std::chrono::steady_clock::now() + std::chrono::milliseconds(300);
  std::map<std::string, int> deaths;
  int status = 0;
  while (waitpid(replay, &status, WNOHANG) == 0) {
    (void)services.tend();
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    if (victims.empty() || std::chrono::steady_clock::now() < next_death) continue;
    next_death = std::chrono::steady_clock::now() + std::chrono::milliseconds(pause_ms(random));
    const pid_t victim = services.process_of(victims.back());
    if (victim <= 0) continue;
    kill(victim, SIGKILL);
    ++deaths[victims.back()];
    victims.pop_back();
  }
  ASSERT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << file_text(folder_ / "replay.log");
  services.stop();
  EXPECT_TRUE(victims.empty()) << "the replay ended before all deaths; " << victims.size() << " left";
  EXPECT_EQ(deaths.size(), 6U);
  expect_same(stored_results("undisturbed"), stored_results("killed"));
}

/// Processes whose command line names this state directory.
std::size_t processes_with(const std::string& state) {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    if (file_text(entry.path() / "cmdline").find(state) != std::string::npos) ++count;
  }
  return count;
}

/// Neither hears the other's services when both begin at once.
TEST_F(Replay, WithServicesIsRefusedWhereAnotherIsStartingThem) {
  const auto lock = InstanceLock::take(state_directory("taken").string(), "supervisor");
  ASSERT_TRUE(lock.has_value());
  const Finished refused = run(with({"sealwatch", "replay", "--with-services", "--state",
                                     state_directory("taken").string(), "--config", config(), "--quiet"},
                                    recordings()));
  EXPECT_EQ(refused.status, 2) << refused.output;
  EXPECT_THAT(refused.output, ::testing::HasSubstr("process " + std::to_string(::getpid())));
  EXPECT_EQ(processes_with(state_directory("taken").string()), 0U);
}

/// The same test with hours of rest behind it: with fewer rows a second, as one test has so many at most, and with more
/// rest before it, so that there are enough rows to tell where it began.
std::string among_rest(const std::filesystem::path& recording, const std::filesystem::path& folder, double hours) {
  constexpr double kApart_s = 0.2;
  constexpr std::size_t kRowsOfRest = 5;  // they differ by their noise: what stays the same is frozen
  constexpr double kBefore_s = 10.0;
  std::ifstream from(recording);
  std::string header, line;
  std::getline(from, header);
  std::vector<std::pair<double, std::string>> rows;  // times, and what is behind them
  while (std::getline(from, line)) rows.emplace_back(std::stod(line), line.substr(line.find(',')));

  std::filesystem::path sidecar = recording;
  std::filesystem::create_directories(folder);
  std::filesystem::copy(sidecar.replace_extension(".yaml"), folder);
  std::ofstream to(folder / recording.filename());
  to << header << '\n' << std::setprecision(9);
  double time_s = 0.0;
  const auto write = [&](const std::string& row) {
    to << time_s << row << '\n';
    time_s += kApart_s;
  };
  while (time_s < kBefore_s)
    for (std::size_t k = 0; k < kRowsOfRest; ++k) write(rows[k].second);
  const double begin_s = time_s;
  for (const auto& [row_s, row] : rows)
    if (begin_s + row_s > time_s - 1e-6) write(row);
  while (time_s < 3600.0 * hours)
    for (std::size_t k = rows.size() - kRowsOfRest; k < rows.size(); ++k) write(rows[k].second);
  return folder / recording.filename();
}

TEST_F(Replay, ATestOfManyHoursIsRefusedByNameAndTheNextIsConcluded) {
  const std::string state = state_directory("hours").string();
  const std::string too_long = among_rest(recordings()[0], folder_ / "hours of rest", 8.0);
  const pid_t up = start({"sealwatch", "up", "--config", config(), "--state", state}, folder_ / "up.log");
  Finished replayed;
  for (int attempt = 0; attempt < 50 && replayed.status != 0; ++attempt) {  // until the services are up
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    replayed = run({"sealwatch", "replay", "--config", config(), "--quiet", too_long, recordings()[1]});
  }
  EXPECT_EQ(replayed.status, 0) << replayed.output;
  const Finished status = run({"sealwatch", "status", "--config", config()});
  const std::string unwrapped = std::regex_replace(status.output, std::regex("\\n +"), " ");
  EXPECT_THAT(unwrapped, ::testing::HasSubstr("the test could not be used: the test is 28800 s long"));
  EXPECT_THAT(status.output, ::testing::Not(::testing::HasSubstr("set aside")));
  const auto last = nlohmann::json::parse(run({"sealwatch", "status", "--config", config(), "--json"}).output);
  const auto& asset = last["assets"]["XT03-MV2"];
  EXPECT_EQ(asset["state_report"]["verdict"], "passed") << asset["state_report"].dump(1);
  EXPECT_TRUE(asset["leakage_estimate"]["used_for_forecast"]) << asset["leakage_estimate"].dump(1);
  EXPECT_EQ(stored_results("hours").at("state_detection").size(), 2U);

  kill(up, SIGTERM);
  EXPECT_TRUE(
      happens_within_two_seconds([&] { return waitpid(up, nullptr, WNOHANG) != 0 && processes_with(state) == 0; }));
}

TEST_F(Replay, ToldToStopOrKilledItLeavesNoServiceBehind) {
  for (const int signal : {SIGTERM, SIGINT, SIGKILL}) {
    const std::string state = state_directory("left " + std::to_string(signal)).string();
    const pid_t replay = start(with({"sealwatch", "replay", "--with-services", "--state", state, "--config", config(),
                                     "--speed", "1", "--quiet"},
                                    recordings()),
                               folder_ / "replay.log");
    const auto wait_until = [&](std::size_t least, std::size_t most) {
      const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
      while (std::chrono::steady_clock::now() < end) {
        const std::size_t count = processes_with(state);
        if (count >= least && count <= most) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
      }
      return false;
    };
    ASSERT_TRUE(wait_until(7, 7)) << "replay and its six services";
    const auto begin = std::chrono::steady_clock::now();
    kill(replay, signal);
    EXPECT_TRUE(happens_within_two_seconds([&] {
      return waitpid(replay, nullptr, WNOHANG) != 0 && processes_with(state) == 0;
    })) << "signal "
        << signal;
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    std::cout << "signal " << signal << ": all gone after " << took.count() << " s\n";
  }
}

}  // namespace
}  // namespace sealwatch::testing
