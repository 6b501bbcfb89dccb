// What an FMU says about itself in modelDescription.xml (FMI 2.0.4 section 2.2, FMI 3.0.1 section 2.4), in one form
// for both versions. Variables of FMI 3 may be arrays; states, derivatives and channels are named by their elements.
//
//   y_SI = factor y + offset        for a variable y in one of its own units; a difference has no offset
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sealwatch/core/fields.hpp"
#include "sealwatch/core/result.hpp"

namespace sealwatch {

SEALWATCH_ENUM(FmiType, float64, float32, int8, uint8, int16, uint16, int32, uint32, int64, uint64, boolean,
               enumeration, string, binary, clock)
SEALWATCH_ENUM(FmiCausality, parameter, calculatedParameter, input, output, local, independent, structuralParameter,
               dependent)
SEALWATCH_ENUM(FmiVariability, constant, fixed, tunable, discrete, continuous)

namespace fmi {

enum class Version { fmi2, fmi3 };

/// Exponents of kg, m, s, A, K, mol, cd, rad.
using BaseExponents = std::array<int, 8>;

struct Conversion {
  double factor = 1.0, offset = 0.0;
  [[nodiscard]] double to_si(double value) const { return factor * value + offset; }
  [[nodiscard]] double from_si(double value) const { return (value - offset) / factor; }
};

/// By its usual name, and the way to it.
struct SiUnit {
  std::string name;
  Conversion conversion;
};

struct Unit {
  std::string name;  ///< "N.m", as the FMU writes it
  bool has_base = false;
  BaseExponents exponents{};
  double factor = 1.0;
  double offset = 0.0;
  std::optional<SiUnit> by_name = {};  ///< where the description does not define it, and its name is a unit's
};

/// Of an enumeration.
struct Item {
  std::string name;
  double value = 0.0;
};

struct Variable {
  std::string name;
  std::uint32_t reference = 0;  ///< value reference: the number by which the binary knows it
  FmiType type = FmiType::float64;
  FmiCausality causality = FmiCausality::local;
  FmiVariability variability = FmiVariability::continuous;
  std::string unit;       ///< name of a Unit, or ""
  bool relative = false;  ///< a difference of two values: 10 degC are 10 K
  std::string description;
  std::size_t size = 1;                   ///< number of elements, row by row
  std::vector<std::size_t> extents = {};  ///< of an array, in each dimension
  std::vector<double> start;              ///< of numbers: empty, or one for each element
  std::optional<double> min, max, nominal;
  std::vector<Item> items = {};
  std::string begins = {};                   ///< of a state that sealwatch has exported: kSettles, kOwn
  std::optional<std::size_t> derivative_of;  ///< index of the variable that it is the time derivative of
};

/// One of the interfaces that the binary offers.
struct Interface {
  std::string model_identifier;  ///< name of its binary
  bool needs_execution_tool = false;
  bool once_per_process = false;
  bool directional_derivatives = false;
  bool needs_completed_step = false;  ///< wants to be told of every step of the integration
  bool variable_steps = false;        ///< of Co-Simulation: the steps from sample to sample may differ
  double fixed_step_s = 0.0;          ///< of which a Co-Simulation unit does whole numbers alone; 0: of any
};

/// How a state begins that sealwatch exports: FMI has no word for it.
inline constexpr const char* kSettles = "settles";             ///< where it rests, its neighbours being held
inline constexpr const char* kOwn = "own";                     ///< each recording has a start of its own
inline constexpr const char* kBegins = "org.sealwatch.start";  ///< what such an annotation is called

/// An element of a variable.
struct Element {
  std::size_t variable = 0;  ///< index in ModelDescription::variables
  std::size_t element = 0;
};

struct ModelDescription {
  Version version = Version::fmi2;
  std::string file;  ///< for messages
  std::string version_text;
  std::string model_name;
  std::string token;  ///< guid, instantiationToken
  std::string tool;
  std::string description;
  std::optional<Interface> model_exchange;
  std::optional<Interface> co_simulation;
  bool offers_exchange = false;  ///< though it is taken for Co-Simulation
  bool scheduled_execution = false;
  std::vector<Unit> units;
  std::vector<Variable> variables;
  std::vector<Element> states;       ///< elements, in the binary's order
  std::vector<Element> derivatives;  ///< of the states
  bool structure_is_empty = false;   ///< it names no variable at all
  std::size_t event_indicators = 0;
  std::optional<double> start_time_s, stop_time_s, step_s;
  /// Until which a unit is to lay out what has no recording: the description's, or shortly behind the start.
  [[nodiscard]] double stop_time() const;
  /// States and the variables of which their starts depend, by the description (InitialUnknowns); indices of variables.
  std::map<std::size_t, std::vector<std::size_t>> start_links;

  /// Derivatives and outputs, and the variables on which they depend between events; those that do not say it are
  /// missing. Indices of variables.
  std::map<std::size_t, std::vector<std::size_t>> dependencies;

  [[nodiscard]] const Variable* find(std::string_view variable) const;
  [[nodiscard]] const Unit* find_unit(std::string_view unit) const;
  /// The SI unit of what the variable counts in; nothing where the description does not say.
  [[nodiscard]] std::optional<SiUnit> si_unit_of(const Variable& variable) const;
  /// "x", "x[2]" of an array, "A[2,1]" of a matrix, counted from 1.
  [[nodiscard]] std::string name_of(const Element& element) const;
  /// The element that name_of() names; an Error with the nearest name otherwise.
  [[nodiscard]] Result<Element> find_element(std::string_view name) const;
};

/// Values for variables that are set once before a run, by name: structural parameters, texts, switches.
using Settings = std::map<std::string, std::string>;

/// From the text of a modelDescription.xml; `file` names it in messages. Settings of structural parameters give arrays
/// other sizes than the description's; what was their start is then unknown.
[[nodiscard]] Result<ModelDescription> read_model_description(const std::string& file, std::string_view text,
                                                              const Settings& settings = {});

/// Of these variables those that count in a unit that the description does not define, nor its name as one of SI:
/// "bar (p_1, p_2), min (tau)"; "" where there are none. Their numbers are taken as they are.
[[nodiscard]] std::string undefined_units(const ModelDescription& description,
                                          const std::vector<std::size_t>& variables);
inline constexpr const char* kUndefinedUnits =
    "the FMU does not define these units, so that its numbers are taken as they are; where those are no SI, convert "
    "them "
    "in the plant file's expressions, as in 1e5[Pa]*p";

/// Those whose unit is taken by its name, as undefined_units() writes them.
[[nodiscard]] std::string units_by_name(const ModelDescription& description, const std::vector<std::size_t>& variables);
/// What a unit is that the description names without a definition, as tools do: "N", "kN/m", "degC".
[[nodiscard]] std::optional<SiUnit> unit_by_name(const std::string& name);

/// SI unit by its usual name ("N m"), or put together ("kg m2/s3"); "1" where the unit says nothing.
[[nodiscard]] std::string si_name(const Unit& unit);

}  // namespace fmi
}  // namespace sealwatch
