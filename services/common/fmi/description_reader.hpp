// Reading the attributes of modelDescription.xml, with errors that name line, value and rule.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <pugixml.hpp>

#include "services/common/fmi/model_description.hpp"

namespace sealwatch::fmi {

/// The first fault ends the reading: what follows it may follow from it.
struct Fault {
  Error error;
};

/// Throws Fault: a description has hundreds of attributes, of which each may be wrong.
class DescriptionReader {
 public:
  DescriptionReader(std::string file, std::string_view text) : file_(std::move(file)), text_(text) {}

  [[noreturn]] void refuse(const pugi::xml_node& at, std::string value, std::string rule,
                           std::string advice = "export the FMU again, or ask its maker") const;
  [[nodiscard]] std::string text(const pugi::xml_node& node, const char* name) const;
  /// What is written for people, which some tools mark up as HTML: the words alone, in one line.
  [[nodiscard]] std::string words(const pugi::xml_node& node, const char* name) const;
  [[nodiscard]] std::string required(const pugi::xml_node& node, const char* name) const;
  [[nodiscard]] bool flag(const pugi::xml_node& node, const char* name) const;
  [[nodiscard]] std::optional<double> number(const pugi::xml_node& node, const char* name) const;
  /// A number that bounds or scales: INF, NaN and what is too large, which xs:double has too, bound nothing.
  [[nodiscard]] std::optional<double> bound(const pugi::xml_node& node, const char* name) const;
  [[nodiscard]] std::uint64_t whole(const pugi::xml_node& node, const char* name, std::uint64_t most) const;
  /// Whole numbers with spaces between them; what is none is left out.
  [[nodiscard]] std::vector<std::uint64_t> wholes(const pugi::xml_node& node, const char* name) const;
  /// Numbers with spaces between them; true and false are 1 and 0. None where one is not finite: then nothing is known.
  [[nodiscard]] std::vector<double> numbers(const pugi::xml_node& node, const char* name) const;
  template <class Enum>
  [[nodiscard]] Enum one_of(const pugi::xml_node& node, const char* name, Enum otherwise) const {
    const pugi::xml_attribute attribute = node.attribute(name);
    if (!attribute) return otherwise;
    if (const auto value = value_of<Enum>(attribute.value())) return *value;
    refuse(node, attribute.value(), std::string("is not a ") + name + " of the standard");
  }
  [[nodiscard]] const std::string& file() const { return file_; }

 private:
  std::string file_;
  std::string_view text_;
};

/// Attributes that a variable without them takes from its type.
struct DeclaredType {
  std::string unit;
  bool relative = false;  ///< a difference: without the unit's offset
  std::optional<double> min, max, nominal;
  std::vector<Item> items;  ///< of an enumeration
};
using DeclaredTypes = std::map<std::string, DeclaredType>;

/// Variables and structure of each version; the rest is common (model_description.cpp).
/// In which a description is written.
[[nodiscard]] pugi::xml_encoding encoding_of(std::string_view text);

void read_fmi2(const DescriptionReader& reader, const pugi::xml_node& root, ModelDescription& description);
void read_fmi3(const DescriptionReader& reader, const pugi::xml_node& root, ModelDescription& description,
               const Settings& settings);

/// Unit, bounds and nominal value of a variable from `node`, or else from its declared type.
void read_number_attributes(const DescriptionReader& reader, const pugi::xml_node& node, const DeclaredTypes& types,
                            Variable& variable);
[[nodiscard]] DeclaredType read_type(const DescriptionReader& reader, const pugi::xml_node& node);
/// Adds every element of the derivative and of the state that belongs to it.
void add_states(const DescriptionReader& reader, const pugi::xml_node& at, std::size_t derivative,
                ModelDescription& description);
/// Takes what one of the unknowns declares; `variable_of` gives the variable that a number stands for. Where
/// it gives none nothing is known.
void read_dependencies(const DescriptionReader& reader, const pugi::xml_node& node, std::size_t unknown,
                       ModelDescription& description,
                       const std::function<std::optional<std::size_t>(std::uint64_t)>& variable_of);

}  // namespace sealwatch::fmi
