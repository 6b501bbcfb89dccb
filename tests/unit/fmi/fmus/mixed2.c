#include "mixed.h"
/* UNTIL: it lays out its run until the stop time, which it must know, and goes no further. */
#ifdef UNTIL
static double until;
#define LAY_OUT                  \
  if (!stop_defined) return kError; \
  until = stop;
#define WITHIN(t) \
  if ((t) > until + 1e-9) return kError;
#else
#define LAY_OUT
#define WITHIN(t)
#endif
#define EACH(call)      \
  size_t k;             \
  int status = kOk;     \
  for (k = 0; k < n; ++k) \
    if ((call) != kOk) status = kError; \
  return status;
void* fmi2Instantiate(const char* name, int kind, const char* guid, const char* resources, const void* callbacks,
                      int visible, int logging) {
  (void)name, (void)guid, (void)resources, (void)callbacks, (void)visible, (void)logging, (void)kind;
  return mixed_new();
}
void fmi2FreeInstance(void* c) { free(c); }
int fmi2SetupExperiment(void* c, int defined, double tolerance, double start, int stop_defined, double stop) {
  (void)defined, (void)tolerance, (void)stop_defined, (void)stop;
  LAY_OUT
  return ((Model*)c)->time = ((Model*)c)->began = start, kOk;
}
int fmi2EnterInitializationMode(void* c) { return ((Model*)c)->mode = kInitialising, kOk; }
int fmi2ExitInitializationMode(void* c) {
  Model* m = c;
  return m->x = m->x0, m->mode = kEvent, kOk;
}
int fmi2EnterEventMode(void* c) { return ((Model*)c)->mode = kEvent, kOk; }
int fmi2EnterContinuousTimeMode(void* c) { return ((Model*)c)->mode = kContinuous, kOk; }
int fmi2Terminate(void* c) { return (void)c, kOk; }
typedef struct {
  int again, terminate, nominals, values, next_defined;
  double next;
} EventInfo;
int fmi2NewDiscreteStates(void* c, EventInfo* info) {
  Model* m = c;
  if (m->mode != kEvent) return kError;
  mixed_event(m);
  memset(info, 0, sizeof *info);
  return info->terminate = m->ended, info->next_defined = 1, info->next = m->steps + 1.0, kOk;
}
int fmi2SetTime(void* c, double time) {
  WITHIN(time)
  return ((Model*)c)->time = time, kOk;
}
int fmi2SetContinuousStates(void* c, const double* x, size_t n) {
  return ((Model*)c)->mode == kContinuous || ((Model*)c)->mode == kEvent ? (((Model*)c)->x = x[0], n == 1 ? kOk : kError)
                                                                         : kError;
}
int fmi2GetContinuousStates(void* c, double* x, size_t n) { return x[0] = ((Model*)c)->x, n == 1 ? kOk : kError; }
int fmi2GetNominalsOfContinuousStates(void* c, double* x, size_t n) {
  return (void)c, x[0] = 1.0, n == 1 ? kOk : kError;
}
int fmi2GetDerivatives(void* c, double* x, size_t n) { return (void)n, mixed_real(c, kDerX, x); }
int fmi2GetEventIndicators(void* c, double* z, size_t n) { return (void)c, (void)z, (void)n, kOk; }
int fmi2CompletedIntegratorStep(void* c, int no_return, int* event, int* terminate) {
  return (void)c, (void)no_return, *event = *terminate = 0, kOk;
}
int fmi2GetReal(void* c, const unsigned* r, size_t n, double* v) { EACH(mixed_real(c, r[k], &v[k])) }
int fmi2SetReal(void* c, const unsigned* r, size_t n, const double* v) { EACH(mixed_set_real(c, r[k], v[k])) }
int fmi2GetInteger(void* c, const unsigned* r, size_t n, int* v) { EACH(mixed_integer(c, r[k], &v[k])) }
int fmi2SetInteger(void* c, const unsigned* r, size_t n, const int* v) { EACH(mixed_set_integer(c, r[k], v[k])) }
int fmi2GetBoolean(void* c, const unsigned* r, size_t n, int* v) { EACH(mixed_integer(c, r[k], &v[k])) }
int fmi2SetBoolean(void* c, const unsigned* r, size_t n, const int* v) { EACH(mixed_set_integer(c, r[k], v[k])) }
int fmi2SetString(void* c, const unsigned* r, size_t n, const char* const* v) { EACH(mixed_set_text(c, r[k], v[k])) }
/* Of Co-Simulation: exact steps; one that leads to the end of its own is discarded there. */
int fmi2DoStep(void* c, double time, double step, int no_return) {
  WITHIN(time + step)
  Model* m = c;
  (void)no_return;
  m->mode = kStepping;
  m->x *= exp(-m->k * step);
  m->time = time + step;
  mixed_event(m);
  return m->ended ? kDiscard : kOk;
}
int fmi2GetBooleanStatus(void* c, int kind, int* value) {
  return *value = ((Model*)c)->ended, kind == 3 ? kOk : kError;
}
int fmi2GetRealStatus(void* c, int kind, double* value) { return *value = ((Model*)c)->time, kind == 2 ? kOk : kError; }
