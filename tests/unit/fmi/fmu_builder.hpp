// Builds FMUs for tests: archives of any members, and whole units around the binaries of tests/unit/fmi/fmus.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace sealwatch::fmi {

struct TestMember {
  std::string name;
  std::string content;
  std::optional<std::uint32_t> unix_mode = {};  ///< of the kind that a symbolic link or a device has
};

/// Writes an archive of these members.
void write_archive(const std::filesystem::path& file, const std::vector<TestMember>& members);

/// What a test's binary is described by.
struct TestUnit {
  std::string binary;  ///< "fmu_spring_return2": its last letter is the version of FMI
  std::string token = "{sealwatch-test-spring-return}";
  bool directional = false;
  int indicators = 0;
  std::string variables;   ///< XML between <ModelVariables> and its end; "": those of spring_return
  std::string structure;   ///< XML between <ModelStructure> and its end
  std::string interfaces;  ///< XML of the interfaces; "": Model Exchange
  std::string version;     ///< "": 2.0 or 3.0
  std::string encoding = "UTF-8";
  std::string experiment = "stopTime=\"3\"";  ///< attributes of <DefaultExperiment>
  std::string library = {};                   ///< beside the binary: "libfmu_gain_library.so"
};
[[nodiscard]] std::string description_of(const TestUnit& unit);
[[nodiscard]] TestUnit spring_return(const std::string& binary);
[[nodiscard]] TestUnit emps();
/// Twelve cells in a row; `declared`: its structure says that each feels its neighbours alone.
[[nodiscard]] TestUnit rod(const std::string& binary, bool declared);
/// For Co-Simulation.
[[nodiscard]] TestUnit gain();
[[nodiscard]] TestUnit bouncing(const std::string& binary);
/// An input of some 1e-9, as its nominal value says.
[[nodiscard]] TestUnit small_input();
/// A bath that jumps to a lower temperature whenever it is hot.
[[nodiscard]] TestUnit dosing();
/// Inputs of all types, time events, a state that a parameter starts, a text: for Model Exchange and Co-Simulation.
[[nodiscard]] TestUnit mixed(const std::string& binary);
/// Arrays whose size is a structural parameter.
[[nodiscard]] TestUnit arrays();
/// Numbers of all types that FMI 3.0 has, alone and in arrays; one of them sizes the others.
[[nodiscard]] TestUnit types();
/// Two masses whose states, parameters, inputs and outputs are arrays.
[[nodiscard]] TestUnit masses();

/// A folder of one test, removed at its end; also tells where sealwatch-fmu-host is.
class TestFolder {
 public:
  TestFolder();
  ~TestFolder();
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// Makes NAME.fmu of a unit.
  [[nodiscard]] std::string build(const TestUnit& unit, const std::string& name = "model.fmu") const;

 private:
  std::filesystem::path path_;
};

}  // namespace sealwatch::fmi
