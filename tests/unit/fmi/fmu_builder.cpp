#include "tests/unit/fmi/fmu_builder.hpp"

#include <stdlib.h>  // NOLINT(modernize-deprecated-headers): mkdtemp, setenv
#include <zip.h>

#include <cstdio>
#include <fstream>
#include <sstream>

namespace sealwatch::fmi {
namespace {

std::string content_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

bool is_fmi3(const TestUnit& unit) { return unit.binary.ends_with('3'); }

std::string real2(const std::string& name, int reference, const std::string& attributes, const std::string& real) {
  return "<ScalarVariable name=\"" + name + "\" valueReference=\"" + std::to_string(reference) + "\" " + attributes +
         "><Real " + real + "/></ScalarVariable>\n";
}
std::string real3(const std::string& name, int reference, const std::string& attributes) {
  return "<Float64 name=\"" + name + "\" valueReference=\"" + std::to_string(reference) + "\" " + attributes + "/>\n";
}

}  // namespace

void write_archive(const std::filesystem::path& file, const std::vector<TestMember>& members) {
  int code = 0;
  zip_t* archive = zip_open(file.c_str(), ZIP_CREATE | ZIP_TRUNCATE, &code);
  if (archive == nullptr) std::abort();
  for (const TestMember& member : members) {
    zip_source_t* source = zip_source_buffer(archive, member.content.data(), member.content.size(), 0);
    const zip_int64_t index = member.name.ends_with('/')
                                  ? zip_dir_add(archive, member.name.c_str(), 0)
                                  : zip_file_add(archive, member.name.c_str(), source, ZIP_FL_ENC_UTF_8);
    if (index < 0) std::abort();
    if (member.unix_mode)
      zip_file_set_external_attributes(archive, static_cast<zip_uint64_t>(index), 0, ZIP_OPSYS_UNIX,
                                       *member.unix_mode << 16U);
  }
  if (zip_close(archive) != 0) std::abort();
}

std::string description_of(const TestUnit& unit) {
  const std::string directional = unit.directional ? "true" : "false";
  std::string text = "<?xml version=\"1.0\" encoding=\"" + unit.encoding + "\"?>\n<fmiModelDescription ";
  const std::string version = !unit.version.empty() ? unit.version : is_fmi3(unit) ? "3.0" : "2.0";
  text += "fmiVersion=\"" + version + (is_fmi3(unit) ? "\" instantiationToken=\"" : "\" guid=\"");
  text += unit.token + "\" modelName=\"test\" generationTool=\"the tests\"";
  if (!is_fmi3(unit)) text += " numberOfEventIndicators=\"" + std::to_string(unit.indicators) + "\"";
  text += ">\n";
  text += unit.interfaces.empty() ? "<ModelExchange modelIdentifier=\"model\" providesDirectionalDerivative" +
                                        std::string(is_fmi3(unit) ? "s" : "") + "=\"" + directional + "\"/>\n"
                                  : unit.interfaces;
  text +=
      "<UnitDefinitions><Unit name=\"mm\"><BaseUnit m=\"1\" factor=\"0.001\"/></Unit>"
      "<Unit name=\"degC\"><BaseUnit K=\"1\" offset=\"273.15\"/></Unit>"
      "<Unit name=\"N\"><BaseUnit kg=\"1\" m=\"1\" s=\"-2\"/></Unit>"
      "<Unit name=\"m\"><BaseUnit m=\"1\"/></Unit></UnitDefinitions>\n";
  text += "<DefaultExperiment startTime=\"0\" " + unit.experiment + "/>\n";
  text += "<ModelVariables>\n" + unit.variables + "</ModelVariables>\n";
  text += "<ModelStructure>\n" + unit.structure + "</ModelStructure>\n</fmiModelDescription>\n";
  return text;
}

TestUnit spring_return(const std::string& binary) {
  TestUnit unit{.binary = binary, .variables = {}, .structure = {}, .interfaces = {}, .version = {}};
  const std::string parameter = "causality=\"parameter\" variability=\"fixed\"";
  const auto names = {"M", "F_v", "k_s", "k_F"};
  const auto values = {"20", "2e3", "1e4", "100"};
  if (is_fmi3(unit)) {
    unit.variables = real3("time", 0, "causality=\"independent\"") +
                     real3("x", 1000, "causality=\"local\" unit=\"m\"") + real3("v", 1001, "causality=\"local\"") +
                     real3("der(x)", 2000, "derivative=\"1000\"") + real3("der(v)", 2001, "derivative=\"1001\"") +
                     real3("u", 3000, "causality=\"input\" start=\"0\"");
    int k = 0;
    for (const auto* name : names)
      unit.variables += real3(name, 4000 + k, parameter + " start=\"" + *(values.begin() + k) + "\""), ++k;
    unit.variables += real3("position", 5000, "causality=\"output\" unit=\"m\"");
    unit.structure =
        "<Output valueReference=\"5000\"/><ContinuousStateDerivative valueReference=\"2000\"/>"
        "<ContinuousStateDerivative valueReference=\"2001\"/>\n";
    return unit;
  }
  unit.variables = real2("x", 1000, "", "unit=\"m\"") + real2("v", 1001, "", "") +
                   real2("der(x)", 2000, "", "derivative=\"1\"") + real2("der(v)", 2001, "", "derivative=\"2\"") +
                   real2("u", 3000, "causality=\"input\"", "start=\"0\"");
  int k = 0;
  for (const auto* name : names)
    unit.variables +=
        real2(name, 4000 + k, parameter, std::string("start=\"") + *(values.begin() + k) + "\" min=\"0\""),
        ++k;
  unit.variables += real2("position", 5000, "causality=\"output\"", "unit=\"m\"");
  unit.structure =
      "<Outputs><Unknown index=\"10\"/></Outputs>"
      "<Derivatives><Unknown index=\"3\"/><Unknown index=\"4\"/></Derivatives>\n";
  return unit;
}

TestUnit rod(const std::string& binary, bool declared) {
  constexpr int kCells = 12, kInput = 2 * kCells + 1, kOutput = kInput + 3;  // variables are counted from 1
  TestUnit unit{.binary = binary,
                .token = "{sealwatch-test-rod}",
                .directional = binary == "fmu_rod_partials2",
                .variables = {},
                .structure = {},
                .interfaces = {},
                .version = {}};
  const auto unknown = [&](int index, const std::string& dependencies) {
    std::string text = "<Unknown index=\"";
    text += std::to_string(index) + "\"";
    if (declared) text += " dependencies=\"" + dependencies + "\"";
    return text + "/>";
  };
  const std::string parameter = "causality=\"parameter\" variability=\"fixed\"";
  const auto cell = [](int k) { return std::string("T").append(std::to_string(k + 1)); };
  for (int k = 0; k < kCells; ++k) unit.variables += real2(cell(k), 1000 + k, "", "");
  for (int k = 0; k < kCells; ++k)
    unit.variables += real2(std::string("der(").append(cell(k)).append(")"), 2000 + k, "",
                            "derivative=\"" + std::to_string(k + 1) + "\"");
  unit.variables += real2("P", 3000, "causality=\"input\"", "start=\"0\"") +
                    real2("C", 4000, parameter, "start=\"1\"") + real2("G", 4001, parameter, "start=\"50\"") +
                    real2("first", 5000, "causality=\"output\"", "") +
                    real2("calls", 5001, "causality=\"output\" variability=\"discrete\"", "");
  unit.structure = "<Outputs>" + unknown(kOutput, "1") + unknown(kOutput + 1, "") + "</Outputs><Derivatives>";
  for (int k = 0; k < kCells; ++k) {
    std::string neighbours = std::to_string(k + 1);
    if (k > 0) neighbours.append(" ").append(std::to_string(k));
    if (k + 1 < kCells) neighbours.append(" ").append(std::to_string(k + 2));
    unit.structure += unknown(kCells + k + 1, k == 0 ? neighbours + " " + std::to_string(kInput) : neighbours);
  }
  unit.structure += "</Derivatives>\n";
  return unit;
}

TestUnit emps() {
  TestUnit unit{.binary = "fmu_emps2",
                .token = "{sealwatch-test-emps}",
                .variables = {},
                .structure = {},
                .interfaces = {},
                .version = {}};
  const std::string parameter = "causality=\"parameter\" variability=\"tunable\"";
  unit.variables =
      real2("x", 1000, "", "unit=\"m\"") + real2("v", 1001, "", "") + real2("der(x)", 2000, "", "derivative=\"1\"") +
      real2("der(v)", 2001, "", "derivative=\"2\"") + real2("u", 3000, "causality=\"input\"", "start=\"0\"") +
      real2("M", 4000, parameter, "start=\"95.1\"") + real2("F_v", 4001, parameter, "start=\"203.5\"") +
      real2("k_F", 4002, parameter, "start=\"35.15\"") + real2("position", 5000, "causality=\"output\"", "unit=\"m\"");
  unit.structure =
      "<Outputs><Unknown index=\"9\"/></Outputs>"
      "<Derivatives><Unknown index=\"3\"/><Unknown index=\"4\"/></Derivatives>\n";
  return unit;
}

TestUnit small_input() {
  TestUnit unit{.binary = "fmu_small_input2",
                .token = "{sealwatch-test-small-input}",
                .variables = {},
                .structure = {},
                .interfaces = {},
                .version = {}};
  unit.variables = real2("x", 1000, "", "") + real2("der(x)", 2000, "", "derivative=\"1\"") +
                   real2("i", 3000, "causality=\"input\"", "start=\"0\" nominal=\"1e-9\"") +
                   real2("y", 5000, "causality=\"output\"", "");
  unit.structure = "<Outputs><Unknown index=\"4\"/></Outputs><Derivatives><Unknown index=\"2\"/></Derivatives>\n";
  return unit;
}

TestUnit dosing() {
  TestUnit unit{.binary = "fmu_dosing2",
                .token = "{sealwatch-test-dosing}",
                .indicators = 1,
                .variables = {},
                .structure = {},
                .interfaces = {},
                .version = {}};
  const std::string parameter = "causality=\"parameter\" variability=\"tunable\"";
  unit.variables = real2("T", 1000, "", "") + real2("der(T)", 2000, "", "derivative=\"1\"") +
                   real2("u", 3000, "causality=\"input\"", "start=\"0\"") +
                   real2("tau", 4000, parameter, "start=\"200\"") + real2("drop", 4001, parameter, "start=\"8\"") +
                   real2("gain", 4002, parameter, "start=\"0.05\"") + real2("y", 5000, "causality=\"output\"", "");
  unit.structure = "<Outputs><Unknown index=\"7\"/></Outputs><Derivatives><Unknown index=\"2\"/></Derivatives>\n";
  return unit;
}

TestUnit gain() {
  TestUnit unit{.binary = "fmu_gain_cs2", .variables = {}, .structure = {}, .interfaces = {}, .version = {}};
  unit.interfaces = "<CoSimulation modelIdentifier=\"model\" canHandleVariableCommunicationStepSize=\"true\"/>\n";
  unit.variables = real2("x", 0, "causality=\"output\"", "") + real2("u", 1, "causality=\"input\"", "start=\"0\"") +
                   real2("k", 2, "causality=\"parameter\" variability=\"fixed\"", "start=\"2\"");
  unit.structure = "<Outputs><Unknown index=\"1\"/></Outputs>\n";
  return unit;
}

TestUnit bouncing(const std::string& binary) {
  TestUnit unit{.binary = binary,
                .token = "{sealwatch-test-bouncing}",
                .indicators = 1,
                .variables = {},
                .structure = {},
                .interfaces = {},
                .version = {}};
  const std::string parameter = "causality=\"parameter\" variability=\"fixed\"";
  if (is_fmi3(unit)) {
    unit.variables = real3("h", 1000, "causality=\"local\"") + real3("v", 1001, "causality=\"local\"") +
                     real3("der(h)", 2000, "derivative=\"1000\"") + real3("der(v)", 2001, "derivative=\"1001\"") +
                     real3("g", 4000, parameter + " start=\"9.81\"") + real3("e", 4001, parameter + " start=\"0.7\"") +
                     real3("w", 4002, parameter + " start=\"3\"") + real3("height", 5000, "causality=\"output\"");
    unit.structure =
        "<Output valueReference=\"5000\"/><ContinuousStateDerivative valueReference=\"2000\"/>"
        "<ContinuousStateDerivative valueReference=\"2001\"/><EventIndicator valueReference=\"1000\"/>\n";
    return unit;
  }
  unit.variables = real2("h", 1000, "", "") + real2("v", 1001, "", "") + real2("der(h)", 2000, "", "derivative=\"1\"") +
                   real2("der(v)", 2001, "", "derivative=\"2\"") + real2("g", 4000, parameter, "start=\"9.81\"") +
                   real2("e", 4001, parameter, "start=\"0.7\"") + real2("w", 4002, parameter, "start=\"3\"") +
                   real2("height", 5000, "causality=\"output\"", "");
  unit.structure =
      "<Outputs><Unknown index=\"8\"/></Outputs>"
      "<Derivatives><Unknown index=\"3\"/><Unknown index=\"4\"/></Derivatives>\n";
  return unit;
}

namespace {

/// A row of a unit of several types, in the words of both versions.
struct MixedRow {
  std::string name, type, causality, attributes;  ///< of FMI 3
  int reference = 0;
  bool discrete = false;
};
const std::vector<MixedRow> kMixed = {{"u_real", "Float64", "input", "start=\"0\"", 1},
                                      {"u_discrete", "Float64", "input", "start=\"0\"", 2, true},
                                      {"u_integer", "Int32", "input", "start=\"0\"", 3, true},
                                      {"u_boolean", "Boolean", "input", "start=\"false\"", 4, true},
                                      {"y_real", "Float64", "output", "", 11},
                                      {"y_discrete", "Float64", "output", "", 12, true},
                                      {"y_integer", "Int32", "output", "", 13, true},
                                      {"y_boolean", "Boolean", "output", "", 14, true},
                                      {"steps", "Int32", "output", "", 20, true},
                                      {"last", "Int32", "parameter", "start=\"1000\"", 21},
                                      {"text", "String", "parameter", "", 22},
                                      {"length", "Int32", "output", "", 23, true},
                                      {"bytes", "Binary", "parameter", "", 24},
                                      {"x0", "Float64", "parameter", "start=\"2\"", 30},
                                      {"x", "Float64", "output", "", 31},
                                      {"der(x)", "Float64", "local", "derivative=\"31\"", 32},
                                      {"k", "Float64", "parameter", "start=\"1\"", 33},
                                      {"now", "Float64", "output", "", 40},
                                      {"began", "Float64", "output", "", 41}};

std::string row2(const MixedRow& row) {
  const std::string type = row.type == "Float64" ? "Real" : row.type == "Int32" ? "Integer" : row.type;
  const std::string variability = row.causality == "parameter" ? "fixed" : row.discrete ? "discrete" : "continuous";
  const std::string inside = row.name == "der(x)"   ? "derivative=\"14\""
                             : row.type == "String" ? "start=\"four\""
                                                    : row.attributes;
  return "<ScalarVariable name=\"" + row.name + "\" valueReference=\"" + std::to_string(row.reference) +
         "\" causality=\"" + row.causality + "\" variability=\"" + variability + "\"><" + type + " " + inside +
         "/></ScalarVariable>\n";
}

std::string row3(const MixedRow& row) {
  const std::string variability = row.causality == "parameter" ? "fixed" : row.discrete ? "discrete" : "continuous";
  const std::string head = "<" + row.type + " name=\"" + row.name + "\" valueReference=\"" +
                           std::to_string(row.reference) + "\" causality=\"" + row.causality + "\" variability=\"" +
                           variability + "\" " + row.attributes;
  return row.type == "String" ? head + "><Start value=\"four\"/></String>\n" : head + "/>\n";
}

}  // namespace

TestUnit mixed(const std::string& binary) {
  TestUnit unit{.binary = binary, .variables = {}, .structure = {}, .interfaces = {}, .version = {}};
  unit.interfaces =
      "<ModelExchange modelIdentifier=\"model\"/><CoSimulation modelIdentifier=\"model\" "
      "canHandleVariableCommunicationStepSize=\"true\"/>\n";
  for (const MixedRow& row : kMixed)
    if (is_fmi3(unit) || row.type != "Binary") unit.variables += is_fmi3(unit) ? row3(row) : row2(row);
  unit.structure = is_fmi3(unit) ? "<ContinuousStateDerivative valueReference=\"32\"/>"
                                   "<InitialUnknown valueReference=\"31\" dependencies=\"30\"/>\n"
                                 : "<Derivatives><Unknown index=\"15\"/></Derivatives>\n";
  return unit;
}

TestUnit arrays() {
  TestUnit unit{.binary = "fmu_arrays3", .variables = {}, .structure = {}, .interfaces = {}, .version = {}};
  const std::string dimension = "><Dimension valueReference=\"1\"/></Float64>\n";
  unit.variables =
      "<UInt64 name=\"n\" valueReference=\"1\" causality=\"structuralParameter\" variability=\"fixed\" start=\"2\"/>\n"
      "<Float64 name=\"x0\" valueReference=\"2\" causality=\"parameter\" variability=\"fixed\" start=\"1 2\"" +
      dimension + "<Float64 name=\"x\" valueReference=\"3\"" + dimension +
      "<Float64 name=\"der(x)\" valueReference=\"4\" derivative=\"3\"" + dimension +
      "<Float64 name=\"y\" valueReference=\"5\" causality=\"output\"/>\n";
  unit.structure = "<Output valueReference=\"5\"/><ContinuousStateDerivative valueReference=\"4\"/>\n";
  return unit;
}

TestUnit types() {
  TestUnit unit{.binary = "fmu_types3", .variables = {}, .structure = {}, .interfaces = {}, .version = {}};
  const auto row = [](const std::string& type, const std::string& name, int reference, const std::string& attributes,
                      const std::string& dimension = "") {
    return "<" + type + " name=\"" + name + "\" valueReference=\"" + std::to_string(reference) + "\" " + attributes +
           (dimension.empty() ? "/>\n" : "><Dimension " + dimension + "/></" + type + ">\n");
  };
  const std::string parameter = "causality=\"parameter\" variability=\"fixed\" start=",
                    input = "causality=\"input\" start=\"0\"", of_n = "valueReference=\"1\"", two = "start=\"2\"";
  unit.variables =
      row("UInt64", "n", 1, "causality=\"structuralParameter\" variability=\"fixed\" start=\"2\"") +
      row("Float64", "x", 2, "start=\"0 0\"", of_n) + row("Float64", "der(x)", 3, "derivative=\"2\"", of_n) +
      row("Float32", "w", 4, parameter + "\"1 2\"", of_n) + row("Int8", "divisor", 5, parameter + "\"1\"") +
      row("Float32", "u", 6, input) + row("Int64", "s", 7, input) + row("Enumeration", "e", 8, input) +
      row("UInt16", "counts", 9, "causality=\"input\" start=\"0 0\"", two) +
      row("Boolean", "flags", 24, parameter + "\"false false\"", two) +
      row("Float32", "low", 20, "causality=\"output\"") + row("Float64", "y", 21, "causality=\"output\"") +
      row("UInt8", "y_byte", 22, "causality=\"output\"") + row("Enumeration", "y_item", 23, "causality=\"output\"");
  unit.structure = "<Output valueReference=\"21\"/><ContinuousStateDerivative valueReference=\"3\"/>\n";
  return unit;
}

TestUnit masses() {
  TestUnit unit{.binary = "fmu_masses3", .variables = {}, .structure = {}, .interfaces = {}, .version = {}};
  const auto array = [](const std::string& name, int reference, const std::string& attributes, int size) {
    return "<Float64 name=\"" + name + "\" valueReference=\"" + std::to_string(reference) + "\" " + attributes +
           "><Dimension start=\"" + std::to_string(size) + "\"/></Float64>\n";
  };
  const std::string parameter = "causality=\"parameter\" variability=\"fixed\"";
  unit.variables = array("x", 1, "start=\"0 0 0 0\"", 4) + array("der(x)", 2, "derivative=\"1\"", 4) +
                   array("m", 3, parameter + " start=\"12 8\"", 2) +
                   array("f", 4, "causality=\"input\" unit=\"N\" start=\"0 0\"", 2) +
                   array("y", 5, "causality=\"output\" unit=\"mm\"", 2) + real3("k", 6, parameter + " start=\"5e4\"");
  unit.structure = "<Output valueReference=\"5\"/><ContinuousStateDerivative valueReference=\"2\"/>\n";
  return unit;
}

TestFolder::TestFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "sealwatch_test_XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) std::abort();
  path_ = name;
  setenv("SEALWATCH_FMU_HOST", SEALWATCH_FMU_HOST_PROGRAM, 1);
}

TestFolder::~TestFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::string TestFolder::build(const TestUnit& unit, const std::string& name) const {
  const std::string binary = content_of(std::filesystem::path(SEALWATCH_TEST_FMUS) / (unit.binary + ".so"));
  const std::string platform = is_fmi3(unit) ? "x86_64-linux" : "linux64";
  std::vector<TestMember> members = {{"modelDescription.xml", description_of(unit)},
                                     {"binaries/" + platform + "/model.so", binary},
                                     {"resources/", ""}};
  if (!unit.library.empty())
    members.push_back({"binaries/" + platform + "/" + unit.library,
                       content_of(std::filesystem::path(SEALWATCH_TEST_FMUS) / unit.library)});
  write_archive(path_ / name, members);
  return (path_ / name).string();
}

}  // namespace sealwatch::fmi
