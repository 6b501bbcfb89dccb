#include "services/common/recording/joined_tests.hpp"

#include <algorithm>
#include <filesystem>
#include <iterator>

#include "sealwatch/core/text.hpp"
#include "services/common/recording/cells.hpp"

namespace sealwatch {
namespace {

/// What is added to the times of `next`.
double shift_behind(const LogTest& last, const LogTest& next) {
  const std::vector<double>& before = last.read.samples.time_s;
  const std::vector<double>& after = next.read.samples.time_s;
  if (last.start_time && next.start_time) return seconds_between(*last.start_time, *next.start_time);
  return after.front() > before.back() ? 0.0 : before.back() + usual_step(before) - after.front();
}

Status join(LogTest& last, LogTest next) {
  TimeSeries& samples = last.read.samples;
  const double shift_s = shift_behind(last, next);
  if (next.read.samples.time_s.front() + shift_s <= samples.time_s.back())
    return fail(error_at("row 1, column time", {}, "begins before the file before it ends",
                         "give the files in the order of their times"));
  if (next.read.samples.channels.size() != samples.channels.size())
    return fail(error_at("row 1, column 1", {}, "has other channels than the file before it"));
  for (Series& channel : samples.channels) {
    const Series* more = next.read.samples.find(channel.name);
    if (more == nullptr) return fail(error_at("channel " + channel.name, {}, "is missing: the file before it has it"));
    channel.values.insert(channel.values.end(), more->values.begin(), more->values.end());
  }
  if (const Status shifted = shift_times(next.read.samples.time_s, shift_s); !shifted) return shifted;
  samples.time_s.insert(samples.time_s.end(), next.read.samples.time_s.begin(), next.read.samples.time_s.end());
  last.read.content_hash = content_hash(last.read.content_hash + next.read.content_hash);
  return {};
}

}  // namespace

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

Status append(std::vector<LogTest>& tests, std::vector<LogTest> next) {
  if (const Status joined = join(tests.back(), std::move(next.front())); !joined) return joined;
  std::move(next.begin() + 1, next.end(), std::back_inserter(tests));
  return {};
}

}  // namespace sealwatch
