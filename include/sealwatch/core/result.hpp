// Results of operations that can fail because of what the outside world gave us.
//
// Three kinds of failure are kept apart:
//   - a bug in sealwatch           -> assert
//   - bad input from outside       -> Result<T> with an Error that names file, place, value and rule
//   - degraded physics or sensors  -> a quality flag or an event inside a message, never an Error
#pragma once

#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace sealwatch {

/// What is wrong with an input: where it is, what stood there, which rule it broke and what would mend it.
/// Any part may be empty; `describe()` prints only the parts that are there.
struct Error {
  std::string file;    ///< file name as the user gave it
  std::string place;   ///< "row 17, column pressure_a", "line 4, key parameters.R_CL"
  std::string value;   ///< the offending text
  std::string rule;    ///< the rule it broke: "must be a number"
  std::string advice;  ///< what to do about it: "did you mean 'pressure_a'?"

  /// "FILE: PLACE: 'VALUE': RULE; ADVICE"
  [[nodiscard]] std::string describe() const;
};

template <class T>
using Result = tl::expected<T, Error>;

/// Result of an operation that returns nothing.
using Status = tl::expected<void, Error>;

inline tl::unexpected<Error> fail(Error error) { return tl::unexpected<Error>(std::move(error)); }

/// An error that only has a rule (and perhaps advice), for checks that know no file.
inline tl::unexpected<Error> fail(std::string rule, std::string advice = {}) {
  return fail(Error{.file = {}, .place = {}, .value = {}, .rule = std::move(rule), .advice = std::move(advice)});
}

}  // namespace sealwatch
