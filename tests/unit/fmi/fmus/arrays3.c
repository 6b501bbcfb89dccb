/* Arrays whose size is a structural parameter, and a start that is a parameter: dx/dt = -x, x(0) = x0 (n elements),
 * y = sum of x. */
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
enum { kOk = 0, kError = 3, kMost = 8 };
enum { kN = 1, kX0, kX, kDerX, kY };
typedef struct {
  uint64_t n;
  int configuring;
  double x0[kMost], x[kMost];
} Model;
typedef void (*Log)(void*, int, const char*, const char*);
void* fmi3InstantiateModelExchange(const char* name, const char* token, const char* resources, bool visible,
                                   bool logging, void* environment, Log log) {
  Model* m = calloc(1, sizeof *m);
  int k;
  (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)environment, (void)log;
  m->n = 2;
  for (k = 0; k < kMost; ++k) m->x0[k] = k + 1.0;
  return m;
}
void fmi3FreeInstance(void* c) { free(c); }
int fmi3EnterConfigurationMode(void* c) { return ((Model*)c)->configuring = 1, kOk; }
int fmi3ExitConfigurationMode(void* c) { return ((Model*)c)->configuring = 0, kOk; }
int fmi3EnterInitializationMode(void* c, bool td, double t, double start, bool sd, double stop) {
  return (void)td, (void)t, (void)start, (void)sd, (void)stop, ((Model*)c)->configuring ? kError : kOk;
}
int fmi3ExitInitializationMode(void* c) { return memcpy(((Model*)c)->x, ((Model*)c)->x0, sizeof ((Model*)c)->x), kOk; }
int fmi3EnterEventMode(void* c) { return (void)c, kOk; }
int fmi3EnterContinuousTimeMode(void* c) { return (void)c, kOk; }
int fmi3UpdateDiscreteStates(void* c, bool* again, bool* terminate, bool* nominals, bool* values, bool* defined,
                             double* next) {
  return (void)c, (void)next, *again = *terminate = *nominals = *values = *defined = false, kOk;
}
int fmi3CompletedIntegratorStep(void* c, bool no_return, bool* event, bool* terminate) {
  return (void)c, (void)no_return, *event = *terminate = false, kOk;
}
int fmi3SetTime(void* c, double time) { return (void)c, (void)time, kOk; }
int fmi3SetContinuousStates(void* c, const double* x, size_t n) {
  return n == ((Model*)c)->n ? (memcpy(((Model*)c)->x, x, n * sizeof *x), kOk) : kError;
}
int fmi3GetContinuousStates(void* c, double* x, size_t n) {
  return n == ((Model*)c)->n ? (memcpy(x, ((Model*)c)->x, n * sizeof *x), kOk) : kError;
}
int fmi3GetNominalsOfContinuousStates(void* c, double* x, size_t n) {
  size_t k;
  for (k = 0; k < n; ++k) x[k] = 1.0;
  return (void)c, kOk;
}
int fmi3GetContinuousStateDerivatives(void* c, double* dx, size_t n) {
  size_t k;
  for (k = 0; k < n; ++k) dx[k] = -((Model*)c)->x[k];
  return n == ((Model*)c)->n ? kOk : kError;
}
int fmi3GetEventIndicators(void* c, double* z, size_t n) { return (void)c, (void)z, (void)n, kOk; }
int fmi3GetFloat64(void* c, const unsigned* r, size_t n, double* v, size_t size) {
  Model* m = c;
  size_t k, j;
  for (k = 0; k < n; ++k) {
    if (r[k] == kY) {
      *v = 0.0;
      for (j = 0; j < m->n; ++j) *v += m->x[j];
      ++v;
      continue;
    }
    if (r[k] != kX0 && r[k] != kX && r[k] != kDerX) return kError;
    for (j = 0; j < m->n; ++j) *v++ = r[k] == kX0 ? m->x0[j] : r[k] == kX ? m->x[j] : -m->x[j];
  }
  return (void)size, kOk;
}
int fmi3SetFloat64(void* c, const unsigned* r, size_t n, const double* v, size_t size) {
  Model* m = c;
  if (n != 1 || r[0] != kX0 || size != m->n) return kError;
  return memcpy(m->x0, v, size * sizeof *v), kOk;
}
int fmi3SetUInt64(void* c, const unsigned* r, size_t n, const uint64_t* v, size_t size) {
  Model* m = c;
  if (n != 1 || size != 1 || r[0] != kN || !m->configuring || v[0] > kMost) return kError;
  return m->n = v[0], kOk;
}
