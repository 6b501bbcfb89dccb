// Which messages a service takes in at all: what people or other systems report must have happened.
//
// A slip in the year of a replacement would set aside every test until then. A report may lie a day ahead of now, as
// clocks differ, or of the newest test of its asset: old or simulated lives are played back under a clock of their own.
// So would a test whose clock was wrong: one in the future is refused where it also lies more than a year after the
// newest test; nothing is kept of it, so that it is taken in once its start time is corrected. A simulated life may go
// on into the future month by month, or lie there as a whole.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "sealwatch/core/time.hpp"
#include "sealwatch/message/topics.hpp"

namespace sealwatch {

class Admission {
 public:
  /// Takes note of when a test was made.
  void note(const Message& message);
  /// Why the message is not to be taken in; none for nearly all.
  [[nodiscard]] std::optional<std::string> refusal(const Message& message, UtcTime now) const;

 private:
  [[nodiscard]] std::optional<std::string> refusal_of_test(const Message& message, UtcTime now) const;

  std::map<std::string, std::int64_t> newest_ns_;  ///< event time of the newest test, by asset
};

}  // namespace sealwatch
