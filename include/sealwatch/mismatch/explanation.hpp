// What the mismatch analysis found: everything that report.json, report.html, the asset file with the found physics and
// the topic `model_discrepancy` are made from. docs/mismatch.md says how each figure comes about.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/core/fields.hpp"
#include "sealwatch/core/time_series.hpp"
#include "sealwatch/estimation/actuator_fit.hpp"

namespace sealwatch {

SEALWATCH_ENUM(MismatchVerdict, consistent, mismatch, undetermined)

namespace mismatch {

using Verdict = MismatchVerdict;

/// A law at an element: what an effect can be named.
struct LawAt {
  std::string id;       ///< of docs/laws.md, or "unlisted"
  std::string form;     ///< which form of the law; "" where there is one
  std::string element;  ///< "piston", "sensor:flow"
  std::string law;      ///< closed form, "F_c tanh(v / v_s)"
  std::string meaning;  ///< for an engineer
};

struct FoundParameter {
  std::string name;
  std::string unit;
  double value = 0.0;
  double std_error = 0.0;  ///< infinite where the data cannot tell
  bool at_bound = false;
};

/// Why another law was not chosen.
struct Alternative {
  LawAt what;
  double misfit_above_best = 0.0;  ///< whitened misfit (long-run) above that of the chosen law, larger is worse
  std::string why_not;             ///< one sentence
};

/// One effect that was added to the model.
struct FoundEffect {
  LawAt what;
  std::vector<FoundParameter> parameters;
  double probability = 0.0;                ///< among all laws that were tried for this effect
  double element_probability = 0.0;        ///< that it sits in this element
  std::vector<LawAt> indistinguishable;    ///< other laws that this data cannot tell from it
  std::vector<std::string> same_elements;  ///< other elements that this data cannot tell from its element
  double delta_bic = 0.0;                  ///< of the model with it against without it; negative favours it
  double engineering_share = 0.0;          ///< its size over the size that an engineer would care about; NaN: unknown
  std::string regime;                      ///< where it acts: "moving, both directions, above 0.5 mm/s"
  std::string evidence;                    ///< one sentence
  std::vector<Alternative> alternatives;   ///< most likely first

  /// Whether `other` is the same law at the same element in another closed form.
  [[nodiscard]] bool is_another_form(const LawAt& other) const {
    return other.id == what.id && other.element == what.element;
  }
};

/// The missing force, flow, torque or voltage of one element over one recording, as the data alone demands it
/// (`demanded`, with its band) and as the found law gives it (`law`).
struct MissingTerm {
  std::string element;
  std::string quantity;  ///< "force against +x"
  std::string unit;
  std::string recording;
  std::string state;       ///< what it depends on: "piston velocity"
  std::string state_unit;  ///< "m/s"
  LawAt what = {};         ///< the law that is drawn; id "" without one
  std::vector<double> time_s, state_value, demanded, band, law;
  std::vector<double> path_state, path_law;  ///< the law itself along the simulation; not a number between windows
};

struct Power {
  LawAt what;
  double minimum_detectable = 0.0;  ///< strength that this data would show with 80 % power at 1 % false alarms
  std::string unit;
  double absorbed_share = 0.0;  ///< of the effect that the free parameters swallow, 0..1
  double significant = 0.0;     ///< strength that an engineer would care about, same unit
  double leakage_shift = 0.0;   ///< relative change of R_CL by which the fit would swallow it at that size
};

/// Fit of one recording and channel. noise_normalised_rms: 1 is the floor.
struct ChannelComparison {
  std::string channel;
  double rms_before = 0.0, rms_after = 0.0;      ///< noise-normalised
  double nrmse_before = 0.0, nrmse_after = 0.0;  ///< percent
  double whiteness_before = 0.0, whiteness_after = 0.0, independence_before = 0.0, independence_after = 0.0;  ///< p
  double weighed_rms_after = 0.0;  ///< where the input's unrecorded course decides, residuals count less
};

struct RecordingComparison {
  std::string recording;
  bool holdout = false;
  bool left_out = false;  ///< a fit recording that was left out in turn, in the absence of holdout recordings
  std::vector<ChannelComparison> channels;
  double likelihood_gain = 0.0;            ///< log likelihood after - before, over the long-run factor
  double gain_low = 0.0, gain_high = 0.0;  ///< its 95 % block-bootstrap interval
  TimeSeries recorded, before, after;      ///< same channels; for the overlays
};

struct ParameterShift {
  std::string name;
  std::string unit;
  double before = 0.0, before_std = 0.0, after = 0.0, after_std = 0.0;
  double datasheet = 0.0;
  bool before_at_bound = false, after_at_bound = false;  ///< the search ended at an end of its range
};

/// A value that the asset file fixes, and what would fit instead.
struct AssetValue {
  std::string name, unit;
  double in_asset_file = 0.0, fitted = 0.0;
  double std_error = 0.0;  ///< infinite where the data cannot tell
};

/// An improvement that physics forbids: it fits better and is not claimed. Shares are of the misfit beyond the noise,
/// on the linearised model before any law was added, one law at a time.
struct Rejected {
  LawAt what;
  std::string why;
  double share = 0.0;          ///< that it would have taken
  double allowed_share = 0.0;  ///< that the best law within physics would have taken
};

/// What the effect does to prognosis. Empty when nothing in the plant wears.
struct PrognosisShift {
  bool known = false;
  std::string part, parameter, unit;  ///< what wears ("piston seal") and by which parameter; R_CL_* are its values
  double R_CL_before = 0.0, R_CL_after = 0.0, theta_before = 0.0, theta_after = 0.0;
  /// That the mean seal of the reference population (forecast/fleet_population.hpp) has left at that condition.
  double months_before = 0.0, months_after = 0.0;
  std::string sentence;
};

struct Location {
  std::string element;
  double probability = 0.0;
  std::vector<std::string> indistinguishable_from;
  std::string evidence;
};

/// Pooled over recordings: the json's fit.fit and fit.holdout.
struct PooledFit {
  static constexpr double kNearly = 3.0;  ///< times the noise, from which a channel is missed
  std::vector<ChannelComparison> channels;

  /// Channel that the model after misses most, by samples that count, where that is kNearly or more; null: none.
  [[nodiscard]] const ChannelComparison* missed() const {
    const auto most = std::ranges::max_element(channels, {}, &ChannelComparison::weighed_rms_after);
    return most == channels.end() || most->weighed_rms_after < kNearly ? nullptr : &*most;
  }
};

/// A model that was fitted on the way, in the order of the search.
struct Asked {
  std::vector<LawAt> laws;               ///< added to the model as it is
  std::vector<std::string> values = {};  ///< of the asset file, set free: "A_C"
  double score = 0.0;  ///< criterion of the model as it is less that of this one, on one scale: larger is better
};

/// What was seen beside the claimed effects.
struct CandidateCause {
  LawAt what;
  double share = 0.0;        ///< of the excess misfit that it would take by itself, 0..1
  double probability = 0.0;  ///< that it is the cause of what it would take
};

struct Explanation {
  std::string asset_id;
  std::string model;
  std::vector<std::string> fit_recordings, holdout_recordings;
  Verdict verdict = Verdict::undetermined;
  double p_value = 1.0;  ///< that the fitted model and the recordings differ by noise alone
  bool statistically_significant = false;
  double explained_share = 0.0;      ///< of the excess misfit of the fit recordings
  std::vector<Location> location;    ///< most probable first
  std::vector<FoundEffect> effects;  ///< most probable first
  std::vector<MissingTerm> missing;
  std::vector<RecordingComparison> recordings;
  PooledFit fit, holdout;
  std::vector<ParameterShift> parameters;
  std::vector<Power> power;
  std::vector<Rejected> rejected;
  /// Each entry, of one value to three, would explain the recordings as well as the laws found; the best first. With
  /// effects and `beside_asset_values`: a value that is off beside these effects.
  std::vector<std::vector<AssetValue>> asset_values;
  /// Laws that are needed beside the first entry; without effects they are no names of what is there.
  std::vector<LawAt> beside_asset_values;
  PrognosisShift prognosis;
  std::string next_test;                   ///< what to record to settle what is still open, or empty
  std::string summary;                     ///< two or three sentences for a maintenance engineer
  std::vector<CandidateCause> candidates;  ///< most probable first
  std::vector<Asked> trace;
  std::vector<std::string> not_asked;  ///< what the time limit cut off; empty where it cut nothing
  std::vector<std::string> notes;      ///< noise model, what was tried, limits of the data
  AssetConfig explained;               ///< the asset with fitted parameters and the found physics

  /// Whether values of the asset file are off beside the effects, and not in their place.
  [[nodiscard]] bool values_beside_effects() const { return !effects.empty() && !beside_asset_values.empty(); }
  /// Whether a model after differs from that before: by laws, or by a value of the asset file in their place.
  [[nodiscard]] bool changed() const {
    return !effects.empty() || (verdict == Verdict::undetermined && !asset_values.empty());
  }
};

}  // namespace mismatch
}  // namespace sealwatch
