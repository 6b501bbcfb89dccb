#include "services/advisory_generation/verdicts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string_view>

namespace sealwatch::advisory_generation {
namespace {

constexpr std::string_view kStart = "this test alone says: ";
constexpr std::string_view kMiddle = ". The advice rests on all tests so far; together they say";
constexpr std::string_view kTheSame = " the same";
constexpr std::string_view kOther = ": ";
constexpr std::string_view kSeparator = "; ";
/// As versions up to 0.1.0 wrote it: their journals are read too.
constexpr std::string_view kOldStart = "what this test by itself says: ";
constexpr std::string_view kOldMiddle = "; what is in force after all tests so far: ";
/// As 0.1.0 wrote it, with kStart, kSeparator, kTheSame and kOther.
constexpr std::string_view kMiddleBefore = ". The advice goes by all tests so far, which say";
constexpr std::string_view kOldSeparator = ", ";
constexpr std::string_view kOldNone = "no work";
constexpr std::string_view kOldNoDate = "no date yet";
constexpr std::string_view kOldBy = "the seal replaced by ";  ///< of later versions, too
constexpr const char* kNotJudged = "nothing about the wear";
/// In the order of WearLevel.
constexpr std::array<const char*, 5> kWear = {"no work yet", "plan the work", "book a vessel", "book a vessel at once",
                                              "replace now"};
static_assert(kWear.size() == EnumNames<WearLevel>::kNames.size());
constexpr std::size_t kMostRemembered = 60;  // five years of tests: more than any sensible confirmation

template <class T>
std::vector<T> newest(const std::vector<T>& values, std::size_t count) {
  return {values.end() - static_cast<std::ptrdiff_t>(std::min(count, values.size())), values.end()};
}

/// The value that `wanted` of `values` reach, worst first by `worse`; none when there are fewer.
template <class T, class Worse>
std::optional<T> reached_by(std::vector<T> values, std::size_t wanted, Worse worse) {
  if (values.size() < wanted) return std::nullopt;
  std::sort(values.begin(), values.end(), worse);
  return values[wanted - 1];
}

template <class T>
std::vector<T> votes(const std::vector<TestVerdict>& verdicts, std::optional<T> TestVerdict::*field) {
  std::vector<T> values;
  for (const TestVerdict& verdict : verdicts)
    if (verdict.*field) values.push_back(*(verdict.*field));
  return values;
}

std::vector<WearLevel> levels_to_ease_to(const std::vector<TestVerdict>& verdicts) {
  std::vector<WearLevel> levels;
  for (const TestVerdict& verdict : verdicts)
    if (verdict.wear)
      levels.push_back(std::max(*verdict.wear, verdict.wear_a_campaign_earlier.value_or(*verdict.wear)));
  return levels;
}

bool raised(const std::vector<TestVerdict>& last, bool TestVerdict::*flag, bool before, const Options& options) {
  const auto says_yes = [&](const TestVerdict& verdict) { return verdict.*flag; };
  const auto recent = newest(last, options.confirming_window);
  const auto count = static_cast<std::size_t>(std::count_if(recent.begin(), recent.end(), says_yes));
  if (count >= options.confirming_tests) return true;
  const auto row = newest(last, options.easing_tests);
  return before && std::any_of(row.begin(), row.end(), says_yes);
}

/// No name of what is replaced: names are the user's, and this line is read again.
constexpr std::string_view kBy = "replacement by ";

constexpr std::string_view kTrusted = "instruments trusted";
constexpr std::string_view kDoubted = "instruments doubted";
constexpr std::string_view kNames = ": ";
constexpr std::string_view kComma = ", ";

std::string instrument_words(bool doubted, const std::set<std::string>& channels) {
  std::string text(doubted ? kDoubted : kTrusted);
  if (!doubted) return text;
  for (const std::string& channel : channels)
    text.append(channel == *channels.begin() ? kNames : kComma).append(channel);
  return text;
}

/// The channels that instrument_words() wrote.
std::set<std::string> channels_in(std::string text) {
  std::set<std::string> channels;
  text.erase(0, std::min(text.size(), kDoubted.size() + kNames.size()));
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(kComma), text.size());
    channels.insert(text.substr(0, end));
    text.erase(0, end + kComma.size());
  }
  return channels;
}

template <class T>
std::string words(const std::string& wear, const T& of, bool failed) {
  std::string text = wear;
  if (of.replace_by) text.append(kSeparator).append(kBy).append(format_date(*of.replace_by));
  text.append(kSeparator).append(instrument_words(of.instruments_doubted, of.doubted_channels));
  return text.append(kSeparator).append(failed ? "stroke failed" : "stroke done");
}

constexpr std::string_view kEarlier = " (with the work one campaign earlier: ";
constexpr std::string_view kOldEarlier = " (were the work one campaign earlier: ";  ///< up to 0.1.0
constexpr std::string_view kEarlierEnd = ")";

std::optional<WearLevel> level_of(std::string_view text) {
  for (std::size_t level = 0; level < kWear.size(); ++level)
    if (text == kWear[level]) return static_cast<WearLevel>(level);
  return text == kOldNone ? std::optional(WearLevel::none) : std::nullopt;
}

struct Words {
  std::optional<WearLevel> wear;
  std::optional<WearLevel> wear_a_campaign_earlier;
  std::optional<UtcTime> replace_by;
  bool doubted = false;
  bool failed = false;
  std::set<std::string> doubted_channels;
};

/// What words() wrote, from its end: "WEAR; DATE; INSTRUMENTS; STROKE", the date only where there is one.
std::optional<Words> read(std::string text, std::string_view separator) {
  Words read;
  for (const std::string_view earlier : {kEarlier, kOldEarlier}) {
    const std::size_t begin = text.find(earlier);
    if (begin == std::string::npos) continue;
    const std::size_t end = text.find(kEarlierEnd, begin);
    if (end == std::string::npos) return std::nullopt;
    read.wear_a_campaign_earlier = level_of(text.substr(begin + earlier.size(), end - begin - earlier.size()));
    text.erase(begin, end + kEarlierEnd.size() - begin);
  }
  const auto last = [&] {
    const std::size_t begin = text.rfind(separator);
    return begin == std::string::npos ? "" : text.substr(begin + separator.size());
  };
  const auto drop = [&](const std::string& part) { text.resize(text.size() - part.size() - separator.size()); };
  const std::string stroke = last();
  if (stroke.empty()) return std::nullopt;
  drop(stroke);
  const std::string instruments = last();
  if (instruments.empty()) return std::nullopt;
  drop(instruments);
  if (const std::string date = last(); date.starts_with(kBy) || date.starts_with(kOldBy) || date == kOldNoDate) {
    const std::size_t words = date.starts_with(kOldBy) ? kOldBy.size() : kBy.size();
    if (const auto time = parse_utc(date.substr(std::min(words, date.size())))) read.replace_by = *time;
    drop(date);
  }
  read.wear = level_of(text);
  if (!read.wear && text != kNotJudged) return std::nullopt;
  read.doubted = instruments.starts_with(kDoubted);
  if (read.doubted) read.doubted_channels = channels_in(instruments);
  read.failed = stroke == "stroke failed";
  return read;
}

}  // namespace

const InForce& VerdictMemory::judge(const TestVerdict& verdict, std::optional<UtcTime> now, const Options& options) {
  remember(verdict);
  if (verdict.wear) judge_wear(verdict, options);
  if (now) drop_stale_date(verdict, *now, options);
  if (verdict.replace_by && now) judge_date(verdict, *now, options);
  in_force_.instruments_doubted =
      raised(last_, &TestVerdict::instruments_doubted, in_force_.instruments_doubted, options);
  in_force_.doubted_channels.clear();
  if (in_force_.instruments_doubted)
    for (const TestVerdict& one : newest(last_, std::max(options.confirming_window, options.easing_tests)))
      in_force_.doubted_channels.insert(one.doubted_channels.begin(), one.doubted_channels.end());
  in_force_.failing = raised(last_, &TestVerdict::failed, in_force_.failing, options);
  return in_force_;
}

void VerdictMemory::judge_wear(const TestVerdict& verdict, const Options& options) {
  const auto levels = votes(last_, &TestVerdict::wear);
  const auto worse = std::greater<>();
  const auto confirmed = reached_by(newest(levels, options.confirming_window), options.confirming_tests, worse);
  const auto row = newest(levels_to_ease_to(last_), options.easing_tests);
  if (row.size() == options.easing_tests) in_force_.wear = std::min(in_force_.wear, *reached_by(row, 1, worse));
  if (confirmed) in_force_.wear = std::max(in_force_.wear, *confirmed);
  if (verdict.urgent) in_force_.wear = std::max(in_force_.wear, *verdict.wear);
}

/// A date that has passed, or that none of the last tests names any more, is not in force: advice never names a day of
/// years ago.
void VerdictMemory::drop_stale_date(const TestVerdict& verdict, UtcTime now, const Options& options) {
  if (!in_force_.replace_by) return;
  const bool still_meant =
      verdict.replace_by && months_between(*in_force_.replace_by, *verdict.replace_by) <= options.date_tolerance_months;
  const bool passed = *in_force_.replace_by <= now && !still_meant;
  const auto recent = newest(last_, options.easing_tests);
  const bool forgotten = recent.size() == options.easing_tests && votes(recent, &TestVerdict::replace_by).empty();
  if (passed || forgotten) in_force_.replace_by.reset();
}

void VerdictMemory::judge_date(const TestVerdict& verdict, UtcTime now, const Options& options) {
  if (!in_force_.replace_by) {
    in_force_.replace_by = verdict.replace_by;
    return;
  }
  const auto worse = std::less<>();
  const auto confirmed = reached_by(votes(newest(last_, options.confirming_window), &TestVerdict::replace_by),
                                    options.confirming_tests, worse);
  const auto row = votes(newest(last_, options.easing_tests), &TestVerdict::replace_by);
  UtcTime date = *in_force_.replace_by;
  const bool may_ease = in_force_.wear != WearLevel::replace && row.size() == options.easing_tests;
  if (may_ease) date = std::max(date, *reached_by(row, 1, worse));
  if (confirmed) date = std::min(date, *confirmed);
  if (verdict.urgent) date = std::min(date, *verdict.replace_by);
  const double left = std::max(months_between(now, *in_force_.replace_by), 0.0);
  const double tolerance = std::max(options.date_tolerance_months, options.date_tolerance_share * left);
  if (std::abs(months_between(*in_force_.replace_by, date)) > tolerance) in_force_.replace_by = date;
}

void VerdictMemory::restore(const TestVerdict& verdict, const InForce& in_force) {
  remember(verdict);
  in_force_ = in_force;
}

void VerdictMemory::remember(const TestVerdict& verdict) {
  if (last_.size() == kMostRemembered) last_.erase(last_.begin());
  last_.push_back(verdict);
}

std::string in_words(const TestVerdict& verdict, const InForce& in_force) {
  const auto wear = [](WearLevel level) { return std::string(kWear.at(static_cast<std::size_t>(level))); };
  const auto of_test = [&](const std::string& level) { return words(level, verdict, verdict.failed); };
  const std::string level = verdict.wear ? wear(*verdict.wear) : kNotJudged;
  std::string alone = level;
  if (verdict.wear_a_campaign_earlier)
    alone.append(kEarlier).append(wear(*verdict.wear_a_campaign_earlier)).append(kEarlierEnd);
  const std::string all = words(wear(in_force.wear), in_force, in_force.failing);
  std::string line(kStart);
  line.append(of_test(alone)).append(kMiddle);
  return of_test(level) == all ? line.append(kTheSame) : line.append(kOther).append(all);
}

std::optional<VerdictRecord> from_words(const std::string& line) {
  const bool old = line.starts_with(kOldStart);
  const std::string_view start = old ? kOldStart : kStart;
  const std::string_view separator = old ? kOldSeparator : kSeparator;
  const std::string_view between = old                                             ? kOldMiddle
                                   : line.find(kMiddleBefore) != std::string::npos ? kMiddleBefore
                                                                                   : kMiddle;
  const auto middle = line.find(between);
  if (!line.starts_with(start) || middle == std::string::npos) return std::nullopt;
  const std::string alone = line.substr(start.size(), middle - start.size());
  std::string all = line.substr(middle + between.size());
  if (!old && all == kTheSame)
    all = alone;
  else if (!old)
    all.erase(0, kOther.size());
  const auto test = read(alone, separator);
  const auto force = read(all, separator);
  if (!test || !force) return std::nullopt;
  VerdictRecord record;
  record.verdict = {.wear = test->wear,
                    .wear_a_campaign_earlier = test->wear_a_campaign_earlier,
                    .replace_by = test->replace_by,
                    .urgent = test->wear == WearLevel::replace,  // nothing else makes it so
                    .instruments_doubted = test->doubted,
                    .failed = test->failed,
                    .doubted_channels = test->doubted_channels};
  record.in_force = {.wear = force->wear.value_or(WearLevel::none),
                     .replace_by = force->replace_by,
                     .instruments_doubted = force->doubted,
                     .failing = force->failed,
                     .doubted_channels = force->doubted_channels};
  return record;
}

}  // namespace sealwatch::advisory_generation
