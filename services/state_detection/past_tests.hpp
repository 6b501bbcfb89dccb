// The tests of one asset as they were judged, so that it can be judged anew without some of them: when an operator
// retracts a test, what it taught (baseline, regions, expected channels, the date of the last test) is forgotten, and
// what was said of later tests because of it is said anew. Limits are left out: they follow from the tests before.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/message/retracted_tests.hpp"
#include "sealwatch/message/state_detection.hpp"
#include "services/state_detection/history.hpp"

namespace sealwatch {

class PastTests {
 public:
  /// Before a test is judged: whether earlier ones do not count any more (message/retracted_tests.hpp).
  [[nodiscard]] bool meet(const std::string& pst_id) { return retracted_.meet(pst_id); }
  /// Takes a test's report. False when the test is retracted: then nothing is learnt from it.
  bool add(const StateReport& report);
  /// From now on the tests that it means do not count, or count again, or the replacement that it means was none.
  void apply(const Retraction& retraction) { retracted_.apply(retraction); }
  /// Plays the tests that count into a history that knows nothing yet. Returns the last of them as it is judged now, as
  /// far as its past says: nothing where none counts.
  [[nodiscard]] std::optional<StateReport> judge_anew(const AssetConfig& asset, AssetHistory& fresh) const;

 private:
  struct Judgement {
    std::uint16_t quantity = 0;  ///< index into names_
    Reference reference = Reference::limit;
    double value = 0.0;
  };
  struct Test {
    std::string pst_id;
    std::optional<UtcTime> time;
    PstVerdict verdict = PstVerdict::not_judged;
    std::vector<std::string> replacements;  ///< ids of those that it is the first test after
    bool replay = false;
    std::string accepted_discrepancy;
    std::vector<Judgement> judgements;
  };
  struct Name {
    std::string quantity;
    std::string unit;
  };
  [[nodiscard]] std::uint16_t index_of(const RegionJudgement& judgement);
  [[nodiscard]] StateReport judged_by(const AssetConfig& asset, const Test& test, const AssetHistory& history) const;

  std::vector<Test> tests_;  ///< in the order of judgement
  std::vector<Name> names_;  ///< of quantities: a handful, said by every test
  RetractedTests retracted_;
};

}  // namespace sealwatch
