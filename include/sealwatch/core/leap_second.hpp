// The 61st second of a minute, which UTC has at times and a count of nanoseconds since 1970 has not.
#pragma once

namespace sealwatch {

inline constexpr const char* kLeapSecond =
    "is a leap second, which has no place of its own among times counted since 1970";
inline constexpr const char* kLeapSecondAdvice = "log the time in s from the test's begin, or split the test there";

}  // namespace sealwatch
