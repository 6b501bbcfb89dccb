// The blind trial's results: a table for each stratum. A pure function of the records; their order changes nothing.
//
//   detected      p <= 0.01
//   element top-1, law top-1    the most probable effect that was found sits there, is that law
//   law in set    the law is the one that was found, or among those that the answer says cannot be told from it
//   renamed       an `unlisted` truth that a listed law was claimed for; an error where it misses the held-out
//                 recordings by more than 2 % above the best closed form at the true element (the oracle)
//   strength      within 1.96 standard errors of the truth, where a strength of the catalogue means the same
//   value named   the wrong value of the asset file is among those that the answer says would do, of those detected
//   value unsaid  a law was claimed, and not said that the wrong value would do
//   held-out      rms of the held-out recordings over the oracle's
//
// Single effects are also divided by their strength (as the oracle refits it) over the smallest that the analysis says
// these tests can show: below 1, 1 to 3, from 3 on.
#pragma once

#include <span>

#include "services/verification/trial/mismatch_record.hpp"

namespace sealwatch::verification {

inline constexpr double kTrialFalseAlarmRate = 0.01;

/// A count with its exact 95 % interval (Clopper, Pearson).
struct CountedShare {
  int count = 0, of = 0;
  double low = 0.0, high = 1.0;
  SEALWATCH_FIELDS(CountedShare, count, of, low, high)
};

/// Some sets of one stratum.
struct TrialTally {
  std::string name = {};  ///< "single", "single, from 3 x detectable"
  int sets = 0, errors = 0;
  int consistent = 0, mismatch = 0, undetermined = 0;
  CountedShare detected = {}, claimed = {}, element_first = {}, law_first = {}, law_in_set = {}, all_named = {},
               renamed = {}, renamed_worse = {}, renamed_as_good = {}, twin_in_set = {}, twins_left_open = {};
  CountedShare value_named = {}, value_unsaid = {};
  CountedShare strength_within = {}, held_within_2_percent = {};
  double set_size = 0.0;          ///< mean, of those with something found
  double held_over_oracle = 0.0;  ///< median
  double held_before_over_oracle = 0.0;
  CountedShare chi_square_detected = {}, bic_detected = {}, bic_element_first = {}, bic_law_first = {};
  CountedShare sparse_detected = {}, sparse_element_first = {}, sparse_law_first = {};
  double sparse_terms = 0.0;                    ///< mean
  CountedShare concealed = {};                  ///< nominal tests alone pass chi-square, whiteness and NRMSE
  double seconds = 0.0, control_seconds = 0.0;  ///< mean
  SEALWATCH_FIELDS(TrialTally, name, sets, errors, consistent, mismatch, undetermined, detected, claimed, element_first,
                   law_first, law_in_set, all_named, renamed, renamed_worse, renamed_as_good, twin_in_set,
                   twins_left_open, value_named, value_unsaid, strength_within, held_within_2_percent, set_size,
                   held_over_oracle, held_before_over_oracle, chi_square_detected, bic_detected, bic_element_first,
                   bic_law_first, sparse_detected, sparse_element_first, sparse_law_first, sparse_terms, concealed,
                   seconds, control_seconds)
};

/// Strength over the smallest that shows; 0 where it is not known.
[[nodiscard]] double times_detectable(const MismatchRecord& record);

/// Hidden effects of a record that were named (id and element) among those found.
[[nodiscard]] int named_effects(const MismatchRecord& record);

[[nodiscard]] std::vector<TrialTally> summarise_trials(std::span<const MismatchRecord> records);

/// The tallies as text, and behind them a line for each set whose answer is wrong.
[[nodiscard]] std::string trial_table(std::span<const TrialTally> tallies);
[[nodiscard]] std::string trial_failures(std::span<const MismatchRecord> records);

}  // namespace sealwatch::verification
