// The power is cut between any two writes of a journal: what was safe from that is there when it is opened again, and
// all else is whole up to some batch.
#include "tests/unit/store/power_cut.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/common/store/journal.hpp"
#include "tests/unit/message/fill.hpp"
#include "tests/unit/store/place.hpp"

namespace sealwatch::testing {
namespace {

constexpr int kBatches = 25;
constexpr int kCutsEach = 4;  ///< lost, kept, and torn twice

Message report(const std::string& id) {
  HealthReport made;
  made.header.message_id = id;
  made.asset_id = "XT03-MV2";
  made.inadmissible_reasons.assign(40, "a reason that fills a page or two of the log");
  return made;
}

void batch(Journal& journal, const std::string& id, Survives survives) {
  ASSERT_TRUE(journal.begin(survives));
  ASSERT_TRUE(journal.add_input(report("input " + id), UtcTime{}, false));
  ASSERT_TRUE(journal.add_output(report("output " + id), UtcTime{}).has_value());
  ASSERT_TRUE(journal.commit());
}

/// Some batches that survive kills alone, then one that survives a cut, or the log brought to the disk; in between the
/// log is moved into the file, twice.
void write_and_confirm(Journal& journal, DiskRecording& disk, const Place& place) {
  const auto to_disk = journal.to_disk();
  for (int number = 0; number < kBatches; ++number) {
    const std::string id = std::to_string(number);
    const bool survives = number % 4 == 2;
    batch(journal, id, survives ? Survives::power_cuts : Survives::kills);
    if (number % 8 == 7) place.execute("PRAGMA wal_checkpoint(PASSIVE)");
    if (number % 4 == 1) {
      ASSERT_TRUE(to_disk());
    }
    if (survives || number % 4 == 1) disk.confirm(id);
  }
}

/// Batches that are there, each whole, without a gap: 0, 1, ..., n-1.
std::size_t whole_batches(Journal& journal) {
  std::vector<std::string> outputs;
  EXPECT_TRUE(
      journal.for_each_output([&](const Message& m) { return outputs.push_back(header_of(m).message_id), Status(); }));
  for (std::size_t k = 0; k < outputs.size(); ++k) EXPECT_EQ(outputs[k], "output " + std::to_string(k));
  EXPECT_EQ(journal.open_inputs(), outputs.size());
  return outputs.size();
}

TEST(PowerCut, BetweenAnyTwoWritesLeavesWhatWasConfirmed) {
  const Place place;
  DiskRecording disk(place.directory());
  {
    auto journal = Journal::open(place.connection(), "state_detection");
    ASSERT_TRUE(journal.has_value());
    write_and_confirm(*journal, disk, place);
    disk.stop();
  }
  ASSERT_GT(disk.events(), 200U) << "SQLite's writes were not seen";
  const Place after;
  std::mt19937 random(20'311'204);
  std::size_t taken_back = 0;
  for (std::size_t event = 0; event <= disk.events(); ++event) {
    const auto confirmed = disk.confirmed_before(event);
    for (int cut = 0; cut < kCutsEach; ++cut) {
      const auto unsynced = static_cast<DiskRecording::Unsynced>(std::min(cut, 2));
      disk.restore(event, unsynced, random, after.directory());
      auto journal = Journal::open(after.connection(), "state_detection");
      ASSERT_TRUE(journal.has_value()) << "cut before event " << event << ": " << journal.error().describe();
      const std::size_t there = whole_batches(*journal);
      const std::size_t promised = confirmed.empty() ? 0 : std::stoul(confirmed.back()) + 1;
      ASSERT_GE(there, promised) << "cut before event " << event << ", way " << cut;
      taken_back += there < kBatches && event == disk.events() ? 1 : 0;
    }
  }
  EXPECT_GT(taken_back, 0U) << "no cut took anything back: the test sees nothing";
}

}  // namespace
}  // namespace sealwatch::testing
