#include "services/verification/trial/mismatch_summary.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "sealwatch/forecast/proper_scores.hpp"
#include "services/common/text/format.hpp"
#include "services/common/text/numbers.hpp"

namespace sealwatch::verification {
namespace {

constexpr double kNormal97_5 = 1.959963984540054;
constexpr double kGoodNrmse = 90.0;  // percent, in every channel: what a user would call a good fit
constexpr double kPasses = 0.01;     // p-value of the usual checks

std::string place_of(const LawRecord& law) { return law.id + " " + law.element; }

bool detected(const MismatchRecord& r) { return r.answer.p_value <= kTrialFalseAlarmRate; }
bool claimed(const MismatchRecord& r) { return r.answer.verdict == "mismatch"; }

bool element_first(const MismatchRecord& r) {
  return !r.answer.places.empty() && std::ranges::any_of(r.hidden, [&](const LawRecord& truth) {
    return truth.element == r.answer.places.front();
  });
}

bool is_hidden(const MismatchRecord& r, const std::string& place) {
  return std::ranges::any_of(r.hidden, [&](const LawRecord& truth) { return place_of(truth) == place; });
}

bool law_first(const MismatchRecord& r) {
  return !r.answer.found.empty() && is_hidden(r, place_of(r.answer.found.front()));
}

bool in_set(const MismatchRecord& r, const std::string& place) {
  return std::ranges::any_of(r.answer.found, [&](const LawRecord& law) {
    return place_of(law) == place || std::ranges::find(law.same, place) != law.same.end();
  });
}

bool all_in_set(const MismatchRecord& r) {
  return !r.answer.found.empty() &&
         std::ranges::all_of(r.hidden, [&](const LawRecord& truth) { return in_set(r, place_of(truth)); });
}

bool renamed(const MismatchRecord& r) {
  return claimed(r) && !r.hidden.empty() && r.hidden.front().id == "unlisted" && !r.answer.found.empty() &&
         r.answer.found.front().id != "unlisted";
}

constexpr double kAsGood = 1.02;  // of the oracle's held-out rms

bool oracle_known(const MismatchRecord& r) {
  return r.wrong_value.empty() && r.control.oracle_held > 0.0 && r.answer.held_after > 0.0;
}
bool as_good(const MismatchRecord& r) { return r.answer.held_after <= kAsGood * r.control.oracle_held; }

bool value_named(const MismatchRecord& r) {
  return std::ranges::find(r.answer.asset_values, r.wrong_value) != r.answer.asset_values.end();
}

/// Two explanations that the tests cannot tell apart: both in a returned set, both elements listed as one place, or
/// nothing claimed.
bool left_open(const MismatchRecord& r) {
  if (!claimed(r) || (in_set(r, r.twin) && all_in_set(r))) return true;
  const std::string twin_element = r.twin.substr(r.twin.find(' ') + 1);
  return std::ranges::any_of(r.answer.found, [&](const LawRecord& law) {
    const auto holds = [&law](const std::string& element) {
      return law.element == element || std::ranges::find(law.same_places, element) != law.same_places.end();
    };
    return holds(twin_element) && holds(r.hidden.front().element);
  });
}

/// Whether a strength that means the same was found, and whether its interval holds the truth.
struct StrengthCheck {
  bool comparable = false, within = false;
};
StrengthCheck check_strength(const MismatchRecord& r) {
  for (const LawRecord& truth : r.hidden)
    for (const LawRecord& found : r.answer.found)
      if (!truth.strength.empty() && place_of(truth) == place_of(found) && truth.strength == found.strength)
        return {true, std::abs(found.value - truth.value) <= kNormal97_5 * found.std_error};
  return {};
}

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::ranges::sort(values);
  return values[values.size() / 2];
}

using Records = std::vector<const MismatchRecord*>;
using Test = std::function<bool(const MismatchRecord&)>;

/// How many of those that `counts` meet `test`.
CountedShare share(const Records& records, const Test& counts, const Test& test) {
  CountedShare share;
  for (const MismatchRecord* record : records) {
    if (!counts(*record)) continue;
    ++share.of;
    if (test(*record)) ++share.count;
  }
  if (const auto interval = forecast::clopper_pearson(share.count, share.of)) {
    share.low = interval->low;
    share.high = interval->high;
  }
  return share;
}

void count_verdicts(const Records& records, TrialTally& tally) {
  for (const MismatchRecord* r : records) {
    ++tally.sets;
    tally.errors += r->error.empty() ? 0 : 1;
    tally.consistent += r->answer.verdict == "consistent" ? 1 : 0;
    tally.mismatch += r->answer.verdict == "mismatch" ? 1 : 0;
    tally.undetermined += r->answer.verdict == "undetermined" ? 1 : 0;
    tally.seconds += r->answer.seconds;
    tally.control_seconds += r->control.seconds;
  }
  tally.seconds /= std::max(tally.sets, 1);
  tally.control_seconds /= std::max(tally.sets, 1);
}

void count_held_out(const Records& records, TrialTally& tally) {
  const auto known = oracle_known;
  tally.held_within_2_percent = share(records, known, as_good);
  std::vector<double> after, before;
  for (const MismatchRecord* r : records) {
    if (!known(*r)) continue;
    after.push_back(r->answer.held_after / r->control.oracle_held);
    before.push_back(r->answer.held_before / r->control.oracle_held);
  }
  tally.held_over_oracle = median(after);
  tally.held_before_over_oracle = median(before);
}

void count_controls(const Records& records, TrialTally& tally) {
  const auto known = [](const MismatchRecord& r) { return r.control.known; };
  tally.chi_square_detected =
      share(records, known, [](const MismatchRecord& r) { return r.control.chi_square_p <= kTrialFalseAlarmRate; });
  tally.bic_detected = share(records, known, [](const MismatchRecord& r) { return !r.control.bic_id.empty(); });
  const auto hides = [&](const MismatchRecord& r) { return known(r) && !r.hidden.empty(); };
  tally.bic_element_first = share(records, hides, [](const MismatchRecord& r) {
    return std::ranges::any_of(r.hidden, [&](const LawRecord& l) { return l.element == r.control.bic_element; });
  });
  tally.bic_law_first = share(records, hides, [](const MismatchRecord& r) {
    return is_hidden(r, r.control.bic_id + " " + r.control.bic_element);
  });
  tally.sparse_detected = share(records, known, [](const MismatchRecord& r) { return !r.control.sparse_id.empty(); });
  tally.sparse_element_first = share(records, hides, [](const MismatchRecord& r) {
    return std::ranges::any_of(r.hidden, [&](const LawRecord& l) { return l.element == r.control.sparse_element; });
  });
  tally.sparse_law_first = share(records, hides, [](const MismatchRecord& r) {
    return is_hidden(r, r.control.sparse_id + " " + r.control.sparse_element);
  });
  for (const MismatchRecord* r : records)
    tally.sparse_terms += static_cast<double>(r->control.sparse_terms) / static_cast<double>(records.size());
  tally.concealed = share(
      records, [](const MismatchRecord& r) { return r.control.nominal_checked; },
      [](const MismatchRecord& r) {
        return r.control.nominal_chi_square_p > kPasses && r.control.nominal_whiteness_p > kPasses / 14.0 &&
               r.control.nominal_nrmse > kGoodNrmse;
      });
}

TrialTally tally_of(std::string name, const Records& records) {
  TrialTally tally;
  tally.name = std::move(name);
  count_verdicts(records, tally);
  const auto done = [](const MismatchRecord& r) { return r.error.empty(); };
  const auto hides = [&](const MismatchRecord& r) { return done(r) && !r.hidden.empty(); };
  tally.detected = share(records, done, detected);
  tally.claimed = share(records, done, claimed);
  tally.element_first = share(records, hides, element_first);
  tally.law_first = share(records, hides, law_first);
  tally.law_in_set = share(records, hides, [](const MismatchRecord& r) {
    return std::ranges::any_of(r.hidden, [&](const LawRecord& truth) { return in_set(r, place_of(truth)); });
  });
  tally.all_named = share(records, hides, all_in_set);
  tally.renamed = share(
      records, [&](const MismatchRecord& r) { return hides(r) && claimed(r); }, renamed);
  const auto compared = [&](const MismatchRecord& r) {
    return hides(r) && claimed(r) && oracle_known(r) && r.hidden.front().id == "unlisted";
  };
  tally.renamed_worse = share(records, compared, [](const MismatchRecord& r) { return renamed(r) && !as_good(r); });
  tally.renamed_as_good = share(records, compared, [](const MismatchRecord& r) { return renamed(r) && as_good(r); });
  tally.twins_left_open = share(
      records, [&](const MismatchRecord& r) { return hides(r) && detected(r) && !r.twin.empty(); }, left_open);
  tally.twin_in_set = share(
      records, [&](const MismatchRecord& r) { return hides(r) && !r.twin.empty() && claimed(r); },
      [](const MismatchRecord& r) { return in_set(r, r.twin) && all_in_set(r); });
  const auto wrong_value = [](const MismatchRecord& r) { return r.error.empty() && !r.wrong_value.empty(); };
  tally.value_named = share(
      records, [&](const MismatchRecord& r) { return wrong_value(r) && detected(r); }, value_named);
  tally.value_unsaid =
      share(records, wrong_value, [](const MismatchRecord& r) { return claimed(r) && !value_named(r); });
  tally.strength_within = share(
      records, [](const MismatchRecord& r) { return check_strength(r).comparable; },
      [](const MismatchRecord& r) { return check_strength(r).within; });
  double members = 0.0, answers = 0.0;
  for (const MismatchRecord* r : records)
    for (const LawRecord& law : r->answer.found) {
      members += 1.0 + static_cast<double>(law.same.size());
      answers += 1.0;
    }
  tally.set_size = answers > 0.0 ? members / answers : 0.0;
  count_held_out(records, tally);
  count_controls(records, tally);
  return tally;
}

Records those(std::span<const MismatchRecord> records, const Test& test) {
  Records found;
  for (const MismatchRecord& record : records)
    if (test(record)) found.push_back(&record);
  return found;
}

std::string cell(const CountedShare& share) {
  if (share.of == 0) return "-";
  return text::format("{}/{} ({:.0f}-{:.0f} %)", share.count, share.of, 100.0 * share.low, 100.0 * share.high);
}

std::string law_list(const std::vector<LawRecord>& laws) {
  std::string text;
  for (const LawRecord& law : laws) {
    text.append(text.empty() ? "" : " + ").append(law.id).append(law.form.empty() ? "" : "/").append(law.form);
    text.append(" at ").append(law.element);
    for (const std::string& other : law.same) text.append(" = ").append(other);
  }
  return text.empty() ? "nothing" : text;
}

std::string hidden_text(const MismatchRecord& r) {
  if (!r.wrong_value.empty()) return text::format("{} wrong by {:+.0f} %", r.wrong_value, 100.0 * r.wrong_share);
  return text::format("{} ({:.1f} x barely, {:.1f} x detectable)", law_list(r.hidden),
                      r.hidden.empty() ? 0.0 : r.hidden.front().times_barely, times_detectable(r));
}

std::string found_text(const AnswerRecord& answer) {
  std::string text = law_list(answer.found);
  for (const std::string& names : answer.asset_values) text += ", or the asset file's " + names;
  return text;
}

}  // namespace

double times_detectable(const MismatchRecord& record) {
  const ControlRecord& control = record.control;
  if (!(control.minimum_detectable > 0.0) || !control.oracle_fitted) return 0.0;
  return std::abs(control.oracle_value) / control.minimum_detectable;
}

int named_effects(const MismatchRecord& record) {
  return static_cast<int>(
      std::ranges::count_if(record.hidden, [&](const LawRecord& truth) { return in_set(record, place_of(truth)); }));
}

std::vector<TrialTally> summarise_trials(std::span<const MismatchRecord> records) {
  std::vector<TrialTally> tallies;
  for (const char* stratum : {"null", "single", "pair", "outside", "sensor", "recording", "source_sensors", "concealed",
                              "inseparable", "nominal_only", "asset_file"}) {
    const auto own = [&](const MismatchRecord& r) { return r.stratum == stratum; };
    const Records all = those(records, own);
    if (all.empty()) continue;
    tallies.push_back(tally_of(stratum, all));
    const std::string name(stratum);
    if (name == "null") {
      tallies.push_back(tally_of("null, white noise", those(records, [&](auto& r) { return own(r) && !r.coloured; })));
      tallies.push_back(
          tally_of("null, coloured noise", those(records, [&](auto& r) { return own(r) && r.coloured; })));
    }
    if (name != "single" && name != "sensor") continue;
    struct Class {
      const char* words;
      double low, high;
    };
    for (const Class& c : {Class{", below detectable", 1e-12, 1.0},
                           {", 1 to 3 x detectable", 1.0, 3.0},
                           {", from 3 x detectable", 3.0, 1e300}})
      tallies.push_back(tally_of(name + c.words, those(records, [&](auto& r) {
                                   const double times = times_detectable(r);
                                   return own(r) && times >= c.low && times < c.high;
                                 })));
  }
  return tallies;
}

std::string trial_table(std::span<const TrialTally> tallies) {
  std::string text;
  const auto line = [&text](const char* words, const std::string& value) {
    if (value != "-") text += text::format("  {:42} {}\n", words, value);
  };
  const auto figure = [](double value) { return value > 0.0 ? text::significant(value) : std::string("-"); };
  for (const TrialTally& t : tallies) {
    if (t.sets == 0) continue;
    text.append(t.name).append(": ").append(std::to_string(t.sets)).append(" sets\n");
    line("consistent, mismatch, undetermined, errors",
         std::to_string(t.consistent) + ", " + std::to_string(t.mismatch) + ", " + std::to_string(t.undetermined) +
             ", " + std::to_string(t.errors));
    line("detected at 1 %", cell(t.detected));
    line("mismatch claimed", cell(t.claimed));
    line("right element first", cell(t.element_first));
    line("right law first", cell(t.law_first));
    line("right law in the returned set", cell(t.law_in_set));
    line("all hidden laws in the returned sets", cell(t.all_named));
    line("law and its twin in the returned set", cell(t.twin_in_set));
    line("both twins left open, of those detected", cell(t.twins_left_open));
    line("the wrong value named, of those detected", cell(t.value_named));
    line("a law claimed and the value not said", cell(t.value_unsaid));
    line("unlisted, a listed law claimed", cell(t.renamed));
    line("  and worse on held-out than a closed form", cell(t.renamed_worse));
    line("  and within 2 % of the closed form there", cell(t.renamed_as_good));
    line("laws in a returned set, mean", figure(t.set_size));
    line("strength within its 95 % interval", cell(t.strength_within));
    line("held-out rms within 2 % of the oracle's", cell(t.held_within_2_percent));
    line("held-out rms over the oracle's, median", figure(t.held_over_oracle));
    line("  the same of the model as it is", figure(t.held_before_over_oracle));
    line("nominal tests alone pass the usual checks", cell(t.concealed));
    line("control: chi-square detects", cell(t.chi_square_detected));
    line("control: BIC detects", cell(t.bic_detected));
    line("control: BIC has the element first", cell(t.bic_element_first));
    line("control: BIC has the law first", cell(t.bic_law_first));
    line("control: sparse regression keeps a law", cell(t.sparse_detected));
    line("control: it has the element first", cell(t.sparse_element_first));
    line("control: it has the law first", cell(t.sparse_law_first));
    line("control: laws that it keeps, mean", figure(t.sparse_terms));
    line("seconds a set, of its controls", figure(t.seconds) + ", " + figure(t.control_seconds));
  }
  return text;
}

std::string trial_failures(std::span<const MismatchRecord> records) {
  std::string text;
  for (const MismatchRecord& r : records) {
    const bool null_set = r.hidden.empty() && r.wrong_value.empty();
    const bool value_missed = !r.wrong_value.empty() && detected(r) && !value_named(r);
    const bool wrong =
        !r.error.empty() || (null_set && detected(r)) || value_missed || (!r.hidden.empty() && !law_first(r));
    if (!wrong) continue;
    text += text::format("{} {}: hidden {}; {}, p {:.2g}, found {}{}{}\n", r.stratum, r.seed, hidden_text(r),
                         r.answer.verdict, r.answer.p_value, found_text(r.answer),
                         r.error.empty() ? "" : "; error: ", r.error);
  }
  return text;
}

}  // namespace sealwatch::verification
