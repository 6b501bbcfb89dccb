// Any bytes as a plant's file: faults that all say what is wrong, or a plant whose equations can be evaluated and
// differentiated; never a crash. The catalogue has two laws here, and FMUs have fuzzers of their own.
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <deque>
#include <string>

#include "sealwatch/model/physics.hpp"
#include "services/common/fmi/fmu_plant.hpp"
#include "services/common/runtime/plant_file.hpp"

namespace sealwatch {

namespace laws {
Law coulomb_friction();
Law quadratic_drag();
}  // namespace laws

std::deque<Law>& law_catalogue() {
  static std::deque<Law> laws = {laws::coulomb_friction(), laws::quadratic_drag()};
  return laws;
}

Result<const PlantDescription*> find_plant(std::string_view name) {
  return fail(Error{.file = {}, .place = {}, .value = std::string(name), .rule = "is not a known model", .advice = {}});
}

Status add_plant(RuntimePlant) { return {}; }

std::optional<equations::BuiltPlant> fmi::build_fmu_plant(const equations::TextPlant&, const FmuSection&,
                                                          const equations::Faults& faults) {
  faults("fmu", Error{.file = {}, .place = {}, .value = {}, .rule = "is not read here", .advice = {}});
  return std::nullopt;
}

namespace {

void require(bool holds) {
  if (!holds) std::abort();
}

/// A file in memory.
class File {
 public:
  File(const std::uint8_t* data, std::size_t size) : descriptor_(memfd_create("plant", 0)) {
    require(descriptor_ >= 0 && write(descriptor_, data, size) == static_cast<ssize_t>(size));
  }
  ~File() { close(descriptor_); }
  [[nodiscard]] std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_;
};

void evaluate(const RuntimePlant& plant) {
  const PlantDescription& description = plant.description;
  std::vector<double> parameters;
  std::vector<std::size_t> all;
  for (const ParameterDescription& row : description.parameters) {
    all.push_back(parameters.size());
    parameters.push_back(row.value);
  }
  const std::vector<double> states(plant.states.size(), 0.5), inputs(plant.inputs.size(), 0.5),
      added(description.sites.size(), 0.0);
  const RuntimePoint point{.time_s = 0.0,
                           .states = states,
                           .inputs = inputs,
                           .input_rates = inputs,
                           .parameters = parameters,
                           .added = added};
  const auto evaluator = plant.equations->evaluator(point, all);
  require(evaluator.has_value());
  for (const auto function : {RuntimeFunction::derivatives, RuntimeFunction::signals, RuntimeFunction::outputs})
    require((*evaluator)->linearise(function, point, {.states = true, .parameters = true, .added = true}) != nullptr);
}

}  // namespace
}  // namespace sealwatch

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const sealwatch::File file(data, size);
  const auto read = sealwatch::read_plant_file(file.path());
  if (read)
    sealwatch::evaluate(read->built.plant);
  else
    for (const sealwatch::Error& error : read.error()) sealwatch::require(!error.rule.empty());
  return 0;
}
