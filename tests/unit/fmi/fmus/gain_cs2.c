/* A Co-Simulation unit: dx/dt = k u - x, y = x, by small steps of Euler's method. STEADY: at the start dx/dt = 0. */
#include <stdlib.h>
#ifdef NEEDS_LIBRARY
double gain_of_library(void);
#else
#define gain_of_library() 2.0
#endif
typedef struct {
  double x, u, k;
} Model;
enum { kOk = 0, kError = 3 };
void* fmi2Instantiate(const char* name, int kind, const char* guid, const char* resources, const void* callbacks,
                      int visible, int logging) {
  Model* m = calloc(1, sizeof *m);
  (void)name, (void)guid, (void)resources, (void)callbacks, (void)visible, (void)logging;
  m->k = gain_of_library();
  return kind == 1 ? m : NULL;
}
void fmi2FreeInstance(void* c) { free(c); }
int fmi2SetupExperiment(void* c, int defined, double tolerance, double start, int stop_defined, double stop) {
  return (void)c, (void)defined, (void)tolerance, (void)start, (void)stop_defined, (void)stop, kOk;
}
int fmi2EnterInitializationMode(void* c) { return (void)c, kOk; }
int fmi2ExitInitializationMode(void* c) {
#ifdef STEADY
  ((Model*)c)->x = ((Model*)c)->k * ((Model*)c)->u;
#endif
  return (void)c, kOk;
}
int fmi2Terminate(void* c) { return (void)c, kOk; }
static double* place(Model* m, unsigned reference) {
  return reference == 0U ? &m->x : reference == 1U ? &m->u : reference == 2U ? &m->k : NULL;
}
int fmi2GetReal(void* c, const unsigned* references, size_t n, double* values) {
  size_t k;
  for (k = 0; k < n; ++k) values[k] = *place(c, references[k]);
  return kOk;
}
int fmi2SetReal(void* c, const unsigned* references, size_t n, const double* values) {
  size_t k;
  for (k = 0; k < n; ++k) *place(c, references[k]) = values[k];
  return kOk;
}
int fmi2GetInteger(void* c, const unsigned* r, size_t n, int* v) { return (void)c, (void)r, (void)n, (void)v, kError; }
int fmi2GetBoolean(void* c, const unsigned* r, size_t n, int* v) { return (void)c, (void)r, (void)n, (void)v, kError; }
int fmi2SetInteger(void* c, const unsigned* r, size_t n, const int* v) {
  return (void)c, (void)r, (void)n, (void)v, kError;
}
int fmi2SetBoolean(void* c, const unsigned* r, size_t n, const int* v) {
  return (void)c, (void)r, (void)n, (void)v, kError;
}
int fmi2DoStep(void* c, double time, double step, int no_return) {
  Model* m = c;
  int k;
  (void)time, (void)no_return;
  for (k = 0; k < 1000; ++k) m->x += step / 1000.0 * (m->k * m->u - m->x);
  return kOk;
}
