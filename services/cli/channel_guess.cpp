#include "services/cli/channel_guess.hpp"

#include <algorithm>
#include <cctype>
#include <functional>
#include <map>
#include <set>

#include "services/common/recording/cells.hpp"
#include "services/common/units/unit_conversion.hpp"

namespace sealwatch::cli {
namespace {

/// What engineers call a quantity, by the SI unit of its channel: English, German, ISA letters.
const std::map<std::string, std::set<std::string>>& vocabulary() {
  static const std::map<std::string, std::set<std::string>> words = {
      {"Pa", {"p", "press", "pressure", "druck", "pt", "pi", "pit"}},
      {"m", {"x", "pos", "position", "stroke", "travel", "displacement", "weg", "hub", "zt", "lvdt"}},
      {"m/s", {"v", "vel", "velocity", "speed", "geschwindigkeit"}},
      {"m3/s", {"q", "flow", "durchfluss", "volumenstrom", "ft", "fi", "fit"}},
      {"V", {"u", "volt", "voltage", "spannung", "command", "cmd"}},
      {"A", {"i", "amp", "amps", "current", "strom"}},
      {"rad/s", {"n", "rpm", "omega", "speed", "drehzahl"}},
      {"rad", {"angle", "winkel", "phi"}},
      {"K", {"temp", "temperature", "temperatur", "tt", "ti"}},
      {"N", {"f", "force", "load", "kraft"}},
      {"N m", {"torque", "moment", "drehmoment"}}};
  return words;
}

/// "PT-101A Druck" as pt, 101, a, druck.
std::vector<std::string> tokens_of(const std::string& text) {
  std::vector<std::string> tokens;
  char before = ' ';
  for (const char letter : text) {
    const auto byte = static_cast<unsigned char>(letter);
    const bool digit = std::isdigit(byte) != 0, alpha = std::isalpha(byte) != 0 || byte >= 0x80;
    const bool goes_on = (digit && std::isdigit(static_cast<unsigned char>(before)) != 0) ||
                         (alpha && (std::isalpha(static_cast<unsigned char>(before)) != 0 ||
                                    static_cast<unsigned char>(before) >= 0x80));
    if (!goes_on && (digit || alpha)) tokens.emplace_back();
    if (digit || alpha) tokens.back() += static_cast<char>(std::tolower(byte));
    before = letter;
  }
  return tokens;
}

/// Chambers and ports are letters to some and numbers to others.
std::string as_letter(const std::string& token) {
  return token.size() == 1 && token[0] >= '1' && token[0] <= '9'
             ? std::string(1, static_cast<char>('a' + token[0] - '1'))
             : token;
}

bool same_word(const std::string& a, const std::string& b) {
  constexpr std::size_t kAbbreviation = 3;
  if (as_letter(a) == as_letter(b)) return true;
  const std::size_t shorter = std::min(a.size(), b.size());
  return shorter >= kAbbreviation && a.compare(0, shorter, b, 0, shorter) == 0;
}

/// Share of the channel's words that the column has, and of those of the column that the channel has.
double likeness(const std::vector<std::string>& column, const std::vector<std::string>& channel) {
  const auto has = [](const std::vector<std::string>& words, const std::string& word) {
    return std::ranges::any_of(words, [&](const std::string& other) { return same_word(word, other); });
  };
  const auto share = [&](const std::vector<std::string>& of, const std::vector<std::string>& in) {
    const auto found = std::ranges::count_if(of, [&](const std::string& word) { return has(in, word); });
    return of.empty() ? 0.0 : static_cast<double>(found) / static_cast<double>(of.size());
  };
  return share(channel, column) + 0.5 * share(column, channel);
}

bool within_range(const Offer& offer, std::size_t column, const ChannelDescription& channel,
                  const UnitConversion& to_si) {
  if (channel.range_max <= channel.range_min || offer.cells[column].empty()) return true;
  return std::ranges::all_of(offer.cells[column], [&](const std::string& cell) {
    const Result<double> number = parse_number(cell, offer.layout.decimal);
    return number && to_si.to_si(*number) >= channel.range_min && to_si.to_si(*number) <= channel.range_max;
  });
}

/// "CH2" for pressure_b: a letter or a number tells apart what a word, a quantity or a unit says, and says nothing alone.
bool share_but_a_letter(const std::vector<std::string>& column, const std::vector<std::string>& channel) {
  const auto is_shared = [&](const std::string& word) {
    return std::ranges::any_of(column, [&](const std::string& other) { return same_word(word, other); });
  };
  return channel.size() > 1 &&
         std::ranges::none_of(channel, [&](const auto& word) { return word.size() > 1 && is_shared(word); });
}

double score_of_name(const OfferedColumn& column, const ChannelDescription& channel, bool has_unit) {
  constexpr double kName = 2.0, kQuantity = 1.0;
  const std::vector<std::string> words = tokens_of(split_header_cell(column.text).name);
  const auto known = vocabulary().find(channel.unit.empty() ? "1" : channel.unit);
  const bool quantity = known != vocabulary().end() && std::ranges::any_of(words, [&](const std::string& word) {
                          return known->second.contains(word);
                        });
  if (!quantity && !has_unit && share_but_a_letter(words, tokens_of(channel.name))) return 0.0;
  return kName * likeness(words, tokens_of(channel.name)) + (quantity ? kQuantity : 0.0);
}

/// How much speaks for it; 0: nothing, or its unit speaks against it.
double score_of(const Offer& offer, std::size_t column, const ChannelDescription& channel) {
  constexpr double kUnit = 1.0, kRange = 0.25;
  const std::string si = channel.unit.empty() ? "1" : channel.unit, unit = unit_for(offer.columns[column], channel);
  const Result<UnitConversion> to_si = convert_unit(unit, si);
  if (!to_si) return 0.0;
  if (!has_numbers(offer, column)) return 0.0;
  const double score = score_of_name(offer.columns[column], channel, !unit.empty());
  if (score <= 0.0) return 0.0;
  return score + (unit.empty() || si == "1" ? 0.0 : kUnit) +
         (within_range(offer, column, channel, *to_si) ? kRange : 0.0);
}

constexpr double kEnough = 1.2;  // more than a unit, or than a word in passing

bool is_taken(const std::vector<ChannelGuess>& guesses, std::size_t column) {
  return std::ranges::find(guesses, column, &ChannelGuess::column) != guesses.end();
}

/// Whatever a column is called: its unit says which channel it is where no other column and no other channel has such.
void add_by_unit_alone(const Offer& offer, const PlantDescription& plant, std::size_t time_column,
                       std::vector<ChannelGuess>& guesses) {
  std::map<std::size_t, std::vector<std::string>> channels_of;  // column
  std::vector<ChannelGuess> only;
  for (const ChannelDescription& channel : plant.channels) {
    if (std::ranges::find(guesses, channel.name, &ChannelGuess::channel) != guesses.end()) continue;
    const std::vector<std::size_t> columns = columns_of_unit(offer, channel, time_column, guesses);
    for (const std::size_t column : columns) channels_of[column].push_back(channel.name);
    if (columns.size() == 1)
      only.push_back({channel.name, columns.front(), unit_for(offer.columns[columns.front()], channel), 0.0, false});
  }
  for (const ChannelGuess& guess : only)
    if (channels_of.at(guess.column).size() == 1) guesses.push_back(guess);
}

}  // namespace

bool is_named_like(const OfferedColumn& column, const ChannelDescription& channel) {
  return likeness(tokens_of(split_header_cell(column.text).name), tokens_of(channel.name)) > 1.0;
}

std::string unit_for(const OfferedColumn& column, const ChannelDescription& channel) {
  const std::string said = unit_of(column);
  const bool plain = channel.unit.empty() || channel.unit == "1";
  if (!said.empty()) return plain && !is_unit(said) ? "1" : said;
  return unit_at_the_end(column.text, channel.unit);
}

std::vector<std::size_t> columns_of_unit(const Offer& offer, const ChannelDescription& channel, std::size_t time_column,
                                         const std::vector<ChannelGuess>& guesses) {
  std::vector<std::size_t> columns;
  for (std::size_t column = 0; column < offer.columns.size(); ++column) {
    const std::string unit = unit_for(offer.columns[column], channel);
    if (column == time_column || is_taken(guesses, column) || unit.empty() || unit == "1") continue;
    if (convert_unit(unit, channel.unit.empty() ? "1" : channel.unit) && has_numbers(offer, column))
      columns.push_back(column);
  }
  return columns;
}

std::vector<std::size_t> plain_columns(const Offer& offer, const ChannelDescription& channel, std::size_t time_column,
                                       const std::vector<ChannelGuess>& guesses) {
  std::vector<std::size_t> columns;
  for (std::size_t column = 0; column < offer.columns.size(); ++column) {
    const std::string unit = unit_for(offer.columns[column], channel);
    if (column == time_column || is_taken(guesses, column) || unit.empty()) continue;
    if (convert_unit(unit, "1") && has_numbers(offer, column)) columns.push_back(column);
  }
  std::ranges::stable_sort(columns, std::greater{},
                           [&](std::size_t column) { return score_of_name(offer.columns[column], channel, true); });
  return columns;
}

std::vector<ChannelGuess> guess_channels(const Offer& offer, const PlantDescription& plant, std::size_t time_column) {
  std::vector<ChannelGuess> all;
  for (std::size_t column = 0; column < offer.columns.size(); ++column) {
    if (column == time_column) continue;
    for (const ChannelDescription& channel : plant.channels)
      if (const double score = score_of(offer, column, channel); score > kEnough)
        all.push_back({channel.name, column, unit_for(offer.columns[column], channel), score, true});
  }
  std::ranges::stable_sort(all, [](const ChannelGuess& a, const ChannelGuess& b) { return a.score > b.score; });
  std::vector<ChannelGuess> taken;
  for (const ChannelGuess& guess : all) {
    const auto clashes = [&](const ChannelGuess& other) {
      return other.channel == guess.channel || other.column == guess.column;
    };
    if (std::ranges::any_of(taken, clashes)) continue;
    taken.push_back(guess);
    taken.back().sure = std::ranges::none_of(all, [&](const ChannelGuess& other) {
      return other.score == guess.score && (other.channel == guess.channel) != (other.column == guess.column);
    });
  }
  add_by_unit_alone(offer, plant, time_column, taken);
  return taken;
}

const PlantDescription& guess_plant(const Offer& offer, std::size_t time_column) {
  const PlantDescription* best = &all_plants().front();
  double most = 0.0;
  for (const PlantDescription& plant : all_plants()) {
    double score = 0.0;
    std::vector<ChannelGuess> guesses = guess_channels(offer, plant, time_column);
    std::erase_if(guesses, [](const ChannelGuess& guess) { return guess.score <= 0.0; });
    for (const ChannelGuess& guess : guesses) score += guess.score;
    for (const ChannelDescription& channel :
         plant.channels)  // what a plant wants and the log has not, its input above all
      if (std::ranges::find(guesses, channel.name, &ChannelGuess::channel) == guesses.end())
        score -= channel.input ? 0.5 : 0.05;
    if (score > most) most = score, best = &plant;
  }
  return *best;
}

}  // namespace sealwatch::cli
