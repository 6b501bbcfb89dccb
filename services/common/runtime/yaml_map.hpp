// Reading YAML mappings key by key, such that every fault is collected with file, line, key, value and rule, and keys
// that nobody reads are named with the nearest one that is known.
#pragma once

#include <yaml-cpp/yaml.h>

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "sealwatch/core/result.hpp"
#include "sealwatch/core/time.hpp"

namespace sealwatch {

/// The root of a YAML file; faults of reading it go to `errors`. An empty file is an empty mapping.
[[nodiscard]] std::optional<YAML::Node> load_yaml(const std::string& file, std::vector<Error>& errors);

/// "line 3, key a.b": where the key stands under its parents, without the line where it does not.
[[nodiscard]] std::string place_in_yaml(const std::string& file, const std::string& key);
[[nodiscard]] std::string place_in_yaml(const YAML::Node& root, const std::string& key);

/// Limits of a number, with the words for them.
struct NumberRule {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool min_excluded = false;
  double least_but_zero = 0.0;  ///< what is not 0 is at least so large
  const char* words = "must be a number";
};
inline constexpr NumberRule kAnyNumber{};
inline constexpr NumberRule kPositive{.min = 0.0, .min_excluded = true, .words = "must be a number above 0"};
inline constexpr NumberRule kNotNegative{.min = 0.0, .words = "must be a number, 0 or above"};
/// Residuals are divided by a noise, and their squares summed up.
inline constexpr double kLeastNoise = 1e-100, kMostNoise = 1e100;
inline constexpr NumberRule kNoise{
    .min = kLeastNoise, .max = kMostNoise, .words = "must be a number above 0, from 1e-100 to 1e100"};
inline constexpr NumberRule kNoiseOrNone{.min = 0.0,
                                         .max = kMostNoise,
                                         .least_but_zero = kLeastNoise,
                                         .words = "must be 0 or a number from 1e-100 to 1e100"};

class YamlMap {
 public:
  /// `path` is the key under which `node` stands ("" for the root). A node that is no mapping is a fault, and reads as
  /// an empty one.
  YamlMap(std::string file, const YAML::Node& node, std::string path, std::vector<Error>& errors);

  /// Each reads a key if it is there; a wrong value is a fault and leaves `target`. Return whether it was read.
  bool read(const std::string& key, std::string& target);
  bool read(const std::string& key, double& target, const NumberRule& rule = kAnyNumber);
  bool read(const std::string& key, std::int32_t& target, const NumberRule& rule);
  bool read(const std::string& key, bool& target);
  bool read(const std::string& key, UtcTime& target);
  /// The text must be one of `known`.
  bool read(const std::string& key, std::string& target, const std::vector<std::string>& known);

  [[nodiscard]] bool has(const std::string& key) const;
  /// Marks the key as known.
  [[nodiscard]] std::optional<YAML::Node> take(const std::string& key);
  /// A mapping under `key`, if it is there and not null.
  [[nodiscard]] std::optional<YamlMap> map(const std::string& key);
  /// The items of a list under `key`.
  [[nodiscard]] std::vector<YAML::Node> list(const std::string& key);
  /// A mapping that stands inside this one, with faults going the same way.
  [[nodiscard]] YamlMap inside(const YAML::Node& node, const std::string& key) const;
  /// The same for item `index` of the list under `key`.
  [[nodiscard]] YamlMap inside(const YAML::Node& node, const std::string& key, std::size_t index) const;
  /// All keys, in the file's order.
  [[nodiscard]] std::vector<std::string> keys() const;

  /// Adds a fault at `key`.
  void fault(const std::string& key, std::string value, std::string rule, std::string advice = {}) const;
  /// Names the keys that nobody asked for, and those that stand twice.
  void finish() const;
  [[nodiscard]] const std::string& file() const { return file_; }

 private:
  [[nodiscard]] std::string full(const std::string& key) const { return path_.empty() ? key : path_ + "." + key; }
  [[nodiscard]] std::optional<std::string> scalar(const std::string& key, const char* rule);

  std::string file_;
  YAML::Node node_;
  std::string path_;
  std::vector<Error>* errors_;
  std::vector<std::string> known_;
};

/// The number that `text` is, if it is a finite one.
[[nodiscard]] std::optional<double> number_of(const std::string& text);

}  // namespace sealwatch
