// What one set of the blind trial was, what the mismatch analysis said of it, and what the controls said: plain data,
// one JSON line each.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sealwatch/core/fields.hpp"

namespace sealwatch::verification {

/// Hidden physics, or a law that was found.
struct LawRecord {
  std::string id = {}, element = {}, form = {};
  double size = 0.0;          ///< hidden: in the truth's own unit
  double times_barely = 0.0;  ///< hidden: size over what such tests begin to show
  std::string strength = {};  ///< name of the catalogue's strength that means the same; "" where none does
  double value = 0.0, std_error = 0.0;
  double probability = 0.0;                   ///< found
  double delta_bic = 0.0;                     ///< found: criterion with it less that without
  std::vector<std::string> same = {};         ///< found: "id element" that this data cannot tell from it
  std::vector<std::string> same_places = {};  ///< found: elements likewise
  SEALWATCH_FIELDS(LawRecord, id, element, form, size, times_barely, strength, value, std_error, probability, delta_bic,
                   same, same_places)
};

/// Noise-normalised rms of one channel over the held-out recordings.
struct HeldOutRecord {
  std::string channel = {};
  double before = 0.0, after = 0.0;
  SEALWATCH_FIELDS(HeldOutRecord, channel, before, after)
};

/// The engine's answer.
struct AnswerRecord {
  std::string verdict = {};
  double p_value = 1.0;
  double explained_share = 0.0;
  std::vector<LawRecord> found = {};
  std::vector<std::string> places = {};        ///< location, most probable first
  bool next_test = false;                      ///< it says what to record
  double held_before = 0.0, held_after = 0.0;  ///< noise-normalised rms of the held-out recordings
  std::vector<HeldOutRecord> held_out = {};    ///< the same of each channel
  std::vector<std::string> rejected = {};      ///< "id element" that physics forbids
  std::vector<std::string> asset_values = {};  ///< of the asset file, that would do: "A_C", "Omega_M T_M"
  double seconds = 0.0;
  SEALWATCH_FIELDS(AnswerRecord, verdict, p_value, explained_share, found, places, next_test, held_before, held_after,
                   held_out, rejected, asset_values, seconds)
};

/// The same set by other means. Absent (known = false) where the voltage was not recorded.
struct ControlRecord {
  bool known = false;
  double misfit = 0.0, degrees = 0.0;  ///< of the refitted model as it is, whitened
  double chi_square_p = 1.0;
  std::string bic_id = {},
              bic_element = {};  ///< single law of the lowest BIC; "" when the model as it is has the lowest
  double bic_gain = 0.0;         ///< BIC of the model as it is less that of the best single law
  std::string sparse_id = {},
              sparse_element = {};  ///< of the sparse regression's largest term; "" where nothing was kept
  int sparse_terms = 0;
  double sparse_gain = 0.0;    ///< by which its balance's BIC grows without it
  bool oracle_fitted = false;  ///< the true laws (nearest of the catalogue) could be refitted
  std::string oracle_form = {}, oracle_strength = {};
  double oracle_value = 0.0;
  double oracle_misfit = 0.0;
  double oracle_held = 0.0;         ///< held-out rms of the oracle
  double minimum_detectable = 0.0;  ///< of the oracle's strength
  double absorbed = 0.0;            ///< share of the true law that free parameters swallow
  /// Concealed sets: the usual checks of the model fitted to the nominal tests alone.
  bool nominal_checked = false;
  double nominal_chi_square_p = 0.0, nominal_whiteness_p = 0.0, nominal_nrmse = 0.0;
  double seconds = 0.0;
  SEALWATCH_FIELDS(ControlRecord, known, misfit, degrees, chi_square_p, bic_id, bic_element, bic_gain, sparse_id,
                   sparse_element, sparse_terms, sparse_gain, oracle_fitted, oracle_form, oracle_strength, oracle_value,
                   oracle_misfit, oracle_held, minimum_detectable, absorbed, nominal_checked, nominal_chi_square_p,
                   nominal_whiteness_p, nominal_nrmse, seconds)
};

struct MismatchRecord {
  std::string stratum = {};
  std::uint64_t seed = 0;
  std::string label = {};
  std::string twin = {};         ///< inseparable sets: "id element"
  std::string wrong_value = {};  ///< of the asset file: "A_C"
  double wrong_share = 0.0;      ///< by which the plant's is larger
  bool coloured = false, rounded = false, jittered = false;
  std::vector<LawRecord> hidden = {};
  std::string error = {};  ///< the analysis, or the trial itself, could not be done
  AnswerRecord answer = {};
  ControlRecord control = {};
  SEALWATCH_FIELDS(MismatchRecord, stratum, seed, label, twin, wrong_value, wrong_share, coloured, rounded, jittered,
                   hidden, error, answer, control)
};

}  // namespace sealwatch::verification
