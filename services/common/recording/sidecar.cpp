#include "services/common/recording/sidecar.hpp"

#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "sealwatch/core/asset_id.hpp"
#include "sealwatch/core/longest_id.hpp"
#include "sealwatch/core/text.hpp"
#include "sealwatch/core/visible_text.hpp"

namespace sealwatch {
namespace {

const std::vector<std::string> kKeys = {"recording_id", "asset_id",      "test", "start_time",
                                        "noise_std",    "interpolation", "note"};

struct KeyValue {
  std::string key;  ///< with its parents: "noise_std.pressure_a"
  YAML::Node value;
  int line = 0;  ///< 1 for the first
};

std::string place_of(int line, const std::string& key) {
  const std::string where = line > 0 ? "line " + std::to_string(line) : "";
  return key.empty() ? where : where + ", key " + printable(key);
}

Error key_error(const KeyValue& item, std::string rule, std::string advice = {}) {
  return error_at(place_of(item.line, item.key), item.value.IsScalar() ? item.value.Scalar() : "", std::move(rule),
                  std::move(advice));
}

/// The entries of a mapping, each key once and one of `known`.
Result<std::vector<KeyValue>> entries(const YAML::Node& mapping, const std::string& prefix,
                                      std::span<const std::string> known) {
  std::vector<KeyValue> out;
  std::set<std::string> seen;
  for (const auto& entry : mapping) {
    KeyValue item{.key = prefix, .value = entry.second, .line = entry.first.Mark().line + 1};
    if (!entry.first.IsScalar()) return fail(key_error(item, "a key must be plain text"));
    const std::string key = entry.first.Scalar();
    item.key += key;
    if (std::find(known.begin(), known.end(), key) == known.end())
      return fail(key_error(item, "is not a known key", suggest(printable(key), known)));
    if (!seen.insert(key).second) return fail(key_error(item, "stands there twice"));
    out.push_back(std::move(item));
  }
  return out;
}

Status read_test(const KeyValue& item, Sidecar& out) {
  const std::optional<TestKind> kind = value_of<TestKind>(item.value.Scalar());
  if (!kind) return fail(key_error(item, "must be pst, full_stroke or other"));
  out.test = *kind;
  return {};
}

Status read_start_time(const KeyValue& item, Sidecar& out) {
  const Result<UtcTime> time = parse_utc(item.value.Scalar());
  if (!time) return fail(key_error(item, time.error().rule, time.error().advice));
  out.start_time = *time;
  return {};
}

Status read_interpolation(const KeyValue& item, Sidecar& out) {
  const std::string& word = item.value.Scalar();
  if (word != "hold" && word != "linear") return fail(key_error(item, "must be hold or linear"));
  out.interpolation_hold = word == "hold";
  return {};
}

Status read_noise(const KeyValue& item, const PlantDescription& plant, Sidecar& out) {
  if (item.value.IsNull()) return {};
  if (!item.value.IsMap()) return fail(key_error(item, "must be a mapping", "noise_std: {pressure_a: 1.0e4}"));
  std::vector<std::string> channels;
  for (const ChannelDescription& channel : plant.channels) channels.push_back(channel.name);
  const Result<std::vector<KeyValue>> noises = entries(item.value, "noise_std.", channels);
  if (!noises) return fail(noises.error());
  for (const KeyValue& noise : *noises) {
    double value = 0.0;
    if (!noise.value.IsScalar() || !YAML::convert<double>::decode(noise.value, value) ||
        !(value >= 1e-100 && value <= 1e100))  // residuals are divided by it, and their squares summed up
      return fail(
          key_error(noise, "must be a positive number, from 1e-100 to 1e100", "leave it out where it is not known"));
    out.noise_std[noise.key.substr(item.key.size() + 1)] = value;
  }
  return {};
}

/// A name stands in topics, logs and file names, each on one line.
Status read_name(const KeyValue& item, std::string& target) {
  const std::string name = item.value.IsNull() ? "" : item.value.Scalar();
  if (name.empty()) return fail(key_error(item, "must not be empty", "leave the key out where there is none"));
  if (item.key == "asset_id")
    if (const auto wrong = fault_of_asset_id(name)) return fail(key_error(item, *wrong));
  if (!is_visible(name))
    return fail(key_error(item, "must not have line breaks, other control characters or invisible ones"));
  if (name.size() > kLongestId)
    return fail(key_error(item, "must not be longer than " + std::to_string(kLongestId) + " bytes"));
  target = name;
  return {};
}

Status read_entry(const KeyValue& item, const PlantDescription& plant, Sidecar& out) {
  if (item.key == "noise_std") return read_noise(item, plant, out);
  const bool is_name = item.key == "recording_id" || item.key == "asset_id";
  if (item.value.IsNull() && !is_name) return {};  // "note:" with nothing behind it
  if (!item.value.IsScalar() && !item.value.IsNull()) return fail(key_error(item, "must be plain text"));
  if (is_name) return read_name(item, item.key == "asset_id" ? out.asset_id : out.recording_id);
  if (item.key == "test") return read_test(item, out);
  if (item.key == "start_time") return read_start_time(item, out);
  if (item.key == "interpolation") return read_interpolation(item, out);
  out.note = item.value.Scalar();
  return {};
}

/// A plant's or an asset's file with the recording's name, by keys that those have.
Status check_is_no_other_file(const YAML::Node& document) {
  constexpr std::array kOthers = {"model", "outputs", "states", "parameters", "channels", "fmu", "physics"};
  for (const auto& entry : document)
    if (entry.first.IsScalar() && std::ranges::find(kOthers, entry.first.Scalar()) != kOthers.end())
      return fail(error_at(place_of(entry.first.Mark().line + 1, entry.first.Scalar()), {},
                           "is a key of a plant or asset file", "give that file another name than the recording's"));
  return {};
}

Result<Sidecar> read_document(const YAML::Node& document, const PlantDescription& plant) {
  Sidecar out;
  if (!document.IsDefined() || document.IsNull()) return out;
  if (!document.IsMap())
    return fail(error_at(place_of(document.Mark().line + 1, ""), {}, "a sidecar must be a mapping of keys to values"));
  if (const Status own = check_is_no_other_file(document); !own) return fail(own.error());
  const Result<std::vector<KeyValue>> items = entries(document, "", kKeys);
  if (!items) return fail(items.error());
  for (const KeyValue& item : *items)
    if (const Status status = read_entry(item, plant, out); !status) return fail(status.error());
  return out;
}

Error yaml_error(const YAML::Exception& problem) {
  return error_at(place_of(problem.mark.line + 1, ""), {}, "is not YAML: " + problem.msg);
}

/// The library takes a quoted text that is still open at the end of the file for closed; the mark for a document's end
/// cannot stand in one.
std::string with_end(const std::string& text) { return text + (text.ends_with('\n') ? "...\n" : "\n...\n"); }

/// Which text was left open: the last one that stands in `text`.
Error open_quote_error(const std::string& text, const YAML::Exception& problem) try {
  const YAML::Node document = YAML::Load(text.ends_with('\n') ? text : text + "\n");
  const auto error_of = [](const KeyValue& item) {
    return key_error(item, "is not YAML: the quoted text has no closing quote");
  };
  Error last = error_of({});
  for (const auto& entry : document) last = error_of({entry.first.Scalar(), entry.second, entry.first.Mark().line + 1});
  return last;
} catch (const YAML::Exception&) {  // inside brackets, which are open then as well
  return yaml_error(problem);
}

/// The one document of a sidecar.
Result<YAML::Node> load_document(const std::string& text) {
  if (!is_utf8(text)) return fail("is not UTF-8", "save it as UTF-8");
  if (const int line = line_of_second_document(text))
    return fail(error_at(place_of(line, ""), {}, "a second YAML document stands here",
                         "a recording has one: take out the line ---"));
  try {
    return YAML::Load(with_end(text));
  } catch (const YAML::Exception& problem) {
    const bool open_quote = problem.msg == YAML::ErrorMsg::DOC_IN_SCALAR;
    return fail(open_quote ? open_quote_error(text, problem) : yaml_error(problem));
  }
}

}  // namespace

Result<Sidecar> parse_sidecar(const std::string& text, const PlantDescription& plant) {
  const Result<YAML::Node> document = load_document(text);
  if (!document) return fail(document.error());
  return read_document(*document, plant);
}

Result<std::string> parse_sidecar_value(const std::string& text, const std::string& key) {
  const Result<YAML::Node> document = load_document(text);
  if (!document) return fail(document.error());
  if (!document->IsMap()) return std::string();  // read_document says what is wrong with it
  if (const Status own = check_is_no_other_file(*document); !own) return fail(own.error());
  if (const auto known = entries(*document, "", kKeys); !known) return fail(known.error());  // 'asset' for 'asset_id'
  const YAML::Node value = (*document)[key];
  return value.IsDefined() && value.IsScalar() ? value.Scalar() : std::string();
}

std::string format_sidecar(const Recording& recording) {
  YAML::Emitter out;
  out << YAML::BeginMap;
  const auto text = [&out](const char* key, const std::string& value) {
    if (!value.empty()) out << YAML::Key << key << YAML::Value << YAML::DoubleQuoted << value;
  };
  text("recording_id", recording.recording_id);
  text("asset_id", recording.asset_id);
  out << YAML::Key << "test" << YAML::Value << std::string(name_of(recording.test));
  if (recording.start_time) out << YAML::Key << "start_time" << YAML::Value << format_utc(*recording.start_time);
  const auto known = [](const Series& channel) { return channel.noise_std > 0.0; };
  if (std::any_of(recording.samples.channels.begin(), recording.samples.channels.end(), known)) {
    out << YAML::Key << "noise_std" << YAML::Value << YAML::BeginMap;
    for (const Series& channel : recording.samples.channels)
      if (known(channel)) out << YAML::Key << channel.name << YAML::Value << channel.noise_std;
    out << YAML::EndMap;
  }
  if (recording.samples.input_hold) out << YAML::Key << "interpolation" << YAML::Value << "hold";
  text("note", recording.note);
  out << YAML::EndMap;
  return std::string(out.c_str()) + "\n";
}

Status apply_sidecar(const Sidecar& sidecar, const std::vector<Column>& columns, Recording& recording) {
  for (const auto& entry : sidecar.noise_std)
    if (std::ranges::find(columns, entry.first, &Column::name) == columns.end())
      return fail(error_at(std::string("key noise_std.").append(entry.first), {}, "its channel is not in the recording",
                           "take it out, or record the channel"));
  if (!sidecar.recording_id.empty()) recording.recording_id = sidecar.recording_id;
  recording.asset_id = sidecar.asset_id;
  recording.test = sidecar.test;
  recording.start_time = sidecar.start_time;
  recording.note = sidecar.note;
  recording.samples.input_hold = sidecar.interpolation_hold;
  for (std::size_t index = 0; index < columns.size(); ++index)
    if (const auto noise = sidecar.noise_std.find(columns[index].name); noise != sidecar.noise_std.end())
      recording.samples.channels[index].noise_std = noise->second * columns[index].to_si.scale;
  return {};
}

}  // namespace sealwatch
