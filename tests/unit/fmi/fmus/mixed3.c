#include <stdbool.h>
#include <stdint.h>
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
  return size == n ? status : kError;
typedef void (*Log)(void*, int, const char*, const char*);
void* fmi3InstantiateModelExchange(const char* name, const char* token, const char* resources, bool visible,
                                   bool logging, void* environment, Log log) {
  (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)environment, (void)log;
  return mixed_new();
}
void* fmi3InstantiateCoSimulation(const char* name, const char* token, const char* resources, bool visible,
                                  bool logging, bool events, bool early, const unsigned* intermediate, size_t n,
                                  void* environment, Log log, void* update) {
  (void)events, (void)early, (void)intermediate, (void)n, (void)update;
  return fmi3InstantiateModelExchange(name, token, resources, visible, logging, environment, log);
}
void fmi3FreeInstance(void* c) { free(c); }
int fmi3EnterInitializationMode(void* c, bool tolerance_defined, double tolerance, double start, bool stop_defined,
                                double stop) {
  (void)tolerance_defined, (void)tolerance, (void)stop_defined, (void)stop;
  LAY_OUT
  return ((Model*)c)->time = ((Model*)c)->began = start, ((Model*)c)->mode = kInitialising, kOk;
}
int fmi3ExitInitializationMode(void* c) {
  Model* m = c;
  return m->x = m->x0, m->mode = kEvent, kOk;
}
int fmi3EnterEventMode(void* c) { return ((Model*)c)->mode = kEvent, kOk; }
int fmi3EnterContinuousTimeMode(void* c) { return ((Model*)c)->mode = kContinuous, kOk; }
int fmi3UpdateDiscreteStates(void* c, bool* again, bool* terminate, bool* nominals, bool* values, bool* next_defined,
                             double* next) {
  Model* m = c;
  if (m->mode != kEvent) return kError;
  mixed_event(m);
  *again = *nominals = *values = false;
  return *terminate = m->ended, *next_defined = true, *next = m->steps + 1.0, kOk;
}
int fmi3CompletedIntegratorStep(void* c, bool no_return, bool* event, bool* terminate) {
  return (void)c, (void)no_return, *event = *terminate = false, kOk;
}
int fmi3SetTime(void* c, double time) {
  WITHIN(time)
  return ((Model*)c)->time = time, kOk;
}
int fmi3SetContinuousStates(void* c, const double* x, size_t n) { return ((Model*)c)->x = x[0], n == 1 ? kOk : kError; }
int fmi3GetContinuousStates(void* c, double* x, size_t n) { return x[0] = ((Model*)c)->x, n == 1 ? kOk : kError; }
int fmi3GetNominalsOfContinuousStates(void* c, double* x, size_t n) {
  return (void)c, x[0] = 1.0, n == 1 ? kOk : kError;
}
int fmi3GetContinuousStateDerivatives(void* c, double* x, size_t n) { return (void)n, mixed_real(c, kDerX, x); }
int fmi3GetEventIndicators(void* c, double* z, size_t n) { return (void)c, (void)z, (void)n, kOk; }
int fmi3GetFloat64(void* c, const unsigned* r, size_t n, double* v, size_t size) { EACH(mixed_real(c, r[k], &v[k])) }
int fmi3SetFloat64(void* c, const unsigned* r, size_t n, const double* v, size_t size) {
  EACH(mixed_set_real(c, r[k], v[k]))
}
int fmi3GetInt32(void* c, const unsigned* r, size_t n, int32_t* v, size_t size) { EACH(mixed_integer(c, r[k], &v[k])) }
int fmi3SetInt32(void* c, const unsigned* r, size_t n, const int32_t* v, size_t size) {
  EACH(mixed_set_integer(c, r[k], v[k]))
}
int fmi3GetBoolean(void* c, const unsigned* r, size_t n, bool* v, size_t size) {
  int value = 0;
  EACH((mixed_integer(c, r[k], &value) == kOk ? (v[k] = value != 0, kOk) : kError))
}
int fmi3SetBoolean(void* c, const unsigned* r, size_t n, const bool* v, size_t size) {
  EACH(mixed_set_integer(c, r[k], v[k]))
}
int fmi3SetString(void* c, const unsigned* r, size_t n, const char* const* v, size_t size) {
  EACH(mixed_set_text(c, r[k], v[k]))
}
int fmi3GetBinary(void* c, const unsigned* r, size_t n, size_t* sizes, const uint8_t** v, size_t size) {
  Model* m = c;
  EACH(r[k] == kBytes ? (sizes[k] = m->bytes_size, v[k] = m->bytes, kOk) : kError)
}
int fmi3SetBinary(void* c, const unsigned* r, size_t n, const size_t* sizes, const uint8_t* const* v, size_t size) {
  EACH(r[k] == kBytes ? mixed_set_bytes(c, sizes[k], v[k]) : kError)
}
int fmi3DoStep(void* c, double time, double step, bool no_return, bool* event, bool* terminate, bool* early,
               double* last) {
  Model* m = c;
  (void)no_return;
  m->mode = kStepping;
  m->x *= exp(-m->k * step);
  m->time = time + step;
  mixed_event(m);
  return *event = *early = false, *terminate = m->ended, *last = m->time, kOk;
}
