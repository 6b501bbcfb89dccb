// `sealwatch asset new`: a first asset file, with its channel map, from somebody's own log (docs/logs.md).
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <optional>
#include <span>

#include "sealwatch/core/text.hpp"
#include "sealwatch/signal/noise_floor.hpp"
#include "services/cli/channel_guess.hpp"
#include "services/cli/commands.hpp"
#include "services/cli/session.hpp"
#include "services/cli/terminal.hpp"
#include "services/common/recording/cells.hpp"
#include "services/common/recording/columns.hpp"
#include "services/common/recording/recording_file.hpp"
#include "services/common/report/page.hpp"
#include "services/common/report/plot.hpp"
#include "services/common/runtime/asset_file.hpp"
#include "services/common/runtime/plant_file.hpp"
#include "services/common/text/readable.hpp"
#include "services/common/text/words.hpp"
#include "services/common/units/unit_conversion.hpp"

namespace sealwatch::cli {
namespace {

namespace fs = std::filesystem;

/// What was understood of a log.
struct Understood {
  Offer offer;
  const PlantDescription* plant = nullptr;
  ChannelMap map;
  std::vector<ChannelGuess> guesses;
  std::vector<Recording> tests;
  std::vector<std::string> remarks;
  std::string asset_id;  ///< as the log's sidecar has it: only then do the file and the log go together
};

const char* word_of(char sign) {
  return sign == ';' ? "semicolon" : sign == '\t' ? "tab" : sign == '|' ? "bar" : sign == ' ' ? "blank" : "comma";
}

void set_layout(Understood& log) {
  if (!log.offer.text) return;
  const FoundLayout& found = log.offer.layout;
  log.map.log.delimiter = word_of(found.delimiter);
  if (found.decimal_sign == DecimalSign::known) log.map.log.decimal = found.decimal == ',' ? "comma" : "point";
  log.map.log.header_row = static_cast<int>(found.header_row);
  log.map.log.units_row = static_cast<int>(found.units_row);
  log.map.log.first_row = static_cast<int>(found.first_row);
}

void set_columns(Understood& log) {
  const ColumnMapping time = log.map.columns["time"];
  log.map.columns = {{"time", time}};
  for (const ChannelGuess& guess : log.guesses)
    log.map.columns[guess.channel] = {.column = name_of_column(log.offer, guess.column), .unit = guess.unit};
}

/// Reads the log by the map; where its time starts anew or cells are empty, the map learns to say so.
Status read_by_map(const std::string& file, Understood& log) {
  for (;;) {
    Result<std::vector<Recording>> tests = read_recordings(file, *log.plant, log.map);
    if (tests) {
      log.tests = std::move(*tests);
      return {};
    }
    const std::string& rule = tests.error().rule;
    if (rule.starts_with("time goes back") && log.map.log.time_resets == "refuse") {
      log.map.log.time_resets = "split";
      log.remarks.emplace_back("its time restarts: each restart begins another test (time_resets: split; or join)");
    } else if (tests.error().advice.find("incomplete_rows: skip") != std::string::npos &&
               log.map.log.incomplete_rows == "refuse") {
      log.map.log.incomplete_rows = "skip";
      log.remarks.emplace_back(
          "rows with an empty cell, or one without a digit, in a used column are left out (incomplete_rows: skip)");
    } else {
      return fail(tests.error());
    }
  }
}

/// Asks for each channel which column it is; an empty line takes the guess.
void ask(Understood& log) {
  for (const ChannelDescription& channel : log.plant->channels) {
    const auto guess = std::ranges::find(log.guesses, channel.name, &ChannelGuess::channel);
    const std::string proposed = guess == log.guesses.end() ? "none" : log.offer.columns[guess->column].text;
    std::printf("%s [%s], %s: column %s? (Enter: yes, another column, or none) ", channel.name.c_str(),
                channel.unit.c_str(), channel.meaning.c_str(), proposed.c_str());
    std::fflush(stdout);
    std::string answer;
    if (!std::getline(std::cin, answer) || answer.empty()) continue;
    if (guess != log.guesses.end()) log.guesses.erase(guess);
    if (answer == "none") continue;
    const Result<std::size_t> column = find_offered(log.offer.columns, answer);
    if (!column) {
      complain(column.error());
      continue;
    }
    std::string unit = unit_for(log.offer.columns[*column], channel);
    if (unit.empty()) {
      std::printf("  its unit? (Enter: %s) ", channel.unit.c_str());
      std::fflush(stdout);
      std::getline(std::cin, unit);
    }
    log.guesses.push_back({channel.name, *column, unit, 0.0, true});
  }
}

std::string range_text(const std::vector<Recording>& tests, const std::string& channel) {
  double low = 0.0, high = 0.0;
  bool any = false;
  std::string unit;
  for (const Recording& test : tests)
    if (const Series* series = test.samples.find(channel)) {
      const auto [least, most] = std::ranges::minmax(series->values);
      low = any ? std::min(low, least) : least, high = any ? std::max(high, most) : most;
      any = true, unit = series->unit;
    }
  return any ? text::readable(low, unit) + " to " + text::readable(high, unit) : "";
}

std::string left_aside(const Understood& log) {
  return log.tests.empty() ? "" : text::joined(log.tests.front().left_aside);
}

std::string mapping_text(const ColumnMapping& mapping) {
  std::string text = "{column: " + text::quoted(mapping.column);
  if (!mapping.unit.empty()) text += ", unit: " + text::quoted(mapping.unit);
  if (mapping.is_scaled) text += ", scale: " + number(mapping.scale);
  return text + "}";
}

/// What an asset file that stands in `folder` calls the plant.
std::string model_name(const PlantDescription& plant, const fs::path& folder) {
  if (plant.file.empty()) return plant.name;
  std::error_code ignored;
  return fs::relative(plant.file, folder.empty() ? "." : folder, ignored).string();
}

std::string columns_text(const Understood& log, const std::vector<std::size_t>& columns) {
  std::string text;
  for (const std::size_t column : columns) text::add_to_list(text, log.offer.columns[column].text);
  return text;
}

/// "PT-1 [psig] may be it, but '1,234.5' in row 7 is not a number": of the first column in a unit of the channel, or of
/// its name, that has cells without numbers.
std::string unreadable(const Understood& log, const ChannelDescription& channel) {
  for (std::size_t column = 0; column < log.offer.columns.size(); ++column) {
    const std::string unit = unit_of(log.offer.columns[column]);
    const bool of_its_unit = !unit.empty() && convert_unit(unit, channel.unit.empty() ? "1" : channel.unit);
    if ((!of_its_unit && !is_named_like(log.offer.columns[column], channel)) || has_numbers(log.offer, column))
      continue;
    const auto word = std::ranges::find_if(log.offer.cells[column], [&](const std::string& cell) {
      return !parse_number(cell, log.offer.layout.decimal).has_value();
    });
    if (word != log.offer.cells[column].end())
      return log.offer.columns[column].text + " may be it, but '" + printable(*word) + "' in row " +
             std::to_string(log.offer.rows[column][static_cast<std::size_t>(word - log.offer.cells[column].begin())]) +
             " is not a number";
  }
  return "";
}

/// The columns that may be a channel that was not found, and what to write for it; "" where there is none.
std::string may_be_it(const Understood& log, const ChannelDescription& channel) {
  if (std::string why = unreadable(log, channel); !why.empty()) return why;
  const std::size_t time = time_column(log.offer);
  const std::vector<std::size_t> columns = columns_of_unit(log.offer, channel, time, log.guesses);
  if (!columns.empty()) {
    const OfferedColumn& first = log.offer.columns[columns.front()];
    return "as " + mapping_text({.column = first.text, .unit = unit_for(first, channel)}) +
           (columns.size() > 1 ? "; of that unit: " + columns_text(log, columns) : "");
  }
  const std::vector<std::size_t> plain = plain_columns(log.offer, channel, time, log.guesses);
  if (plain.empty()) return "";
  const std::string unit = ", unit: " + text::quoted(channel.unit) + "}";
  const OfferedColumn& first = log.offer.columns[plain.front()];
  const bool percent = unit_for(first, channel) == "%";
  return "as {column: " + text::quoted(first.text) + (percent ? ", scale: 0.01" : ", scale: 1") + unit +
         (percent ? ", with a hundredth of what 100 % is in place of 0.01" : ", with what one count is in place of 1") +
         (plain.size() > 1 ? "; plain numbers: " + columns_text(log, plain) : "");
}

/// What to write for a channel that was not found.
std::string by_hand(const Understood& log, const ChannelDescription& channel) {
  const std::string may_be = may_be_it(log, channel);
  return may_be.empty() ? "as {column: NAME, scale: 1, unit: " + text::quoted(channel.unit) + "}" : may_be;
}

std::string why_no_unit(const std::string& header) {
  const std::size_t open = header.rfind('('), end = header.find_last_of(" _");
  if (header.ends_with(')') && open != std::string::npos) return header.substr(open) + " is not a known unit";
  const std::string last = end == std::string::npos ? "" : header.substr(end + 1);
  if (last.size() > 1 && is_unit(last)) return "'" + last + "' may be its unit, of another quantity";  // P1_mA
  return "the log gives no unit";
}

/// What the reader has to check of a channel that was found; "": nothing.
std::string doubt(const Understood& log, const ChannelDescription& channel) {
  const auto guess = std::ranges::find(log.guesses, channel.name, &ChannelGuess::channel);
  if (guess == log.guesses.end()) return "";
  std::string doubts = guess->sure ? "" : "uncertain, check it";
  if (guess->unit.empty() && channel.unit != "1")
    doubts.append(doubts.empty() ? "" : "; ")
        .append(why_no_unit(log.offer.columns[guess->column].text))
        .append(": taken for " + channel.unit + ", check it");
  return doubts;
}

/// Of a log whose names say nothing, CH1, CH2: its columns, and for each channel the line to complete.
Error nothing_like_a_channel(const Understood& log, const AssetNewOptions& options) {
  constexpr std::size_t kMostNamed = 30;
  std::vector<std::string> columns, lines;
  // Not std::views: clang 14, whose clang-tidy reads this, cannot compile them.
  const std::span offered(log.offer.columns);
  for (const OfferedColumn& column : offered.first(std::min(kMostNamed, offered.size())))
    columns.push_back(column.text);
  if (log.offer.columns.size() > kMostNamed)
    columns.push_back("and " + std::to_string(log.offer.columns.size() - kMostNamed) + " more");
  if (options.model.empty())
    return Error{.file = options.log,
                 .place = {},
                 .value = {},
                 .rule = "its columns look like no channel of a built-in plant",
                 .advice =
                     "describe your plant in a file (docs/tutorial-plant.md) and give --model PLANT.yaml; the "
                     "log's columns are " +
                     text::separated(columns, ", ")};
  lines.push_back("time: " + mapping_text(log.map.columns.at("time")));
  for (const ChannelDescription& channel : log.plant->channels) {
    const std::string line = by_hand(log, channel);
    lines.push_back(channel.name + ": " + line.substr(line.starts_with("as ") ? 3 : 0));
  }
  const std::string pivot = log.offer.names ? "where each row has one value, named in column " +
                                                  text::quoted(log.offer.columns[*log.offer.names].text) +
                                                  ", give each name a column of its own (a pivot table); else "
                                            : "";
  return Error{.file = options.log,
               .place = {},
               .value = {},
               .rule = "no column looks like a channel of plant " + log.plant->name,
               .advice = pivot +
                         "write the map by hand (docs/logs.md), or name another plant with --model; the log's columns "
                         "are " +
                         text::separated(columns, ", ") + "; under channels: " + text::separated(lines, "; ")};
}

/// Whose asset it is: as given, as the log's sidecar says, else the log's name.
std::string asset_id_of(const Understood& log, const AssetNewOptions& options) {
  const std::string& named = options.asset_id.empty() ? log.asset_id : options.asset_id;
  return named.empty() ? fs::path(options.log).stem().string() : named;
}

/// The section `log`; of vectors, which have no rows of text, what became of their samples alone.
std::string layout_yaml(const Understood& log) {
  const LogLayout& layout = log.map.log;
  std::string out;
  if (log.offer.text) {
    out += "  delimiter: " + layout.delimiter + "\n";
    if (!layout.decimal.empty()) out += "  decimal: " + layout.decimal + "\n";
    if (layout.header_row > 0) out += "  header_row: " + std::to_string(layout.header_row) + "\n";
    if (layout.units_row > 0) out += "  units_row: " + std::to_string(layout.units_row) + "\n";
    out += "  first_row: " + std::to_string(layout.first_row) + "\n";
  }
  if (layout.time_resets != "refuse") out += "  time_resets: " + layout.time_resets + "\n";
  if (layout.incomplete_rows != "refuse") out += "  incomplete_rows: " + layout.incomplete_rows + "\n";
  return out.empty() ? out : "\nlog:\n" + out;
}

std::string yaml_of(const Understood& log, const AssetNewOptions& options) {
  const std::string model = model_name(*log.plant, fs::path(options.file).parent_path());
  std::string out = "# Written from " + fs::path(options.log).filename().string() +
                    ". Correct what is wrong (docs/logs.md, docs/asset-file.md).\n";
  for (const std::string& remark : log.remarks) out += "# " + remark + "\n";
  out +=
      "asset_id: " + text::quoted(asset_id_of(log, options)) + "\nmodel: " + model + "  # " + log.plant->meaning + "\n";
  out += "# Parameters that you leave out keep the plant's defaults; give yours in SI units, such as\n# parameters: {";
  for (std::size_t k = 0; k < std::min<std::size_t>(3, log.plant->parameters.size()); ++k)
    out.append(k > 0 ? ", " : "")
        .append(log.plant->parameters[k].name)
        .append(": ")
        .append(number(log.plant->parameters[k].value));
  out += "}\n\nchannels:\n  time: " + mapping_text(log.map.columns.at("time")) + "\n";
  for (const ChannelDescription& channel : log.plant->channels) {
    const auto mapping = log.map.columns.find(channel.name);
    if (mapping == log.map.columns.end()) {
      out += "  # " + channel.name + ": not found in the log; " + channel.meaning + "; " + by_hand(log, channel) + "\n";
      continue;
    }
    out += "  " + channel.name + ": " + mapping_text(mapping->second) + "  # " + range_text(log.tests, channel.name);
    const std::string check = doubt(log, channel);
    out += (check.empty() ? "" : "; " + check) + "\n";
  }
  out += layout_yaml(log);
  if (const std::string aside = left_aside(log); !aside.empty()) out += "# left aside: " + aside + "\n";
  return out;
}

std::string page_of(const Understood& log, const std::string& file) {
  report::Table table({"channel", "column of the log", "unit", "range", "noise from sample to sample"});
  std::string plots;
  const Recording& test = log.tests.front();
  for (const Series& channel : test.samples.channels) {
    const auto mapping = log.map.columns.find(channel.name);
    const bool mapped = mapping != log.map.columns.end();
    table.row({text::in_words(channel.name), mapped ? mapping->second.column : channel.name,
               mapped ? mapping->second.unit : "", range_text(log.tests, channel.name),
               text::readable(signal::estimate_noise_floor(channel.values, test.samples.time_s).standard_deviation,
                              channel.unit, 2)});
    plots += "<div>" +
             report::to_svg({.title = text::in_words(channel.name),
                             .x = {.label = "time", .unit = "s"},
                             .y = {.label = text::in_words(channel.name), .unit = channel.unit},
                             .marks = {report::Line{.x = test.samples.time_s, .y = channel.values}},
                             .height = 180,
                             .legend = false}) +
             "</div>";
  }
  std::string body = "<h1>" + report::escaped(fs::path(file).filename().string()) + " as " +
                     report::escaped(log.plant->name) + "</h1>";
  for (const std::string& remark : log.remarks) body += report::paragraph(remark);
  if (const std::string aside = left_aside(log); !aside.empty())
    body += report::paragraph("Left aside: " + aside, "muted");
  return report::html_page("What was understood of a log",
                           body + table.html() + "<div class=\"plots\">" + plots + "</div>");
}

/// Inputs and outputs of the plant that no column was taken for, and why; what nothing in the log may be, in one line.
void print_not_found(const Understood& log, const std::string& file) {
  std::string absent;
  for (const ChannelDescription& channel : log.plant->channels) {
    if (log.map.columns.contains(channel.name)) continue;
    const std::string name = channel.name + " [" + channel.unit + "]";
    const std::string may_be = may_be_it(log, channel);
    if (may_be.empty())
      text::add_to_list(absent, name + (channel.input ? " (input)" : ""));
    else
      std::printf("  %s %s not found in %s: %s\n", channel.input ? "input" : "output", name.c_str(), file.c_str(),
                  may_be.c_str());
  }
  if (!absent.empty())
    std::printf("  no column of %s has the unit of %s; map by hand what the log has (docs/logs.md)\n", file.c_str(),
                absent.c_str());
}

void print_table(const Understood& log, const std::string& file) {
  const FoundLayout& found = log.offer.layout;
  if (log.offer.text)
    std::printf("%s between columns, decimal %s, header in row %zu, numbers from row %zu\n", word_of(found.delimiter),
                found.decimal == ',' ? "comma" : "point", found.header_row, found.first_row);
  std::vector<std::size_t> sizes;
  for (const Recording& test : log.tests) sizes.push_back(test.samples.time_s.size());
  const auto [least, most] = std::ranges::minmax(sizes);
  const std::string samples = (least < most ? std::to_string(least) + " to " : "") + std::to_string(most);
  std::printf("plant %s, %s of %s samples\n", log.plant->name.c_str(), count_of(log.tests.size(), "test").c_str(),
              samples.c_str());
  std::printf("  %-24s %-30s %-12s %s\n", "channel", "column", "unit", "range");
  const auto line = [&](const std::string& channel, const ColumnMapping& mapping, const std::string& range) {
    std::printf("  %s %s %s %s\n", padded(channel, 24).c_str(), padded(mapping.column, 30).c_str(),
                padded(mapping.unit, 12).c_str(), range.c_str());
  };
  line("time", log.map.columns.at("time"), "");
  for (const ChannelDescription& channel : log.plant->channels) {
    const auto mapping = log.map.columns.find(channel.name);
    if (mapping == log.map.columns.end()) continue;
    const std::string check = doubt(log, channel);
    line(channel.name, mapping->second, range_text(log.tests, channel.name) + (check.empty() ? "" : "; " + check));
  }
  print_not_found(log, file);
  for (const std::string& remark : log.remarks) std::printf("  %s\n", remark.c_str());
  if (const std::string aside = left_aside(log); !aside.empty()) std::printf("  left aside: %s\n", aside.c_str());
}

/// Whether an input mostly stays as it is and else jumps, as a switch does: between two samples it is then no ramp.
bool is_switched(const Series& input) {
  constexpr double kJump = 0.1;  // of the range
  constexpr std::size_t kFewestJumps = 3;
  const auto [least, most] = std::ranges::minmax(input.values);
  std::size_t stays = 0, jumps = 0, in_a_row = 0;
  bool jumped = false;
  for (std::size_t k = 1; k < input.values.size(); ++k) {
    const double change = std::abs(input.values[k] - input.values[k - 1]);
    const bool jump = change > kJump * (most - least);
    stays += change == 0.0 ? 1 : 0;
    jumps += jump ? 1 : 0;
    in_a_row += jump && jumped ? 1 : 0;
    jumped = jump;
  }
  return jumps >= kFewestJumps && jumps <= stays && 4 * in_a_row <= jumps && stays + jumps + 1 == input.values.size();
}

void note_switched_inputs(Understood& log) {
  for (const ChannelDescription& channel : log.plant->channels) {
    const Series* series = log.tests.front().samples.find(channel.name);
    if (channel.input && !channel.hold && series != nullptr && is_switched(*series))
      log.remarks.push_back(channel.name +
                            " stays and jumps, as a switch does, and is taken as a ramp from sample to sample: where "
                            "it holds until the next sample, write 'course: held' in the plant's file");
  }
}

/// Where rows are absent: what is simulated there is held against nothing, and an input is a ramp.
void note_gaps(Understood& log) {
  constexpr double kHides = 1.7;  // usual steps; as data acquisition counts them
  double longest_s = 0.0, after_s = 0.0, step_s = 0.0;
  std::size_t gaps = 0, test = 0;
  for (std::size_t k = 0; k < log.tests.size(); ++k) {
    const std::vector<double>& time_s = log.tests[k].samples.time_s;
    const double usual_s = usual_step(time_s);
    for (std::size_t row = 1; row < time_s.size(); ++row) {
      const double gap_s = time_s[row] - time_s[row - 1];
      if (!(gap_s > kHides * usual_s)) continue;
      ++gaps;
      if (gap_s > longest_s) longest_s = gap_s, after_s = time_s[row - 1], step_s = usual_s, test = k + 1;
    }
  }
  if (gaps == 0) return;
  log.remarks.push_back(
      count_of(gaps, "gap") + " between rows that are usually " + text::readable(step_s, "s") +
      " apart: the longest, " + text::readable(longest_s, "s") + ", after " + text::readable(after_s, "s") +
      (log.tests.size() > 1 ? " of test " + std::to_string(test) : "") + "; inputs are taken as ramps across them");
}

/// A number that stands in some rows, farther from all others than they are from each other: for no value, as -9999.
std::optional<std::size_t> rows_of_fill_value(const Series& channel, double& fill) {
  constexpr double kFar = 10.0;  // ranges of the other numbers
  for (const bool lowest : {true, false}) {
    const auto [low, high] = std::ranges::minmax(channel.values);
    fill = lowest ? low : high;
    double least = lowest ? high : low, most = least;
    std::size_t rows = 0;
    for (const double value : channel.values)
      if (value == fill)
        ++rows;
      else
        least = std::min(least, value), most = std::max(most, value);
    const double distance = lowest ? least - fill : fill - most;
    if (rows > 0 && rows < channel.values.size() / 2 && most > least && distance > kFar * (most - least)) return rows;
  }
  return std::nullopt;
}

void note_fill_values(Understood& log) {
  for (const Series& channel : log.tests.front().samples.channels) {
    double fill = 0.0;
    if (const auto rows = rows_of_fill_value(channel, fill))
      log.remarks.push_back(channel.name + " is " + text::readable(fill, channel.unit) + " in " +
                            count_of(*rows, "row") +
                            ", far from all others: where that stands for no value, empty "
                            "those cells, and log: {incomplete_rows: skip}");
  }
}

/// A file that is there may have been completed by hand: it is never written over.
Status write_new(const std::string& file, const std::string& text) {
  std::FILE* stream = std::fopen(file.c_str(), "wx");
  const bool written = stream != nullptr && std::fwrite(text.data(), 1, text.size(), stream) == text.size();
  if (stream != nullptr && std::fclose(stream) == 0 && written) return {};
  std::error_code ignored;
  const bool there = stream == nullptr && fs::exists(file, ignored);
  return fail(Error{.file = file,
                    .place = {},
                    .value = {},
                    .rule = there ? "is there already" : "cannot be written",
                    .advice = there ? "give another name with --out" : ""});
}

/// Whether `file` would be read as the sidecar of `log`: an asset file there makes the log unreadable.
bool is_sidecar(const std::string& file, const std::string& log) {
  std::error_code ignored;
  const fs::path sidecar = fs::path(log).replace_extension(".yaml");
  return fs::weakly_canonical(file, ignored) == fs::weakly_canonical(sidecar, ignored);
}

/// A plant that is built in, or a plant file.
Result<const PlantDescription*> named_plant(const std::string& model) {
  if (!is_plant_file(model)) return find_plant(model);
  std::error_code ignored;
  if (!fs::is_regular_file(model, ignored))
    return fail(Error{.file = model, .place = {}, .value = {}, .rule = "is not a file", .advice = "--model"});
  const auto plant = load_plant(model);
  if (!plant) return fail(combine(plant.error()));
  return *plant;
}

/// Of "3/4/2031" nobody can tell whether it is in April or in March.
void note_doubtful_date(Understood& log) {
  const ColumnMapping& time = log.map.columns.at("time");
  const std::size_t day = time.unit.find("%d/%m/");
  if (day == std::string::npos) return;
  const std::size_t plus = time.column.find(kDayAndTime);
  std::optional<std::size_t> apart;
  if (plus != std::string::npos && !find_offered(log.offer.columns, time.column))
    if (const Result<std::size_t> found = find_offered(log.offer.columns, time.column.substr(0, plus))) apart = *found;
  const std::vector<std::string>& cells = log.offer.cells[apart ? *apart : time_column(log.offer)];
  std::string other = time.unit;
  other.replace(day, 6, "%m/%d/");
  const std::string pattern = apart ? other.substr(0, other.find(' ')) : other;
  const auto fits = [&](const std::string& cell) { return parse_pattern(cell, pattern).has_value(); };
  if (!cells.empty() && std::ranges::all_of(cells, fits))
    log.remarks.push_back("the time " + printable(cells.front()) +
                          " is taken for day/month: where it is month/day, write '" + other + "' as its unit");
}

/// A clock without a day, and the day in a column of its own, which is not read: the test's start is then not known.
void note_day_elsewhere(Understood& log) {
  const Result<TimeFormat> format = TimeFormat::of(log.map.columns.at("time").unit);
  if (!format || !format->is_absolute() || log.tests.front().start_time) return;
  for (const OfferedColumn& column : log.offer.columns)
    if (const std::string name = split_header_cell(column.text).name;
        name == "Date" || name == "date" || name == "Datum")
      log.remarks.push_back("the day in column " + name +
                            " is not read: give the test's start_time in the log's sidecar");
}

/// A time whose unit is a guess, above all where the column is called no time and its numbers only rise.
void note_unit_of_time(Understood& log, std::size_t time) {
  const ColumnMapping& mapping = log.map.columns.at("time");
  const Result<TimeFormat> format = TimeFormat::of(mapping.unit);
  const bool said = !unit_of(log.offer.columns[time]).empty() || seconds_of_one(log.offer.columns[time]);
  const bool count = !format || !format->is_absolute() || mapping.unit.find(" since ") != std::string::npos;
  if (said || !count) return;
  const std::string steps = "{column: " + text::quoted(mapping.column) + ", unit: s, scale: SECONDS_BETWEEN_SAMPLES}";
  log.remarks.push_back("the log gives no unit for the time, column " + text::quoted(mapping.column) + ": taken for " +
                        mapping.unit + (counts_by_one(log.offer, time) ? "; if it counts samples: " + steps : ""));
}

/// How far the plant can be relied on: with columns named as its channels, or by units that any machine may have.
void note_guessed_plant(Understood& log) {
  const bool named = std::ranges::any_of(log.guesses, &ChannelGuess::sure);
  log.remarks.insert(
      log.remarks.begin(),
      named
          ? "plant " + log.plant->name +
                " is a guess: of the built-in plants it fits the columns best; for another plant give --model FILE.yaml"
          : "plant " + log.plant->name +
                " was chosen by the units alone and is probably not your machine; describe yours in a file "
                "(docs/tutorial-plant.md) and give --model FILE.yaml");
}

/// Inputs of the plant that the log does not have.
void note_missing_inputs(Understood& log) {
  std::string missing;
  for (const ChannelDescription& channel : log.plant->channels)
    if (channel.input && !log.map.columns.contains(channel.name)) text::add_to_list(missing, channel.name);
  if (!missing.empty())
    log.remarks.push_back("plant " + log.plant->name + " cannot be simulated as a whole: the log lacks its input " +
                          missing);
}

Result<Understood> understand(const AssetNewOptions& options) {
  Result<Offer> offer = offer_of(options.log, {});
  if (!offer) return fail(offer.error());
  if (!has_time(*offer))
    return fail(Error{.file = options.log,
                      .place = {},
                      .value = {},
                      .rule = "no column is a time: none has such a name, holds clock times or rises from row to row",
                      .advice = "write the map by hand (docs/logs.md): of rows a fixed time apart it is "
                                "time: {column: row, unit: s, scale: SECONDS_BETWEEN_ROWS}"});
  Understood log;
  log.offer = std::move(*offer);
  log.map.columns["time"] = guess_time(log.offer);
  const std::size_t time = time_column(log.offer);
  const Result<const PlantDescription*> wanted =
      options.model.empty() ? &guess_plant(log.offer, time) : named_plant(options.model);
  if (!wanted) return fail(wanted.error());
  log.plant = *wanted;
  if (time == kNoColumn)
    log.remarks.push_back("no column holds times: the rows are taken as " +
                          text::readable(log.map.columns["time"].scale, "s") + " apart, as the log's head says");
  else
    note_unit_of_time(log, time);
  log.guesses = guess_channels(log.offer, *log.plant, time);
  if (!options.yes && isatty(STDIN_FILENO) != 0) ask(log);
  set_layout(log);
  set_columns(log);
  if (options.model.empty()) note_guessed_plant(log);
  if (log.guesses.empty()) return fail(nothing_like_a_channel(log, options));
  if (const Status read = read_by_map(options.log, log); !read) return fail(read.error());
  note_missing_inputs(log);
  note_switched_inputs(log);
  note_gaps(log);
  note_fill_values(log);
  note_doubtful_date(log);
  note_day_elsewhere(log);
  const Result<std::string> recorded = recorded_asset_id(options.log);
  if (!recorded) return fail(recorded.error());
  log.asset_id = *recorded;
  return log;
}

}  // namespace

int run_asset_new(const AssetNewOptions& options) {
  if (is_sidecar(options.file, options.log))
    return complain(Error{.file = options.file,
                          .place = {},
                          .value = {},
                          .rule = "is the name of this log's sidecar (docs/recordings.md)",
                          .advice = "give another name with --out"}),
           kBadInput;
  const Result<Understood> log = understand(options);
  if (!log) return complain(log.error()), kBadInput;
  if (const Status written = write_new(options.file, yaml_of(*log, options)); !written)
    return complain(written.error()), kBadInput;
  if (const Result<AssetConfig> back = load_asset(options.file); !back) return complain(back.error()), kInternalFailure;
  const std::string page = fs::path(options.file).replace_extension(".html").string();
  std::ofstream(page, std::ios::binary) << page_of(*log, options.log);
  print_table(*log, options.log);
  const std::string id = asset_id_of(*log, options);
  const char* from = !options.asset_id.empty() ? ""
                     : !log->asset_id.empty()  ? ", from the log's sidecar"
                                               : ", from the log's name";
  std::printf("  asset id: %s%s; change it under asset_id in %s, or give --id\n", id.c_str(), from,
              options.file.c_str());
  std::printf("wrote %s, and plots of it to %s. Correct what is wrong, then try\n  sealwatch fit --asset %s %s\n",
              options.file.c_str(), page.c_str(), options.file.c_str(), options.log.c_str());
  return kOk;
}

}  // namespace sealwatch::cli
