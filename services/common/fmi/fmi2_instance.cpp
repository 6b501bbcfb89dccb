#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <limits>

#include "services/common/fmi/fmi_instance.hpp"

namespace sealwatch::fmi {
namespace {

constexpr int kModelExchange = 0, kCoSimulation = 1;

void log_message(void*, const char*, int status, const char* category, const char* message, ...) {
  std::array<char, 1024> text{};
  va_list arguments;
  va_start(arguments, message);
  if (message != nullptr) std::vsnprintf(text.data(), text.size(), message, arguments);
  va_end(arguments);
  messages().add(status, category == nullptr ? "" : category, text.data());
}

constexpr fmi2::Callbacks kCallbacks = {&log_message, &std::calloc, &std::free, nullptr, nullptr};

struct Functions {
  fmi2::Instantiate* instantiate;
  FreeInstance* free;
  fmi2::SetupExperiment* setup;
  Plain *enter_initialization, *exit_initialization, *enter_event, *enter_continuous, *terminate;
  fmi2::Get<double>* get_real;
  fmi2::Set<double>* set_real;
  fmi2::Get<int>*get_integer, *get_boolean;
  fmi2::Set<int>*set_integer, *set_boolean;
  fmi2::Set<const char*>* set_string;
  fmi2::NewDiscreteStates* new_discrete_states;
  SetTime* set_time;
  SetVector* set_states;
  GetVector *get_states, *get_nominals, *get_derivatives, *get_indicators;
  fmi2::CompletedStep* completed_step;
  fmi2::Directional* directional;
  fmi2::DoStep* do_step;
  fmi2::GetStatus<double>* real_status;
  fmi2::GetStatus<fmi2::Boolean>* boolean_status;

  Functions(const Library& library, bool co_simulation)
      : instantiate(library.find<fmi2::Instantiate>("fmi2Instantiate")),
        free(library.find<FreeInstance>("fmi2FreeInstance")),
        setup(library.find<fmi2::SetupExperiment>("fmi2SetupExperiment")),
        enter_initialization(library.find<Plain>("fmi2EnterInitializationMode")),
        exit_initialization(library.find<Plain>("fmi2ExitInitializationMode")),
        enter_event(library.find<Plain>("fmi2EnterEventMode", !co_simulation)),
        enter_continuous(library.find<Plain>("fmi2EnterContinuousTimeMode", !co_simulation)),
        terminate(library.find<Plain>("fmi2Terminate")),
        get_real(library.find<fmi2::Get<double>>("fmi2GetReal")),
        set_real(library.find<fmi2::Set<double>>("fmi2SetReal")),
        get_integer(library.find<fmi2::Get<int>>("fmi2GetInteger")),
        get_boolean(library.find<fmi2::Get<int>>("fmi2GetBoolean")),
        set_integer(library.find<fmi2::Set<int>>("fmi2SetInteger")),
        set_boolean(library.find<fmi2::Set<int>>("fmi2SetBoolean")),
        set_string(library.find<fmi2::Set<const char*>>("fmi2SetString", false)),
        new_discrete_states(library.find<fmi2::NewDiscreteStates>("fmi2NewDiscreteStates", !co_simulation)),
        set_time(library.find<SetTime>("fmi2SetTime", !co_simulation)),
        set_states(library.find<SetVector>("fmi2SetContinuousStates", !co_simulation)),
        get_states(library.find<GetVector>("fmi2GetContinuousStates", !co_simulation)),
        get_nominals(library.find<GetVector>("fmi2GetNominalsOfContinuousStates", !co_simulation)),
        get_derivatives(library.find<GetVector>("fmi2GetDerivatives", !co_simulation)),
        get_indicators(library.find<GetVector>("fmi2GetEventIndicators", !co_simulation)),
        completed_step(library.find<fmi2::CompletedStep>("fmi2CompletedIntegratorStep", !co_simulation)),
        directional(library.find<fmi2::Directional>("fmi2GetDirectionalDerivative", false)),
        do_step(library.find<fmi2::DoStep>("fmi2DoStep", co_simulation)),
        real_status(library.find<fmi2::GetStatus<double>>("fmi2GetRealStatus", false)),
        boolean_status(library.find<fmi2::GetStatus<fmi2::Boolean>>("fmi2GetBooleanStatus", false)) {}
};

class Fmi2Instance final : public FmiInstance {
 public:
  Fmi2Instance(const Functions& functions, const Setup& setup) : f_(functions), co_simulation_(setup.co_simulation) {
    instance_ = f_.instantiate("sealwatch", co_simulation_ ? kCoSimulation : kModelExchange, setup.token.c_str(),
                               setup.resources.c_str(), &kCallbacks, 0, 0);
    if (instance_ == nullptr) throw Failure{"fmi2Instantiate gave no instance"};
  }
  ~Fmi2Instance() override { f_.free(instance_); }

  void set_constants(std::span<const Constant> constants) override {
    for (const Constant& constant : constants) {
      if (constant.handle.type != FmiType::string) {
        set(Group({constant.handle}), numbers_of(constant));
        continue;
      }
      if (f_.set_string == nullptr) throw Failure{"the binary has no function fmi2SetString"};
      const char* text = constant.text.c_str();
      check(f_.set_string(instance_, &constant.handle.reference, 1, &text), "fmi2SetString");
    }
  }
  EventOutcome initialise(double start_time, double stop_time, const Group& parameters,
                          std::span<const double> parameter_values, const Group& inputs,
                          std::span<const double> input_values) override {
    set(parameters, parameter_values);
    const bool stops = std::isfinite(stop_time);
    check(f_.setup(instance_, 0, 0.0, start_time, stops ? 1 : 0, stops ? stop_time : 0.0), "fmi2SetupExperiment");
    check(f_.enter_initialization(instance_), "fmi2EnterInitializationMode");
    set(inputs, input_values);
    check(f_.exit_initialization(instance_), "fmi2ExitInitializationMode");
    if (co_simulation_) return {.next_time_s = std::numeric_limits<double>::infinity()};
    return settle_event();  // the standard leaves it in event mode
  }
  void set(const Group& group, std::span<const double> values) override {
    if (group.all_float64) {
      if (group.size > 0)
        check(f_.set_real(instance_, group.references.data(), group.size, values.data()), "fmi2SetReal");
      return;
    }
    for (std::size_t k = 0; k < group.handles.size(); ++k) {
      const Handle& handle = group.handles[k];
      if (handle.type == FmiType::float64) {
        check(f_.set_real(instance_, &handle.reference, 1, &values[k]), "fmi2SetReal");
      } else if (handle.type == FmiType::boolean) {
        const int value = values[k] != 0.0 ? 1 : 0;
        check(f_.set_boolean(instance_, &handle.reference, 1, &value), "fmi2SetBoolean");
      } else {
        constexpr double kLeast = std::numeric_limits<int>::min(), kMost = std::numeric_limits<int>::max();
        const int value = static_cast<int>(std::clamp(std::round(values[k]), kLeast, kMost));
        check(f_.set_integer(instance_, &handle.reference, 1, &value), "fmi2SetInteger");
      }
    }
  }
  void get(const Group& group, std::span<double> values) override {
    if (group.all_float64) {
      if (group.size > 0)
        check(f_.get_real(instance_, group.references.data(), group.size, values.data()), "fmi2GetReal");
      return;
    }
    for (std::size_t k = 0; k < group.handles.size(); ++k) {
      const Handle& handle = group.handles[k];
      int value = 0;
      if (handle.type == FmiType::float64) {
        check(f_.get_real(instance_, &handle.reference, 1, &values[k]), "fmi2GetReal");
        continue;
      }
      if (handle.type == FmiType::boolean)
        check(f_.get_boolean(instance_, &handle.reference, 1, &value), "fmi2GetBoolean");
      else
        check(f_.get_integer(instance_, &handle.reference, 1, &value), "fmi2GetInteger");
      values[k] = value;
    }
  }
  void set_time(double time) override { check(f_.set_time(instance_, time), "fmi2SetTime"); }
  void set_states(std::span<const double> states) override {
    check(f_.set_states(instance_, states.data(), states.size()), "fmi2SetContinuousStates");
  }
  void get_states(std::span<double> states) override {
    check(f_.get_states(instance_, states.data(), states.size()), "fmi2GetContinuousStates");
  }
  void get_nominals(std::span<double> nominals) override {
    check(f_.get_nominals(instance_, nominals.data(), nominals.size()), "fmi2GetNominalsOfContinuousStates");
  }
  void get_derivatives(std::span<double> derivatives) override {
    check(f_.get_derivatives(instance_, derivatives.data(), derivatives.size()), "fmi2GetDerivatives");
  }
  void get_event_indicators(std::span<double> indicators) override {
    check(f_.get_indicators(instance_, indicators.data(), indicators.size()), "fmi2GetEventIndicators");
  }
  void directional(std::span<const Reference> unknowns, std::span<const Reference> knowns, std::span<const double> seed,
                   std::span<double> sensitivity) override {
    if (f_.directional == nullptr) throw Failure{"the binary has no function fmi2GetDirectionalDerivative"};
    check(f_.directional(instance_, unknowns.data(), unknowns.size(), knowns.data(), knowns.size(), seed.data(),
                         sensitivity.data()),
          "fmi2GetDirectionalDerivative");
  }
  void enter_event_mode() override { check(f_.enter_event(instance_), "fmi2EnterEventMode"); }
  EventOutcome settle_event() override {
    constexpr int kMostRounds = 1000;
    EventOutcome outcome;
    fmi2::EventInfo info{};
    info.again = 1;
    for (int round = 0; info.again != 0; ++round) {
      if (round == kMostRounds) throw Failure{"the event never settles: fmi2NewDiscreteStates asks for ever more"};
      info = {};
      check(f_.new_discrete_states(instance_, &info), "fmi2NewDiscreteStates");
      outcome.terminate = outcome.terminate || info.terminate != 0;
      outcome.values_changed = outcome.values_changed || info.values_changed != 0;
    }
    outcome.next_time_s = info.next_time_defined != 0 ? info.next_time_s : std::numeric_limits<double>::infinity();
    check(f_.enter_continuous(instance_), "fmi2EnterContinuousTimeMode");
    return outcome;
  }
  StepOutcome completed_step() override {
    fmi2::Boolean event = 0, terminate = 0;
    check(f_.completed_step(instance_, 1, &event, &terminate), "fmi2CompletedIntegratorStep");
    return {event != 0, terminate != 0};
  }
  CoStep do_step(double time, double step) override {
    const int status = f_.do_step(instance_, time, step, 1);
    CoStep done{.terminate = false, .reached_s = time + step};
    fmi2::Boolean terminated = 0;
    // A unit that ends the simulation by itself discards the rest of the step.
    if (status == kDiscard && f_.boolean_status != nullptr &&
        f_.boolean_status(instance_, fmi2::kTerminated, &terminated) == kOkStatus && terminated != 0) {
      done.terminate = true;
      if (f_.real_status == nullptr ||
          f_.real_status(instance_, fmi2::kLastSuccessfulTime, &done.reached_s) != kOkStatus)
        done.reached_s = time + step;
      return done;
    }
    check(status, "fmi2DoStep");
    return done;
  }

 private:
  const Functions& f_;
  bool co_simulation_;
  Instance instance_ = nullptr;
};

}  // namespace

MakeInstance fmi2_instances(const Library& library, const Setup& setup) {
  const auto functions = std::make_shared<const Functions>(library, setup.co_simulation != 0);
  return [functions, &setup] { return std::make_unique<Fmi2Instance>(*functions, setup); };
}

}  // namespace sealwatch::fmi
