// The functions of a binary as the standards define them, as far as sealwatch calls them (FMI 2.0.4 chapter 2 and 3,
// FMI 3.0.1 chapter 2 to 4). Types have the standard's widths; both versions number their status alike.
#pragma once

#include <cstddef>
#include <cstdint>

namespace sealwatch::fmi {

enum Status : int { kOkStatus = 0, kWarning = 1, kDiscard = 2, kErrorStatus = 3, kFatal = 4, kPending = 5 };

using Instance = void*;
using Reference = std::uint32_t;

namespace fmi2 {

using Boolean = int;
using Logger = void (*)(void* environment, const char* instance, int status, const char* category, const char* message,
                        ...);
struct Callbacks {
  Logger logger;
  void* (*allocate)(std::size_t count, std::size_t size);
  void (*free)(void* memory);
  void (*step_finished)(void* environment, int status);
  void* environment;
};
struct EventInfo {
  Boolean again, terminate, nominals_changed, values_changed, next_time_defined;
  double next_time_s;
};

using Instantiate = Instance(const char* name, int kind, const char* guid, const char* resources, const Callbacks*,
                             Boolean visible, Boolean logging);
using SetupExperiment = int(Instance, Boolean tolerance_defined, double tolerance, double start_time,
                            Boolean stop_time_defined, double stop_time);
template <class T>
using Get = int(Instance, const Reference*, std::size_t, T*);
template <class T>
using Set = int(Instance, const Reference*, std::size_t, const T*);
using NewDiscreteStates = int(Instance, EventInfo*);
using CompletedStep = int(Instance, Boolean no_return, Boolean* event, Boolean* terminate);
using Directional = int(Instance, const Reference* unknowns, std::size_t, const Reference* knowns, std::size_t,
                        const double* seed, double* sensitivity);
using DoStep = int(Instance, double time, double step, Boolean no_return);
/// Of the last step: kLastSuccessfulTime is a number, kTerminated a Boolean.
enum StatusKind : int { kLastSuccessfulTime = 2, kTerminated = 3 };
template <class T>
using GetStatus = int(Instance, int kind, T*);

}  // namespace fmi2

namespace fmi3 {

using Logger = void (*)(void* environment, int status, const char* category, const char* message);
using InstantiateModelExchange = Instance(const char* name, const char* token, const char* resources, bool visible,
                                          bool logging, void* environment, Logger);
using InstantiateCoSimulation = Instance(const char* name, const char* token, const char* resources, bool visible,
                                         bool logging, bool event_mode, bool early_return,
                                         const Reference* intermediate, std::size_t, void* environment, Logger,
                                         void* intermediate_update);
using EnterInitialization = int(Instance, bool tolerance_defined, double tolerance, double start_time,
                                bool stop_time_defined, double stop_time);
template <class T>
using Get = int(Instance, const Reference*, std::size_t, T*, std::size_t);
template <class T>
using Set = int(Instance, const Reference*, std::size_t, const T*, std::size_t);
using UpdateDiscreteStates = int(Instance, bool* again, bool* terminate, bool* nominals_changed, bool* values_changed,
                                 bool* next_time_defined, double* next_time);
using CompletedStep = int(Instance, bool no_return, bool* event, bool* terminate);
using Directional = int(Instance, const Reference* unknowns, std::size_t, const Reference* knowns, std::size_t,
                        const double* seed, std::size_t, double* sensitivity, std::size_t);
using DoStep = int(Instance, double time, double step, bool no_return, bool* event_needed, bool* terminate,
                   bool* early_return, double* last_time);

}  // namespace fmi3

// The same in both versions.
using Plain = int(Instance);
using FreeInstance = void(Instance);
using SetTime = int(Instance, double);
using SetVector = int(Instance, const double*, std::size_t);
using GetVector = int(Instance, double*, std::size_t);

}  // namespace sealwatch::fmi
