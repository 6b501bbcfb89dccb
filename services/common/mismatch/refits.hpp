// The fitted model with some laws more, refitted: start values in, trials out.
#pragma once

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "services/common/mismatch/fitted_model.hpp"

namespace sealwatch::mismatch {

/// A law at an element that was added, or could be.
struct Effect {
  const Law* law = nullptr;
  std::string element;
};

/// The model refitted with some laws.
struct Trial {
  std::vector<Effect> effects;
  std::shared_ptr<const FittedModel> model;
  std::string differs_in = {};  ///< a parameter that each recording has for itself here, and not in the search
  bool is_start = false;        ///< found otherwise: nothing was asked in place of its laws yet
};

/// A law with start values of all its parameters, and by how much the unknowns of the model that it is added to change
/// beside it; empty: not known.
struct LawStart {
  Effect effect;
  std::vector<double> parameters;
  PemPoint beside = {};
  /// By how much the misfit falls from where it was asked, `asked_at`, on the linear model, with all laws that it is added
  /// with; infinite: not known.
  double promised = std::numeric_limits<double>::infinity();
  double asked_at = 0.0;
};

/// The law that was added last, with the values that it was found with.
[[nodiscard]] LawStart last_law_of(const Trial& trial);

/// The laws found so far with the plant's parameters where the asset file has them; nothing where that cannot be
/// simulated. In a gross misfit parameters bend to what is missing: their fit has several minima, from some of which no
/// search finds the law.
[[nodiscard]] std::optional<Trial> with_given_values(const Trial& found, const Data& data);

/// Where values of the asset file that are known within a tolerance are as the file gives them, and stay that.
struct AsKnown {
  AssetConfig asset;
  Data data;
};
[[nodiscard]] AsKnown as_known(const AssetConfig& asset, const Data& data);

struct RefitOptions {
  /// Indices of effects of the model set out from that are taken out first, ascending.
  std::vector<std::size_t> in_place_of = {};
  /// The starts have the strengths at which they do what these effects did (replacement.hpp). Else strengths come first,
  /// and shapes are held until they fit.
  bool sized = false;
  /// A refit that ends worse than what it set out from starts again with a tenth of its strength (for alternatives, and
  /// in a gross misfit; near the noise a search takes the law that is easier to find).
  bool again_smaller = false;
  /// What a first round comes to is enough.
  bool first_round_only = false;
  /// Misfit of an explanation that is known: what cannot come near it is cut too.
  double to_beat = std::numeric_limits<double>::infinity();
};

/// A model that others are compared with, fitted from where another one ended. A gross misfit is known well enough once
/// its linear model promises little of it.
[[nodiscard]] Result<FittedModel> fit_baseline(const AssetConfig& asset, const Data& data, const FittedModel& from,
                                               int threads);

/// Refits of `laws` (each with its start values) added to `from`, on `threads` threads; those that fail are left out.
/// After a first round of iterations, those are cut that cannot come near the best, however well the rest of their search
/// went: by twice what their linear model promises.
[[nodiscard]] std::vector<Trial> refit(const Trial& from, const std::vector<std::vector<LawStart>>& laws,
                                       const Data& data, int threads, const RefitOptions& options = {});

/// Of a gross misfit: what the linear model promises less of decides nothing there, where laws differ by multiples.
inline constexpr double kDecidesNothing = 0.01;

/// Times what the linear model promises: no search has done better by far.
inline constexpr double kOptimistic = 2.0;

/// The same of a screening's promise (LawStart). Near the noise the most of 150 refits was 2.7 times; in a gross misfit
/// of an actuator, too, but 16 times of tanks that run over.
inline constexpr double kOptimisticOfPromise = 3.0, kOptimisticFarOff = 20.0;

/// The least misfit that its search can come to, at best: `optimism` times what the linear model promises lower.
[[nodiscard]] double could_reach(const FittedModel& model, double optimism = kOptimistic);

/// The trial with its derivatives, where a round did not keep them (refit); as it is where they cannot be computed.
[[nodiscard]] Trial with_derivatives(Trial trial, const Data& data, int threads);
/// A search that ran out of iterations, whose simulations were coarser than its misfit allows, or that ended with a first
/// round, without what values may be off by within their tolerances, goes on from where it is.
[[nodiscard]] Trial polished(Trial trial, const Data& data, int threads);

}  // namespace sealwatch::mismatch
