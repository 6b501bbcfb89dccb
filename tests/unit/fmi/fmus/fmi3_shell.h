/* The functions of FMI 3.0 for Model Exchange around the model of a test, as services/common/fmi/export/fmi2_shell.c
 * has those of FMI 2.0: the same definitions come before it. With ARRAYS the states are one array variable (reference
 * 1000) and so are their derivatives (2000). */
#include <math.h>
#include <stdbool.h>
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
enum { kOk = 0, kError = 3 };

void* fmi3InstantiateModelExchange(const char* name, const char* token, const char* resources, bool visible,
                                   bool logging, void* environment, void (*log)(void*, int, const char*, const char*)) {
  Model* m;
  (void)name, (void)resources, (void)visible, (void)logging;
  if (strcmp(token, MODEL_TOKEN) != 0) {
    log(environment, kError, "logStatusError", "wrong token");
    return NULL;
  }
  m = calloc(1, sizeof *m);
  m->next_time = INFINITY;
  memcpy(m->x, start_states, STATES * sizeof(double));
  memcpy(m->u, start_inputs, INPUTS * sizeof(double));
  memcpy(m->p, start_parameters, PARAMETERS * sizeof(double));
  return m;
}
void fmi3FreeInstance(void* c) { free(c); }
int fmi3EnterInitializationMode(void* c, bool tolerance_defined, double tolerance, double start, bool stop_defined,
                                double stop) {
  (void)tolerance_defined, (void)tolerance, (void)stop_defined, (void)stop;
  return ((Model*)c)->time = start, kOk;
}
int fmi3ExitInitializationMode(void* c) { return (void)c, kOk; }
int fmi3EnterEventMode(void* c) { return (void)c, kOk; }
int fmi3EnterContinuousTimeMode(void* c) { return (void)c, kOk; }
int fmi3UpdateDiscreteStates(void* c, bool* again, bool* terminate, bool* nominals, bool* values, bool* next_defined,
                             double* next) {
  *again = *terminate = *nominals = *values = *next_defined = false;
#if INDICATORS > 0 || DISCRETES > 0
  Model* m = c;
  *values = model_event(m->time, m->x, m->u, m->p, m->d, &m->next_time);
  *next_defined = isfinite(m->next_time);
  *next = m->next_time;
#else
  (void)c, (void)next;
#endif
  return kOk;
}
int fmi3CompletedIntegratorStep(void* c, bool no_return, bool* event, bool* terminate) {
  (void)c, (void)no_return;
  return *event = *terminate = false, kOk;
}
int fmi3SetTime(void* c, double time) { return ((Model*)c)->time = time, kOk; }
int fmi3SetContinuousStates(void* c, const double* x, size_t n) {
  if (n != STATES) return kError;
  return memcpy(((Model*)c)->x, x, n * sizeof *x), kOk;
}
int fmi3GetContinuousStates(void* c, double* x, size_t n) {
  if (n != STATES) return kError;
  return memcpy(x, ((Model*)c)->x, n * sizeof *x), kOk;
}
int fmi3GetNominalsOfContinuousStates(void* c, double* x, size_t n) {
  size_t k;
  (void)c;
  for (k = 0; k < n; ++k) x[k] = 1.0;
  return kOk;
}
int fmi3GetContinuousStateDerivatives(void* c, double* dx, size_t n) {
  Model* m = c;
  if (n != STATES) return kError;
  model_derivatives(m->time, m->x, m->u, m->p, dx);
  return kOk;
}
int fmi3GetEventIndicators(void* c, double* z, size_t n) {
  if (n != INDICATORS) return kError;
#if INDICATORS > 0
  model_indicators(((Model*)c)->time, ((Model*)c)->x, ((Model*)c)->u, ((Model*)c)->p, ((Model*)c)->d, z);
#else
  (void)c, (void)z;
#endif
  return kOk;
}

static double* kept(Model* m, unsigned reference) {
  const int kind = (int)(reference / 1000U), index = (int)(reference % 1000U);
  if (kind == 1 && index < STATES) return &m->x[index];
  if (kind == 3 && index < INPUTS) return &m->u[index];
  if (kind == 4 && index < PARAMETERS) return &m->p[index];
  return NULL;
}
int fmi3GetFloat64(void* c, const unsigned* references, size_t n, double* values, size_t size) {
  Model* m = c;
  double derivatives[ROOM(STATES)], outputs[ROOM(OUTPUTS)];
  size_t k;
  (void)size;
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
int fmi3SetFloat64(void* c, const unsigned* references, size_t n, const double* values, size_t size) {
  size_t k;
  (void)size;
  for (k = 0; k < n; ++k) {
    double* place = kept(c, references[k]);
    if (place == NULL) return kError;
    *place = values[k];
  }
  return kOk;
}
#ifdef MODEL_DIRECTIONAL3
/* d der / d (x, u) from a function of the model: column of the known. */
int fmi3GetDirectionalDerivative(void* c, const unsigned* unknowns, size_t nu, const unsigned* knowns, size_t nk,
                                 const double* seed, size_t n_seed, double* sensitivity, size_t n_sensitivity) {
  size_t row, column;
  (void)n_seed, (void)n_sensitivity;
  for (row = 0; row < nu; ++row) {
    sensitivity[row] = 0.0;
    for (column = 0; column < nk; ++column)
      sensitivity[row] += model_partial((const Model*)c, unknowns[row], knowns[column]) * seed[column];
  }
  return kOk;
}
#endif
