// What people tell the running services, and what they are told back.
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "sealwatch/core/time.hpp"
#include "tests/integration/six_services.hpp"

namespace sealwatch::testing {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;

/// The six services with three tests behind them. One person is enough.
class Operator : public SixServices {
 protected:
  void SetUp() override {
    std::filesystem::copy(SixServices::config(), config(), std::filesystem::copy_options::recursive);
    std::ofstream(config() + "/sealwatch.yaml", std::ios::app) << "\noperator_acts: {confirmed_by_second: false}\n";
    up_ = start({"sealwatch", "up", "--config", config(), "--state", state_directory("state").string()},
                folder_ / "up.log");
    EXPECT_TRUE(takes_recordings());
  }
  void TearDown() override {
    kill(up_, SIGTERM);
    waitpid(up_, nullptr, 0);
  }
  [[nodiscard]] std::string config() const { return (folder_ / "alone").string(); }
  [[nodiscard]] Finished replay(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {"sealwatch", "replay", "--config", config(), "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    arguments.insert(arguments.end(), recordings().begin(), recordings().begin() + 3);
    return run(arguments);
  }
  /// Once the services are up.
  [[nodiscard]] bool takes_recordings() const {
    for (int attempt = 0; attempt < 30; ++attempt) {
      if (replay().status == 0) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(200));
    }
    return false;
  }
  [[nodiscard]] Finished acknowledge(const std::string& advisory_id) const {
    return run({"sealwatch", "acknowledge", "--config", config(), "XT03-MV2", advisory_id, "--by", "operator"});
  }
  [[nodiscard]] Finished say(const std::string& command, const std::vector<std::string>& words) const {
    std::vector<std::string> arguments = {"sealwatch", command, "--config", config()};
    arguments.insert(arguments.end(), words.begin(), words.end());
    arguments.insert(arguments.end(), {"--by", "J. Silva"});
    return run(arguments);
  }
  [[nodiscard]] std::string advisory_in_force() const {
    const json status = json::parse(run({"sealwatch", "status", "--config", config(), "--json"}).output);
    return status["assets"]["XT03-MV2"]["advisory"]["advisory_id"];
  }

  pid_t up_ = -1;
};

/// What changes nothing: all these tests ask the same services.
class OperatorWhoAsks : public Operator {
 protected:
  void SetUp() override {
    own_folder_ = folder_;
    if (shared_up_ < 0) {
      Operator::SetUp();
      shared_up_ = up_;
      shared_folder_ = folder_;
      own_folder_ = folder_.string() + "_own";
    }
    folder_ = shared_folder_;
    up_ = shared_up_;
  }
  /// The services go on, and what they keep stays.
  void TearDown() override { folder_ = own_folder_; }
  static void TearDownTestSuite() {
    kill(shared_up_, SIGTERM);
    waitpid(shared_up_, nullptr, 0);
    std::filesystem::remove_all(shared_folder_);
    shared_up_ = -1;
  }

 private:
  inline static pid_t shared_up_ = -1;
  inline static std::filesystem::path shared_folder_;
  std::filesystem::path own_folder_;
};

TEST_F(OperatorWhoAsks, OpensAnAdvisoryDownToTheWaveformWhileTheServicesRun) {
  const std::string state = state_directory("state").string();
  const Finished shown = run({"sealwatch", "show", "XT03-MV2", "--state", state, "--json"});
  ASSERT_EQ(shown.status, 0) << shown.output;
  json node = json::parse(shown.output);
  EXPECT_EQ(node["topic"], "advisory");
  const std::string pst_id = node["message"]["header"]["pst_id"];
  std::vector<std::string> topics;
  for (; !node["sources"].empty(); node = json(node["sources"][0])) topics.push_back(node["topic"]);
  EXPECT_THAT(topics, ::testing::IsSupersetOf({"advisory", "health_report", "test_window", "sample_block"}));
  EXPECT_EQ(node["topic"], "raw_samples") << "the last is what came from outside";

  const std::string waveform = (folder_ / "waveform.csv").string();
  const Finished text = run({"sealwatch", "show", "leakage_estimate/" + pst_id, "--state", state, "--csv", waveform});
  ASSERT_EQ(text.status, 0) << text.output;
  EXPECT_THAT(text.output, AllOf(HasSubstr("test_window/" + pst_id), HasSubstr("samples of recording")));
  const Finished again = run({"sealwatch", "fit", "--asset", config() + "/assets/xt03-mv2.yaml", waveform, "--json"});
  EXPECT_EQ(again.status, 0) << "the waveform is a recording: " << again.output;

  const Finished unknown = run({"sealwatch", "show", "advisory/" + pst_id + "x", "--state", state});
  EXPECT_EQ(unknown.status, 2);
  EXPECT_THAT(unknown.output, HasSubstr("the nearest are advisory/" + pst_id));
}

TEST_F(OperatorWhoAsks, ForecastsFromWhatTheServicesKeep) {
  const std::string page = (folder_ / "life.html").string();
  const Finished forecast = run({"sealwatch", "forecast", "--config", config(), "--state",
                                 state_directory("state").string(), "--page", page, "--json"});
  ASSERT_EQ(forecast.status, 0) << forecast.output;  // the fleet tells something after three tests
  const json result = json::parse(forecast.output);
  EXPECT_EQ(result["asset_id"], "XT03-MV2");
  EXPECT_EQ(result["tests"], 3);
  EXPECT_EQ(result["forecasts"][0]["state"], "insufficient_history");
  EXPECT_TRUE(std::filesystem::exists(page));
  EXPECT_THAT(run({"sealwatch", "forecast", "--config", config(), "--state", state_directory("state").string(),
                   "--asset", "XT03-MV3"})
                  .output,
              HasSubstr("did you mean 'XT03-MV2'?"));
}

/// What means nothing, or what every service would refuse, is not told as done.
TEST_F(OperatorWhoAsks, IsToldThatARetractionMeansNothing) {
  const auto retract = [&](const std::string& what, const std::string& value, const std::string& why) {
    return run(
        {"sealwatch", "retract", "--config", config(), "XT03-MV2", what, value, "--by", "J. Silva", "--reason", why});
  };
  const auto is_told = [&](const std::string& what, const std::string& value, const std::string& says) {
    const Finished vain = retract(what, value, "wrong valve");
    EXPECT_EQ(vain.status, 1) << vain.output;
    EXPECT_THAT(vain.output,
                AllOf(HasSubstr(what + ": '" + value + "'"), HasSubstr(says), Not(HasSubstr("received:"))));
  };
  is_told("--test", "NOSUCH", "is not a test of XT03-MV2");
  is_told("--test", "XT03-MV2-20010101T000000Z-00000000", "changes nothing");
  is_told("--since", "2031-01-01", "changes nothing");
  is_told("--withdraw", "retraction/XT03-MV2/since/2031-01-01T00:00:00Z/2031-01-01T00:00:00Z", "changes nothing");
  const Finished latin = retract("--since", "2001-01-01", "falsches Ger\xe4t");
  EXPECT_EQ(latin.status, 2) << latin.output;
  EXPECT_THAT(latin.output, HasSubstr("is not UTF-8"));
}

TEST_F(OperatorWhoAsks, RefusesWhatCannotBeDone) {
  const Finished unknown =
      say("shelve", {"XT03-MV2", "sensor_lost/pressure_a", "--until", "2199-01-01", "--reason", "a try"});
  EXPECT_EQ(unknown.status, 1) << unknown.output;
  EXPECT_THAT(unknown.output, HasSubstr("'sensor_lost/pressure_a': is not an alarm of XT03-MV2"));
  const Finished no_time = say("shelve", {"XT03-MV2", "x", "--until", "soon", "--reason", "a try"});
  EXPECT_EQ(no_time.status, 2) << no_time.output;
  EXPECT_THAT(no_time.output, HasSubstr("--until"));
  const Finished not_out = say("in-service", {"XT03-MV2"});
  EXPECT_EQ(not_out.status, 1) << not_out.output;
  EXPECT_THAT(not_out.output, HasSubstr("is not out of service"));
  EXPECT_EQ(say("out-of-service", {"XT09", "--reason", "x"}).status, 2);
}

TEST_F(OperatorWhoAsks, IsToldOfAServiceThatHangs) {
  const auto state_of = [](const std::string& output) {
    std::map<std::string, json> services;
    const json status = json::parse(output);
    for (const json& service : status["services"]) services[service["service"]] = service;
    return services;
  };
  const Finished well = run({"sealwatch", "status", "--config", config(), "--json"});
  EXPECT_EQ(well.status, 0) << well.output;
  const auto services = state_of(well.output);
  ASSERT_EQ(services.size(), 6U);
  const pid_t hung = services.at("health_assessment")["process_id"].get<pid_t>();
  kill(hung, SIGSTOP);
  const Finished text = run({"sealwatch", "status", "--config", config()});
  const Finished machine = run({"sealwatch", "status", "--config", config(), "--json"});
  kill(hung, SIGCONT);
  EXPECT_EQ(text.status, 1) << text.output;
  EXPECT_THAT(text.output,
              AllOf(HasSubstr("health_assessment  no heartbeat\n"), HasSubstr("state_detection  running")));
  EXPECT_EQ(machine.status, 1);
  EXPECT_EQ(state_of(machine.output).at("health_assessment")["state"], "no heartbeat");
  EXPECT_EQ(state_of(machine.output).at("state_detection")["trouble"], "");
}

TEST_F(Operator, LeavesNoServiceBehindWhenUpIsKilled) {
  kill(up_, SIGKILL);
  waitpid(up_, nullptr, 0);
  Finished status;
  for (int attempt = 0; attempt < 50; ++attempt) {
    status = run({"sealwatch", "status", "--config", config(), "--seconds", "1.5"});
    if (status.output.find("no service is running") != std::string::npos) break;  // not merely the first of them
  }
  EXPECT_EQ(status.status, 1) << status.output;
  EXPECT_THAT(status.output, HasSubstr("no service is running"));
  up_ = start({"sealwatch", "up", "--config", config(), "--state", state_directory("state").string()},
              folder_ / "up_again.log");
}

/// Whichever of them misses a replacement would count other tests than the rest, and refuse its confirmation.
TEST_F(Operator, IsToldWhichLayerDidNotReceiveAReplacement) {
  std::map<std::string, pid_t> processes;
  const json status = json::parse(run({"sealwatch", "status", "--config", config(), "--json"}).output);
  for (const json& service : status["services"]) processes[service["service"]] = service["process_id"].get<pid_t>();
  const pid_t stopped = processes.at("data_acquisition");
  kill(stopped, SIGSTOP);
  const Finished said =
      run({"sealwatch", "replaced", "--config", config(), "XT03-MV2", "--at", "2020-01-01", "--by", "J. Silva"});
  kill(stopped, SIGCONT);
  EXPECT_EQ(said.status, 1) << said.output;
  EXPECT_THAT(said.output, HasSubstr("was not received by data_acquisition"));
}

TEST_F(Operator, IsToldThatAnEarlierTestLeavesTheAdvice) {
  const auto state = state_directory("late");
  const auto play = [&](std::size_t k) {
    return run({"sealwatch", "replay", "--config", config(), "--quiet", recordings()[k]});
  };
  kill(up_, SIGTERM);
  waitpid(up_, nullptr, 0);
  up_ = start({"sealwatch", "up", "--config", config(), "--state", state.string()}, folder_ / "late.log");
  Finished newest;
  for (int attempt = 0; attempt < 10 && newest.status != 0; ++attempt) newest = play(2);
  ASSERT_EQ(newest.status, 0) << newest.output;
  const Finished earlier = play(0);
  EXPECT_EQ(earlier.status, 0) << earlier.output;
  EXPECT_THAT(earlier.output, AllOf(HasSubstr("1 test is earlier than"), HasSubstr("the advice stands"),
                                    Not(HasSubstr("known already"))));
  EXPECT_THAT(play(0).output, HasSubstr("known already"));
}

TEST_F(Operator, IsToldThatAllAreUpOnlyOnceAllAre) {
  std::ostringstream log;
  log << std::ifstream(folder_ / "up.log").rdbuf();
  EXPECT_THAT(log.str(), HasSubstr("sealwatch is up"));
  kill(up_, SIGTERM);
  waitpid(up_, nullptr, 0);
  const auto blocked = state_directory("blocked");
  std::ofstream(blocked) << "a file where the state directory should be";
  const Finished refused = run({"sealwatch", "up", "--config", config(), "--state", blocked.string()});
  EXPECT_EQ(refused.status, 2) << refused.output;
  EXPECT_THAT(refused.output, AllOf(HasSubstr("one could not start"), Not(HasSubstr("sealwatch is up"))));
  up_ = start({"sealwatch", "up", "--config", config(), "--state", state_directory("state").string()},
              folder_ / "up_again.log");
}

/// Each took the journals of some services, and both ended.
TEST_F(Operator, OfTwoThatStartAtOnceOneRunsAndTheOtherSaysWhichDoes) {
  kill(up_, SIGTERM);
  waitpid(up_, nullptr, 0);
  const std::vector<std::string> command = {"sealwatch", "up",      "--config",
                                            config(),    "--state", state_directory("state").string()};
  const pid_t one = start(command, folder_ / "one.log"), other = start(command, folder_ / "other.log");
  int status = 0;
  const pid_t loser = ::waitpid(-1, &status, 0);
  up_ = loser == one ? other : one;
  EXPECT_EQ(WEXITSTATUS(status), 2);
  std::ostringstream said;
  said << std::ifstream(folder_ / (loser == one ? "one.log" : "other.log")).rdbuf();
  EXPECT_THAT(said.str(), ContainsRegex("process " + std::to_string(up_) + "|runs here already"));
  EXPECT_TRUE(takes_recordings()) << "the other's services run";
}

TEST_F(Operator, IsToldWhatBecameOfIt) {
  const Finished again = replay({"--results", (folder_ / "again").string()});
  EXPECT_EQ(again.status, 0) << again.output;
  EXPECT_THAT(again.output, AllOf(HasSubstr("nothing was written to"), HasSubstr("replay --offline"),
                                  HasSubstr("were known already"), ContainsRegex("[1-3] tests? shown")))
      << "what was known is on the screen all the same";

  const Finished second = run({"sealwatch", "up", "--config", config(), "--state", state_directory("other").string()});
  EXPECT_EQ(second.status, 2) << second.output;
  EXPECT_THAT(second.output, AllOf(HasSubstr(" (process "), HasSubstr("runs here already")));
  EXPECT_EQ(replay({"--with-services", "--state", state_directory("other").string()}).status, 2);

  const std::string advisory = advisory_in_force();
  const Finished unknown = acknowledge("recommendation/XT03-MV2-never-given");
  EXPECT_EQ(unknown.status, 1) << unknown.output;
  EXPECT_THAT(unknown.output, AllOf(HasSubstr("is not the advisory in force"), HasSubstr(advisory)));
  const Finished known = acknowledge(advisory);
  EXPECT_EQ(known.status, 0) << known.output;
  EXPECT_THAT(known.output, HasSubstr("acknowledged by operator"));
  EXPECT_EQ(acknowledge(advisory).status, 0) << "twice is as once";

  const Finished revoked = run({"sealwatch", "accept", "--config", config(), "--asset-id", "XT03-MV2", "--discrepancy",
                                "model_discrepancy/never-given", "--revoke", "--by", "operator"});
  EXPECT_EQ(revoked.status, 1) << revoked.output;
  EXPECT_THAT(revoked.output, HasSubstr("is not known"));

  EXPECT_THAT(run({"sealwatch", "status", "--config", config()}).output, HasSubstr("R_CL"));
  const Finished replaced =
      run({"sealwatch", "replaced", "--config", config(), "XT03-MV2", "--at", "2020-01-01", "--by", "operator"});
  EXPECT_EQ(replaced.status, 0) << replaced.output;
  const Finished status = run({"sealwatch", "status", "--config", config()});
  EXPECT_THAT(status.output, AllOf(HasSubstr("replaced on 2020-01-01, no test since"), Not(HasSubstr("R_CL")),
                                   Not(HasSubstr("grade")), Not(HasSubstr("last test"))));

  for (const char* day : {"2019-01-01", "2020-01-01"}) {
    const Finished vain =
        run({"sealwatch", "replaced", "--config", config(), "XT03-MV2", "--at", day, "--by", "operator"});
    EXPECT_EQ(vain.status, 1) << vain.output;
    EXPECT_THAT(vain.output, AllOf(HasSubstr("a replacement on 2020-01-01 is known already"),
                                   HasSubstr("only tests since 2020-01-01 count"), Not(HasSubstr("received"))));
  }
}

TEST_F(Operator, KeepsARecordOfWhatPeopleDidThatShowsChanges) {
  const std::string state = state_directory("state").string();
  const auto audit = [&](const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {"sealwatch", "audit", "--config", config(), "--state", state};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  };
  ASSERT_EQ(acknowledge(advisory_in_force()).status, 0);
  const json shown = json::parse(run({"sealwatch", "show", "XT03-MV2", "--state", state, "--json"}).output);
  const std::string pst_id = shown["message"]["header"]["pst_id"];
  const Finished retracted = run({"sealwatch", "retract", "--config", config(), "XT03-MV2", "--test", pst_id, "--by",
                                  "J. Silva", "--reason", "wrong valve"});
  ASSERT_EQ(retracted.status, 0) << retracted.output;
  const Finished whole = audit({"--json"});
  EXPECT_EQ(whole.status, 0) << whole.output;
  std::map<std::string, json> acts;
  const json record = json::parse(whole.output);
  for (const json& service : record["services"]) acts[service["service"]] = service["acts"];
  ASSERT_EQ(acts["advisory_generation"].size(), 2U) << whole.output;
  EXPECT_EQ(acts["advisory_generation"][0]["kind"], "acknowledgement");
  EXPECT_EQ(acts["advisory_generation"][0]["who"], "operator");
  ASSERT_EQ(acts["state_detection"].size(), 1U);
  EXPECT_EQ(acts["state_detection"][0]["kind"], "test_retracted");
  EXPECT_EQ(acts["state_detection"][0]["text"], "wrong valve");

  const std::string changes = "DROP TRIGGER acts_no_UPDATE; UPDATE acts SET who = 'nobody' WHERE sequence = 1";
  ASSERT_EQ(std::system(("sqlite3 " + state + "/state_detection.db \"" + changes + "\"").c_str()), 0);
  const Finished changed = audit();
  EXPECT_EQ(changed.status, 1) << changed.output;
  EXPECT_THAT(changed.output, AllOf(HasSubstr("state_detection: BROKEN at entry 1"),
                                    HasSubstr("advisory_generation: 2 acts, as they were written")));
}

/// The states of alarms after ISA-18.2, through restarts of the service that keeps them.
class OperatorOfAlarms : public Operator {
 protected:
  static constexpr const char* kSilent = "no_heartbeat/health_assessment";

  /// What is stored, but for the acts that services keep for each other.
  [[nodiscard]] StoredResults conclusions() const {
    StoredResults stored = stored_results(state_directory("state").string());
    for (auto& [service, outputs] : stored)
      std::erase_if(outputs, [](const auto& output) { return output.first.starts_with("act_record/"); });
    return stored;
  }

  [[nodiscard]] json status() const {
    return json::parse(run({"sealwatch", "status", "--config", config(), "--json", "--seconds", "1.5"}).output);
  }
  [[nodiscard]] static json alarm_in(const json& status, const std::string& id) {
    for (const json& alarm : status["alarms"])
      if (alarm["id"] == id || (id == kSilent && alarm["kind"] == "no_heartbeat")) return alarm;
    return {};
  }
  [[nodiscard]] static pid_t process_of(const json& status, const std::string& name) {
    for (const json& service : status["services"])
      if (service["service"] == name) return service.value("process_id", -1);
    return -1;
  }
  /// Waits until the alarm is in that state; "" is in none, as it is not there.
  [[nodiscard]] ::testing::AssertionResult becomes(const std::string& id, const std::string& state) const {
    json alarm;
    for (int attempt = 0; attempt < 12; ++attempt) {
      alarm = alarm_in(status(), id);
      if ((alarm.is_null() ? "" : alarm.value("state", "")) == state) return ::testing::AssertionSuccess();
    }
    return ::testing::AssertionFailure() << alarm.dump();
  }
};

TEST_F(OperatorOfAlarms, ShelvesAcknowledgesAndTakesOutOfService) {
  const json well = status();
  const pid_t hung = process_of(well, "health_assessment");
  const StoredResults before = conclusions();
  kill(hung, SIGSTOP);
  ASSERT_TRUE(becomes(kSilent, "unacknowledged"));
  const std::string until = format_utc({std::time(nullptr) * 1'000'000'000 + 86'400'000'000'000});
  const Finished shelved = say("shelve", {"-", kSilent, "--until", until, "--reason", "being looked at"});
  EXPECT_EQ(shelved.status, 0) << shelved.output;
  ASSERT_TRUE(becomes(kSilent, "shelved"));
  kill(process_of(status(), "advisory_generation"), SIGKILL);  // up starts it again
  ASSERT_TRUE(becomes(kSilent, "shelved")) << "it is in the journal";
  EXPECT_THAT(run({"sealwatch", "status", "--config", config()}).output,
              HasSubstr("SHELVED until " + until + " by J. Silva, being looked at (failure)  health_assessment"));
  EXPECT_EQ(say("unshelve", {"-", kSilent}).status, 0);
  ASSERT_TRUE(becomes(kSilent, "unacknowledged"));
  kill(hung, SIGCONT);
  ASSERT_TRUE(becomes(kSilent, "returned")) << "nobody has said that it was seen";
  const Finished seen = say("acknowledge", {"-", kSilent});
  EXPECT_EQ(seen.status, 0) << seen.output;
  ASSERT_TRUE(becomes(kSilent, ""));

  EXPECT_EQ(say("out-of-service", {"XT03-MV2", "--reason", "valve is being replaced"}).status, 0);
  ASSERT_TRUE(becomes("out_of_service", "out_of_service"));
  EXPECT_EQ(say("in-service", {"XT03-MV2"}).status, 0);
  ASSERT_TRUE(becomes("out_of_service", ""));
  EXPECT_TRUE(before == conclusions()) << "none of it is concluded from";
  const Finished audit =
      run({"sealwatch", "audit", "--config", config(), "--state", state_directory("state").string()});
  for (const char* act :
       {"alarm_shelved", "alarm_unshelved", "acknowledgement", "asset_out_of_service", "asset_in_service"})
    EXPECT_THAT(audit.output, ContainsRegex(std::string("advisory_generation [0-9]+  ") + act + ".*by J. Silva"));
}

/// They were told to one service alone: the others keep its record of them.
TEST_F(OperatorOfAlarms, ALostJournalHasBackWhatWasSaidOfThem) {
  const std::string state = state_directory("state").string();
  const pid_t hung = process_of(status(), "health_assessment");
  kill(hung, SIGSTOP);
  ASSERT_TRUE(becomes(kSilent, "unacknowledged"));
  const std::string until = format_utc({std::time(nullptr) * 1'000'000'000 + 86'400'000'000'000});
  EXPECT_EQ(say("shelve", {"-", kSilent, "--until", until, "--reason", "being looked at"}).status, 0);
  EXPECT_EQ(say("out-of-service", {"XT03-MV2", "--reason", "valve is being replaced"}).status, 0);
  ASSERT_TRUE(becomes(kSilent, "shelved"));
  ASSERT_TRUE(becomes("out_of_service", "out_of_service"));
  kill(hung, SIGCONT);
  kill(up_, SIGTERM);
  waitpid(up_, nullptr, 0);
  for (const char* end : {"", "-wal", "-shm"}) std::filesystem::remove(state + "/advisory_generation.db" + end);
  up_ = start({"sealwatch", "up", "--config", config(), "--state", state}, folder_ / "up_again.log");
  ASSERT_TRUE(becomes("out_of_service", "out_of_service"));
  const pid_t hangs_again = process_of(status(), "health_assessment");
  kill(hangs_again, SIGSTOP);
  EXPECT_TRUE(becomes(kSilent, "shelved"));
  kill(hangs_again, SIGCONT);
  const std::string audit = run({"sealwatch", "audit", "--config", config(), "--state", state}).output;
  for (const char* act : {"alarm_shelved", "asset_out_of_service"})
    EXPECT_THAT(audit, ContainsRegex(std::string("advisory_generation.*") + act + ".*fetched back from"));
}

/// A retraction reaches every layer: what the status says of regions and health is said anew at once.
TEST_F(Operator, ConcludesHealthAndStateAnewWithoutARetractedTest) {
  const std::string state = state_directory("state").string();
  const json shown = json::parse(run({"sealwatch", "show", "XT03-MV2", "--state", state, "--json"}).output);
  const std::string pst_id = shown["message"]["header"]["pst_id"];
  ASSERT_EQ(run({"sealwatch", "retract", "--config", config(), "XT03-MV2", "--test", pst_id, "--by", "J. Silva",
                 "--reason", "wrong valve"})
                .status,
            0);
  json asset;
  for (int attempt = 0; attempt < 10; ++attempt) {
    asset = json::parse(run({"sealwatch", "status", "--config", config(), "--json"}).output)["assets"]["XT03-MV2"];
    if (asset["health_report"]["header"]["pst_id"] == "") break;
  }
  for (const char* topic : {"state_report", "health_report", "remaining_life"}) {
    EXPECT_EQ(asset[topic]["header"]["pst_id"], "") << topic;
    EXPECT_THAT(asset[topic]["header"]["message_id"].get<std::string>(),
                HasSubstr("retraction/XT03-MV2/test/" + pst_id));
  }
}

/// A journal that was made anew has what people said from its neighbours: exactly the tests that counted count.
TEST_F(Operator, ALostJournalHasBackWhatPeopleSaid) {
  const std::string state = state_directory("state").string();
  const auto retract = [&](const std::string& what, const std::string& value) {
    const Finished said = run({"sealwatch", "retract", "--config", config(), "XT03-MV2", what, value, "--by",
                               "J. Silva", "--reason", "wrong"});
    EXPECT_EQ(said.status, 0) << said.output;
  };
  const auto status = [&] {
    return json::parse(run({"sealwatch", "status", "--config", config(), "--json", "--seconds", "1.5"}).output);
  };
  const auto tests = [&] { return status()["assets"]["XT03-MV2"]["remaining_life"]["header"]["source_ids"]; };
  const json shown = json::parse(run({"sealwatch", "show", "XT03-MV2", "--state", state, "--json"}).output);
  const std::int64_t newest_ns = shown["message"]["header"]["event_time_ns"];
  for (int attempt = 0; attempt < 10 && tests().size() != 3; ++attempt) continue;  // each look takes a second
  retract("--since", format_date({newest_ns}));  // the third test; what is tested later counts
  ASSERT_EQ(run({"sealwatch", "replay", "--config", config(), "--quiet", recordings()[3], recordings()[4]}).status, 0);
  const json before = tests();
  const std::string wrong = "leakage_estimate/" + shown["message"]["header"]["pst_id"].get<std::string>();
  ASSERT_FALSE(before.empty());
  ASSERT_EQ(std::ranges::count(before, json(wrong)), 0) << before.dump();
  kill(up_, SIGTERM);
  waitpid(up_, nullptr, 0);
  for (const char* service : {"prognostic_assessment", "state_detection", "data_acquisition"})
    for (const char* end : {"", "-wal", "-shm"}) std::filesystem::remove(state + "/" + service + ".db" + end);
  up_ = start({"sealwatch", "up", "--config", config(), "--state", state}, folder_ / "up_again.log");
  json after;
  for (int attempt = 0; attempt < 30 && after != before; ++attempt) after = tests();
  EXPECT_EQ(after, before);
  std::this_thread::sleep_for(std::chrono::seconds(2));
  EXPECT_EQ(tests(), before) << "and it stays so";
  const std::string audit = run({"sealwatch", "audit", "--state", state}).output;
  for (const char* service : {"prognostic_assessment", "state_detection", "data_acquisition"})
    EXPECT_THAT(audit, ContainsRegex(std::string(service) + ".*tests_retracted.*fetched back from"));
  EXPECT_THAT(audit, Not(ContainsRegex("refused: (taken|waits)"))) << "nobody refused any of it";
  std::vector<std::string> lost;
  const json seen = status();
  for (const json& alarm : seen["alarms"])
    if (alarm["kind"] == "set_aside") lost.push_back(alarm["text"]);
  EXPECT_THAT(lost, SizeIs(3)) << "each tells that its journal was removed";
  EXPECT_THAT(lost, Contains(HasSubstr("but for the samples of earlier tests")));
}

/// As installed.
TEST_F(Operator, CountsAReplacementOnceAnotherPersonConfirmsIt) {
  kill(up_, SIGTERM);
  waitpid(up_, nullptr, 0);
  const std::string strict = SixServices::config();
  up_ = start({"sealwatch", "up", "--config", strict, "--state", state_directory("state").string()},
              folder_ / "strict.log");
  Finished said;
  for (int attempt = 0; attempt < 30 && said.output.find("counts once") == std::string::npos; ++attempt)
    said = run({"sealwatch", "replaced", "--config", strict, "XT03-MV2", "--at", "2020-01-01", "--by", "J. Silva"});
  ASSERT_EQ(said.status, 0) << said.output;
  const std::size_t id = said.output.find("maintenance_event/XT03-MV2/actuator_replaced/");
  ASSERT_NE(id, std::string::npos) << said.output;
  const std::string act = said.output.substr(id, said.output.find(' ', id) - id);
  EXPECT_THAT(act, ::testing::EndsWith("/2020-01-01T00:00:00Z"));
  const Finished waits = run({"sealwatch", "status", "--config", strict});
  EXPECT_EQ(waits.status, 0) << waits.output;
  EXPECT_THAT(waits.output, AllOf(HasSubstr("sealwatch confirm XT03-MV2 " + act + " --by NAME"),
                                  Not(HasSubstr("replaced on 2020-01-01"))));
  const auto confirm = [&](const std::string& who, const std::string& what) {
    return run({"sealwatch", "confirm", "--config", strict, "XT03-MV2", what, "--by", who});
  };
  EXPECT_THAT(confirm("M. Okoye", "maintenance_event/XT03-MV2/other").output, HasSubstr("waits for no confirmation"));
  const Finished himself = confirm("J. Silva", act);
  EXPECT_EQ(himself.status, 1);
  EXPECT_THAT(himself.output, HasSubstr("it takes another person"));
  const Finished another = confirm("M. Okoye", act);
  EXPECT_EQ(another.status, 0) << another.output;
  Finished counts;  // each service says so with its next heartbeat
  for (int attempt = 0; attempt < 10; ++attempt) {
    counts = run({"sealwatch", "status", "--config", strict});
    if (counts.output.find(act) == std::string::npos) break;
  }
  EXPECT_THAT(counts.output, AllOf(HasSubstr("replaced on 2020-01-01"), Not(HasSubstr(act))));
}

}  // namespace
}  // namespace sealwatch::testing
