// The analysis of one asset, step by step: what is missing is searched, proven and told. The steps share what they learn;
// each group has a file of its own.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sealwatch/mismatch/explain.hpp"
#include "services/common/estimation/runaway.hpp"
#include "services/common/mismatch/averaged_inputs.hpp"
#include "services/common/mismatch/baseline.hpp"
#include "services/common/mismatch/datasheet.hpp"
#include "services/common/mismatch/held_out.hpp"
#include "services/common/mismatch/naming.hpp"
#include "services/common/mismatch/own_values.hpp"
#include "services/common/mismatch/proven_laws.hpp"
#include "services/common/mismatch/remainder.hpp"
#include "services/common/mismatch/time_budget.hpp"
#include "services/common/mismatch/trace.hpp"
#include "services/common/mismatch/why_none.hpp"

namespace sealwatch::mismatch {

/// What was not asked, where time was up.
inline constexpr const char* kFixedValues = "the values that the asset file fixes";

class Analysis {
 public:
  Analysis(const AssetConfig& asset, Data fit, Data holdout, const ExplainOptions& options, const Progress& progress)
      : asset_(asset),
        fit_(std::move(fit)),
        holdout_(std::move(holdout)),
        options_(options),
        progress_(progress),
        time_(options.time_limit_s, options.cancel, options.time_used_s) {
    fit_.deadline = holdout_.deadline = &time_.deadline();
    for (const auto& [name, setting] : asset_.parameters) fit_.given[name] = setting.value;
  }

  /// An Error where the model cannot be simulated at all, or the analysis was called off.
  [[nodiscard]] Result<Explanation> run();

 private:
  [[nodiscard]] Result<Explanation> analyse();
  void take_no_law() { best_ = {.effects = {}, .model = with_another_value_ ? with_another_value_ : baseline_}; }
  void take_up(Baseline baseline);

  // What is missing (analysis_search.cpp).

  // In a gross misfit with averaged inputs first, and as they were held where that makes a difference in the end.
  Status look_for_what_is_missing();
  bool take_averaged_inputs();
  [[nodiscard]] bool averages_do();
  // From what was found; that stays where there is no time for more.
  void look_with_held_inputs();
  // In tests of different days first beside a seal of its own in each, then in common from what was found there, unless
  // a seal that wears leaves nothing. What else differs from test to test is asked beside the laws. `from`: what is
  // known already.
  Status look_from(std::optional<Trial> from);
  // The baseline ended in a local minimum: everything anew from a better one, which leaves less than half of its misfit.
  Status look_beside_better(std::shared_ptr<const FittedModel> baseline);
  // Whether another parameter with a value for each test promises more than what wears, beside the same laws: wear fills
  // its place.
  [[nodiscard]] bool another_differs_rather(const Trial& common) const;
  // Whether one value of the asset file leaves no gross misfit. Set out from the recorded states, several laws would fill
  // its place.
  [[nodiscard]] bool a_value_ends_it(const Screening& first) const;
  // Refits of laws of which the linear model promises the same: a sensor's, to whose course states would be held.
  [[nodiscard]] std::vector<Trial> laws_that_may_end_it(const Screening& first) const;
  // Sensors that were off beside what differs are so in common; also where the time to search is over.
  Result<Screening> look_with_inexact_sensors(const std::vector<KnownValue>& known, const ScreeningOptions& options);
  // Also where the time to search is over: it is what is told then.
  std::optional<Trial> found_in_common(const OwnValues& own);
  // Laws that all recordings have in common, beginning with `from`, beside sensors that are exact or not. `known`: of
  // the baseline; null: nothing.
  Result<Naming> look_in_common(const Trial& from, const ExplainOptions& options, const KnownOfBaseline* known);
  // Sensors that are taken for exact so far.
  [[nodiscard]] std::vector<KnownValue> unknown_sensors() const;
  // Laws beside a parameter of which each recording has its own; false where one for all does as well.
  bool look_beside_what_differs(const Naming& found, const ExplainOptions& options);
  // Laws beside it, beginning with those found in common, beside sensors that are exact or not.
  bool look_beside_own(OwnValues& own, const Trial& found, const ExplainOptions& options) const;
  // The best of a search that was cut: whether it takes all of its laws, and what it leaves, has not been looked at.
  void look_at_what_is_left();
  // What was found is asked again beside sensors that are off by no more than they may be.
  [[nodiscard]] Result<Naming> beside_inexact_sensors(const Naming& found, const ExplainOptions& options) const;
  // A search that began with values free does not know the laws that they replaced before.
  static void keep_what_was_replaced(Naming& naming, const Naming& before);
  // With the laws that were found beside inexact sensors, one value of the asset file does what all sensors did.
  [[nodiscard]] bool value_in_place_of_sensors(const Naming& found, const std::vector<KnownValue>& sensors) const;
  // A plant that runs away by itself and was left behind by the machine: laws would bend to where it happens to go.
  [[nodiscard]] std::optional<Runaway> follows_no_machine() const;
  // The model was fitted, but nothing can be asked of it: no law, no test, no power.
  Result<Explanation> tell_no_law(WhyNone why);
  // Where time was up before a law was asked: a plant that jumps at events is never asked for one, whatever the time.
  [[nodiscard]] std::optional<Error> why_no_law_can_be_asked();
  void say_how_likely_by_noise(const Screening& screening);
  // Of other data; what was predicted before is of no use.
  void forget_predictions() { predictions_ = std::make_shared<KeptPredictions>(); }
  void take_over(const OwnValues& own);
  // Why the recordings differ though no physics is missing: something changed from test to test.
  void look_for_a_change();
  // Why no law is named beside what differs from test to test, where that is so.
  void say_what_differs();
  [[nodiscard]] bool leaves_nothing() const;

  // Values of the asset file that are off (analysis_values.cpp).

  // What looks like another value in each test, and not by wear, may be a wrong value of another parameter in all of them.
  void ask_values_in_place_of_own();
  // What is fixed in the asset file may be wrong: laws and sensors' faults are then bent to it, or none is found. (In a
  // gross misfit without a law a value takes up some of whatever is missing.)
  void ask_the_datasheet();
  void ask_the_datasheet_alone();
  [[nodiscard]] bool only_measurements_are_off() const;
  // What explains as much as a sensor that is off may be a value that is off: a search that had no time to ask claims
  // neither.
  void take_no_measurement_for_a_value();
  // Values that took the place of laws while these were searched are off, where the held-out recordings bear them out and
  // laws are beside them. Else the laws again: what values do alone is asked in the end, all that do it alike.
  void take_values_found();
  void add_values_that_do_as_well(WrongDatasheet& wrong) const;
  // All values that do it alike, and several of them.
  void ask_what_values_do_alone(const Naming& laws);
  void value_alone(WrongDatasheet wrong, const Naming& laws);
  // The search for laws goes on where it was left, without values.
  void look_on_from(const Naming& laws);
  static bool is_among(const Effect& effect, const std::vector<Effect>& effects);
  // A value in place of one law, and others needed beside it: these are in both explanations, and are claimed. The search
  // goes on from them with that value free; false where it does not come to them, or to less than the laws did.
  bool take_beside_values(const WrongDatasheet& wrong, const std::vector<std::string>& laws,
                          const std::vector<RecordingComparison>& compared);
  // The laws beside it were taken back: what is left is the value.
  void fall_back_on_the_value();
  // Not where the value does not help on held-out recordings. Near the noise, whose own size is not known well enough to
  // tell shares of what exceeds it, it has to explain no more than what it replaces.
  [[nodiscard]] bool bears_out(const WrongDatasheet& wrong, const FittedModel& replaced,
                               std::vector<RecordingComparison>& compared) const;
  void blame_the_asset_file(const WrongDatasheet& wrong, const std::string& instead_of,
                            const std::vector<RecordingComparison>& compared);

  void tell(std::string_view step, double share) const;
  // Where everything found still misses grossly, what is left is a slow course, to which slow laws bend best. Weighed
  // by its own colour, corners and episodes count for what they are. Where that fails, what was found before stays.
  void look_again();
  Status weigh_by_colour();
  // The simulated part of the plant, where the model misses much and something that drives it is not recorded.
  [[nodiscard]] std::optional<PlantPart> driven_unseen() const;
  [[nodiscard]] const PlantDescription& plant() const;
  [[nodiscard]] bool windowed() const { return window_s_ > 0.0; }
  [[nodiscard]] HeldOut held_out() const { return {fit_, holdout_, window_s_, options_, predictions_}; }
  [[nodiscard]] Data prepared(const Data& data) const { return in_windows(data, window_s_); }
  [[nodiscard]] ToProve to_prove() { return {held_out(), naming_, baseline_, unknown_sensors()}; }

  // What is claimed and told (analysis_findings.cpp).

  void prove();
  void note_not_compared(const BlockGains& blocks);
  // What is left beside a law says that something is left, not what, where it could as well sit in three other elements
  // or is no more than the law's own form may be off by; nor is a law claimed whose strength may be nothing.
  void describe_what_was_found();
  /// In a gross misfit: by what laws take on held-out recordings. Forms at other elements are told by the linear model,
  /// which says little there.
  void take_out_forms_of_larger_laws();
  void take_out(const Remainder& remainder);
  [[nodiscard]] bool more_than_form(const LawAt& small, const LawAt& large);
  void take_out(std::size_t slot);
  // Everything that the report holds; once more with fewer laws where some are taken back.
  Status finish();
  // Values that are off are told beside laws, or alone where these were taken back.
  void take_values_beside();
  Status compare_recordings();
  void compare_fitted(std::size_t recording);
  void say_where();
  // In the explained asset, at what fits.
  void fix_values_again();
  void put_in_words();
  // A law that has no value where the plant goes may be what is missing.
  void note_laws_not_asked();
  void say_what_was_cut(Explanation& result) const;
  /// What is left may be by what was not asked, or not listed: a law is no surer than the share that is explained.
  static void limit_probabilities(Explanation& result);
  /// Of the laws found without one of them, the explanation that predicts held-out recordings best and makes no channel
  /// worse there; nothing where each does.
  std::optional<Trial> without_what_makes_it_worse();
  void take_back_to(const Trial& rest);
  void take_all_laws_back();
  // Laws that leave less than half of a channel's course reproduced, far above its noise, bend to something else: a
  // wrong unit, a sign, a channel of another sensor.
  bool takes_back_what_comes_nowhere_near();
  // Nor where a channel of held-out recordings comes out worse, or none can be compared: other loads and speeds do not
  // bear it out.
  bool takes_back_what_does_not_carry_over();
  /// The model that the laws are beside: with the values that are off, where they were found beside such.
  [[nodiscard]] const FittedModel& without_laws() const { return beside_ ? *naming_.baseline : *baseline_; }
  [[nodiscard]] double share_explained_by(const FittedModel& model) const;
  /// The same of held-out recordings' free runs, where a gross misfit stays: a law that bends to the fitted ones alone
  /// takes less there. 1 where other things than laws decide these runs.
  [[nodiscard]] double share_held_out() const;
  [[nodiscard]] double explained_share() const { return share_explained_by(*best_.model); }
  [[nodiscard]] bool explains() const;
  // Laws that fit better and explain too little say where to look; a name for it they are not.
  bool takes_back_what_does_not_explain();
  // The fitted recordings agree, and those kept aside do not: what came in between, or acts under their conditions
  // alone, has no part in the fit that could tell it.
  void compare_with_what_was_kept_aside();
  // The channel that is furthest off, where that is more than its noise; null where none is.
  static const ChannelComparison* missed_in(const PooledFit& fit);
  [[nodiscard]] std::string what_happened() const;
  // Beside the verdict and the laws.
  void say_what_else_is_known();
  void decide();

  const AssetConfig& asset_;
  Data fit_, holdout_;
  const ExplainOptions& options_;
  const Progress& progress_;
  TimeBudget time_;
  std::shared_ptr<const FittedModel> baseline_;
  struct AsHeld {
    Data fit, holdout;
    std::shared_ptr<const FittedModel> baseline;
  };
  std::optional<AsHeld> as_held_;  ///< set: inputs were averaged
  std::optional<OwnValues> own_;   ///< each test has its own of a parameter, and nothing in common is preferred
  Naming naming_;
  Trial best_;
  std::string too_small_by_size_;  ///< a law that was taken out by law_sizes alone, in words
  Trial tried_;                    ///< what was taken back, as it explains too little
  bool proven_ = false;
  bool all_compared_ = true;               ///< the models can be simulated on every recording
  std::vector<std::string> not_compared_;  ///< recordings on which a model cannot be simulated, and why
  bool none_compared_ = false;             ///< of the held-out recordings
  bool more_time_helps_ = true;
  bool input_swings_ = false;                              ///< between its samples, through much of the tests
  std::optional<WhyNone> why_none_;                        ///< set: no law is named
  std::shared_ptr<const FittedModel> with_another_value_;  ///< of the asset file, where that explains it
  std::vector<Asked> asked_values_;                        ///< of the asset file, the best only
  /// Values that are off beside the laws that are claimed.
  struct Beside {
    WrongDatasheet wrong;
    std::string instead;  ///< of them: the laws that they replace, in words
    std::string laws;     ///< all that were found without them
    std::vector<RecordingComparison> compared;
    Naming before;  ///< without them
  };
  std::optional<Beside> beside_;
  std::size_t instead_of_ = 0;  ///< laws, for which a value would do as well
  double window_s_ = 0.0;
  std::shared_ptr<KeptPredictions> predictions_ = std::make_shared<KeptPredictions>();  ///< of fit_ and holdout_
  Explanation result_;
};

}  // namespace sealwatch::mismatch
