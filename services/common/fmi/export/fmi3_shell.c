/* The functions of FMI 3.0 for Model Exchange around a model in plain C without events. The model's file defines, before
 * it includes this one, what fmi2_shell.c asks for; value references are the same, and 0 is time. What the model does
 * not have (other types, clocks, Co-Simulation, saved states) is there, as importers look for every function, and says
 * that it failed: see fmi3_common.c, which stands behind this text.
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
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

static void reset(Model* m) {
  m->time = 0.0;
  memcpy(m->x, start_states, STATES * sizeof(double));
  memcpy(m->u, start_inputs, INPUTS * sizeof(double));
  memcpy(m->p, start_parameters, PARAMETERS * sizeof(double));
}

EXPORT void* fmi3InstantiateModelExchange(const char* name, const char* token, const char* resources, bool visible,
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
EXPORT void fmi3FreeInstance(void* c) { free(c); }
EXPORT int fmi3Reset(void* c) { return reset(c), kOk; }
EXPORT int fmi3SetDebugLogging(void* c, bool on, size_t n, const char* const* categories) {
  return (void)c, (void)on, (void)n, (void)categories, kOk;
}
EXPORT int fmi3EnterInitializationMode(void* c, bool tolerance_defined, double tolerance, double start, bool stop_defined,
                                    double stop) {
  (void)tolerance_defined, (void)tolerance, (void)stop_defined, (void)stop;
  return ((Model*)c)->time = start, kOk;
}
EXPORT int fmi3ExitInitializationMode(void* c) { return (void)c, kOk; }
EXPORT int fmi3EnterEventMode(void* c) { return (void)c, kOk; }
EXPORT int fmi3EnterContinuousTimeMode(void* c) { return (void)c, kOk; }
EXPORT int fmi3EnterConfigurationMode(void* c) { return (void)c, kOk; }
EXPORT int fmi3ExitConfigurationMode(void* c) { return (void)c, kOk; }
EXPORT int fmi3Terminate(void* c) { return (void)c, kOk; }
EXPORT int fmi3EvaluateDiscreteStates(void* c) { return (void)c, kOk; }
EXPORT int fmi3UpdateDiscreteStates(void* c, bool* again, bool* terminate, bool* nominals, bool* values, bool* next_defined,
                                 double* next) {
  (void)c, (void)next;
  return *again = *terminate = *nominals = *values = *next_defined = false, kOk;
}
EXPORT int fmi3CompletedIntegratorStep(void* c, bool no_return, bool* event, bool* terminate) {
  (void)c, (void)no_return;
  return *event = *terminate = false, kOk;
}
EXPORT int fmi3SetTime(void* c, double time) { return ((Model*)c)->time = time, kOk; }
EXPORT int fmi3SetContinuousStates(void* c, const double* x, size_t n) {
  if (n != STATES) return kError;
  return memcpy(((Model*)c)->x, x, n * sizeof *x), kOk;
}
EXPORT int fmi3GetContinuousStates(void* c, double* x, size_t n) {
  if (n != STATES) return kError;
  return memcpy(x, ((Model*)c)->x, n * sizeof *x), kOk;
}
EXPORT int fmi3GetNominalsOfContinuousStates(void* c, double* x, size_t n) {
  (void)c;
  if (n != STATES) return kError;
  return memcpy(x, nominal_states, n * sizeof *x), kOk;
}
EXPORT int fmi3GetContinuousStateDerivatives(void* c, double* dx, size_t n) {
  Model* m = c;
  if (n != STATES) return kError;
  return model_derivatives(m->time, m->x, m->u, m->p, dx), kOk;
}
EXPORT int fmi3GetEventIndicators(void* c, double* z, size_t n) { return (void)c, (void)z, n == 0 ? kOk : kError; }
EXPORT int fmi3GetNumberOfContinuousStates(void* c, size_t* n) { return (void)c, *n = STATES, kOk; }
EXPORT int fmi3GetNumberOfEventIndicators(void* c, size_t* n) { return (void)c, *n = 0, kOk; }

/* The place of a value that is kept, or NULL. */
static double* kept(Model* m, Ref reference) {
  const size_t kind = reference / 1000U, index = reference % 1000U;
  if (kind == 1 && index < STATES) return &m->x[index];
  if (kind == 3 && index < INPUTS) return &m->u[index];
  if (kind == 4 && index < PARAMETERS) return &m->p[index];
  return NULL;
}
EXPORT int fmi3GetFloat64(void* c, const Ref* references, size_t n, double* values, size_t size) {
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
EXPORT int fmi3SetFloat64(void* c, const Ref* references, size_t n, const double* values, size_t size) {
  size_t k;
  if (size != n) return kError;
  for (k = 0; k < n; ++k) {
    double* place = kept(c, references[k]);
    if (place == NULL) return kError;
    *place = values[k];
  }
  return kOk;
}
#if defined(MODEL_PARTIALS)
EXPORT int fmi3GetDirectionalDerivative(void* c, const Ref* unknowns, size_t nu, const Ref* knowns, size_t nk,
                                        const double* seed, size_t n_seed, double* sensitivity, size_t n_sensitivity) {
  const Model* m = c;
  if (n_seed != nk || n_sensitivity != nu) return kError;
  return model_directional(m->time, m->x, m->u, m->p, unknowns, nu, knowns, nk, seed, sensitivity) ? kOk : kError;
}
#endif
/* The model has no variables but real ones of 64 bits. */
#define NONE_OF(type, name)                                                                                     \
  EXPORT int fmi3Get##name(void* c, const Ref* references, size_t n, type* values, size_t size) {                   \
    return (void)c, (void)references, (void)values, (void)size, n == 0 ? kOk : kError;                           \
  }                                                                                                              \
  EXPORT int fmi3Set##name(void* c, const Ref* references, size_t n, const type* values, size_t size) {             \
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
