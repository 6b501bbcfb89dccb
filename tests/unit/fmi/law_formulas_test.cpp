// The catalogue's laws as formulas: compiled as C by the compiler that is there, each gives what the law itself gives.
#include <dlfcn.h>
#include <gmock/gmock.h>

#include <cstdlib>
#include <fstream>
#include <random>

#include "sealwatch/model/law_sizes.hpp"
#include "services/common/fmi/export/law_code.hpp"
#include "services/common/fmi/export/law_formulas.hpp"
#include "tests/unit/fmi/fmu_builder.hpp"

namespace sealwatch::fmi {
namespace {

using testing::HasSubstr;

constexpr const char* kArguments =
    "(double s1, double s2, double s3, double s4, double h, double p1, double p2, double p3, double p4, "
    "double r1, double r2, double r3)";
using Formula = double(double, double, double, double, double, double, double, double, double, double, double, double);

/// All laws that act on a plant, one C file of them, loaded.
class CompiledLaws {
 public:
  CompiledLaws() {
    std::ofstream source(folder_ / "laws.c");
    source << "#include <math.h>\n" << helper_functions_c();
    for (const Law& law : all_laws()) {
      if (!law.evaluate || !law.plant.empty()) continue;
      const LawFormula* formula = find_formula(law);
      if (formula == nullptr) {
        missing_.push_back(std::string(law.id) + "/" + std::string(law.form));
        continue;
      }
      laws_.push_back(&law);
      const std::string number = std::to_string(laws_.size());
      const std::string_view rate = formula->rate.empty() ? "0.0" : formula->rate;
      for (const auto& [name, text] : {std::pair{"law", formula->contribution}, {"rate", rate}})
        source << "double " << name << number << kArguments << " { return " << in_c(text) << "; }\n";
    }
    source.close();
    const std::string file = (folder_ / "laws.so").string();
    const std::string command = "cc -O1 -fPIC -shared -o " + file + " " + (folder_ / "laws.c").string() + " -lm";
    if (std::system(command.c_str()) == 0) library_ = dlopen(file.c_str(), RTLD_NOW);
  }
  ~CompiledLaws() {
    if (library_ != nullptr) dlclose(library_);
  }
  [[nodiscard]] bool loaded() const { return library_ != nullptr; }
  [[nodiscard]] const std::vector<const Law*>& laws() const { return laws_; }
  [[nodiscard]] const std::vector<std::string>& missing() const { return missing_; }
  [[nodiscard]] Formula* find(const std::string& name) const {
    return reinterpret_cast<Formula*>(dlsym(library_, name.c_str()));
  }

 private:
  TestFolder folder_;
  void* library_ = nullptr;
  std::vector<const Law*> laws_;
  std::vector<std::string> missing_;
};

/// Signals of the size that the law's kind of site has, of both signs.
std::array<double, 4> signals_for(const Law& law, std::mt19937& random) {
  const double pressures = law.kind == SiteKind::piston_force || law.kind == SiteKind::voltage_command ? 1.0 : 1e6;
  std::uniform_real_distribution<double> any(-2.0, 2.0);
  std::array signals = {any(random), any(random), any(random), any(random)};
  if (law.kind == SiteKind::piston_force) signals[0] *= 1e-3, signals[1] *= 0.05, signals[2] *= 1e7, signals[3] *= 1e6;
  if (pressures > 1.0) signals[0] *= pressures;
  return signals;
}

TEST(LawFormulas, AreTheLaws) {
  const CompiledLaws compiled;
  EXPECT_THAT(compiled.missing(), testing::IsEmpty()) << "a law needs a row in law_formulas.cpp";
  if (!compiled.loaded()) GTEST_SKIP() << "no C compiler here";
  EXPECT_GT(compiled.laws().size(), 70U);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (std::size_t k = 0; k < compiled.laws().size(); ++k) {
    const Law& law = *compiled.laws()[k];
    Formula* contribution = compiled.find("law" + std::to_string(k + 1));
    Formula* rate = compiled.find("rate" + std::to_string(k + 1));
    for (int trial = 0; trial < 20; ++trial) {
      const std::array s = signals_for(law, random);
      const double h = 2.0 * share(random) - 1.0;
      std::array p = {1.0, 1.0, 1.0, 1.0};
      for (std::size_t i = 0; i < law.parameters.size(); ++i)
        p[i] = law.parameters[i].start.front() * (0.5 + share(random));
      Roundings r = roundings_of(law);
      for (double& width : r) width *= 0.5 + share(random);  // of another plant
      const LawOutput expected = law.evaluate(law_input(s, h, std::span(p).first(law.parameters.size()), r));
      const double found = contribution(s[0], s[1], s[2], s[3], h, p[0], p[1], p[2], p[3], r[0], r[1], r[2]);
      const double found_rate = rate(s[0], s[1], s[2], s[3], h, p[0], p[1], p[2], p[3], r[0], r[1], r[2]);
      constexpr double kRounding = 1e-9;
      const double near_zero = 1e-10 * std::abs(p[0]);  // where large terms cancel
      EXPECT_NEAR(found, expected.contribution.value, kRounding * std::abs(expected.contribution.value) + near_zero)
          << law.id << " " << law.form;
      EXPECT_NEAR(found_rate, expected.rate.value, kRounding * std::abs(expected.rate.value))
          << law.id << " " << law.form;
    }
  }
}

TEST(LawFormulas, BecomeFunctionsWithTheFoundValues) {
  AssetConfig asset;
  asset.asset_id = "V-7";
  asset.model = "emps";
  asset.physics = {{.id = "coulomb_friction", .element = "piston", .parameters = {}}};
  asset.physics[0].parameters["F_c"].value = 20.25;
  asset.physics[0].parameters["v_s"].value = 1e-3;
  const LawCode code = law_code(**find_plant("emps"), asset);
  EXPECT_THAT(code.c, HasSubstr("double piston_coulomb_friction(double s1, double s2"));
  EXPECT_THAT(code.c, HasSubstr("const double p1 = 20.25; /* F_c: friction force [N] */"));
  EXPECT_THAT(code.c, HasSubstr("return p1 * tanh(s1 / p2);"));
  EXPECT_THAT(code.modelica, HasSubstr("function piston_coulomb_friction"));
  EXPECT_THAT(code.modelica, HasSubstr("input Real p1 = 20.25 \"F_c: friction force [N]\";"));
}

}  // namespace
}  // namespace sealwatch::fmi
