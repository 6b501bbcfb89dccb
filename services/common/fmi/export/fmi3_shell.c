/* The functions of FMI 3.0 for Model Exchange around a model in plain C without events. The model's file defines, before
 * it includes this one, what fmi2_shell.c asks for; value references are the same, and 0 is time. What the model does
 * not have (other types, clocks, Co-Simulation, saved states) is there, as importers look for every function, and says
 * that it failed.
 */
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define ROOM(count) ((count) + 1)

typedef struct {
  double time;
  double x[ROOM(STATES)], u[ROOM(INPUTS)], p[ROOM(PARAMETERS)];
} Model;

typedef uint32_t Ref;
typedef void (*Log)(void* environment, int status, const char* category, const char* message);

enum { kOk = 0, kError = 3 };
#if defined(_WIN32)
#define API __declspec(dllexport)
#else
#define API __attribute__((visibility("default")))
#endif

API const char* fmi3GetVersion(void) { return "3.0"; }

static void reset(Model* m) {
  m->time = 0.0;
  memcpy(m->x, start_states, STATES * sizeof(double));
  memcpy(m->u, start_inputs, INPUTS * sizeof(double));
  memcpy(m->p, start_parameters, PARAMETERS * sizeof(double));
}

API void* fmi3InstantiateModelExchange(const char* name, const char* token, const char* resources, bool visible,
                                       bool logging, void* environment, Log log) {
  Model* m;
  (void)name, (void)resources, (void)visible, (void)logging;
  if (strcmp(token, MODEL_TOKEN) != 0) {
    if (log != NULL) log(environment, kError, "logStatusError", "the instantiation token is another model's");
    return NULL;
  }
  m = calloc(1, sizeof *m);
  if (m != NULL) reset(m);
  return m;
}
API void* fmi3InstantiateCoSimulation(const char* name, const char* token, const char* resources, bool visible,
                                      bool logging, bool event_mode, bool early_return, const Ref* intermediate,
                                      size_t n, void* environment, Log log, void* update) {
  (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)event_mode, (void)early_return;
  (void)intermediate, (void)n, (void)environment, (void)log, (void)update;
  return NULL;
}
API void* fmi3InstantiateScheduledExecution(const char* name, const char* token, const char* resources, bool visible,
                                            bool logging, void* environment, Log log, void* update, void* lock,
                                            void* unlock) {
  (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)environment, (void)log;
  (void)update, (void)lock, (void)unlock;
  return NULL;
}
API void fmi3FreeInstance(void* c) { free(c); }
API int fmi3Reset(void* c) { return reset(c), kOk; }
API int fmi3SetDebugLogging(void* c, bool on, size_t n, const char* const* categories) {
  return (void)c, (void)on, (void)n, (void)categories, kOk;
}
API int fmi3EnterInitializationMode(void* c, bool tolerance_defined, double tolerance, double start, bool stop_defined,
                                    double stop) {
  (void)tolerance_defined, (void)tolerance, (void)stop_defined, (void)stop;
  return ((Model*)c)->time = start, kOk;
}
API int fmi3ExitInitializationMode(void* c) { return (void)c, kOk; }
API int fmi3EnterEventMode(void* c) { return (void)c, kOk; }
API int fmi3EnterContinuousTimeMode(void* c) { return (void)c, kOk; }
API int fmi3EnterConfigurationMode(void* c) { return (void)c, kOk; }
API int fmi3ExitConfigurationMode(void* c) { return (void)c, kOk; }
API int fmi3Terminate(void* c) { return (void)c, kOk; }
API int fmi3EvaluateDiscreteStates(void* c) { return (void)c, kOk; }
API int fmi3UpdateDiscreteStates(void* c, bool* again, bool* terminate, bool* nominals, bool* values, bool* next_defined,
                                 double* next) {
  (void)c, (void)next;
  return *again = *terminate = *nominals = *values = *next_defined = false, kOk;
}
API int fmi3CompletedIntegratorStep(void* c, bool no_return, bool* event, bool* terminate) {
  (void)c, (void)no_return;
  return *event = *terminate = false, kOk;
}
API int fmi3SetTime(void* c, double time) { return ((Model*)c)->time = time, kOk; }
API int fmi3SetContinuousStates(void* c, const double* x, size_t n) {
  if (n != STATES) return kError;
  return memcpy(((Model*)c)->x, x, n * sizeof *x), kOk;
}
API int fmi3GetContinuousStates(void* c, double* x, size_t n) {
  if (n != STATES) return kError;
  return memcpy(x, ((Model*)c)->x, n * sizeof *x), kOk;
}
API int fmi3GetNominalsOfContinuousStates(void* c, double* x, size_t n) {
  size_t k;
  (void)c;
  for (k = 0; k < n; ++k) x[k] = 1.0;
  return kOk;
}
API int fmi3GetContinuousStateDerivatives(void* c, double* dx, size_t n) {
  Model* m = c;
  if (n != STATES) return kError;
  return model_derivatives(m->time, m->x, m->u, m->p, dx), kOk;
}
API int fmi3GetEventIndicators(void* c, double* z, size_t n) { return (void)c, (void)z, n == 0 ? kOk : kError; }
API int fmi3GetNumberOfContinuousStates(void* c, size_t* n) { return (void)c, *n = STATES, kOk; }
API int fmi3GetNumberOfEventIndicators(void* c, size_t* n) { return (void)c, *n = 0, kOk; }

/* The place of a value that is kept, or NULL. */
static double* kept(Model* m, Ref reference) {
  const size_t kind = reference / 1000U, index = reference % 1000U;
  if (kind == 1 && index < STATES) return &m->x[index];
  if (kind == 3 && index < INPUTS) return &m->u[index];
  if (kind == 4 && index < PARAMETERS) return &m->p[index];
  return NULL;
}
API int fmi3GetFloat64(void* c, const Ref* references, size_t n, double* values, size_t size) {
  Model* m = c;
  double derivatives[ROOM(STATES)], outputs[ROOM(OUTPUTS)];
  size_t k;
  if (size != n) return kError;
  model_derivatives(m->time, m->x, m->u, m->p, derivatives);
  model_outputs(m->time, m->x, m->u, m->p, outputs);
  for (k = 0; k < n; ++k) {
    const size_t kind = references[k] / 1000U, index = references[k] % 1000U;
    const double* place = references[k] == 0 ? &m->time : kept(m, references[k]);
    if (kind == 2 && index < STATES) place = &derivatives[index];
    if (kind == 5 && index < OUTPUTS) place = &outputs[index];
    if (place == NULL) return kError;
    values[k] = *place;
  }
  return kOk;
}
API int fmi3SetFloat64(void* c, const Ref* references, size_t n, const double* values, size_t size) {
  size_t k;
  if (size != n) return kError;
  for (k = 0; k < n; ++k) {
    double* place = kept(c, references[k]);
    if (place == NULL) return kError;
    *place = values[k];
  }
  return kOk;
}
/* The model has no variables but real ones of 64 bits. */
#define NONE_OF(type, name)                                                                                     \
  API int fmi3Get##name(void* c, const Ref* references, size_t n, type* values, size_t size) {                   \
    return (void)c, (void)references, (void)values, (void)size, n == 0 ? kOk : kError;                           \
  }                                                                                                              \
  API int fmi3Set##name(void* c, const Ref* references, size_t n, const type* values, size_t size) {             \
    return (void)c, (void)references, (void)values, (void)size, n == 0 ? kOk : kError;                           \
  }
NONE_OF(float, Float32)
NONE_OF(int8_t, Int8)
NONE_OF(uint8_t, UInt8)
NONE_OF(int16_t, Int16)
NONE_OF(uint16_t, UInt16)
NONE_OF(int32_t, Int32)
NONE_OF(uint32_t, UInt32)
NONE_OF(int64_t, Int64)
NONE_OF(uint64_t, UInt64)
NONE_OF(bool, Boolean)
typedef const char* Text;
NONE_OF(Text, String)

#define FAILS(name, ...)          \
  API int fmi3##name(void* c, __VA_ARGS__) { return (void)c, kError; }
#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif
FAILS(GetBinary, const Ref* references, size_t n, size_t* sizes, const uint8_t** values, size_t size)
FAILS(SetBinary, const Ref* references, size_t n, const size_t* sizes, const uint8_t* const* values, size_t size)
FAILS(GetClock, const Ref* references, size_t n, bool* values)
FAILS(SetClock, const Ref* references, size_t n, const bool* values)
FAILS(GetIntervalDecimal, const Ref* references, size_t n, double* intervals, int* qualifiers)
FAILS(GetIntervalFraction, const Ref* references, size_t n, uint64_t* counters, uint64_t* resolutions, int* qualifiers)
FAILS(GetShiftDecimal, const Ref* references, size_t n, double* shifts)
FAILS(GetShiftFraction, const Ref* references, size_t n, uint64_t* counters, uint64_t* resolutions)
FAILS(SetIntervalDecimal, const Ref* references, size_t n, const double* intervals)
FAILS(SetIntervalFraction, const Ref* references, size_t n, const uint64_t* counters, const uint64_t* resolutions)
FAILS(SetShiftDecimal, const Ref* references, size_t n, const double* shifts)
FAILS(SetShiftFraction, const Ref* references, size_t n, const uint64_t* counters, const uint64_t* resolutions)
FAILS(ActivateModelPartition, Ref clock, double activation)
FAILS(GetNumberOfVariableDependencies, Ref reference, size_t* n)
FAILS(GetVariableDependencies, Ref dependent, size_t* elements, Ref* independents, size_t* their_elements, int* kinds,
      size_t n)
FAILS(GetFMUState, void** state)
FAILS(SetFMUState, void* state)
FAILS(FreeFMUState, void** state)
FAILS(SerializedFMUStateSize, void* state, size_t* size)
FAILS(SerializeFMUState, void* state, uint8_t* bytes, size_t size)
FAILS(DeserializeFMUState, const uint8_t* bytes, size_t size, void** state)
FAILS(GetDirectionalDerivative, const Ref* unknowns, size_t nu, const Ref* knowns, size_t nk, const double* seed,
      size_t n_seed, double* sensitivity, size_t n_sensitivity)
FAILS(GetAdjointDerivative, const Ref* unknowns, size_t nu, const Ref* knowns, size_t nk, const double* seed,
      size_t n_seed, double* sensitivity, size_t n_sensitivity)
FAILS(GetOutputDerivatives, const Ref* references, size_t n, const int32_t* orders, double* values, size_t size)
FAILS(DoStep, double time, double step, bool no_set_before, bool* event_needed, bool* terminate, bool* early,
      double* last_time)
API int fmi3EnterStepMode(void* c) { return (void)c, kError; }
