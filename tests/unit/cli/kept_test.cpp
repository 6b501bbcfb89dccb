// What the commands tell from journals: of a life with a replacement, of other services, of journals that are missing
// or damaged.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <sstream>

#include "sealwatch/core/time.hpp"
#include "services/cli/commands.hpp"
#include "services/cli/replay_page.hpp"
#include "services/cli/session.hpp"
#include "services/common/runtime/configuration_loader.hpp"
#include "services/common/store/journal.hpp"

namespace sealwatch::cli {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr const char* kAsset = "XT03-MV2";
const std::string kConfig = std::string(SEALWATCH_SOURCE_DIR) + "/config";

struct Said {
  int status = 0;
  std::string output, errors;
};

Said said(const std::function<int()>& command) {
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  const int status = command();
  std::fflush(stdout);
  std::fflush(stderr);
  std::string output = ::testing::internal::GetCapturedStdout();
  return {status, std::move(output), ::testing::internal::GetCapturedStderr()};
}

std::string content(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

class Kept : public ::testing::Test {
 protected:
  Kept() {
    std::string pattern = (std::filesystem::temp_directory_path() / "sealwatch_kept_XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
    state_ = folder_ / "state";
    std::filesystem::create_directory(state_);
    // Sixty months of a seal that ages steadily.
    for (int month = 0; month < 60; ++month) conclude("prognostic_assessment", estimate(month));
    for (const std::string& service : service_names()) conclude(service, {});
    Advisory advice;
    advice.header.message_id = "advisory/last";
    advice.header.source_ids = {"leakage_estimate/life-59"};
    advice.asset_id = kAsset;
    conclude("advisory_generation", advice);
  }
  ~Kept() override { std::filesystem::remove_all(folder_); }

  static LeakageEstimate estimate(int month, const std::string& life = "life") {
    LeakageEstimate one;
    one.asset_id = kAsset;
    one.header.pst_id = life + "-" + std::to_string(month);
    one.header.message_id = "leakage_estimate/" + one.header.pst_id;
    one.header.event_time_known = true;
    one.header.event_time_ns = add_months(parse_utc("2010-01-10").value(), month).nanoseconds;
    one.condition = 0.98 - 0.004 * month + 0.0005 * (month % 3 - 1);
    one.condition_std = 0.001;
    one.used_for_forecast = true;
    return one;
  }
  /// What prognosis says to a maintenance_event: of no test.
  static RemainingLife replaced(const std::string& day, const std::string& id) {
    RemainingLife life;
    life.asset_id = kAsset;
    life.header.message_id = "remaining_life/" + id;
    life.replacement_known = true;
    life.replaced_ns = parse_utc(day).value().nanoseconds;
    return life;
  }
  [[nodiscard]] std::filesystem::path file_of(const std::string& service) const { return state_ / (service + ".db"); }
  /// Keeps a message, or the bare journal; the writer id of the journal.
  std::string conclude(const std::string& service, const std::optional<Message>& message,
                       const std::filesystem::path& state = {}) const {
    const auto file = (state.empty() ? state_ : state) / (service + ".db");
    Result<Journal> journal = Journal::open("sqlite3://" + file.string(), service);
    EXPECT_TRUE(journal) << journal.error().describe();
    EXPECT_TRUE(journal->begin());
    if (message) {
      EXPECT_TRUE(journal->add_output(*message, UtcTime{1}));
    }
    EXPECT_TRUE(journal->commit());
    return journal->writer_id();
  }
  void damage(const std::string& service) const {
    for (const char* more : {"", "-wal", "-shm"}) std::filesystem::remove(file_of(service).string() + more);
    std::ofstream(file_of(service)) << std::string(8192, 'x');
  }
  [[nodiscard]] Said forecast(bool json = false) const {
    ForecastOptions options;
    options.config = kConfig;
    options.state_directory = state_.string();
    options.page = json ? "" : (folder_ / "life.html").string();
    options.json = json;
    return said([&] { return run_forecast(options); });
  }
  [[nodiscard]] Said show(const std::string& id, const std::string& csv = {}) const {
    ShowOptions options;
    options.config = kConfig;
    options.state_directory = state_.string();
    options.id = id;
    options.csv = csv;
    return said([&] { return run_show(options); });
  }
  [[nodiscard]] Said page_of_replay(const LeakageEstimate& played) const {
    ReplayOptions options;
    options.config = kConfig;
    options.state_directory = state_.string();
    options.page = (folder_ / "replay.html").string();
    Histories histories;
    histories[kAsset].take(played);
    const auto configuration = load_or_explain(kConfig);
    return said([&] { return write_replay_page(options, *configuration, histories); });
  }

  std::filesystem::path folder_, state_;
};

TEST_F(Kept, AForecastIsOfTheSealThatIsInThereNow) {
  EXPECT_EQ(forecast().status, kOk);
  EXPECT_THAT(content(folder_ / "life.html"), AllOf(HasSubstr("60 tests"), HasSubstr("end of life about")));

  conclude("prognostic_assessment", replaced("2015-06-10", "by hand"));
  conclude("prognostic_assessment", replaced("2011-06-10", "reported after it"));
  const Said after = forecast();
  EXPECT_EQ(after.status, kAnswerIsNo) << after.errors;
  EXPECT_THAT(after.output, AllOf(HasSubstr("replaced on 2015-06-10, no test since"), Not(HasSubstr("month"))));
  EXPECT_THAT(content(folder_ / "life.html"),
              AllOf(HasSubstr("replaced on <span class=\"whole\">2015-06-10,</span> no test since"),
                    Not(HasSubstr("end of life about"))));
  const Said json = forecast(true);
  EXPECT_EQ(json.status, kAnswerIsNo);
  EXPECT_THAT(json.output, AllOf(HasSubstr("insufficient_history"), HasSubstr("\"tests\": 0"),
                                 HasSubstr("no test since"), Not(HasSubstr("rul_months"))));

  conclude("prognostic_assessment", estimate(70, "new"));
  EXPECT_THAT(forecast().output, HasSubstr("1 test, 2015-11-10"));
}

TEST_F(Kept, APageOfReplayedTestsIsNotMadeOfOtherServicesJournals) {
  EXPECT_EQ(page_of_replay(estimate(59)).status, kOk);
  ASSERT_TRUE(std::filesystem::remove(folder_ / "replay.html"));
  const auto refused = [&](const LeakageEstimate& played) {
    const Said page = page_of_replay(played);
    EXPECT_EQ(page.status, kBadInput);
    EXPECT_THAT(page.errors, AllOf(HasSubstr("--page"), HasSubstr(state_.string()), HasSubstr(played.header.pst_id),
                                   HasSubstr("--state that the services were started with")));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "replay.html"));
  };
  refused(estimate(59, "another"));
  // The same recordings, played to services with journals of their own.
  LeakageEstimate same = estimate(59);
  same.header.writer_id = "prognostic_assessment-of-others";
  refused(same);
  same.header.writer_id = conclude("prognostic_assessment", {});
  EXPECT_EQ(page_of_replay(same).status, kOk) << "these are theirs";
}

TEST_F(Kept, AWaveformTakesNoFilesPlace) {
  TestWindow window;
  window.header.message_id = "test_window/life-59";
  window.header.pst_id = "life-59";
  window.asset_id = kAsset;
  window.samples.time_s = {0.0, 0.01};
  conclude("data_manipulation", window);
  const std::string id = window.header.message_id;
  const auto csv = folder_ / "wave.csv";
  const auto yaml = folder_ / "wave.yaml";
  std::ofstream(yaml) << "asset_id: mine\n";
  const Said sidecar = show(id, csv.string());
  EXPECT_EQ(sidecar.status, kBadInput);
  EXPECT_THAT(sidecar.errors, AllOf(HasSubstr(yaml.string()), HasSubstr("another name")));
  EXPECT_EQ(content(yaml), "asset_id: mine\n");
  EXPECT_FALSE(std::filesystem::exists(csv));
  std::filesystem::remove(yaml);
  std::ofstream(csv) << "mine\n";
  EXPECT_EQ(show(id, csv.string()).status, kBadInput);
  EXPECT_EQ(content(csv), "mine\n");
  std::filesystem::remove(csv);
  const Said suffix = show(id, yaml.string());
  EXPECT_EQ(suffix.status, kBadInput);
  EXPECT_THAT(suffix.errors, HasSubstr("must end in .csv"));
  EXPECT_FALSE(std::filesystem::exists(yaml));

  const Said written = show(id, csv.string());
  EXPECT_EQ(written.status, kOk) << written.errors;
  EXPECT_TRUE(std::filesystem::exists(csv));
  EXPECT_EQ(show(id, csv.string()).status, kBadInput) << "not twice either";
}

TEST_F(Kept, ShowWantsAnId) {
  EXPECT_EQ(show(kAsset).status, kOk);
  const Said nothing = show("");
  EXPECT_EQ(nothing.status, kBadInput);
  EXPECT_THAT(nothing.output, IsEmpty());
  EXPECT_THAT(nothing.errors, HasSubstr("must not be empty"));
}

TEST_F(Kept, AMissingJournalIsNamed) {
  std::filesystem::remove(file_of("prognostic_assessment"));
  const std::string file = file_of("prognostic_assessment").string();
  const Said life = forecast();
  EXPECT_EQ(life.status, kBadInput);
  EXPECT_THAT(life.errors, AllOf(HasSubstr(file), HasSubstr("does not exist"), Not(HasSubstr("no test of any asset"))));
  const Said estimate = show("leakage_estimate/life-59");
  EXPECT_EQ(estimate.status, kBadInput);
  EXPECT_THAT(estimate.errors, AllOf(HasSubstr(file), Not(HasSubstr("came from outside"))));
  EXPECT_THAT(show("life-59").errors, AllOf(HasSubstr(file), Not(HasSubstr("is not a message"))))
      << "a test that may be in there";
  const Said advice = show(kAsset);
  EXPECT_EQ(advice.status, kOk) << advice.errors;
  EXPECT_THAT(advice.output, HasSubstr(file)) << "in place of the source";
}

TEST_F(Kept, ADamagedJournalIsSaidToBeDamagedAndStopsOnlyWhatNeedsIt) {
  damage("advisory_generation");
  EXPECT_EQ(forecast().status, kOk);
  const Said advice = show(kAsset);
  EXPECT_EQ(advice.status, kBadInput);
  EXPECT_THAT(advice.errors,
              AllOf(HasSubstr("advisory_generation.db"), HasSubstr("damaged"), Not(HasSubstr("SELECT"))));
  EXPECT_EQ(show("leakage_estimate/life-59").status, kOk);

  damage("prognostic_assessment");
  const Said life = forecast();
  EXPECT_EQ(life.status, kBadInput);
  EXPECT_THAT(life.errors, AllOf(HasSubstr("prognostic_assessment.db"), HasSubstr("the journal is damaged"),
                                 HasSubstr("restore it from a backup"), Not(HasSubstr("SELECT"))));
}

TEST_F(Kept, AStateDirectoryIsNoBackupOfItself) {
  const Said refused = said([&] {
    return run_restore({kConfig, state_.string(), (state_ / ".." / "state").string()});
  });
  EXPECT_EQ(refused.status, kBadInput);
  EXPECT_THAT(refused.errors, HasSubstr("advisory_generation.db: is the journal that would be replaced"));
  EXPECT_EQ(show(kAsset).status, kOk) << "and it is where it was";
}

/// Who is refused one copy has all journals as they were, also those before it.
TEST_F(Kept, ABackupWithADamagedCopyRestoresNothing) {
  const auto backup = folder_ / "backup";
  ASSERT_EQ(said([&] { return run_backup({kConfig, state_.string(), backup.string()}); }).status, kOk);
  conclude("prognostic_assessment", estimate(60));
  std::ofstream(backup / "state_detection.db") << std::string(8192, 'x');
  const Said refused = said([&] { return run_restore({kConfig, state_.string(), backup.string()}); });
  EXPECT_EQ(refused.status, kBadInput);
  EXPECT_THAT(refused.errors, HasSubstr("state_detection.db"));
  EXPECT_THAT(refused.output, IsEmpty());
  EXPECT_EQ(show("leakage_estimate/life-60").status, kOk) << "of a service whose copy is whole";
  std::filesystem::remove(backup / "state_detection.db");
  EXPECT_EQ(said([&] { return run_restore({kConfig, state_.string(), backup.string()}); }).status, kOk);
  EXPECT_EQ(show("leakage_estimate/life-60").status, kBadInput);
}

TEST_F(Kept, JournalsThatTheConfigurationNamesWinOverTheStateDirectory) {
  const auto elsewhere = folder_ / "elsewhere";
  const auto config = folder_ / "config";
  std::filesystem::create_directory(elsewhere);
  std::filesystem::create_directory(config);
  Advisory advice;
  advice.header.message_id = "advisory/configured";
  advice.asset_id = kAsset;
  conclude("advisory_generation", advice, elsewhere);
  std::ofstream(config / "sealwatch.yaml") << "state_directory: none\nassets: []\nservices:\n  advisory_generation:\n"
                                              "    journal: sqlite3://"
                                           << (elsewhere / "advisory_generation.db").string() << "\n";
  ShowOptions options;
  options.config = config.string();
  options.state_directory = state_.string();
  options.id = kAsset;
  const Said newest = said([&] { return run_show(options); });
  EXPECT_EQ(newest.status, kOk) << newest.errors;
  EXPECT_THAT(newest.output, HasSubstr("advisory/configured"));
  options.id = "leakage_estimate/life-59";
  EXPECT_EQ(said([&] { return run_show(options); }).status, kOk) << "the others are in the state directory";
  options.config = (folder_ / "no config").string();
  EXPECT_EQ(said([&] { return run_show(options); }).status, kOk) << "it can be looked into without a configuration";
}

TEST_F(Kept, OfATestTheBeginningOfItsIdWillDo) {
  conclude("prognostic_assessment", estimate(3, "another"));
  const Said one = show("anoth");
  EXPECT_EQ(one.status, kOk) << one.errors;
  EXPECT_THAT(one.output, HasSubstr("leakage_estimate/another-3"));
  const Said many = show("life-");
  EXPECT_EQ(many.status, kBadInput);
  EXPECT_THAT(many.errors, AllOf(HasSubstr("is how the ids of 60 tests begin"), HasSubstr("life-9, life-8, life-7")));
  EXPECT_EQ(show("life-5").status, kOk) << "a whole id, though others begin so";
  EXPECT_EQ(show("ano").status, kBadInput) << "too short to be meant";
}

TEST_F(Kept, ProbabilitiesOnThePageReadAsOnTheScreen) {
  ASSERT_EQ(forecast().status, kOk);
  const std::string page = content(folder_ / "life.html");
  const auto whole = [](const std::string& number) { return " <span class=\"whole\">" + number + " %</span>"; };
  EXPECT_THAT(page, AllOf(HasSubstr(">under" + whole("0.1")), HasSubstr(">over" + whole("99.9"))));
  EXPECT_THAT(page, AllOf(Not(HasSubstr(">0 %<")), Not(HasSubstr(">100 %<"))));
}

}  // namespace
}  // namespace sealwatch::cli
