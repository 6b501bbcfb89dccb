#include "services/common/fmi/fmu_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <set>
#include <sstream>

#include "services/common/fmi/declared_dependencies.hpp"
#include "services/common/fmi/setting_values.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch::fmi {
namespace {

/// An ELF file of 64 bits for x86-64, by its first bytes (System V ABI, ELF header).
std::string fault_of_binary(const std::filesystem::path& file) {
  std::array<char, 20> header{};
  std::ifstream(file, std::ios::binary).read(header.data(), header.size());
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(header[k]); };
  if (header[0] == 'M' && header[1] == 'Z') return "is a binary for Windows";
  if (!std::string_view(header.data(), 4)
           .starts_with("\x7f"
                        "ELF"))
    return "is not a binary for Linux";
  if (byte(4) != 2) return "is a binary for 32 bits";
  constexpr unsigned kX86_64 = 62;
  const unsigned machine = byte(18) + 256U * byte(19);
  return machine == kX86_64 ? "" : "is a binary for another processor (ELF machine " + std::to_string(machine) + ")";
}

/// RFC 3986: of a path, what is no unreserved character and no slash stands as %XX.
std::string file_uri(const std::string& path) {
  constexpr std::string_view kPlain = "/-._~", kDigits = "0123456789ABCDEF";
  std::string uri = "file://";
  for (const char c : path) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 128 && (std::isalnum(byte) != 0 || kPlain.find(c) != std::string_view::npos))
      uri += c;
    else
      uri.append({'%', kDigits[byte / 16], kDigits[byte % 16]});
  }
  return uri;
}

Handle handle_of(const Variable& variable) {
  return {variable.reference, variable.type, static_cast<std::uint32_t>(variable.size)};
}

std::vector<Handle> handles_of(const ModelDescription& description, std::span<const std::size_t> variables) {
  std::vector<Handle> handles;
  for (const std::size_t variable : variables) handles.push_back(handle_of(description.variables[variable]));
  return handles;
}

/// Whole variables of elements that follow each other.
std::vector<Handle> handles_of(const ModelDescription& description, std::span<const Element> elements) {
  std::vector<Handle> handles;
  for (const Element& element : elements)
    if (element.element == 0) handles.push_back(handle_of(description.variables[element.variable]));
  return handles;
}

bool can_be_set(const Variable& variable) {
  return (variable.causality == FmiCausality::parameter || variable.causality == FmiCausality::structuralParameter) &&
         variable.variability != FmiVariability::constant && variable.type != FmiType::binary &&
         variable.type != FmiType::clock;
}

}  // namespace

bool is_number(FmiType type) { return type != FmiType::string && type != FmiType::binary && type != FmiType::clock; }

bool changes_between_events(const Variable& variable) {
  return variable.variability == FmiVariability::continuous &&
         (variable.type == FmiType::float64 || variable.type == FmiType::float32);
}

Result<std::shared_ptr<const FmuFile>> FmuFile::open(const std::string& file, const Settings& settings, Choice choice) {
  Result<UnpackedFmu> unpacked = unpack_fmu(file);
  if (!unpacked) return fail(unpacked.error());
  std::ostringstream text;
  text << std::ifstream(unpacked->path_of(kDescriptionName), std::ios::binary).rdbuf();
  Result<ModelDescription> description = read_model_description(file, text.str(), settings);
  if (!description) return fail(description.error());
  const bool wants_exchange = choice == Choice::model_exchange, wants_steps = choice == Choice::co_simulation;
  if ((wants_exchange && !description->model_exchange) || (wants_steps && !description->co_simulation))
    return fail(
        Error{.file = file,
              .place = {},
              .value = wants_exchange ? "me" : "cs",
              .rule = std::string("it has no interface for ") + (wants_exchange ? "Model Exchange" : "Co-Simulation"),
              .advice = "leave `interface` out, and the one that it has is taken"});
  description->offers_exchange = description->model_exchange.has_value();
  if (wants_steps) description->model_exchange.reset();
  std::shared_ptr<FmuFile> fmu(new FmuFile(std::move(*unpacked), std::move(*description), settings));
  if (const Status sound = fmu->take_settings(); !sound) return fail(sound.error());
  if (const Status named = fmu->check_states(); !named) return fail(named.error());
  if (const Status found = fmu->find_binary(); !found) return fail(found.error());
  return fmu;
}

const Interface& FmuFile::interface() const {
  return co_simulation() ? *description_.co_simulation : *description_.model_exchange;
}

Error FmuFile::refusal(std::string rule, std::string advice, std::string value) const {
  return {.file = unpacked_.file,
          .place = {},
          .value = std::move(value),
          .rule = std::move(rule),
          .advice = std::move(advice)};
}

Status FmuFile::find_binary() {
  const std::string& name = interface().model_identifier;
  const std::string platform = description_.version == Version::fmi2 ? "linux64" : "x86_64-linux";
  binary_ = "binaries/" + platform + "/" + name + ".so";
  if (unpacked_.has(binary_)) {
    const std::string fault = fault_of_binary(unpacked_.path_of(binary_));
    if (fault.empty()) return {};
    return fail(refusal("its member " + binary_ + " " + fault, "export the FMU for Linux on x86-64"));
  }
  std::set<std::string> platforms;
  std::string others;  // of this platform
  for (const std::string& member : unpacked_.members) {
    if (!member.starts_with("binaries/")) continue;
    if (member.starts_with("binaries/" + platform + "/") && member.ends_with(".so")) text::add_to_list(others, member);
    const std::string rest = member.substr(9);
    if (const auto end = rest.find('/'); end != std::string::npos && end > 0) platforms.insert(rest.substr(0, end));
  }
  if (!others.empty())
    return fail(refusal("has no binary " + binary_ + ", after its modelIdentifier, but " + others,
                        "give the binary the name that modelIdentifier says"));
  std::string there;
  for (const std::string& one : platforms) text::add_to_list(there, one);
  const bool has_sources = std::ranges::any_of(
      unpacked_.members, [](const std::string& member) { return member.starts_with("sources/") && member.size() > 8; });
  return fail(refusal(
      "has no binary " + binary_ + (there.empty() ? "; it has none for any platform" : "; it has some for " + there),
      has_sources ? "it has its sources: compile those in sources/ to a shared library of that name and add it to "
                    "the archive, or export the FMU for Linux on x86-64 (linux64)"
                  : "export the FMU for Linux on x86-64 (linux64)"));
}

Status FmuFile::take_settings() {
  for (const auto& [name, text] : settings_) {
    const auto refused = [&, place = kSettingPlace + name](Error error) {
      error.file = unpacked_.file, error.place = place;
      return fail(std::move(error));
    };
    const Variable* variable = description_.find(name);
    if (variable == nullptr) return refused(description_.find_element(name).error());
    if (!can_be_set(*variable))
      return refused(refusal("is not a parameter that can be set", "settings are for parameters", name));
    Result<std::string> value = value_of_setting(*variable, text);
    if (!value) return refused(value.error());
    values_[name] = std::move(*value);
  }
  return {};
}

// Without states in its structure a unit would stand still. An input has a derivative too, and so has an output that is no
// state: it has no start, and a structure that names other things.
Status FmuFile::check_states() const {
  const auto is_of_state = [&](const Variable& rate) {
    if (!rate.derivative_of || rate.size == 0) return false;
    const Variable& of = description_.variables[*rate.derivative_of];
    return of.causality != FmiCausality::input && (description_.structure_is_empty || !of.start.empty());
  };
  const auto rate = std::ranges::find_if(description_.variables, is_of_state);
  if (co_simulation() || !description_.states.empty() || rate == description_.variables.end()) return {};
  return fail(refusal("is a derivative, but ModelStructure names no state's: it alone tells their order in the binary",
                      std::string("export it with its ModelStructure") +
                          (description_.co_simulation ? ", or take `interface: cs`" : ""),
                      rate->name));
}

// Structural parameters come first: they are set in a mode of their own.
void FmuFile::put_settings(Setup& setup) const {
  for (const bool structural : {true, false})
    for (const auto& [name, text] : values_) {
      const Variable& variable = *description_.find(name);
      if ((variable.causality == FmiCausality::structuralParameter) != structural) continue;
      setup.constants.push_back(handle_of(variable));
      setup.constant_texts += text + '\0';
      setup.structural += structural ? 1U : 0U;
    }
}

Result<Setup> FmuFile::setup(Selection& selection) const {
  const auto& variables = description_.variables;
  for (const auto* list : {&selection.parameters, &selection.inputs, &selection.outputs})
    for (const std::size_t k : *list)
      if (!is_number(variables[k].type))
        return fail(
            refusal("is not a number, but a variable of type " + std::string(sealwatch::name_of(variables[k].type)),
                    "leave it out", variables[k].name));
  // Not std::ranges: clang 14, whose clang-tidy reads this, cannot compile it.
  const auto behind = std::stable_partition(selection.inputs.begin(), selection.inputs.end(),
                                            [&](std::size_t k) { return changes_between_events(variables[k]); });
  const auto continuous = static_cast<std::uint32_t>(behind - selection.inputs.begin());
  const bool real_outputs = std::ranges::all_of(selection.outputs, [&](std::size_t k) {
    return variables[k].causality == FmiCausality::output && variables[k].type == FmiType::float64;
  });
  const bool real_inputs = std::ranges::all_of(selection.inputs.begin(), behind,
                                               [&](std::size_t k) { return variables[k].type == FmiType::float64; });
  const bool directional = !co_simulation() && interface().directional_derivatives && real_inputs;
  const std::string resources = unpacked_.path_of("resources").string();
  Setup setup{
      .library = unpacked_.path_of(binary_).string(),
      .folder = unpacked_.folder.path().string(),
      .resources = description_.version == Version::fmi2 ? file_uri(resources) : resources + "/",
      .token = description_.token,
      .fmi3 = description_.version == Version::fmi3 ? 1U : 0U,
      .co_simulation = co_simulation() ? 1U : 0U,
      .once_per_process = interface().once_per_process ? 1U : 0U,
      .state_directional = directional ? 1U : 0U,
      .output_directional = directional && real_outputs ? 1U : 0U,
      .event_indicators = co_simulation() ? 0U : static_cast<std::uint32_t>(description_.event_indicators),
      .states = co_simulation() ? std::vector<Handle>() : handles_of(description_, description_.states),
      .derivatives = co_simulation() ? std::vector<Handle>() : handles_of(description_, description_.derivatives),
      .parameters = handles_of(description_, selection.parameters),
      .constants = {},
      .constant_texts = {},
      .inputs = handles_of(description_, selection.inputs),
      .outputs = handles_of(description_, selection.outputs),
      .continuous_inputs = continuous,
      .dependencies =
          co_simulation() ? std::vector<std::uint32_t>() : declared_dependencies(description_, selection.outputs),
      .needed_tool = {}};
  if (interface().needs_execution_tool)
    setup.needed_tool = description_.tool.empty() ? "the tool that made it" : description_.tool;
  put_settings(setup);
  return setup;
}

}  // namespace sealwatch::fmi
