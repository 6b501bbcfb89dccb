#include <algorithm>
#include <cmath>
#include <limits>

#include "services/common/fmi/fmi_instance.hpp"

namespace sealwatch::fmi {
namespace {

void log_message(void*, int status, const char* category, const char* message) {
  messages().add(status, category == nullptr ? "" : category, message == nullptr ? "" : message);
}

struct Functions {
  fmi3::InstantiateModelExchange* instantiate_exchange;
  fmi3::InstantiateCoSimulation* instantiate_co_simulation;
  FreeInstance* free;
  fmi3::EnterInitialization* enter_initialization;
  Plain *exit_initialization, *enter_event, *enter_continuous, *enter_configuration, *exit_configuration;
  fmi3::Get<double>* get_float64;
  fmi3::Set<double>* set_float64;
  fmi3::UpdateDiscreteStates* update;
  SetTime* set_time;
  SetVector* set_states;
  GetVector *get_states, *get_nominals, *get_derivatives, *get_indicators;
  fmi3::CompletedStep* completed_step;
  fmi3::Directional* directional;
  fmi3::DoStep* do_step;

  Functions(const Library& library, bool co_simulation)
      : instantiate_exchange(
            library.find<fmi3::InstantiateModelExchange>("fmi3InstantiateModelExchange", !co_simulation)),
        instantiate_co_simulation(
            library.find<fmi3::InstantiateCoSimulation>("fmi3InstantiateCoSimulation", co_simulation)),
        free(library.find<FreeInstance>("fmi3FreeInstance")),
        enter_initialization(library.find<fmi3::EnterInitialization>("fmi3EnterInitializationMode")),
        exit_initialization(library.find<Plain>("fmi3ExitInitializationMode")),
        enter_event(library.find<Plain>("fmi3EnterEventMode", !co_simulation)),
        enter_continuous(library.find<Plain>("fmi3EnterContinuousTimeMode", !co_simulation)),
        enter_configuration(library.find<Plain>("fmi3EnterConfigurationMode", false)),
        exit_configuration(library.find<Plain>("fmi3ExitConfigurationMode", false)),
        get_float64(library.find<fmi3::Get<double>>("fmi3GetFloat64")),
        set_float64(library.find<fmi3::Set<double>>("fmi3SetFloat64")),
        update(library.find<fmi3::UpdateDiscreteStates>("fmi3UpdateDiscreteStates", !co_simulation)),
        set_time(library.find<SetTime>("fmi3SetTime", !co_simulation)),
        set_states(library.find<SetVector>("fmi3SetContinuousStates", !co_simulation)),
        get_states(library.find<GetVector>("fmi3GetContinuousStates", !co_simulation)),
        get_nominals(library.find<GetVector>("fmi3GetNominalsOfContinuousStates", !co_simulation)),
        get_derivatives(library.find<GetVector>("fmi3GetContinuousStateDerivatives", !co_simulation)),
        get_indicators(library.find<GetVector>("fmi3GetEventIndicators", !co_simulation)),
        completed_step(library.find<fmi3::CompletedStep>("fmi3CompletedIntegratorStep", !co_simulation)),
        directional(library.find<fmi3::Directional>("fmi3GetDirectionalDerivative", false)),
        do_step(library.find<fmi3::DoStep>("fmi3DoStep", co_simulation)) {}
};

/// Functions of one type of variable: fmi3GetInt32, fmi3SetInt32.
template <class T>
void get_as(const Library& library, Instance instance, const char* name, const Handle& handle, double* values) {
  std::vector<T> typed(handle.size);
  // vector<bool> has no array beneath it, so booleans come as bytes, which bool is.
  check(library.find<fmi3::Get<T>>(name)(instance, &handle.reference, 1, typed.data(), typed.size()), name);
  std::ranges::copy(typed, values);
}

/// The nearest number of the type: the largest of 64 bits has a double beside it that is larger.
template <class T>
T rounded(double value) {
  constexpr T kLeast = std::numeric_limits<T>::min(), kMost = std::numeric_limits<T>::max();
  const double whole = std::round(value);
  if (!(whole > static_cast<double>(kLeast))) return kLeast;
  return whole >= static_cast<double>(kMost) ? kMost : static_cast<T>(whole);
}

template <class T>
void set_as(const Library& library, Instance instance, const char* name, const Handle& handle, const double* values) {
  std::vector<T> typed(handle.size);
  for (std::size_t k = 0; k < handle.size; ++k) {
    if (handle.type == FmiType::boolean)
      typed[k] = values[k] != 0.0 ? 1 : 0;
    else if constexpr (std::is_integral_v<T>)
      typed[k] = rounded<T>(values[k]);
    else
      typed[k] = static_cast<T>(values[k]);
  }
  check(library.find<fmi3::Set<T>>(name)(instance, &handle.reference, 1, typed.data(), typed.size()), name);
}

class Fmi3Instance final : public FmiInstance {
 public:
  Fmi3Instance(const Functions& functions, const Library& library, const Setup& setup)
      : f_(functions), library_(library), co_simulation_(setup.co_simulation) {
    const char* function = co_simulation_ ? "fmi3InstantiateCoSimulation" : "fmi3InstantiateModelExchange";
    instance_ = co_simulation_
                    ? f_.instantiate_co_simulation("sealwatch", setup.token.c_str(), setup.resources.c_str(), false,
                                                   false, false, false, nullptr, 0, nullptr, &log_message, nullptr)
                    : f_.instantiate_exchange("sealwatch", setup.token.c_str(), setup.resources.c_str(), false, false,
                                              nullptr, &log_message);
    if (instance_ == nullptr) throw Failure{std::string(function) + " gave no instance"};
  }
  ~Fmi3Instance() override { f_.free(instance_); }

  void set_constants(std::span<const Constant> constants) override {
    const bool structural = !constants.empty() && constants.front().structural;
    if (structural && (f_.enter_configuration == nullptr || f_.exit_configuration == nullptr))
      throw Failure{"the binary has no configuration mode, in which structural parameters are set"};
    if (structural) check(f_.enter_configuration(instance_), "fmi3EnterConfigurationMode");
    bool configuring = structural;
    for (const Constant& constant : constants) {
      if (configuring && !constant.structural) {
        check(f_.exit_configuration(instance_), "fmi3ExitConfigurationMode");
        configuring = false;
      }
      set_constant(constant);
    }
    if (configuring) check(f_.exit_configuration(instance_), "fmi3ExitConfigurationMode");
  }
  EventOutcome initialise(double start_time, double stop_time, const Group& parameters,
                          std::span<const double> parameter_values, const Group& inputs,
                          std::span<const double> input_values) override {
    set(parameters, parameter_values);
    const bool stops = std::isfinite(stop_time);
    check(f_.enter_initialization(instance_, false, 0.0, start_time, stops, stops ? stop_time : 0.0),
          "fmi3EnterInitializationMode");
    set(inputs, input_values);
    check(f_.exit_initialization(instance_), "fmi3ExitInitializationMode");
    if (co_simulation_) return {.next_time_s = std::numeric_limits<double>::infinity()};
    return settle_event();
  }
  void set(const Group& group, std::span<const double> values) override {
    if (group.all_float64) {
      if (group.size > 0)
        check(f_.set_float64(instance_, group.references.data(), group.references.size(), values.data(), group.size),
              "fmi3SetFloat64");
      return;
    }
    const double* value = values.data();
    for (const Handle& handle : group.handles) {
      set_one(handle, value);
      value += handle.size;
    }
  }
  void get(const Group& group, std::span<double> values) override {
    if (group.all_float64) {
      if (group.size > 0)
        check(f_.get_float64(instance_, group.references.data(), group.references.size(), values.data(), group.size),
              "fmi3GetFloat64");
      return;
    }
    double* value = values.data();
    for (const Handle& handle : group.handles) {
      get_one(handle, value);
      value += handle.size;
    }
  }
  void set_time(double time) override { check(f_.set_time(instance_, time), "fmi3SetTime"); }
  void set_states(std::span<const double> states) override {
    check(f_.set_states(instance_, states.data(), states.size()), "fmi3SetContinuousStates");
  }
  void get_states(std::span<double> states) override {
    check(f_.get_states(instance_, states.data(), states.size()), "fmi3GetContinuousStates");
  }
  void get_nominals(std::span<double> nominals) override {
    check(f_.get_nominals(instance_, nominals.data(), nominals.size()), "fmi3GetNominalsOfContinuousStates");
  }
  void get_derivatives(std::span<double> derivatives) override {
    check(f_.get_derivatives(instance_, derivatives.data(), derivatives.size()), "fmi3GetContinuousStateDerivatives");
  }
  void get_event_indicators(std::span<double> indicators) override {
    check(f_.get_indicators(instance_, indicators.data(), indicators.size()), "fmi3GetEventIndicators");
  }
  void directional(std::span<const Reference> unknowns, std::span<const Reference> knowns, std::span<const double> seed,
                   std::span<double> sensitivity) override {
    if (f_.directional == nullptr) throw Failure{"the binary has no function fmi3GetDirectionalDerivative"};
    check(f_.directional(instance_, unknowns.data(), unknowns.size(), knowns.data(), knowns.size(), seed.data(),
                         seed.size(), sensitivity.data(), sensitivity.size()),
          "fmi3GetDirectionalDerivative");
  }
  void enter_event_mode() override { check(f_.enter_event(instance_), "fmi3EnterEventMode"); }
  EventOutcome settle_event() override {
    constexpr int kMostRounds = 1000;
    EventOutcome outcome;
    bool again = true, next_defined = false;
    double next = 0.0;
    for (int round = 0; again; ++round) {
      if (round == kMostRounds) throw Failure{"the event never settles: fmi3UpdateDiscreteStates asks for ever more"};
      bool terminate = false, nominals = false, values = false;
      again = false, next_defined = false;
      check(f_.update(instance_, &again, &terminate, &nominals, &values, &next_defined, &next),
            "fmi3UpdateDiscreteStates");
      outcome.terminate = outcome.terminate || terminate;
      outcome.values_changed = outcome.values_changed || values;
    }
    outcome.next_time_s = next_defined ? next : std::numeric_limits<double>::infinity();
    check(f_.enter_continuous(instance_), "fmi3EnterContinuousTimeMode");
    return outcome;
  }
  StepOutcome completed_step() override {
    bool event = false, terminate = false;
    check(f_.completed_step(instance_, true, &event, &terminate), "fmi3CompletedIntegratorStep");
    return {event, terminate};
  }
  // Early return is not allowed at the start; a unit that does it all the same is led on to the step's end.
  CoStep do_step(double time, double step) override {
    constexpr double kRounding = 1e-9;
    const double end = time + step;
    for (double from = time;;) {
      bool event = false, terminate = false, early = false;
      double last = end;
      check(f_.do_step(instance_, from, end - from, true, &event, &terminate, &early, &last), "fmi3DoStep");
      const double reached = early ? last : end;
      if (terminate || !(end - reached > kRounding * step)) return {.terminate = terminate, .reached_s = reached};
      if (!(reached - from > kRounding * step))
        throw Failure{"fmi3DoStep returns early time and again and comes no further than " + std::to_string(reached) +
                      " s"};
      from = reached;
    }
  }

 private:
  void set_constant(const Constant& constant) const {
    if (constant.handle.type != FmiType::string) {
      const std::vector<double> values = numbers_of(constant);
      if (values.size() != constant.handle.size)
        throw Failure{"another number of values than its size: " + constant.text};
      return set_one(constant.handle, values.data());
    }
    const char* text = constant.text.c_str();
    check(library_.find<fmi3::Set<const char*>>("fmi3SetString")(instance_, &constant.handle.reference, 1, &text, 1),
          "fmi3SetString");
  }
  void get_one(const Handle& handle, double* values) const {
    switch (handle.type) {
      case FmiType::float64:
        return get_as<double>(library_, instance_, "fmi3GetFloat64", handle, values);
      case FmiType::float32:
        return get_as<float>(library_, instance_, "fmi3GetFloat32", handle, values);
      case FmiType::int8:
        return get_as<std::int8_t>(library_, instance_, "fmi3GetInt8", handle, values);
      case FmiType::uint8:
        return get_as<std::uint8_t>(library_, instance_, "fmi3GetUInt8", handle, values);
      case FmiType::int16:
        return get_as<std::int16_t>(library_, instance_, "fmi3GetInt16", handle, values);
      case FmiType::uint16:
        return get_as<std::uint16_t>(library_, instance_, "fmi3GetUInt16", handle, values);
      case FmiType::int32:
        return get_as<std::int32_t>(library_, instance_, "fmi3GetInt32", handle, values);
      case FmiType::uint32:
        return get_as<std::uint32_t>(library_, instance_, "fmi3GetUInt32", handle, values);
      case FmiType::uint64:
        return get_as<std::uint64_t>(library_, instance_, "fmi3GetUInt64", handle, values);
      case FmiType::boolean:
        return get_as<std::uint8_t>(library_, instance_, "fmi3GetBoolean", handle, values);
      case FmiType::int64:
      case FmiType::enumeration:
        return get_as<std::int64_t>(library_, instance_, "fmi3GetInt64", handle, values);
      default:
        throw Failure{"a variable that is not a number cannot be read as one"};
    }
  }
  void set_one(const Handle& handle, const double* values) const {
    switch (handle.type) {
      case FmiType::float64:
        return set_as<double>(library_, instance_, "fmi3SetFloat64", handle, values);
      case FmiType::float32:
        return set_as<float>(library_, instance_, "fmi3SetFloat32", handle, values);
      case FmiType::int8:
        return set_as<std::int8_t>(library_, instance_, "fmi3SetInt8", handle, values);
      case FmiType::uint8:
        return set_as<std::uint8_t>(library_, instance_, "fmi3SetUInt8", handle, values);
      case FmiType::int16:
        return set_as<std::int16_t>(library_, instance_, "fmi3SetInt16", handle, values);
      case FmiType::uint16:
        return set_as<std::uint16_t>(library_, instance_, "fmi3SetUInt16", handle, values);
      case FmiType::int32:
        return set_as<std::int32_t>(library_, instance_, "fmi3SetInt32", handle, values);
      case FmiType::uint32:
        return set_as<std::uint32_t>(library_, instance_, "fmi3SetUInt32", handle, values);
      case FmiType::uint64:
        return set_as<std::uint64_t>(library_, instance_, "fmi3SetUInt64", handle, values);
      case FmiType::boolean:
        return set_as<std::uint8_t>(library_, instance_, "fmi3SetBoolean", handle, values);
      case FmiType::int64:
      case FmiType::enumeration:
        return set_as<std::int64_t>(library_, instance_, "fmi3SetInt64", handle, values);
      default:
        throw Failure{"a variable that is not a number cannot be set as one"};
    }
  }

  const Functions& f_;
  const Library& library_;
  bool co_simulation_;
  Instance instance_ = nullptr;
};

}  // namespace

MakeInstance fmi3_instances(const Library& library, const Setup& setup) {
  const auto functions = std::make_shared<const Functions>(library, setup.co_simulation != 0);
  return [functions, &library, &setup] { return std::make_unique<Fmi3Instance>(*functions, library, setup); };
}

}  // namespace sealwatch::fmi
