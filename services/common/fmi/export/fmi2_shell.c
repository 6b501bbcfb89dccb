/* The functions of FMI 2.0 for Model Exchange around a model in plain C. The model's file defines, before it includes
 * this one:
 *
 *   MODEL_TOKEN                                        the guid of modelDescription.xml
 *   STATES, INPUTS, PARAMETERS, OUTPUTS                how many of each
 *   static const double start_states[], start_inputs[], start_parameters[]        (each with at least one element)
 *   static void model_derivatives(double t, const double* x, const double* u, const double* p, double* dx);
 *   static void model_outputs(double t, const double* x, const double* u, const double* p, double* y);
 * and where it has events
 *   INDICATORS, DISCRETES                              signs of the former tell events, the latter change at them alone
 *   static void model_indicators(double t, const double* x, const double* u, const double* p, const double* d,
 *                                double* z);
 *   static int model_event(double t, double* x, const double* u, const double* p, double* d, double* next_time);
 *                                                      returns whether it changed states; next_time: INFINITY or later
 *
 * and where its derivatives are known
 *   MODEL_PARTIALS                                     is defined
 *   static int model_directional(double t, const double* x, const double* u, const double* p, const unsigned* unknowns,
 *                                size_t nu, const unsigned* knowns, size_t nk, const double* seed, double* sensitivity);
 *                                                      by value references; returns whether it has those
 *
 * Value references: states from 1000, derivatives from 2000, inputs from 3000, parameters from 4000, outputs from 5000.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#ifndef INDICATORS
#define INDICATORS 0
#define DISCRETES 0
#endif
#define ROOM(count) ((count) + 1)

typedef struct {
  double time, next_time;
  double x[ROOM(STATES)], u[ROOM(INPUTS)], p[ROOM(PARAMETERS)], d[ROOM(DISCRETES)];
} Model;

typedef struct {
  int new_discrete_states_needed, terminate, nominals_changed, values_changed, next_time_defined;
  double next_time;
} EventInfo;
typedef struct {
  void (*logger)(void*, const char*, int, const char*, const char*, ...);
  void* (*allocate)(size_t, size_t);
  void (*release)(void*);
  void (*step_finished)(void*, int);
  void* environment;
} Callbacks;

enum { kOk = 0, kError = 3 };
#if defined(_WIN32)
#define API __declspec(dllexport)
#else
#define API __attribute__((visibility("default")))
#endif

#ifndef MODEL_BEFORE_INSTANTIATE
#define MODEL_BEFORE_INSTANTIATE(callbacks)
#endif

API const char* fmi2GetTypesPlatform(void) { return "default"; }
API const char* fmi2GetVersion(void) { return "2.0"; }

static void reset(Model* m) {
  m->time = 0.0;
  m->next_time = INFINITY;
  memset(m->d, 0, sizeof m->d);
  memcpy(m->x, start_states, STATES * sizeof(double));
  memcpy(m->u, start_inputs, INPUTS * sizeof(double));
  memcpy(m->p, start_parameters, PARAMETERS * sizeof(double));
}

API void* fmi2Instantiate(const char* name, int kind, const char* guid, const char* resources,
                          const Callbacks* callbacks, int visible, int logging) {
  Model* m;
  (void)name, (void)resources, (void)visible, (void)logging, (void)callbacks;
  MODEL_BEFORE_INSTANTIATE(callbacks)
  if (kind != 0 || strcmp(guid, MODEL_TOKEN) != 0) return NULL;
  m = calloc(1, sizeof *m);
  if (m != NULL) reset(m);
  return m;
}
API void fmi2FreeInstance(void* c) { free(c); }
API int fmi2Reset(void* c) { return reset(c), kOk; }
API int fmi2SetDebugLogging(void* c, int on, size_t n, const char* const* names) {
  return (void)c, (void)on, (void)n, (void)names, kOk;
}
API int fmi2SetupExperiment(void* c, int tolerance_defined, double tolerance, double start, int stop_defined,
                            double stop) {
  (void)tolerance_defined, (void)tolerance, (void)stop_defined, (void)stop;
  return ((Model*)c)->time = start, kOk;
}
API int fmi2EnterInitializationMode(void* c) { return (void)c, kOk; }
API int fmi2ExitInitializationMode(void* c) { return (void)c, kOk; }
API int fmi2EnterEventMode(void* c) { return (void)c, kOk; }
API int fmi2EnterContinuousTimeMode(void* c) { return (void)c, kOk; }
API int fmi2Terminate(void* c) { return (void)c, kOk; }

API int fmi2NewDiscreteStates(void* c, EventInfo* info) {
  memset(info, 0, sizeof *info);
#if INDICATORS > 0 || DISCRETES > 0
  Model* m = c;
  info->values_changed = model_event(m->time, m->x, m->u, m->p, m->d, &m->next_time);
  info->next_time_defined = isfinite(m->next_time);
  info->next_time = m->next_time;
#else
  (void)c;
#endif
  return kOk;
}
API int fmi2CompletedIntegratorStep(void* c, int no_return, int* event, int* terminate) {
  (void)c, (void)no_return;
  return *event = 0, *terminate = 0, kOk;
}
API int fmi2SetTime(void* c, double time) { return ((Model*)c)->time = time, kOk; }
API int fmi2SetContinuousStates(void* c, const double* x, size_t n) {
  if (n != STATES) return kError;
  return memcpy(((Model*)c)->x, x, n * sizeof *x), kOk;
}
API int fmi2GetContinuousStates(void* c, double* x, size_t n) {
  if (n != STATES) return kError;
  return memcpy(x, ((Model*)c)->x, n * sizeof *x), kOk;
}
API int fmi2GetNominalsOfContinuousStates(void* c, double* x, size_t n) {
  (void)c;
  if (n != STATES) return kError;
  return memcpy(x, nominal_states, n * sizeof *x), kOk;
}
API int fmi2GetDerivatives(void* c, double* dx, size_t n) {
  Model* m = c;
  if (n != STATES) return kError;
  model_derivatives(m->time, m->x, m->u, m->p, dx);
  return kOk;
}
API int fmi2GetEventIndicators(void* c, double* z, size_t n) {
  if (n != INDICATORS) return kError;
#if INDICATORS > 0
  model_indicators(((Model*)c)->time, ((Model*)c)->x, ((Model*)c)->u, ((Model*)c)->p, ((Model*)c)->d, z);
#else
  (void)c, (void)z;
#endif
  return kOk;
}

/* The place of a value that is kept, or NULL. */
static double* kept(Model* m, unsigned reference) {
  const int kind = (int)(reference / 1000U), index = (int)(reference % 1000U);
  if (kind == 1 && index < STATES) return &m->x[index];
  if (kind == 3 && index < INPUTS) return &m->u[index];
  if (kind == 4 && index < PARAMETERS) return &m->p[index];
  return NULL;
}
API int fmi2GetReal(void* c, const unsigned* references, size_t n, double* values) {
  Model* m = c;
  double derivatives[ROOM(STATES)], outputs[ROOM(OUTPUTS)];
  size_t k;
  model_derivatives(m->time, m->x, m->u, m->p, derivatives);
  model_outputs(m->time, m->x, m->u, m->p, outputs);
  for (k = 0; k < n; ++k) {
    const int kind = (int)(references[k] / 1000U), index = (int)(references[k] % 1000U);
    const double* place = kept(m, references[k]);
    if (kind == 2 && index < STATES) place = &derivatives[index];
    if (kind == 5 && index < OUTPUTS) place = &outputs[index];
    if (place == NULL) return kError;
    values[k] = *place;
  }
  return kOk;
}
API int fmi2SetReal(void* c, const unsigned* references, size_t n, const double* values) {
  size_t k;
  for (k = 0; k < n; ++k) {
    double* place = kept(c, references[k]);
    if (place == NULL) return kError;
    *place = values[k];
  }
  return kOk;
}
/* The model has real variables only. */
#define NONE_OF(type, name)                                                           \
  API int fmi2Get##name(void* c, const unsigned* references, size_t n, type* values) { \
    return (void)c, (void)references, (void)values, n == 0 ? kOk : kError;             \
  }                                                                                    \
  API int fmi2Set##name(void* c, const unsigned* references, size_t n, const type* values) { \
    return (void)c, (void)references, (void)values, n == 0 ? kOk : kError;             \
  }
NONE_OF(int, Integer)
NONE_OF(int, Boolean)
NONE_OF(const char*, String)

#if defined(MODEL_PARTIALS)
API int fmi2GetDirectionalDerivative(void* c, const unsigned* unknowns, size_t nu, const unsigned* knowns, size_t nk,
                                     const double* seed, double* sensitivity) {
  const Model* m = c;
  return model_directional(m->time, m->x, m->u, m->p, unknowns, nu, knowns, nk, seed, sensitivity) ? kOk : kError;
}
#elif !defined(MODEL_DIRECTIONAL)
API int fmi2GetDirectionalDerivative(void* c, const unsigned* unknowns, size_t nu, const unsigned* knowns, size_t nk,
                                     const double* seed, double* sensitivity) {
  (void)c, (void)unknowns, (void)nu, (void)knowns, (void)nk, (void)seed, (void)sensitivity;
  return kError;
}
#endif
API int fmi2GetFMUstate(void* c, void** state) { return (void)c, (void)state, kError; }
API int fmi2SetFMUstate(void* c, void* state) { return (void)c, (void)state, kError; }
API int fmi2FreeFMUstate(void* c, void** state) { return (void)c, (void)state, kError; }
API int fmi2SerializedFMUstateSize(void* c, void* state, size_t* size) {
  return (void)c, (void)state, (void)size, kError;
}
API int fmi2SerializeFMUstate(void* c, void* state, char* bytes, size_t size) {
  return (void)c, (void)state, (void)bytes, (void)size, kError;
}
API int fmi2DeSerializeFMUstate(void* c, const char* bytes, size_t size, void** state) {
  return (void)c, (void)bytes, (void)size, (void)state, kError;
}
