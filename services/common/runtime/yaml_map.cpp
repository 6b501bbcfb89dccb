#include "services/common/runtime/yaml_map.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <set>
#include <sstream>

#include <yaml-cpp/exceptions.h>

#include "sealwatch/core/file.hpp"
#include "sealwatch/core/text.hpp"
#include "sealwatch/core/visible_text.hpp"

namespace sealwatch {
namespace {

constexpr std::size_t kMostKeys = 4000;  // each is looked for among the others: as many assets, or parameters

std::string line_of(const YAML::Mark& mark) { return mark.line < 0 ? "" : "line " + std::to_string(mark.line + 1); }

/// The text that stands last.
YAML::Node last_text(YAML::Node node) {
  while (node.size() > 0) {
    YAML::Node last;
    for (const auto& entry : node) last.reset(node.IsMap() ? entry.second : YAML::Node(entry));
    node.reset(last);
  }
  return node;
}

/// The library takes a quoted text that is still open at the end of the file for closed, and passes over all documents
/// but the first. The mark for a document's end cannot stand in a quoted text.
std::optional<Error> broken_off(const std::string& file, const std::string& text, const YAML::Node& document) {
  try {
    (void)YAML::Load(text + (text.ends_with('\n') ? "...\n" : "\n...\n"));
  } catch (const YAML::Exception& exception) {
    if (exception.msg != YAML::ErrorMsg::DOC_IN_SCALAR) throw;
    const YAML::Node open = last_text(document);
    return Error{file, line_of(open.Mark()), open.Scalar(), "is not YAML: the quoted text has no closing quote", {}};
  }
  return std::nullopt;
}

}  // namespace

std::optional<YAML::Node> load_yaml(const std::string& file, std::vector<Error>& errors) {
  const Result<std::string> text = read_file(file, kLongestYaml_bytes);
  if (!text) {
    errors.push_back(text.error());
    return std::nullopt;
  }
  try {
    if (const int line = line_of_second_document(*text)) {
      errors.push_back(
          {file, "line " + std::to_string(line), {}, "a second YAML document stands here", "take out the line ---"});
      return std::nullopt;
    }
    YAML::Node root = YAML::Load(*text);
    if (const std::optional<Error> broken = broken_off(file, *text, root)) {
      errors.push_back(*broken);
      return std::nullopt;
    }
    return root.IsNull() ? YAML::Node(YAML::NodeType::Map) : root;
  } catch (const YAML::Exception& exception) {
    errors.push_back({file, line_of(exception.mark), {}, "is not YAML: " + exception.msg, {}});
  }
  return std::nullopt;
}

std::string place_in_yaml(const std::string& file, const std::string& key) {
  std::vector<Error> ignored;
  const std::optional<YAML::Node> root = load_yaml(file, ignored);
  return root ? place_in_yaml(*root, key) : "key " + key;
}

namespace {

bool has_key(const YAML::Node& map, const std::string& key) {
  return std::any_of(map.begin(), map.end(),
                     [&](const auto& entry) { return entry.first.IsScalar() && entry.first.Scalar() == key; });
}

/// The next of the names in `rest`, without it: up to a point, or further where a key of the map has points in it, as
/// variables of an FMU do.
std::string take_name(const YAML::Node& map, std::string& rest) {
  const auto end_after = [&](std::size_t from) { return std::min(rest.find('.', from), rest.size()); };
  std::size_t length = end_after(0);
  for (std::size_t end = length; end < rest.size();)
    if (end = end_after(end + 1); has_key(map, rest.substr(0, end))) length = end;
  std::string name = rest.substr(0, length);
  rest.erase(0, length + 1);
  return name;
}

}  // namespace

std::string place_in_yaml(const YAML::Node& root, const std::string& key) {
  std::optional<YAML::Node> node(root);  // made anew below, never assigned: that would change the document
  std::string line;
  for (std::string rest = key; node && node->IsMap() && !rest.empty();) {
    const std::string name = take_name(*node, rest);
    std::optional<YAML::Node> inside;
    line.clear();
    const bool is_item = name.ends_with(']') && !has_key(*node, name);
    const std::size_t bracket = is_item ? name.find('[') : std::string::npos;
    for (const auto& entry : *node)
      if (entry.first.IsScalar() && entry.first.Scalar() == name.substr(0, bracket)) {
        line = line_of(entry.first.Mark()) + ", ";
        inside.emplace(entry.second);
      }
    if (inside && bracket != std::string::npos) {
      const auto item = number_of(name.substr(bracket + 1, name.size() - bracket - 2)).value_or(-1.0);
      if (!inside->IsSequence() || item < 0.0 || item >= static_cast<double>(inside->size())) return "key " + key;
      const YAML::Node found = (*inside)[static_cast<std::size_t>(item)];
      line = line_of(found.Mark()) + ", ";
      inside.emplace(found);
    }
    node.reset();
    if (inside) node.emplace(*inside);
  }
  return (node ? line : "") + "key " + key;
}

std::optional<double> number_of(const std::string& text) {
  const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
  const char* end = text.data() + text.size();
  double value = 0.0;
  const auto [stopped, error] = std::from_chars(begin, end, value);
  if (error != std::errc() || stopped != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

YamlMap::YamlMap(std::string file, const YAML::Node& node, std::string path, std::vector<Error>& errors)
    : file_(std::move(file)), node_(node), path_(std::move(path)), errors_(&errors) {
  if (node_.IsMap() && node_.size() <= kMostKeys) return;
  const std::string place = line_of(node_.Mark()) + (path_.empty() ? "" : ", key " + path_);
  if (node_.IsMap())
    errors_->push_back({file_,
                        place,
                        std::to_string(node_.size()) + " keys",
                        "are more than the " + std::to_string(kMostKeys) + " that one mapping may have",
                        {}});
  else
    errors_->push_back(
        {file_, place, node_.IsScalar() ? node_.Scalar() : "", "must be a mapping of keys to values", {}});
  node_ = YAML::Node(YAML::NodeType::Map);
}

bool YamlMap::has(const std::string& key) const {
  return std::ranges::any_of(keys(), [&key](const std::string& there) { return there == key; });
}

std::vector<std::string> YamlMap::keys() const {
  std::vector<std::string> keys;
  for (const auto& entry : node_) keys.push_back(entry.first.IsScalar() ? entry.first.Scalar() : "");
  return keys;
}

std::optional<YAML::Node> YamlMap::take(const std::string& key) {
  if (std::ranges::find(known_, key) == known_.end()) known_.push_back(key);
  for (const auto& entry : node_)
    if (entry.first.IsScalar() && entry.first.Scalar() == key) return entry.second;
  return std::nullopt;
}

void YamlMap::fault(const std::string& key, std::string value, std::string rule, std::string advice) const {
  YAML::Mark mark = YAML::Mark::null_mark();
  for (const auto& entry : node_)
    if (entry.first.IsScalar() && entry.first.Scalar() == key) mark = entry.first.Mark();
  if (mark.is_null() && !path_.empty()) mark = node_.Mark();
  const std::string line = mark.is_null() ? "" : line_of(mark) + ", ";
  errors_->push_back({file_, line + "key " + full(key), std::move(value), std::move(rule), std::move(advice)});
}

std::optional<std::string> YamlMap::scalar(const std::string& key, const char* rule) {
  const auto node = take(key);
  if (!node) return std::nullopt;
  if (node->IsScalar()) return node->Scalar();
  fault(key, {}, rule);
  return std::nullopt;
}

bool YamlMap::read(const std::string& key, std::string& target) {
  const auto text = scalar(key, "must be a text");
  if (!text) return false;
  if (!is_visible(*text, true)) {
    // It goes out in messages, which their readers refuse, and onto terminals.
    fault(key, visible(*text), "must be UTF-8 without control characters or invisible ones", "save the file as UTF-8");
    return false;
  }
  target = *text;
  return true;
}

bool YamlMap::read(const std::string& key, std::string& target, const std::vector<std::string>& known) {
  const auto text = scalar(key, "must be a text");
  if (!text) return false;
  if (std::ranges::find(known, *text) == known.end()) {
    fault(key, *text, "is not known", suggest(*text, known));
    return false;
  }
  target = *text;
  return true;
}

bool YamlMap::read(const std::string& key, double& target, const NumberRule& rule) {
  const auto text = scalar(key, rule.words);
  if (!text) return false;
  const auto number = number_of(*text);
  if (!number || *number < rule.min || *number > rule.max || (rule.min_excluded && *number == rule.min) ||
      (*number != 0.0 && std::abs(*number) < rule.least_but_zero)) {
    fault(key, *text, rule.words);
    return false;
  }
  target = *number;
  return true;
}

bool YamlMap::read(const std::string& key, std::int32_t& target, const NumberRule& rule) {
  double number = 0.0;
  if (!read(key, number, rule)) return false;
  if (number != std::floor(number)) {
    fault(key, take(key)->Scalar(), rule.words);
    return false;
  }
  target = static_cast<std::int32_t>(number);
  return true;
}

bool YamlMap::read(const std::string& key, bool& target) {
  constexpr const char* kRule = "must be true or false";
  const auto text = scalar(key, kRule);
  if (!text) return false;
  if (*text != "true" && *text != "false") {
    fault(key, *text, kRule);
    return false;
  }
  target = *text == "true";
  return true;
}

bool YamlMap::read(const std::string& key, UtcTime& target) {
  const auto text = scalar(key, "must be a UTC time in ISO 8601");
  if (!text) return false;
  const auto time = parse_utc(*text);
  if (!time) {
    fault(key, *text, time.error().rule, time.error().advice);
    return false;
  }
  target = *time;
  return true;
}

std::optional<YamlMap> YamlMap::map(const std::string& key) {
  const auto node = take(key);
  if (!node || node->IsNull()) return std::nullopt;
  return inside(*node, key);
}

YamlMap YamlMap::inside(const YAML::Node& node, const std::string& key) const {
  return {file_, node, full(key), *errors_};
}

YamlMap YamlMap::inside(const YAML::Node& node, const std::string& key, std::size_t index) const {
  std::string item = key;
  item.append("[").append(std::to_string(index)).append("]");
  return inside(node, item);
}

std::vector<YAML::Node> YamlMap::list(const std::string& key) {
  const auto node = take(key);
  if (!node || node->IsNull()) return {};
  if (!node->IsSequence()) {
    fault(key, node->IsScalar() ? node->Scalar() : "", "must be a list");
    return {};
  }
  return {node->begin(), node->end()};
}

namespace {

constexpr const char* kDecimalPoint = "numbers have a decimal point here: 10.5, not 10,5";

/// {scale: 10,5} reads as a key behind a comma.
bool is_number_behind_comma(const std::string& key) {
  return std::ranges::all_of(key, [](unsigned char c) { return std::isdigit(c) != 0; });
}

}  // namespace

void YamlMap::finish() const {
  std::set<std::string> seen;
  for (const std::string& key : keys()) {
    if (!seen.insert(key).second)
      fault(key, key, "stands twice", "keep one of them");
    else if (std::ranges::find(known_, key) == known_.end())
      fault(key, key, "is not a known key", is_number_behind_comma(key) ? kDecimalPoint : suggest(key, known_));
  }
}

}  // namespace sealwatch
