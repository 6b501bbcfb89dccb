// Which laws: every single law and every pair on the linearised problem, then nonlinear refits of the best of them,
// law after law, at most three.
// docs/mismatch.md gives the thresholds with their reasons.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sealwatch/mismatch/explain.hpp"
#include "services/common/mismatch/criterion.hpp"
#include "services/common/mismatch/refits.hpp"
#include "services/common/mismatch/screening.hpp"

namespace sealwatch::mismatch {

/// An improvement that physics forbids.
struct Forbidden {
  Effect effect;
  double strength = 0.0;  ///< what the data would want
  double score = 0.0;
  double share = 0.0, allowed_share = 0.0;  ///< Rejected
};

/// A model without one law of another, from whose values it was fitted.
struct WithoutLaw {
  std::shared_ptr<const FittedModel> whole;
  Trial fewer;
};

/// What is known of a baseline before its search.
struct KnownOfBaseline {
  Screening first;
  std::vector<Trial> tried = {};  ///< refits of it with a law each
};

struct Naming {
  std::shared_ptr<const FittedModel> baseline;
  Trial best;                          ///< effects may be empty
  std::vector<Trial> trials;           ///< all that were refitted, the best among them
  std::vector<WithoutLaw> fewer = {};  ///< see without_law
  std::vector<Trial> tried = {};       ///< KnownOfBaseline
  Screening first;                     ///< of the baseline
  Screening last;                      ///< of the best model
  std::vector<Forbidden> forbidden = {};
  std::vector<std::string> remarks = {};              ///< what was not taken for a reason of computation
  std::shared_ptr<const FittedModel> looked_at = {};  ///< the model that was screened last,
  Screening seen = {};                                ///< and what that showed
  /// A model beside whose laws others are more than what these may be off by in their form (form_error.hpp).
  std::shared_ptr<const FittedModel> more_beside = {};
  /// Sensors that are off by what they may be (Data::sensors) explain more than any law: the search ended there, and
  /// `best` is to be asked beside them.
  bool sensors_are_inexact = false;
  std::shared_ptr<const FittedModel> with_sensors = {};           ///< `best` beside them, where it was fitted
  std::shared_ptr<const FittedModel> baseline_with_sensors = {};  ///< the same of the baseline
  /// A parameter that differs from recording to recording (Data::may_differ) explains more than any law: the search ended
  /// there, and `best` is to be asked beside it. "": none.
  std::string differs_in = {};
  std::vector<std::string> not_asked = {};  ///< cut off by the deadline; `last` is then of an earlier model than `best`
  bool settled = false;  ///< it was asked whether each law of `best` is needed, and whether a plainer one does
  /// Fixed values that took the place of laws (Data::fixed): `baseline` has them free, and all others here are beside them.
  std::vector<std::string> freed = {};
  /// The search until then, whose best has the laws in their place (none where it began beside them); null without such.
  std::shared_ptr<const Naming> with_laws = {};
  std::vector<Effect> replaced = {};      ///< these laws
  double behind_laws = 0.0;               ///< criterion of `best` less that with the values known and these laws again
  std::vector<std::string> refused = {};  ///< values that did less well than laws in the end
};

/// The search as it began: with no value free that the asset file fixes.
[[nodiscard]] const Naming& as_it_began(const Naming& naming);

/// An Error when nothing can be looked at: the baseline cannot be linearised, or what is to begin with cannot be, beside
/// free values. A law whose model cannot be is not taken,
/// `remarks` says so, and the search ends with what it had. `from`: laws and free values to begin with, refitted to the
/// same data; laws that are not needed there are taken out first. `known`: null: nothing.
[[nodiscard]] Result<Naming> name_effects(std::shared_ptr<const FittedModel> baseline, const Data& data,
                                          const ExplainOptions& options, const Progress& progress,
                                          const Trial& from = {}, const KnownOfBaseline* known = nullptr);

/// Whether each law of the best trial is needed, and whether a plainer law does as well, where a search that was cut left
/// that open; so far as there is time.
void settle(Naming& naming, const Data& data, const ExplainOptions& options);

/// Whether one fixed value beyond its tolerance brings the criterion below `score`: sensors need not be off then. Asked
/// are those that the model holds at an end of their tolerance.
[[nodiscard]] bool a_value_explains(const FittedModel& model, double score, double phi, const Data& data, int threads);

/// Whether what the only law of the best trial leaves may be its exact form, and no other law is more than that: none
/// could be claimed beside it.
[[nodiscard]] bool leaves_its_form(const Naming& naming);
/// How much that is, of what the law took.
[[nodiscard]] double share_left_by_best(const Naming& naming);

}  // namespace sealwatch::mismatch
