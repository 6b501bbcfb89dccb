#include "services/data_acquisition/recordings_folder.hpp"

#include <gmock/gmock.h>
#include <malloc.h>
#include <sys/stat.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <functional>
#include <set>
#include <sstream>
#include <thread>

#include "services/common/recording/recording_file.hpp"
#include "services/data_acquisition/data_acquisition.hpp"
#include "services/data_acquisition/folder_reader.hpp"
#include "tests/unit/signal/synthetic_pst.hpp"

namespace sealwatch {
namespace {

namespace fs = std::filesystem;

class RecordingsFolderTest : public testing::Test {
 protected:
  RecordingsFolderTest() : directory_(fs::path(testing::TempDir()) / "sealwatch_recordings_folder") {
    fs::remove_all(directory_);
    AssetConfig asset;
    asset.asset_id = "XT03-MV2";
    assets_ = {asset};
  }
  ~RecordingsFolderTest() override { fs::remove_all(directory_); }

  void drop(const std::string& name, const std::string& asset_id, double duration_s = 6.0,
            std::optional<UtcTime> start_time = {}) {
    Recording recording;
    recording.recording_id = name;
    recording.asset_id = asset_id;
    recording.start_time = start_time;
    recording.samples = test::SyntheticPst{.rate_Hz = 50.0, .duration_s = duration_s}.record();
    ASSERT_TRUE(write_recording_csv(recording, (directory_ / (name + ".csv")).string()));
  }
  struct Watched {
    RecordingsFolder folder;
    /// A second of it: a look, and what can be read then.
    std::vector<Message> look() {
      folder.look();
      std::vector<Message> messages;
      while (const auto blocks = folder.read_next())
        for (const RawSamples& block : *blocks) messages.emplace_back(block);
      return messages;
    }
  };
  Watched folder(DataAcquisition& layer, int looks_until_settled = 1) {
    return {RecordingsFolder(
        directory_, assets_, [&layer](const RawSamples& first) { return layer.is_closed(first); },
        [this](const Error& error) { errors_.push_back(error.describe()); }, looks_until_settled)};
  }
  /// Names in the folder and, with a slash, below it.
  std::set<std::string> files() const {
    std::set<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(directory_))
      if (entry.is_regular_file()) names.insert(fs::relative(entry.path(), directory_).string());
    return names;
  }

  fs::path directory_;
  std::vector<AssetConfig> assets_;
  std::vector<std::string> errors_;
};

TEST_F(RecordingsFolderTest, TakesARecordingAndPutsItAwayWhenItsTestIsConcluded) {
  DataAcquisition layer(assets_);
  Watched watched = folder(layer);
  drop("april", "XT03-MV2");
  EXPECT_TRUE(watched.look().empty()) << "it might still be growing";
  const std::vector<Message> blocks = watched.look();
  ASSERT_EQ(blocks.size(), 2U);
  EXPECT_FALSE(header_of(blocks[0]).replay);
  EXPECT_TRUE(watched.look().empty()) << "taken once";
  EXPECT_THAT(files(), testing::ElementsAre("april.csv", "april.yaml")) << "not concluded yet";
  for (const Message& block : blocks) (void)layer.receive(block);
  EXPECT_TRUE(watched.look().empty());
  EXPECT_THAT(files(), testing::ElementsAre("done/april.csv", "done/april.yaml"));
  EXPECT_THAT(errors_, testing::IsEmpty());
}

TEST_F(RecordingsFolderTest, ReadsARecordingAgainThatWasNotConcludedAndIsMended) {
  DataAcquisition layer(assets_);
  Watched watched = folder(layer);
  drop("april", "XT03-MV2");
  EXPECT_TRUE(watched.look().empty());
  EXPECT_EQ(watched.look().size(), 2U) << "and the service refuses it";
  EXPECT_TRUE(watched.look().empty());
  std::ofstream(directory_ / "april.yaml", std::ios::app) << "start_time: 2025-04-12T03:00:00Z\n";
  EXPECT_TRUE(watched.look().empty()) << "it might still be changing";
  const std::vector<Message> blocks = watched.look();
  ASSERT_EQ(blocks.size(), 2U);
  EXPECT_TRUE(std::get<RawSamples>(blocks[0]).start_time_known);
}

TEST_F(RecordingsFolderTest, OneThatIsOverwrittenWhenItsTestIsConcludedIsReadToo) {
  DataAcquisition layer(assets_);
  Watched watched = folder(layer);
  drop("april", "XT03-MV2");
  (void)watched.look();
  for (const Message& block : watched.look()) (void)layer.receive(block);
  drop("april", "XT03-MV2", 7.0);
  EXPECT_TRUE(watched.look().empty()) << "it might still be growing";
  EXPECT_THAT(files(), testing::ElementsAre("april.csv", "april.yaml")) << "it is not the one that was read";
  const std::vector<Message> blocks = watched.look();
  EXPECT_FALSE(blocks.empty());
  for (const Message& block : blocks) (void)layer.receive(block);
  EXPECT_TRUE(watched.look().empty());
  EXPECT_THAT(files(), testing::ElementsAre("done/april.csv", "done/april.yaml"));
  EXPECT_THAT(errors_, testing::IsEmpty());
}

/// As an archive unpacks them, of one size and time.
TEST_F(RecordingsFolderTest, OneWhoseNameAnotherOfItsSizeAndTimeTakesIsReadToo) {
  DataAcquisition layer(assets_);
  Watched watched = folder(layer);
  drop("april", "XT03-MV2");
  (void)watched.look();
  for (const Message& block : watched.look()) (void)layer.receive(block);
  const fs::path file = directory_ / "april.csv", other = directory_ / "april.new";
  std::stringstream text;
  text << std::ifstream(file).rdbuf();
  std::string another = text.str();
  std::string::value_type& digit = another.at(another.find_last_of("0123456789"));
  digit = digit == '1' ? '2' : '1';
  std::ofstream(other) << another;
  fs::last_write_time(other, fs::last_write_time(file));
  fs::rename(other, file);
  EXPECT_TRUE(watched.look().empty());
  EXPECT_TRUE(fs::exists(file)) << "it is not the one that was read";
  EXPECT_FALSE(watched.look().empty());
}

TEST_F(RecordingsFolderTest, LeavesACopyInProgressAlone) {
  DataAcquisition layer(assets_);
  Watched watched = folder(layer, 3);
  const auto looks = [&watched](int count) {
    std::size_t blocks = 0;
    for (int k = 0; k < count; ++k) blocks += watched.look().size();
    return blocks;
  };
  drop("april", "XT03-MV2");
  std::ifstream whole(directory_ / "april.csv");
  const std::string text(std::istreambuf_iterator<char>(whole), {});
  fs::rename(directory_ / "april.yaml", directory_ / "later");
  std::ofstream(directory_ / "april.csv") << text.substr(0, text.size() / 2);
  EXPECT_EQ(looks(3), 0U);
  std::ofstream(directory_ / "april.csv") << text;
  EXPECT_EQ(looks(3), 0U) << "it grew";
  fs::rename(directory_ / "later", directory_ / "april.yaml");
  EXPECT_EQ(looks(3), 0U) << "its sidecar came";
  EXPECT_EQ(looks(1), 2U);
  EXPECT_THAT(errors_, testing::IsEmpty());
}

TEST_F(RecordingsFolderTest, ARestartReadsWhatWasNotConcludedAgainWithTheSameIds) {
  DataAcquisition layer(assets_);
  Watched before = folder(layer);
  drop("april", "XT03-MV2");
  (void)before.look();
  const std::vector<Message> first = before.look();
  Watched after = folder(layer);
  (void)after.look();
  const std::vector<Message> again = after.look();
  EXPECT_EQ(again, first);
}

TEST_F(RecordingsFolderTest, RejectsWhatCannotBeReadWithTheReason) {
  DataAcquisition layer(assets_);
  Watched watched = folder(layer);
  drop("stranger", "XT09-MV9");
  std::ofstream(directory_ / "broken.csv") << "time[s],flow[m3/s]\n0,abc\n";
  std::ofstream(directory_ / "broken.yaml") << "asset_id: XT03-MV2\n";
  (void)watched.look();
  EXPECT_TRUE(watched.look().empty());
  EXPECT_THAT(files(), testing::IsSupersetOf({"rejected/broken.csv", "rejected/broken.csv.error.txt",
                                              "rejected/stranger.csv", "rejected/stranger.csv.error.txt"}));
  ASSERT_EQ(errors_.size(), 2U);
  EXPECT_THAT(errors_[0], testing::HasSubstr("abc"));
  EXPECT_THAT(errors_[1], testing::HasSubstr("XT09-MV9"));
}

/// Whoever drops recordings looks nowhere else: what is not taken is an alarm until somebody has seen to it.
TEST_F(RecordingsFolderTest, WhatIsNotTakenIsAnAlarmUntilSomebodyHasSeenToIt) {
  DataAcquisition layer(assets_);
  const std::string long_name = std::string(240, 'x') + ".csv";
  {
    Watched watched = folder(layer);
    drop("good", "XT03-MV2");
    for (const std::string& name : {std::string("new\nline\x1b[31m.csv"), long_name})
      std::ofstream(directory_ / name) << "time[s]\n";
    for (int looks = 0; looks < 3; ++looks) watched.look();
    const auto alarms = watched.folder.alarms();
    ASSERT_THAT(alarms, testing::SizeIs(2));
    for (const ServiceAlarm& alarm : alarms) {
      EXPECT_EQ(alarm.kind, "recording_not_taken");
      EXPECT_THAT(alarm.text, testing::AllOf(testing::HasSubstr("names no asset"), testing::HasSubstr("rejected/")));
      EXPECT_EQ((alarm.subject + alarm.text).find_first_of("\n\x1b"), std::string::npos);
    }
  }
  Watched restarted = folder(layer);
  restarted.look();
  EXPECT_THAT(restarted.folder.alarms(), testing::SizeIs(2)) << "a restart has seen to nothing";
  fs::remove_all(directory_ / "rejected");
  restarted.look();
  EXPECT_THAT(restarted.folder.alarms(), testing::IsEmpty());
}

TEST_F(RecordingsFolderTest, OfManyThatAreRejectedTheFirstAreNamed) {
  DataAcquisition layer(assets_);
  Watched watched = folder(layer);
  for (int k = 0; k < 30; ++k) std::ofstream(directory_ / (std::to_string(k) + ".csv")) << "time[s]\n";
  for (int looks = 0; looks < 3; ++looks) watched.look();
  const auto alarms = watched.folder.alarms();
  ASSERT_THAT(alarms, testing::SizeIs(9));
  EXPECT_EQ(alarms.back().subject, "others");
  EXPECT_THAT(alarms.back().text, testing::HasSubstr("22 more"));
}

TEST_F(RecordingsFolderTest, ANameThatCameBeforeOverwritesNothing) {
  DataAcquisition layer(assets_);
  Watched watched = folder(layer);
  for (const char* text : {"time,position\n0,first\n", "time,position\n0,second\n"}) {
    std::ofstream(directory_ / "may.csv") << text;
    std::ofstream(directory_ / "may.yaml") << "asset_id: XT03-MV2\n";
    EXPECT_TRUE(watched.look().empty());
    EXPECT_TRUE(watched.look().empty());
  }
  EXPECT_THAT(files(), testing::UnorderedElementsAre("rejected/may.csv", "rejected/may.yaml",
                                                     "rejected/may.csv.error.txt", "rejected/may.2.csv",
                                                     "rejected/may.2.yaml", "rejected/may.2.csv.error.txt"));
  const auto text_of = [this](const char* name) {
    std::ifstream file(directory_ / "rejected" / name);
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  EXPECT_THAT(text_of("may.csv"), testing::HasSubstr("first"));
  EXPECT_THAT(text_of("may.2.csv"), testing::HasSubstr("second"));
}

/// A file's name may be so long that a sidecar's, a numbered one's or a reason's would be longer than any may be.
TEST_F(RecordingsFolderTest, TheLongestNamesThereAreAreMovedAwayWithTheirReasons) {
  DataAcquisition layer(assets_);
  Watched watched = folder(layer);
  for (int times = 1; times <= 2; ++times) {
    std::ofstream(directory_ / (std::string(251, 'x') + ".csv")) << "time[s]\n";
    for (int looks = 0; looks < 2; ++looks) EXPECT_TRUE(watched.look().empty());
  }
  const std::string first = "rejected/" + std::string(241, 'x') + ".csv";
  const std::string second = "rejected/" + std::string(239, 'x') + ".2.csv";
  EXPECT_THAT(files(), testing::UnorderedElementsAre(first, first + ".error.txt", second, second + ".error.txt"));
}

/// A share that was away for a while, or a disk that was full: nobody restarts a service for that.
TEST_F(RecordingsFolderTest, WhatCouldNotBeMovedAwayIsMovedOnceItCan) {
  DataAcquisition layer(assets_);
  Watched watched = folder(layer);
  drop("april", "XT03-MV2");
  std::ofstream(directory_ / "broken.csv") << "time[s]\n";
  for (const char* folder : {"done", "rejected"}) std::ofstream(directory_ / folder) << "in the way of the folder";
  for (int looks = 0; looks < 4; ++looks)
    for (const Message& block : watched.look()) (void)layer.receive(block);
  ASSERT_THAT(watched.folder.alarms(), testing::SizeIs(1));
  EXPECT_THAT(watched.folder.alarms()[0].text, testing::AllOf(testing::HasSubstr("2 read and still in the folder"),
                                                              testing::HasSubstr("it is not a folder")));
  EXPECT_THAT(errors_, testing::SizeIs(3)) << "why it is rejected, and once of each that it stays";
  for (const char* folder : {"done", "rejected"}) fs::remove(directory_ / folder);
  EXPECT_TRUE(watched.look().empty());
  EXPECT_THAT(files(), testing::UnorderedElementsAre("done/april.csv", "done/april.yaml", "rejected/broken.csv",
                                                     "rejected/broken.csv.error.txt"));
  ASSERT_THAT(watched.folder.alarms(), testing::SizeIs(1));
  EXPECT_EQ(watched.folder.alarms()[0].subject, "broken.csv");
}

/// There was no room for it, or somebody emptied it.
TEST_F(RecordingsFolderTest, ARejectedOneWithoutAReasonSaysWhereItIs) {
  DataAcquisition layer(assets_);
  Watched watched = folder(layer);
  fs::create_directories(directory_ / "rejected");
  std::ofstream(directory_ / "rejected" / "bad.csv.error.txt").close();
  watched.look();
  ASSERT_THAT(watched.folder.alarms(), testing::SizeIs(1));
  EXPECT_THAT(watched.folder.alarms()[0].text, testing::HasSubstr("see the log"));
}

/// A link could lead the service to read, or to write over, any file that its user may.
TEST_F(RecordingsFolderTest, LinksAreNotFollowed) {
  const fs::path elsewhere = directory_.string() + "_elsewhere";
  fs::create_directories(elsewhere);
  fs::create_directories(directory_ / "rejected");
  std::ofstream(elsewhere / "precious") << "precious";
  fs::create_symlink(elsewhere / "precious", directory_ / "link.csv");
  fs::create_symlink(elsewhere / "precious", directory_ / "rejected" / "bad.csv.error.txt");
  std::ofstream(directory_ / "bad.csv") << "no recording";
  DataAcquisition layer(assets_);
  Watched watched = folder(layer);
  EXPECT_TRUE(watched.look().empty());
  EXPECT_TRUE(watched.look().empty());
  EXPECT_THAT(errors_, testing::Contains(testing::HasSubstr("link.csv: is a symbolic link, which is not followed")));
  EXPECT_TRUE(fs::is_symlink(directory_ / "rejected" / "link.csv"));
  std::ifstream precious(elsewhere / "precious");
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(precious), {}), "precious");

  fs::remove_all(directory_ / "rejected");
  fs::create_directory_symlink(elsewhere, directory_ / "rejected");
  std::ofstream(directory_ / "worse.csv") << "no recording";
  EXPECT_TRUE(watched.look().empty());
  EXPECT_TRUE(watched.look().empty());
  EXPECT_FALSE(fs::exists(elsewhere / "worse.csv"));
  EXPECT_THAT(errors_, testing::Contains(testing::HasSubstr("could not be moved to")));
  fs::remove_all(elsewhere);
}

/// Who reads a pipe waits until somebody writes to it: the service would wait with it.
TEST_F(RecordingsFolderTest, ALinkThatLeadsNowhereIsRefusedToo) {
  DataAcquisition layer(assets_);
  Watched watched = folder(layer);
  fs::create_symlink("/nowhere", directory_ / "gone.csv");
  fs::create_symlink("round.csv", directory_ / "round.csv");
  EXPECT_TRUE(watched.look().empty());
  EXPECT_TRUE(watched.look().empty());
  EXPECT_THAT(errors_, testing::UnorderedElementsAre(testing::HasSubstr("gone.csv: is a symbolic link"),
                                                     testing::HasSubstr("round.csv: is a symbolic link")));
  EXPECT_FALSE(fs::is_symlink(directory_ / "gone.csv"));
}

TEST_F(RecordingsFolderTest, AFolderThatIsGoneIsToldOfOnceAndUsedWhenItIsBack) {
  DataAcquisition layer(assets_);
  Watched watched = folder(layer);
  fs::remove_all(directory_);
  for (int look = 0; look < 3; ++look) EXPECT_TRUE(watched.look().empty());
  EXPECT_THAT(errors_, testing::ElementsAre(testing::HasSubstr("recordings_directory: cannot be read: No such file")));
  ASSERT_THAT(watched.folder.alarms(), testing::SizeIs(1));
  EXPECT_THAT(watched.folder.alarms().front().text, testing::HasSubstr("nothing dropped there is taken"));
  fs::create_directories(directory_);
  drop("april", "XT03-MV2");
  EXPECT_TRUE(watched.look().empty());
  EXPECT_EQ(watched.look().size(), 2U);
  EXPECT_THAT(errors_, testing::SizeIs(1));
  EXPECT_THAT(watched.folder.alarms(), testing::IsEmpty());
}

TEST_F(RecordingsFolderTest, FilesThatAreGoneAreForgotten) {
  DataAcquisition layer(assets_);
  Watched watched = folder(layer);
  std::size_t halfway = 0;
  for (int k = 0; k < 2000; ++k) {
    const fs::path file = directory_ / ("comes and goes " + std::to_string(k) + ".csv");
    std::ofstream(file) << "time\n";
    EXPECT_TRUE(watched.look().empty());
    fs::remove(file);
    if (k == 1000) halfway = ::mallinfo2().uordblks;
  }
  EXPECT_LT(::mallinfo2().uordblks, halfway + 100'000);
}

TEST_F(RecordingsFolderTest, ASidecarThatIsAPipeIsNotWaitedFor) {
  fs::create_directories(directory_);
  drop("april", "XT03-MV2");
  fs::remove(directory_ / "april.yaml");
  ASSERT_EQ(::mkfifo((directory_ / "april.yaml").c_str(), 0600), 0);
  DataAcquisition layer(assets_);
  Watched watched = folder(layer);
  EXPECT_TRUE(watched.look().empty());
  EXPECT_TRUE(watched.look().empty());
  EXPECT_THAT(errors_, testing::ElementsAre(testing::HasSubstr("april.yaml: is a pipe")));
  EXPECT_TRUE(fs::exists(directory_ / "rejected" / "april.csv"));
}

/// It was passed over without a word, so that whoever dropped it waited for a conclusion.
TEST_F(RecordingsFolderTest, ARecordingThatIsAPipeIsRefusedByName) {
  fs::create_directories(directory_);
  drop("april", "XT03-MV2");
  fs::remove(directory_ / "april.csv");
  ASSERT_EQ(::mkfifo((directory_ / "april.csv").c_str(), 0600), 0);
  DataAcquisition layer(assets_);
  Watched watched = folder(layer);
  EXPECT_TRUE(watched.look().empty());
  EXPECT_TRUE(watched.look().empty());
  EXPECT_THAT(errors_, testing::ElementsAre(testing::HasSubstr("april.csv: is a pipe")));
  EXPECT_TRUE(fs::is_fifo(directory_ / "rejected" / "april.csv"));
}

/// Files before it may take long: it is not known to be whole any more.
TEST_F(RecordingsFolderTest, ARecordingThatChangesBeforeItsTurnIsLeftAlone) {
  DataAcquisition layer(assets_);
  Watched watched = folder(layer);
  drop("april", "XT03-MV2");
  drop("may", "XT03-MV2");
  watched.folder.look();
  watched.folder.look();
  EXPECT_THAT(watched.folder.read_next(), testing::Optional(testing::SizeIs(2)));
  std::ofstream(directory_ / "may.csv", std::ios::app) << "6.1,";
  EXPECT_THAT(watched.folder.read_next(), testing::Optional(testing::IsEmpty()));
  EXPECT_EQ(watched.folder.read_next(), std::nullopt);
  EXPECT_THAT(errors_, testing::IsEmpty());
}

class FolderReaderTest : public RecordingsFolderTest {
 protected:
  /// One with nearly as many numbers as a recording may have: it takes a while to read.
  void drop_large(const std::string& name) {
    std::ofstream file(directory_ / (name + ".csv"));
    file << "time[s],position[m],pressure_a[Pa],pressure_b[Pa],velocity[m/s],motor_voltage[V],flow[m3/s]\n";
    for (int k = 0; k < 220'000; ++k) file << k / 1000 << '.' << 1000 + k % 1000 << ",0.06,100001,100002,0.0,1.0,0\n";
    std::ofstream(directory_ / (name + ".yaml")) << "asset_id: XT03-MV2\nrecording_id: " << name << "\n";
  }
  FolderReader reader() {
    return {directory_, assets_, [](const Error& error) { ADD_FAILURE() << error.describe(); }, kBetweenLooks, 1};
  }
  const LocalInputs::LayerAtRest at_rest_ = [this](const std::string&) { return &layer_; };
  static constexpr std::chrono::milliseconds kBetweenLooks{20};
  DataAcquisition layer_{assets_};
};

/// The main loop's part of it takes no time, whatever the thread reads.
TEST_F(FolderReaderTest, ALargeRecordingHoldsUpNobody) {
  using Clock = std::chrono::steady_clock;
  FolderReader watched = reader();
  drop_large("large");
  Clock::duration longest{};
  std::size_t taken = 0;
  const auto end = Clock::now() + std::chrono::seconds(60);
  while (!fs::exists(directory_ / "done" / "large.csv") && Clock::now() < end) {
    const auto begin = Clock::now();
    watched.look(at_rest_, at_rest_);
    const std::vector<Message> piece = watched.take();
    longest = std::max(longest, Clock::now() - begin);
    EXPECT_LE(piece.size(), 16U);
    for (const Message& block : piece) (void)layer_.receive(block);
    taken += piece.size();
    if (piece.empty()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_EQ(taken, 1100U);
  EXPECT_TRUE(fs::exists(directory_ / "done" / "large.yaml"));
  EXPECT_LT(longest, std::chrono::milliseconds(100)) << "it takes ten times as long to read";
}

TEST_F(FolderReaderTest, ReadsOneRecordingAtATimeAndStopsThoughNobodyTakesIt) {
  FolderReader watched = reader();
  drop("april", "XT03-MV2");
  drop("may", "XT03-MV2");
  watched.look(at_rest_, at_rest_);
  std::set<std::string> taken;
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (!watched.has_some() && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(kBetweenLooks);
  for (const Message& block : watched.take()) taken.insert(std::get<RawSamples>(block).recording_id);
  EXPECT_THAT(taken, testing::ElementsAre("april"));
  while (!watched.has_some() && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(kBetweenLooks);
  EXPECT_TRUE(watched.has_some());
  EXPECT_TRUE(watched.stop(std::chrono::seconds(5)));
  EXPECT_TRUE(watched.stop(std::chrono::seconds(5))) << "told twice";
  EXPECT_THAT(files(), testing::IsSupersetOf({"april.csv", "may.csv"})) << "read again at the next start";
}

/// Ids of tests have '_' for what stands between: of the same content at the same time, two have one id. What is put
/// away is read no more, also by a service that was killed before it took the blocks.
TEST_F(FolderReaderTest, OneOfTwoAssetsThatAreAlikeInTheIdsOfTheirTestsPutsTheOthersRecordingNotAway) {
  assets_.resize(2, assets_.front());
  assets_[0].asset_id = "XT_1";
  assets_[1].asset_id = "XT 1";
  DataAcquisition concluded(assets_), behind(assets_);
  const LocalInputs::LayerAtRest each = [&](const std::string& asset_id) {
    return asset_id == "XT_1" ? &concluded : &behind;
  };
  FolderReader watched = reader();
  drop("april", "XT_1", 6.0, UtcTime{1'900'000'000'000'000'000});
  drop("april too", "XT 1", 6.0, UtcTime{1'900'000'000'000'000'000});
  const auto look_until = [&](const std::function<bool()>& is_so) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (!is_so() && std::chrono::steady_clock::now() < end) {
      watched.look(each, each);
      for (const Message& block : watched.take())
        if (std::get<RawSamples>(block).asset_id == "XT_1") (void)concluded.receive(block);
      std::this_thread::sleep_for(kBetweenLooks);
    }
    return is_so();
  };
  EXPECT_TRUE(look_until([&] { return fs::exists(directory_ / "done" / "april.csv"); }));
  int looks = 0;
  EXPECT_TRUE(look_until([&] { return ++looks > 20; }));
  EXPECT_TRUE(fs::exists(directory_ / "april too.csv"));
}

/// Killed between two pieces: what is read again goes on, but this was removed meanwhile, and nobody sends the rest.
TEST_F(FolderReaderTest, OneThatWasTakenInPartAndRemovedEndsItsTest) {
  Watched before = folder(layer_);
  drop("april", "XT03-MV2");
  drop("may", "XT03-MV2");
  (void)before.look();
  const std::vector<Message> blocks = before.look();
  ASSERT_EQ(blocks.size(), 4U);
  for (const std::size_t first : {0U, 2U}) (void)layer_.receive(blocks[first]);
  fs::remove(directory_ / "april.csv");
  FolderReader watched(
      directory_, assets_, [this](const Error& error) { errors_.push_back(error.describe()); }, kBetweenLooks, 1);
  std::vector<SampleBlock> ends;
  const auto is_closed = [&] { return layer_.is_closed(std::get<RawSamples>(blocks[0])); };
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (!is_closed() && std::chrono::steady_clock::now() < end) {
    watched.look(at_rest_, at_rest_);
    for (const Message& block : watched.take())
      for (const Message& output : layer_.receive(block).outputs)
        if (const auto& made = std::get<SampleBlock>(output); made.boundary == BlockBoundary::end) ends.push_back(made);
    std::this_thread::sleep_for(kBetweenLooks);
  }
  EXPECT_TRUE(watched.stop(std::chrono::seconds(5)));
  ASSERT_EQ(ends.size(), 2U);
  EXPECT_EQ(ends[0].recording_id, "may");
  EXPECT_FALSE(ends[0].aborted) << "it is still there, and taken whole";
  EXPECT_EQ(ends[1].recording_id, "april");
  EXPECT_EQ(ends[1].abort_reason, "cut: the recording was removed from the folder before all of it was taken");
  EXPECT_THAT(errors_, testing::ElementsAre(
                           testing::HasSubstr("april: asset XT03-MV2: was removed before it was read completely")));
}

/// The main loop slept up to a second for each recording of a folder.
TEST_F(FolderReaderTest, SaysWhenThereIsSomethingToTake) {
  FolderReader watched = reader();
  std::atomic<int> told = 0;
  watched.on_some([&told] { ++told; });
  drop("april", "XT03-MV2");
  drop("may", "XT03-MV2");
  watched.look(at_rest_, at_rest_);
  for (const int expected : {1, 2}) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (told < expected && std::chrono::steady_clock::now() < end)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    EXPECT_EQ(told, expected);
    EXPECT_FALSE(watched.take().empty());
  }
  EXPECT_TRUE(watched.stop(std::chrono::seconds(5)));
}

TEST_F(FolderReaderTest, OneThatNeverLookedStopsAtOnce) { EXPECT_TRUE(reader().stop(std::chrono::milliseconds(0))); }

/// What is seen to is kept for so long, and no more than so much; nothing else is touched.
class OldRecordingsTest : public RecordingsFolderTest {
 protected:
  OldRecordingsTest() {
    for (const char* const folder : {"done/below", "rejected"}) fs::create_directories(directory_ / folder);
  }
  void put(const std::string& name, std::size_t bytes = 100) {
    std::ofstream(directory_ / name) << std::string(bytes, 'x');
  }
  void look(const RetentionConfig& kept, double days, double clock_days = 0.0) {
    const auto later = [](double count) {
      return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::duration<double>(count * 86'400.0));
    };
    OldRecordings old(kept);
    const auto now = std::chrono::system_clock::now();
    const auto steady = std::chrono::steady_clock::now();
    if (clock_days != 0.0) old.look(directory_, now, steady);
    old.look(directory_, now + later(days + clock_days), steady + later(days));
  }
};

TEST_F(OldRecordingsTest, AreRemovedWithAllThatBelongsToThem) {
  for (const char* const name : {"done/april.csv", "done/april.yaml", "done/april.2.csv", "done/below/may.csv",
                                 "rejected/june.csv", "rejected/june.csv.error.txt", "new.csv"})
    put(name);
  look({.days = 30.0}, 29.0);
  EXPECT_EQ(files().size(), 7U);
  look({}, 10'000.0);
  EXPECT_EQ(files().size(), 7U) << "for ever, where nothing else is said";
  look({.days = 30.0}, 31.0);
  EXPECT_EQ(files(), (std::set<std::string>{"done/below/may.csv", "new.csv"}));
}

TEST_F(OldRecordingsTest, GoTheOldestFirstWhereThereIsTooMuch) {
  for (const char* const name : {"done/b.csv", "done/a.csv", "done/c.csv"}) {
    put(name, 4'000'000);
    std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // told apart by the second
  }
  look({.megabytes = 10.0}, 0.0);
  EXPECT_EQ(files(), (std::set<std::string>{"done/a.csv", "done/c.csv"}));
}

TEST_F(OldRecordingsTest, AreOldByNoClockThatWasSet) {
  put("done/april.csv");
  look({.days = 30.0}, 1.0, 400.0);
  EXPECT_EQ(files().size(), 1U);
}

/// Whoever may write into the folder could have this service remove what only it may remove.
TEST_F(OldRecordingsTest, AreNeverReachedThroughALink) {
  const fs::path elsewhere = directory_.string() + "_elsewhere";
  fs::create_directories(elsewhere);
  std::ofstream(elsewhere / "precious.csv") << "x";
  fs::remove_all(directory_ / "done");
  fs::create_directory_symlink(elsewhere, directory_ / "done");
  fs::create_symlink(elsewhere / "precious.csv", directory_ / "rejected/link.csv");
  look({.days = 1.0, .megabytes = 10.0}, 100.0);
  EXPECT_TRUE(fs::exists(elsewhere / "precious.csv"));
  EXPECT_TRUE(fs::is_symlink(directory_ / "rejected/link.csv"));
  fs::remove_all(elsewhere);
}

/// A folder that is swapped for a link, and files that come and go meanwhile.
TEST_F(OldRecordingsTest, AreNotReachedThroughALinkThatComesMeanwhile) {
  const fs::path elsewhere = directory_.string() + "_elsewhere";
  fs::create_directories(elsewhere);
  for (int k = 0; k < 50; ++k) std::ofstream(elsewhere / (std::to_string(k) + ".csv")) << "x";
  std::jthread stranger([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      std::error_code ignored;
      fs::rename(directory_ / "done", directory_ / "was", ignored);
      fs::create_directory_symlink(elsewhere, directory_ / "done", ignored);
      fs::remove(directory_ / "done", ignored);
      fs::rename(directory_ / "was", directory_ / "done", ignored);
    }
  });
  for (int round = 0; round < 200; ++round) look({.days = 1.0}, 100.0);
  stranger.request_stop();
  stranger.join();
  EXPECT_EQ(std::distance(fs::directory_iterator(elsewhere), {}), 50);
  fs::remove_all(elsewhere);
}

}  // namespace
}  // namespace sealwatch
