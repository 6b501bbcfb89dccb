#include "services/common/fmi/plant_host.hpp"

#include "sealwatch/core/file.hpp"
#include "sealwatch/core/text.hpp"
#include "services/common/fmi/fmi_instance.hpp"
#include "services/common/fmi/fmu_archive.hpp"
#include "services/common/model/runtime_simulation.hpp"
#include "services/common/runtime/plant_file.hpp"

namespace sealwatch::fmi {
namespace {

/// Columns whose weights the asker knows.
class AskedColumns final : public InjectedColumns {
 public:
  AskedColumns(Conversation& conversation, const HostedRun& run) : conversation_(conversation), run_(run) {}
  [[nodiscard]] std::size_t columns() const override { return run_.injected_columns; }
  [[nodiscard]] std::span<const Entry> entries() const override { return run_.entries; }
  void weigh(double t, Signals signals, std::span<double> weights) override {
    Packer question(conversation_.heap());
    question.put(t);
    for (const auto& site : signals) question.put_numbers(site);
    conversation_.ask();
    Unpacker answer(conversation_.heap());
    std::ranges::copy(answer.numbers(weights.size()), weights.begin());
  }

 private:
  Conversation& conversation_;
  const HostedRun& run_;
};

}  // namespace

void PlantHost::load(Unpacker request) {
  const HostedPlant hosted = get_plant(request);
  if (content_hash(read_file(hosted.file, kLongestYaml_bytes).value_or("")) != hosted.hash)
    throw Failure{"the plant file " + hosted.file + " has been changed meanwhile"};
  use_unpacked(hosted.fmu_folder);
  const auto plant = load_plant(hosted.file);
  if (!plant) throw Failure{plant.error().front().describe()};
}

void PlantHost::make_simulation(Unpacker request) {
  const auto place = static_cast<std::size_t>(request.get<std::uint64_t>());
  const HostedSimulation hosted = get_simulation(request);
  auto simulation = PlantSimulation::create(hosted.asset, hosted.recorded);
  if (!simulation) throw Failure{simulation.error().describe()};
  if (simulations_.size() <= place) simulations_.resize(place + 1);
  simulations_[place] = std::move(*simulation);
}

void PlantHost::run(Unpacker request) {
  const auto place = static_cast<std::size_t>(request.get<std::uint64_t>());
  const auto& simulation = dynamic_cast<const RuntimePlantSimulation&>(*simulations_.at(place));
  Result<HostedRun> run = get_run(request, simulation.plant());
  if (!run) throw Failure{run.error().describe()};
  stop_ = {};
  const Deadline deadline(stop_.get_token());
  run->options.deadline = &deadline;
  AskedColumns asked(conversation_, *run);
  LawColumns laws(run->laws, simulation.plant());
  InjectedColumns* injected = run->laws.empty() ? static_cast<InjectedColumns*>(&asked) : &laws;
  if (!run->injected) injected = nullptr;
  auto outputs = simulation.run_driven_by(run->input, run->values, run->free, run->options, injected);
  if (outputs && injected == &laws) laws.mark_not_finite(outputs->sensitivities);
  Packer answer(conversation_.heap());
  put_outputs(answer, outputs);
}

}  // namespace sealwatch::fmi
