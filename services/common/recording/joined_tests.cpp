#include "services/common/recording/joined_tests.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>

#include "sealwatch/core/text.hpp"
#include "services/common/recording/cells.hpp"
#include "services/common/text/numbers.hpp"

namespace sealwatch {

std::vector<std::string> parts_of(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored)) return {path};
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t plus = std::min(path.find('+', begin), path.size());
    parts.push_back(path.substr(begin, plus - begin));
    begin = plus + 1;
  }
  const auto is_there = [&](const std::string& part) { return std::filesystem::exists(part, ignored); };
  return std::ranges::any_of(parts, is_there) ? parts : std::vector<std::string>{path};
}

Status JoinedTests::append(const std::string& file, std::vector<LogTest> next) {
  if (Status again = refuse_again(file, next.front()); !again) return again;
  const std::vector<double>& last_s = next.back().read.samples.time_s;
  const OwnTimes own{.begin_s = last_s.front(), .end_s = last_s.back(), .step_s = usual_step(last_s)};
  auto rest = next.begin();
  if (!tests_.empty()) {
    const Result<std::optional<double>> shift_s = shift_behind(next.front());
    if (!shift_s) return fail(shift_s.error());
    if (*shift_s)
      if (Status joined = go_on_with(std::move(*rest++), **shift_s); !joined) return joined;
    shift_s_ = next.size() == 1 ? shift_s->value_or(0.0) : 0.0;
  }
  std::move(rest, next.end(), std::back_inserter(tests_));
  last_file_ = file;
  last_ = own;
  return {};
}

Status JoinedTests::refuse_again(const std::string& file, const LogTest& next) {
  const std::string& hash = next.read.content_hash;
  const auto same = std::ranges::find(hashes_, hash, &std::pair<std::string, std::string>::first);
  if (same != hashes_.end())
    return fail(error_at({}, {}, "holds the same as " + same->second + ", which goes before it",
                         "give each file of a test once"));
  hashes_.emplace_back(hash, file);
  return {};
}

/// What is added to the times of `next`; nothing where it is another test.
Result<std::optional<double>> JoinedTests::shift_behind(const LogTest& next) const {
  constexpr const char* kOrder = "give the files in the order of their times, and no time twice";
  const LogTest& last = tests_.back();
  const double end_s = last.read.samples.time_s.back();
  const double begin_s = next.read.samples.time_s.front();
  const std::string before = "begins before " + last_file_ + " ends";
  if (last.clock && next.clock) {
    const double shift_s = seconds_between(*last.clock, *next.clock);
    if (begin_s + shift_s <= end_s) return fail(not_behind(next, before, kOrder));
    return std::optional(shift_s);
  }
  if (begin_s > last_.end_s) return std::optional(shift_s_);
  if (std::abs(begin_s - last_.begin_s) > last_.step_s) return fail(not_behind(next, before, kOrder));
  if (time_resets_ == "split") return std::optional<double>();
  if (time_resets_ == "join") return std::optional(end_s + last_.step_s - begin_s);
  return fail(not_behind(next, "time starts anew, as in " + last_file_,
                         "log: {time_resets: join} takes both as one test, split as another test"));
}

Error JoinedTests::not_behind(const LogTest& next, std::string rule, std::string advice) const {
  std::string value = text::significant(next.read.samples.time_s.front(), 9) + " s";
  if (next.clock) value = format_utc(*next.clock);
  if (next.clock && !next.start_time) value.erase(0, value.find('T') + 1);  // the day is not known
  return error_at("row " + std::to_string(next.first_row) + ", column time", value, std::move(rule), std::move(advice));
}

Status JoinedTests::go_on_with(LogTest next, double shift_s) {
  ColumnarSamples& last = tests_.back().read;
  if (next.read.samples.channels.size() != last.samples.channels.size())
    return fail(error_at("row 1, column 1", {}, "has other channels than the file before it"));
  for (Series& channel : last.samples.channels) {
    const Series* more = next.read.samples.find(channel.name);
    if (more == nullptr) return fail(error_at("channel " + channel.name, {}, "is missing: the file before it has it"));
    channel.values.insert(channel.values.end(), more->values.begin(), more->values.end());
  }
  std::vector<double>& time_s = next.read.samples.time_s;
  if (Status shifted = shift_times(time_s, shift_s); !shifted) return shifted;
  last.samples.time_s.insert(last.samples.time_s.end(), time_s.begin(), time_s.end());
  last.content_hash = content_hash(last.content_hash + next.read.content_hash);
  return {};
}

}  // namespace sealwatch
