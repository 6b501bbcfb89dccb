/* A unit with all that a model may have besides numbers: discrete and typed inputs, a state that its own parameter
 * starts, time events, an end of its own, and a text. It keeps to the standard's modes: what may be set at events alone is
 * refused elsewhere.
 *   dx/dt = -k x, x(0) = x0;  steps counts the seconds and asks to end at `last`;  y = u of each type */
#include <math.h>
#include <stdlib.h>
#include <string.h>
enum { kOk = 0, kDiscard = 2, kError = 3 };
enum { kReal = 1, kDiscrete, kInteger, kBoolean, kYReal = 11, kYDiscrete, kYInteger, kYBoolean, kSteps = 20, kLast,
       kText, kLength, kBytes, kX0 = 30, kX, kDerX, kK, kNow = 40, kBegan };
enum Mode { kSetUp, kInitialising, kEvent, kContinuous, kStepping };
typedef struct {
  enum Mode mode;
  double time, began, u_real, u_discrete, x0, x, k;
  int u_integer, u_boolean, steps, last;
  char text[64];
  unsigned char bytes[8];
  size_t bytes_size;
  int ended;
} Model;

static Model* mixed_new(void) {
  Model* m = calloc(1, sizeof *m);
  m->x0 = 2.0, m->k = 1.0, m->last = 1000;
  strcpy(m->text, "four");
  return m;
}
static int mixed_real(const Model* m, unsigned reference, double* value) {
  switch (reference) {
    case kReal: case kYReal: return *value = m->u_real, kOk;
    case kDiscrete: case kYDiscrete: return *value = m->u_discrete, kOk;
    case kX0: return *value = m->x0, kOk;
    case kX: return *value = m->x, kOk;
    case kDerX: return *value = -m->k * m->x, kOk;
    case kK: return *value = m->k, kOk;
    case kNow: return *value = m->time, kOk;
    case kBegan: return *value = m->began, kOk;
    default: return kError;
  }
}
static int mixed_set_real(Model* m, unsigned reference, double value) {
  const int at_events = m->mode != kContinuous;
  switch (reference) {
    case kReal: return m->u_real = value, kOk;
    case kDiscrete: return at_events ? (m->u_discrete = value, kOk) : kError;
    case kX0: return m->mode == kSetUp ? (m->x0 = value, kOk) : kError;
    case kK: return m->mode == kSetUp ? (m->k = value, kOk) : kError;
    default: return kError;
  }
}
static int mixed_integer(const Model* m, unsigned reference, int* value) {
  switch (reference) {
    case kInteger: case kYInteger: return *value = m->u_integer, kOk;
    case kBoolean: case kYBoolean: return *value = m->u_boolean, kOk;
    case kSteps: return *value = m->steps, kOk;
    case kLast: return *value = m->last, kOk;
    case kLength: return *value = (int)strlen(m->text), kOk;
    default: return kError;
  }
}
static int mixed_set_integer(Model* m, unsigned reference, int value) {
  const int at_events = m->mode != kContinuous;
  switch (reference) {
    case kInteger: return at_events ? (m->u_integer = value, kOk) : kError;
    case kBoolean: return at_events ? (m->u_boolean = value, kOk) : kError;
    case kLast: return m->mode == kSetUp ? (m->last = value, kOk) : kError;
    default: return kError;
  }
}
static int mixed_set_text(Model* m, unsigned reference, const char* text) {
  if (reference != kText || m->mode != kSetUp) return kError;
  return strncpy(m->text, text, sizeof m->text - 1), kOk;
}
static inline int mixed_set_bytes(Model* m, size_t size, const unsigned char* bytes) {
  if (m->mode != kSetUp || size > sizeof m->bytes) return kError;
  return memcpy(m->bytes, bytes, size), m->bytes_size = size, kOk;
}
static void mixed_event(Model* m) {
  if (m->time >= m->steps + 1 - 1e-9) ++m->steps;
  m->ended = m->steps >= m->last;
}
