#include "services/common/fmi/description_reader.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <set>
#include <sstream>

namespace sealwatch::fmi {
namespace {

/// An xs:double, which may be too large for a double, too small, or none: infinite, 0, NaN.
std::optional<double> to_number(std::string_view text) {
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.front())) != 0) text.remove_prefix(1);
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back())) != 0) text.remove_suffix(1);
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc::invalid_argument || end != text.data() + text.size()) return std::nullopt;
  if (error != std::errc::result_out_of_range) return value;
  const auto exponent = text.find_first_of("eE");
  const bool large =
      exponent != std::string_view::npos && text.substr(exponent + 1).find('-') == std::string_view::npos;
  return large ? std::numeric_limits<double>::infinity() : 0.0;
}

bool is_finite(std::optional<double> value) { return value && std::isfinite(*value); }

}  // namespace

void DescriptionReader::refuse(const pugi::xml_node& at, std::string value, std::string rule,
                               std::string advice) const {
  const auto offset = static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, at.offset_debug()));
  const auto line = 1 + std::ranges::count(text_.substr(0, std::min(offset, text_.size())), '\n');
  std::string place = "modelDescription.xml, line " + std::to_string(line);
  if (const char* name = at.attribute("name").value(); *name != '\0') place += std::string(", ") + name;
  throw Fault{{.file = file_,
               .place = std::move(place),
               .value = std::move(value),
               .rule = std::move(rule),
               .advice = std::move(advice)}};
}

namespace {

/// Of a tag of HTML at the begin of a text; 0 where there is none, as in "x<y and y>z".
std::size_t length_of_tag(std::string_view text) {
  static const std::set<std::string_view> kTags = {
      "html", "head", "body", "p",          "br",    "hr", "b",  "i",  "u",  "em", "strong", "tt", "code", "pre",
      "sub",  "sup",  "span", "blockquote", "h1",    "h2", "h3", "h4", "ul", "ol", "li",     "dl", "dt",   "dd",
      "div",  "a",    "img",  "font",       "table", "tr", "td", "th", "h5", "h6", "small",  "big"};
  const std::size_t end = text.find('>');
  if (text.empty() || text[0] != '<' || end == std::string_view::npos) return 0;
  std::string_view inside = text.substr(1, end - 1);
  if (inside.starts_with('/')) inside.remove_prefix(1);
  const std::size_t name = std::min(inside.find_first_of(" /"), inside.size());
  const std::string_view rest = inside.substr(name);
  return kTags.contains(inside.substr(0, name)) && (rest.size() < 3 || rest.find('=') != std::string_view::npos)
             ? end + 1
             : 0;
}

}  // namespace

std::string DescriptionReader::text(const pugi::xml_node& node, const char* name) const {
  return node.attribute(name).value();
}

std::string DescriptionReader::words(const pugi::xml_node& node, const char* name) const {
  const std::string all = text(node, name);
  std::string plain;
  for (std::size_t at = 0; at < all.size(); ++at) {
    const std::size_t length = length_of_tag(std::string_view(all).substr(at));
    if (length > 0) at += length - 1;
    const bool blank = length > 0 || std::isspace(static_cast<unsigned char>(all[at])) != 0;
    if (!blank)
      plain += all[at];
    else if (!plain.empty() && plain.back() != ' ')
      plain += ' ';
  }
  if (plain.ends_with(' ')) plain.pop_back();
  return plain;
}

std::string DescriptionReader::required(const pugi::xml_node& node, const char* name) const {
  if (!node.attribute(name)) refuse(node, node.name(), std::string("lacks the attribute ") + name);
  return node.attribute(name).value();
}

bool DescriptionReader::flag(const pugi::xml_node& node, const char* name) const {
  const std::string value = text(node, name);
  if (value.empty() || value == "false" || value == "0") return false;
  if (value != "true" && value != "1") refuse(node, value, std::string(name) + " must be true or false");
  return true;
}

std::optional<double> DescriptionReader::number(const pugi::xml_node& node, const char* name) const {
  const pugi::xml_attribute attribute = node.attribute(name);
  if (!attribute) return std::nullopt;
  const std::optional<double> value = to_number(attribute.value());
  if (!is_finite(value)) refuse(node, attribute.value(), std::string(name) + " must be a number");
  return value;
}

std::uint64_t DescriptionReader::whole(const pugi::xml_node& node, const char* name, std::uint64_t most) const {
  const std::string value = required(node, name);
  std::uint64_t result = 0;
  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), result);
  if (error != std::errc() || end != value.data() + value.size() || result > most)
    refuse(node, value, std::string(name) + " must be a whole number up to " + std::to_string(most));
  return result;
}

std::vector<std::uint64_t> DescriptionReader::wholes(const pugi::xml_node& node, const char* name) const {
  std::vector<std::uint64_t> values;
  std::istringstream parts(text(node, name));
  for (std::string part; parts >> part;) {
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    if (error == std::errc() && end == part.data() + part.size()) values.push_back(value);
  }
  return values;
}

std::vector<double> DescriptionReader::numbers(const pugi::xml_node& node, const char* name) const {
  std::vector<double> values;
  std::istringstream parts(text(node, name));
  for (std::string part; parts >> part;) {
    const std::optional<double> value = part == "true" ? 1.0 : part == "false" ? 0.0 : to_number(part);
    if (!value) refuse(node, part, std::string(name) + " must be a number");
    values.push_back(*value);
  }
  return std::ranges::all_of(values, [](double value) { return std::isfinite(value); }) ? values
                                                                                        : std::vector<double>();
}

std::optional<double> DescriptionReader::bound(const pugi::xml_node& node, const char* name) const {
  const std::optional<double> value = to_number(node.attribute(name).value());
  return value && !std::isfinite(*value) ? std::nullopt : number(node, name);
}

namespace {

std::vector<Item> items_of(const DescriptionReader& reader, const pugi::xml_node& type) {
  std::vector<Item> items;
  for (const pugi::xml_node& item : type.children("Item"))
    if (const std::optional<double> value = reader.number(item, "value"))
      items.push_back({reader.text(item, "name"), *value});
  return items;
}

/// With which an input starts that says nothing of its start: 0, or an enumeration without that value its first.
std::vector<double> usual_start(const std::vector<Item>& items) {
  const bool has_zero = std::ranges::find(items, 0.0, &Item::value) != items.end();
  return items.empty() || has_zero ? std::vector<double>() : std::vector{items.front().value};
}

}  // namespace

DeclaredType read_type(const DescriptionReader& reader, const pugi::xml_node& node) {
  return {.unit = reader.text(node, "unit"),
          .relative = reader.flag(node, "relativeQuantity"),
          .min = reader.bound(node, "min"),
          .max = reader.bound(node, "max"),
          .nominal = reader.bound(node, "nominal"),
          .items = items_of(reader, node)};
}

void read_number_attributes(const DescriptionReader& reader, const pugi::xml_node& node, const DeclaredTypes& types,
                            Variable& variable) {
  if (variable.type == FmiType::string || variable.type == FmiType::binary || variable.type == FmiType::clock) return;
  DeclaredType own = read_type(reader, node);
  // A type that is not there tells nothing; some tools leave theirs out.
  if (const auto type = types.find(reader.text(node, "declaredType")); type != types.end()) {
    if (own.unit.empty()) own.unit = type->second.unit;
    if (!node.attribute("relativeQuantity")) own.relative = type->second.relative;
    if (!node.attribute("min")) own.min = type->second.min;
    if (!node.attribute("max")) own.max = type->second.max;
    if (!node.attribute("nominal")) own.nominal = type->second.nominal;
    own.items = type->second.items;
  }
  variable.unit = std::move(own.unit);
  variable.relative = own.relative;
  variable.min = own.min, variable.max = own.max, variable.nominal = own.nominal;
  variable.start = reader.numbers(node, "start");
  variable.items = std::move(own.items);
  if (variable.start.empty() && variable.causality == FmiCausality::input) variable.start = usual_start(variable.items);
}

void add_states(const DescriptionReader& reader, const pugi::xml_node& at, std::size_t derivative,
                ModelDescription& description) {
  const Variable& rate = description.variables[derivative];
  if (!rate.derivative_of)
    reader.refuse(at, rate.name, "stands among the state derivatives and has no attribute derivative");
  const Variable& state = description.variables[*rate.derivative_of];
  if (state.size != rate.size) reader.refuse(at, rate.name, "has another size than its state " + state.name);
  if (state.type != FmiType::float64 || rate.type != FmiType::float64)
    reader.refuse(at, state.name,
                  "is a state that is not a Float64 (Real), the only type of state that sealwatch integrates");
  for (std::size_t element = 0; element < rate.size; ++element) {
    description.states.push_back({*rate.derivative_of, element});
    description.derivatives.push_back({derivative, element});
  }
}

void read_dependencies(const DescriptionReader& reader, const pugi::xml_node& node, std::size_t unknown,
                       ModelDescription& description,
                       const std::function<std::optional<std::size_t>(std::uint64_t)>& variable_of) {
  if (!node.attribute("dependencies")) return;
  std::vector<std::size_t> variables;
  for (const std::uint64_t number : reader.wholes(node, "dependencies")) {
    const auto variable = variable_of(number);
    if (!variable) return;
    variables.push_back(*variable);
  }
  description.dependencies[unknown] = std::move(variables);
}

}  // namespace sealwatch::fmi
