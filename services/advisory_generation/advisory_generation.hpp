// Layer 6 of ISO 13374: one recommendation for each asset, with its priority, latest-by date and reasons.
//
// Driven by remaining_life, joined with health_report, state_report and leakage_estimate of the same pst_id, in
// whatever order they come. Acknowledgements, replacements, retractions and overdue tests are answered at once; after a
// retraction the memory is what the tests that still count make of it, and the advice is renewed as soon as the layers
// below have said what they make of them. Tests older than the last one judged change nothing. docs/advisories.md has the decision table and the rules against flapping.
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "sealwatch/config/configuration.hpp"
#include "sealwatch/message/retracted_tests.hpp"
#include "sealwatch/port/halves.hpp"
#include "sealwatch/port/layer.hpp"
#include "services/advisory_generation/options.hpp"
#include "services/advisory_generation/recommendation.hpp"
#include "services/advisory_generation/verdicts.hpp"

namespace sealwatch::advisory_generation {

class AdvisoryGeneration final : public Layer {
 public:
  /// An Error for options that make no sense.
  [[nodiscard]] static Result<std::unique_ptr<AdvisoryGeneration>> make(const Configuration& configuration,
                                                                        const Options& options = {});

  [[nodiscard]] std::string_view name() const override { return "advisory_generation"; }
  [[nodiscard]] std::span<const Topic> inputs() const override;
  [[nodiscard]] std::span<const Topic> outputs() const override;
  void restore(const Message& own_output) override;
  [[nodiscard]] Conclusion receive(const Message& input) override;
  [[nodiscard]] std::size_t held() const override;

 private:
  /// Inputs of tests of which not all are there.
  struct Pending {
    Halves<RemainingLife> life;
    Halves<HealthReport> health;
    Halves<StateReport> state;
    Halves<LeakageEstimate> leakage;
  };
  /// Answers to one retraction, until all are there.
  struct Answers {
    std::string retraction_id;
    std::optional<RemainingLife> life = {};
    std::optional<HealthReport> health = {};
    std::optional<StateReport> state = {};
    std::optional<LeakageEstimate> leakage = {};
  };
  /// One test of the memory, or a replacement between two.
  struct Judged {
    std::string pst_id;
    std::optional<UtcTime> time;
    TestVerdict verdict;
    std::string replacement_id = {};  ///< "" of a test
    TestWords said = {};
  };
  /// What is remembered of one asset, all of it rebuilt from its advisories, and what waits.
  struct Asset {
    std::optional<Advisory> current;
    std::string current_id;  ///< message id under which it came about, before anybody acknowledged it
    VerdictMemory memory;
    std::optional<UtcTime> last_test;
    std::optional<UtcTime> replaced;
    std::vector<Judged> judged;                   ///< the last kMostJudged, in the order of judgement
    std::map<std::string, UtcTime> replacements;  ///< by message id
    RetractedTests retracted;
    std::set<std::string> retractions;  ///< all that are known
    std::set<std::string> concluded;    ///< message ids of all advisories
    Pending pending;
    std::deque<Answers> answers;  ///< at most kMostAnswered
  };

  AdvisoryGeneration(const Configuration& configuration, const Options& options)
      : configuration_(configuration), options_(options) {}

  template <class Input>
  [[nodiscard]] Conclusion join(const Input& input, Halves<Input> Pending::*halves,
                                std::optional<Input> Answers::*slot);
  void advise(const Evidence& evidence, Conclusion& conclusion);
  /// What all tests so far, of which the evidence is the last, make the advice; and puts it out.
  void put_out(const Evidence& evidence, const Header& cause, const Assessment& assessment, const InForce& in_force,
               Conclusion& conclusion);
  [[nodiscard]] Conclusion overdue(const StateReport& report);
  [[nodiscard]] Conclusion replaced(const MaintenanceEvent& event);
  [[nodiscard]] Conclusion retracted(const MaintenanceEvent& event);
  /// The memory as it is with the tests that count after `retraction`.
  void apply(const Retraction& retraction, Asset& asset) const;
  /// Likewise, once: false where it was known. It may come by itself, or be named by an answer to it alone, where this
  /// service's journal was lost.
  bool learn(const Retraction& retraction, Asset& asset) const;
  /// The memory as the tests make it that are remembered and count.
  void judge_anew(Asset& asset) const;
  /// Takes what a layer below made of the tests that count after a retraction.
  template <class Input>
  [[nodiscard]] Conclusion take_answer(const Input& input, std::optional<Input> Answers::*slot);
  [[nodiscard]] static Answers& answers_to(const std::string& retraction_id, Asset& asset, Conclusion& conclusion);
  /// The advice that follows from them, once all have answered.
  void renew(const std::string& retraction_id, Asset& asset, Conclusion& conclusion);
  /// The last test that counts, where none since was a replacement's first; nullptr where it is not remembered.
  [[nodiscard]] static Judged* last_counted(Asset& asset);
  /// Takes note of what the test said of itself in its advice.
  static void remember_words(const Advisory& advisory, Asset& asset);
  static void note_replacement(const std::string& message_id, UtcTime time, Asset& asset);
  static void remember(Judged judged, Asset& asset);
  static void stand(const Advisory& advisory, Asset& asset);
  [[nodiscard]] Conclusion acknowledged(const Acknowledgement& acknowledgement);
  /// Remembers `advisory` and puts it out, after the one that it supersedes.
  void put_out(Advisory advisory, Conclusion& conclusion);
  [[nodiscard]] const SiteConfig* site_of(const std::string& asset_id) const;
  /// What wears in that asset: "piston seal".
  [[nodiscard]] std::string part_of(const std::string& asset_id) const;
  [[nodiscard]] RequestForWork work_order(const Advisory& advisory, const Recommendation& recommendation) const;

  Configuration configuration_;
  Options options_;
  std::map<std::string, Asset> assets_;  ///< by asset_id
};

}  // namespace sealwatch::advisory_generation
