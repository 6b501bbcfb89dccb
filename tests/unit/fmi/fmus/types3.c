/* A unit of all of FMI 3.0's numbers, and of arrays of them whose size is a structural parameter. What may change at
 * events alone is refused elsewhere.
 *   dx[i]/dt = w[i] u - x[i] / divisor,  x(0) = 0;   y = sum of x + s + 10 e + 100 counts[0] + 1000 counts[1] */
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
enum { kOk = 0, kError = 3, kMost = 8 };
enum { kN = 1, kX, kDerX, kW, kDivisor, kU, kS, kE, kCounts, kLow = 20, kY, kYByte, kYItem, kFlags };
typedef struct {
  uint64_t n;
  int configuring, continuous;
  double x[kMost];
  float w[kMost], u;
  int8_t divisor;
  int64_t s, e;
  uint16_t counts[2];
  bool flags[2];
} Model;
typedef void (*Log)(void*, int, const char*, const char*);
void* fmi3InstantiateModelExchange(const char* name, const char* token, const char* resources, bool visible,
                                   bool logging, void* environment, Log log) {
  Model* m = calloc(1, sizeof *m);
  int k;
  (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)environment, (void)log;
  m->n = 2, m->divisor = 1;
  for (k = 0; k < kMost; ++k) m->w[k] = (float)(k + 1);
  return m;
}
void fmi3FreeInstance(void* c) { free(c); }
int fmi3EnterConfigurationMode(void* c) { return ((Model*)c)->configuring = 1, kOk; }
int fmi3ExitConfigurationMode(void* c) { return ((Model*)c)->configuring = 0, kOk; }
int fmi3EnterInitializationMode(void* c, bool td, double t, double start, bool sd, double stop) {
  return (void)td, (void)t, (void)start, (void)sd, (void)stop, ((Model*)c)->configuring ? kError : kOk;
}
int fmi3ExitInitializationMode(void* c) { return (void)c, kOk; }
int fmi3EnterEventMode(void* c) { return ((Model*)c)->continuous = 0, kOk; }
int fmi3EnterContinuousTimeMode(void* c) { return ((Model*)c)->continuous = 1, kOk; }
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
  const Model* m = c;
  size_t k;
  for (k = 0; k < n && k < m->n; ++k) dx[k] = (double)m->w[k] * (double)m->u - m->x[k] / m->divisor;
  return n == m->n ? kOk : kError;
}
int fmi3GetEventIndicators(void* c, double* z, size_t n) { return (void)c, (void)z, (void)n, kOk; }
static double level(const Model* m) {
  double sum = (double)m->s + 10.0 * (double)m->e + 100.0 * m->counts[0] + 1000.0 * m->counts[1];
  size_t k;
  for (k = 0; k < m->n; ++k) sum += m->x[k];
  return sum;
}
int fmi3GetFloat64(void* c, const unsigned* r, size_t n, double* v, size_t size) {
  const Model* m = c;
  (void)size;
  for (; n > 0; --n, ++r) {
    if (*r == kX) memcpy(v, m->x, m->n * sizeof *v);
    if (*r == kX) v += m->n;
    if (*r == kDerX) fmi3GetContinuousStateDerivatives(c, v, m->n), v += m->n;
    if (*r == kY) *v++ = level(m);
    if (*r != kX && *r != kDerX && *r != kY) return kError;
  }
  return kOk;
}
int fmi3SetFloat64(void* c, const unsigned* r, size_t n, const double* v, size_t size) {
  return (void)c, (void)r, (void)v, (void)size, n == 0 ? kOk : kError;
}
/* Of one variable a call, as those that have them in arrays of another type do. */
#define GET(type, name, reference, place, count)                                            \
  int fmi3Get##name(void* c, const unsigned* r, size_t n, type* v, size_t size) {            \
    Model* m = c;                                                                           \
    if (n != 1 || size != (count) || r[0] != (reference)) return kError;                    \
    return memcpy(v, place, size * sizeof *v), kOk;                                         \
  }
#define SET(type, name, reference, place, count, allowed)                                   \
  int fmi3Set##name(void* c, const unsigned* r, size_t n, const type* v, size_t size) {      \
    Model* m = c;                                                                           \
    if (n != 1 || size != (count) || r[0] != (reference) || !(allowed)) return kError;      \
    return memcpy(place, v, size * sizeof *v), kOk;                                         \
  }
SET(uint64_t, UInt64, kN, &m->n, 1, m->configuring && *v <= kMost)
GET(uint64_t, UInt64, kN, &m->n, 1)
SET(int8_t, Int8, kDivisor, &m->divisor, 1, !m->continuous)
GET(int8_t, Int8, kDivisor, &m->divisor, 1)
SET(uint16_t, UInt16, kCounts, m->counts, 2, !m->continuous)
GET(uint16_t, UInt16, kCounts, m->counts, 2)
SET(bool, Boolean, kFlags, m->flags, 2, !m->continuous)
GET(bool, Boolean, kFlags, m->flags, 2)
int fmi3SetFloat32(void* c, const unsigned* r, size_t n, const float* v, size_t size) {
  Model* m = c;
  if (n != 1 || (r[0] != kU && r[0] != kW) || size != (r[0] == kU ? 1 : m->n)) return kError;
  return memcpy(r[0] == kU ? &m->u : m->w, v, size * sizeof *v), kOk;
}
int fmi3GetFloat32(void* c, const unsigned* r, size_t n, float* v, size_t size) {
  const Model* m = c;
  float low = (float)level(m);
  if (n != 1 || size != (r[0] == kW ? m->n : 1)) return kError;
  return memcpy(v, r[0] == kU ? &m->u : r[0] == kW ? m->w : &low, size * sizeof *v), kOk;
}
int fmi3SetInt64(void* c, const unsigned* r, size_t n, const int64_t* v, size_t size) {
  Model* m = c;
  if (n != 1 || size != 1 || (r[0] != kS && r[0] != kE) || m->continuous) return kError;
  return *(r[0] == kS ? &m->s : &m->e) = v[0], kOk;
}
int fmi3GetInt64(void* c, const unsigned* r, size_t n, int64_t* v, size_t size) {
  const Model* m = c;
  if (n != 1 || size != 1) return kError;
  return v[0] = r[0] == kS ? m->s : m->e, kOk;
}
int fmi3GetUInt8(void* c, const unsigned* r, size_t n, uint8_t* v, size_t size) {
  if (n != 1 || size != 1 || r[0] != kYByte) return kError;
  return v[0] = (uint8_t)((Model*)c)->s, kOk;
}
