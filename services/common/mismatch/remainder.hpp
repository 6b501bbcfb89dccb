// A law beside another one that says only that something is left. Either it could as well sit in three other elements,
// or what it takes is so little beside what the largest law takes that it may be no more than that law's exact form:
//
//   gain < 2e-2 of the largest law's, where forms of the largest law or other laws at its element could do what it does
//   (form_error.hpp); in a gross misfit, where that cannot be asked, wherever it is at the same element
//
// gain: criterion without the law less that with all. As amplitudes a seventh: no closer is the form of a law known (a
// clamp or an arctangent where the catalogue has a hyperbolic tangent). Where the laws found leave less than 2e-3 of what
// they took, only laws that are more than their forms are tried.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>

#include "sealwatch/mismatch/explanation.hpp"
#include "services/common/mismatch/refits.hpp"
#include "services/common/mismatch/resolution.hpp"

namespace sealwatch::mismatch {

/// Of the largest law's gain.
inline constexpr double kForm = 2e-2;

struct Remainder {
  LawAt law;
  std::string sentence;
};

/// Whether the first law is more than what the form of the second may be off by.
using MoreThanForm = std::function<bool(const LawAt&, const LawAt&)>;

/// Of the laws of one model, described; `last`: the one that was added last. Nothing where each says what it is.
[[nodiscard]] std::optional<Remainder> remainder_among(std::span<const FoundEffect> effects, const LawAt& last,
                                                       const MoreThanForm& is_more_than_form);

/// What the laws found leave, of what they took off the misfit `without` it: what exceeds the noise's share of the misfit
/// `with` it, or, as that share is only known to about sqrt(2 N), what another law promises to take (`promised`).
[[nodiscard]] double share_left(const FittedModel& without, const FittedModel& with, double promised);
/// Whether that is no more than its exact form may take. Not in what stays a gross misfit.
[[nodiscard]] bool leaves_its_form_at_most(const FittedModel& without, const FittedModel& with, double promised);
/// The same to a user: which law, and how much is left.
[[nodiscard]] std::string left_beside(const LawAt& law, double share);

/// Whether what came in takes less than half of what the model without it leaves beyond the noise. Some model that comes
/// to `least_misfit` shows that the noise is no more than that.
[[nodiscard]] bool takes_up_little(const FittedModel& without, const FittedModel& with,
                                   double least_misfit = std::numeric_limits<double>::infinity());

/// A law of a trial, and why it is not claimed.
struct NotTold {
  std::size_t slot = 0;
  std::string sentence;
  /// The entry of law_sizes without which its strength were told, and what it is there for; "": it has no part in that.
  std::string by_size = {};
};

/// The one whose strength is nearest to nothing, where that is within two of its standard errors (standard_errors.hpp,
/// and what the simulation's own errors allow, as they are told).
/// The criterion takes what a model leaves for white; where it is a course, neighbouring samples tell less than that,
/// and a law that follows it is not told from none. Not asked where no standard error is known.
[[nodiscard]] std::optional<NotTold> not_told_from_zero(const Trial& trial, const Resolution& resolution);

/// Whether it fits at three other elements as well.
[[nodiscard]] bool could_sit_anywhere(const FoundEffect& effect);

/// The same law at the same element, whatever its form.
[[nodiscard]] bool same_place(const LawAt& a, const LawAt& b);

}  // namespace sealwatch::mismatch
