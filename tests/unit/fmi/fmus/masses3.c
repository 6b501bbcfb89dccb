/* Two masses on a spring and a damper, each with a force on it, all of them arrays: states x = (s_1, v_1, s_2, v_2),
 * parameters m[2], inputs f[2], outputs y[2] in mm. */
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
enum { kOk = 0, kError = 3 };
enum { kX = 1, kDerX, kM, kF, kY, kStiffness };
typedef struct {
  double x[4], m[2], f[2], k;
} Model;
typedef void (*Log)(void*, int, const char*, const char*);
void* fmi3InstantiateModelExchange(const char* name, const char* token, const char* resources, bool visible,
                                   bool logging, void* environment, Log log) {
  Model* m = calloc(1, sizeof *m);
  (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)environment, (void)log;
  m->m[0] = 12.0, m->m[1] = 8.0, m->k = 5e4;
  return m;
}
void fmi3FreeInstance(void* c) { free(c); }
int fmi3EnterInitializationMode(void* c, bool td, double t, double start, bool sd, double stop) {
  return (void)c, (void)td, (void)t, (void)start, (void)sd, (void)stop, kOk;
}
int fmi3ExitInitializationMode(void* c) { return (void)c, kOk; }
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
  return memcpy(((Model*)c)->x, x, n * sizeof *x), n == 4 ? kOk : kError;
}
int fmi3GetContinuousStates(void* c, double* x, size_t n) {
  return memcpy(x, ((Model*)c)->x, n * sizeof *x), n == 4 ? kOk : kError;
}
int fmi3GetNominalsOfContinuousStates(void* c, double* x, size_t n) {
  size_t k;
  for (k = 0; k < n; ++k) x[k] = k % 2 == 0 ? 0.01 : 0.1;
  return (void)c, kOk;
}
int fmi3GetContinuousStateDerivatives(void* c, double* dx, size_t n) {
  const Model* m = c;
  const double* x = m->x;
  const double shaft = m->k * (x[0] - x[2]) + 200.0 * (x[1] - x[3]);
  dx[0] = x[1], dx[2] = x[3];
  dx[1] = (m->f[0] - shaft - 150.0 * x[1]) / m->m[0];
  dx[3] = (m->f[1] + shaft - 2e3 * x[2]) / m->m[1];
  return n == 4 ? kOk : kError;
}
int fmi3GetEventIndicators(void* c, double* z, size_t n) { return (void)c, (void)z, (void)n, kOk; }
static double* place(Model* m, unsigned reference, size_t* size) {
  *size = reference == kX ? 4 : reference == kStiffness ? 1 : 2;
  return reference == kX ? m->x : reference == kM ? m->m : reference == kF ? m->f : &m->k;
}
int fmi3GetFloat64(void* c, const unsigned* r, size_t n, double* v, size_t size) {
  Model* m = c;
  size_t k, done = 0, count;
  for (k = 0; k < n; ++k, done += count) {
    const double* values = place(m, r[k], &count);
    const double shown[2] = {1e3 * m->x[0], 1e3 * m->x[2]};
    double rates[4];
    if (r[k] == kDerX) count = 4, fmi3GetContinuousStateDerivatives(c, rates, 4), values = rates;
    if (r[k] == kY) values = shown;
    if (done + count > size) return kError;
    memcpy(v + done, values, count * sizeof *v);
  }
  return done == size ? kOk : kError;
}
int fmi3SetFloat64(void* c, const unsigned* r, size_t n, const double* v, size_t size) {
  size_t k, done = 0, count;
  for (k = 0; k < n; ++k, done += count) {
    double* values = place(c, r[k], &count);
    if (done + count > size || r[k] == kDerX || r[k] == kY) return kError;
    memcpy(values, v + done, count * sizeof *v);
  }
  return done == size ? kOk : kError;
}
