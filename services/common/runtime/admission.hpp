// Which messages a service takes in at all. What it does not take is refused with what would mend it.
//
// Texts. Ids stand in logs, on terminals, in file names and in commands that people paste: on one line, without control
// characters, at most kLongestId bytes. All else is UTF-8, and what people and their systems say at most kLongestRemark
// bytes: it stands in advisories and in the audit trail.
//
// Samples. What another process sends as a block or window of a test keeps the limits of one test
// (core/test_limits.hpp); raw samples data acquisition cleans itself.
//
// Times. A slip in the year of a replacement would set aside every test until then; so would a test whose clock was
// wrong. A live test may lie a day ahead of now, as clocks differ, and so may a report, or a day ahead of its asset's
// newest test. What is played back, and what the virtual bench makes up, may be of another time: month by month into
// the future, or as a whole, but not more than a year after the asset's newest test, and not where live tests have come.
// So in every layer, whoever says a test's time. By a clock that is not set yet nothing lies in the future. No test is
// older than its asset.
//
// Assets. Each takes a layer, a lane and a place in every history, for ever, and a stranger may invent as many as it
// likes: of those that the configuration does not name, kMostUnknownAssets are taken, the first that come and those of
// which the journal tells; or none.
//
// Makings. A test that the virtual bench made up is not taken into the history of an asset with recorded tests.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "sealwatch/core/longest_id.hpp"
#include "sealwatch/core/time.hpp"
#include "sealwatch/message/retracted_tests.hpp"
#include "sealwatch/message/topics.hpp"

namespace sealwatch {

inline constexpr std::size_t kLongestRemark = 4000;
inline constexpr std::size_t kMostUnknownAssets = 64;
/// Of an asset. Each is answered by every layer, with a forecast and an advice that are the same as before: more wait in
/// the journal until what they mean is known, as a service may be behind others.
inline constexpr std::size_t kMostIdleRetractions = 64;

/// A text that no service takes: not UTF-8, too long, or an id that is not one visible line.
struct TextFault {
  std::string field;  ///< "remark"
  std::string text;
  std::string rule;  ///< "is not UTF-8"
};
[[nodiscard]] std::optional<TextFault> fault_of_texts(const Message& message);

/// Which assets the configuration names, and whether it wants no others.
struct ConfiguredAssets {
  std::set<std::string> names = {};
  bool refuses_others = false;
};

class Admission {
 public:
  /// When assets were commissioned, where it is known.
  explicit Admission(std::map<std::string, UtcTime> commissioned = {}, ConfiguredAssets assets = {});
  /// Takes note of its asset, of when a test was made, and of retractions. Of what others say of tests, from which
  /// nothing may be concluded, `concluded` is false: of them only the newest date is known, until a retraction. Whether it
  /// is of a test, or tells of an act, that was not known before, or is the first that is concluded of the test.
  bool note(const Message& message, bool concluded = true);
  /// Takes note of an asset alone.
  void note_asset(const std::string& asset_id);
  /// Of which assets two may give their tests the same ids, as far as it was not asked before.
  [[nodiscard]] std::vector<std::string> take_alike();
  /// Takes note of an act of that id, if it is a retraction or a replacement; whether it is new.
  bool note_act(const std::string& asset_id, const std::string& act_id);
  /// Why nothing of its asset is taken in; none where it is.
  [[nodiscard]] std::optional<std::string> refusal_of_asset(const Message& message) const;
  /// Why the message of such an asset is not to be taken in; none for nearly all.
  [[nodiscard]] std::optional<std::string> refusal(const Message& message, UtcTime now) const;
  /// Likewise, of an act that a neighbour took and recorded: whether it means something, and lies in the future, was
  /// judged there, by tests of which this service may not have heard yet.
  [[nodiscard]] std::optional<std::string> refusal_of_recorded(const Message& act) const;
  /// Why a retraction of many is not taken that means nothing known here; none where there is room for it.
  [[nodiscard]] std::optional<std::string> refusal_of_idle(const Message& message) const;
  /// The tests that a retraction of many means: those that are known, and those on their way.
  [[nodiscard]] std::vector<std::string> tests_meant(const std::string& asset_id, const Retraction& retraction) const;
  /// Takes note of the tests that a retraction of many names.
  void note_named_tests(const MaintenanceEvent& event);
  /// Whether a retraction that is kept until what it means is known changes something, or has changed something.
  [[nodiscard]] bool may_be_given(const std::string& asset_id, const Retraction& retraction) const;
  /// Whether all that a retraction means is here: concluded, not only on its way.
  [[nodiscard]] bool knows_all_of(const std::string& asset_id, const Retraction& retraction) const;
  /// Whether an act is to wait until what it means is known.
  [[nodiscard]] bool is_ahead(const Message& message) const;
  /// Whether a retraction of the asset changes nothing. A test that others conclude from is known, with its date, before
  /// it is concluded here: else a service that is behind would refuse what others take.
  [[nodiscard]] bool means_nothing(const std::string& asset_id, const Retraction& retraction) const;
  /// Whether a retraction counts here, and meant something when it came.
  [[nodiscard]] bool meant_something(const std::string& asset_id, const std::string& act_id) const;
  /// Whether the configuration names it, or it was taken without.
  [[nodiscard]] bool knows(const std::string& asset_id) const {
    return assets_.names.contains(asset_id) || unknown_.contains(asset_id);
  }
  /// Of tests that were neither played back nor made up: time passes for such an asset, whatever is played back beside.
  [[nodiscard]] bool has_live_tests(const std::string& asset_id) const { return live_.contains(asset_id); }

  /// The date of a test in the future, which was played back, where live tests have come: beside it they are old.
  [[nodiscard]] std::optional<UtcTime> future_test_before_live(const std::string& asset_id, UtcTime now) const;

 private:
  void note_name(const std::string& asset_id);
  void note_test(const Message& message, UtcTime time);
  [[nodiscard]] bool knows_test(const std::string& asset_id, const std::string& pst_id) const;
  [[nodiscard]] std::optional<std::string> refusal_of_test(const RawSamples& raw) const;
  [[nodiscard]] std::optional<std::string> refusal_of_time(const Message& message, UtcTime now) const;
  [[nodiscard]] std::optional<std::string> refusal_of_future(const Message& message, UtcTime time, UtcTime now) const;
  /// The date of the asset's newest test that was not retracted.
  [[nodiscard]] std::optional<UtcTime> newest_test(const std::string& asset_id) const;
  [[nodiscard]] std::optional<std::string> refusal_of_report(const Message& message, UtcTime now) const;
  /// The retraction where it changes nothing and is beyond those that are answered all the same.
  [[nodiscard]] std::optional<Retraction> idle_retraction(const Message& message) const;
  [[nodiscard]] std::optional<std::string> refusal_of_future_act(const Message& message, UtcTime now) const;

  std::map<std::string, UtcTime> commissioned_;
  ConfiguredAssets assets_;
  std::map<std::string, std::string> asset_of_id_part_;  ///< of all, the first of those that are alike there
  std::vector<std::string> alike_;                       ///< not yet told
  std::set<std::string> unknown_;                        ///< assets that it does not name, and that were taken
  std::map<std::string, RetractedTests> tests_;          ///< by asset
  struct Acts {
    std::set<std::string> retractions = {};  ///< and withdrawals, all that count
    std::set<std::string> replacements = {};
    std::set<std::string> idle = {};  ///< of the retractions those that meant nothing that was known when they came
  };
  std::map<std::string, Acts> acts_;  ///< by asset: message ids of what people said
  std::map<std::string, std::map<std::string, std::optional<UtcTime>>> on_their_way_;  ///< see means_nothing
  std::map<std::string, std::set<UtcTime>> named_;  ///< dates of those that have a PST id, by asset
  std::map<std::string, UtcTime> heard_;            ///< the newest date of those that others speak of, by asset
  std::set<std::string> recorded_;                  ///< assets with tests that no bench made up
  std::set<std::string> live_;                      ///< of them, those with tests that were not played back
};

}  // namespace sealwatch
