/* The functions of FMI 3.0 for Model Exchange around another unit of FMI 3.0, with laws added: fmi2_wrapper.c, which stands
 * before this text, does the work. Here what it calls of the other unit becomes a call of FMI 3.0, and what importers call
 * of FMI 3.0 becomes a call of its functions. Texts, binary variables and clocks are the other unit's alone. */
#include <stdbool.h>
#include <stdint.h>

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

typedef uint32_t Ref;
typedef const char* Text;
typedef void (*Log)(void* environment, int status, const char* category, const char* message);

typedef void* Instantiate3Type(const char*, const char*, const char*, bool, bool, void*, Log);
typedef int Logging3Type(void*, bool, size_t, const char* const*);
typedef int Initialise3Type(void*, bool, double, double, bool, double);
typedef int Update3Type(void*, bool*, bool*, bool*, bool*, bool*, double*);
typedef int Step3Type(void*, bool, bool*, bool*);
typedef int Count3Type(void*, size_t*);
#define TYPED(type, name)                                                      \
  typedef int Get##name##Type(void*, const Ref*, size_t, type*, size_t);        \
  typedef int Set##name##Type(void*, const Ref*, size_t, const type*, size_t);
/* The types of numbers; an enumeration is an Int64. The nearest number of a type is the one that it is set to. */
#define AS_SINGLE(type, value, least, most) (type)(value)
#define AS_FLAG(type, value, least, most) ((value) != 0.0)
#define AS_WHOLE(type, value, least, most)   \
  ((value) >= (double)(most)    ? (type)(most) \
   : (value) <= (double)(least) ? (type)(least) \
                                : (type)((value) < 0.0 ? (value)-0.5 : (value) + 0.5))
#define EACH_OTHER_NUMBER(X)                                                                            \
  X(float, Float32, kSingle, AS_SINGLE, 0, 0) X(bool, Boolean, kBoolean, AS_FLAG, 0, 0)                  \
  X(int8_t, Int8, kInt8, AS_WHOLE, INT8_MIN, INT8_MAX) X(uint8_t, UInt8, kUInt8, AS_WHOLE, 0, UINT8_MAX)  \
  X(int16_t, Int16, kInt16, AS_WHOLE, INT16_MIN, INT16_MAX)                                             \
  X(uint16_t, UInt16, kUInt16, AS_WHOLE, 0, UINT16_MAX)                                                 \
  X(int32_t, Int32, kInteger, AS_WHOLE, INT32_MIN, INT32_MAX)                                           \
  X(uint32_t, UInt32, kUInt32, AS_WHOLE, 0, UINT32_MAX)                                                 \
  X(int64_t, Int64, kInt64, AS_WHOLE, INT64_MIN, INT64_MAX)                                             \
  X(uint64_t, UInt64, kUInt64, AS_WHOLE, 0, UINT64_MAX)
#define EACH_NUMBER(X) X(double, Float64, kReal, AS_SINGLE, 0, 0) EACH_OTHER_NUMBER(X)
#define NUMBER_TYPED(type, name, kind, as, least, most) TYPED(type, name)
EACH_NUMBER(NUMBER_TYPED)
TYPED(Text, String)
#define INNER ((Model*)c)->inner
#define EACH_PASSED_ON(GET, SET)                                                                                      \
  GET(GetBinary, (void* c, const Ref* r, size_t n, size_t* sizes, const uint8_t** values, size_t size),               \
      (INNER, r, n, sizes, values, size))                                                                             \
  SET(SetBinary, (void* c, const Ref* r, size_t n, const size_t* sizes, const uint8_t* const* values, size_t size),   \
      (INNER, r, n, sizes, values, size))                                                                             \
  GET(GetClock, (void* c, const Ref* r, size_t n, bool* values), (INNER, r, n, values))                               \
  SET(SetClock, (void* c, const Ref* r, size_t n, const bool* values), (INNER, r, n, values))                         \
  GET(GetIntervalDecimal, (void* c, const Ref* r, size_t n, double* values, int* qualifiers),                         \
      (INNER, r, n, values, qualifiers))                                                                              \
  GET(GetIntervalFraction, (void* c, const Ref* r, size_t n, uint64_t* counters, uint64_t* parts, int* qualifiers),   \
      (INNER, r, n, counters, parts, qualifiers))                                                                     \
  GET(GetShiftDecimal, (void* c, const Ref* r, size_t n, double* values), (INNER, r, n, values))                      \
  GET(GetShiftFraction, (void* c, const Ref* r, size_t n, uint64_t* counters, uint64_t* parts),                       \
      (INNER, r, n, counters, parts))                                                                                 \
  SET(SetIntervalDecimal, (void* c, const Ref* r, size_t n, const double* values), (INNER, r, n, values))             \
  SET(SetIntervalFraction, (void* c, const Ref* r, size_t n, const uint64_t* counters, const uint64_t* parts),        \
      (INNER, r, n, counters, parts))                                                                                 \
  SET(SetShiftDecimal, (void* c, const Ref* r, size_t n, const double* values), (INNER, r, n, values))                \
  SET(SetShiftFraction, (void* c, const Ref* r, size_t n, const uint64_t* counters, const uint64_t* parts),           \
      (INNER, r, n, counters, parts))
#define PASSED_TYPE(name, parameters, arguments) typedef int name##Type parameters;
EACH_PASSED_ON(PASSED_TYPE, PASSED_TYPE)

#define EACH_NEEDED3(X)                                                                              \
  X(Instantiate3, InstantiateModelExchange) X(Initialise3, EnterInitializationMode)                   \
  X(Update3, UpdateDiscreteStates) X(Step3, CompletedIntegratorStep) X(GetFloat64, GetFloat64)        \
  X(SetFloat64, SetFloat64)
static struct {
  Instantiate3Type* InstantiateModelExchange;
  Initialise3Type* EnterInitializationMode;
  Update3Type* UpdateDiscreteStates;
  Step3Type* CompletedIntegratorStep;
  Logging3Type* SetDebugLogging;
  Count3Type* GetNumberOfEventIndicators;
  PlainType* EvaluateDiscreteStates;
#define TYPED_FIELD(type, name) \
  Get##name##Type* Get##name;   \
  Set##name##Type* Set##name;
#define NUMBER_FIELD(type, name, kind, as, least, most) TYPED_FIELD(type, name)
  EACH_NUMBER(NUMBER_FIELD) TYPED_FIELD(Text, String)
#define PASSED_FIELD(name, parameters, arguments) name##Type* name;
  EACH_PASSED_ON(PASSED_FIELD, PASSED_FIELD)
} inner3;

/* The other unit, as fmi2_wrapper.c calls it. */
#define NUMBERS(type, name, kind, as, least, most)                                                                 \
  static int set_##name(void* c, unsigned reference, const double* values, size_t n) {                              \
    type one, *typed = n == 1 ? &one : malloc((n + 1) * sizeof *typed);                                             \
    int status = typed == NULL || inner3.Set##name == NULL ? kError : kOk;                                          \
    size_t k;                                                                                                      \
    for (k = 0; k < n && good(status); ++k) typed[k] = as(type, values[k], least, most);                            \
    if (good(status)) status = inner3.Set##name(c, &reference, 1, typed, n);                                        \
    if (n != 1) free(typed);                                                                                       \
    return status;                                                                                                 \
  }                                                                                                                \
  static int get_##name(void* c, unsigned reference, double* values, size_t n) {                                    \
    type one, *typed = n == 1 ? &one : malloc((n + 1) * sizeof *typed);                                             \
    int status = typed == NULL || inner3.Get##name == NULL ? kError : inner3.Get##name(c, &reference, 1, typed, n); \
    size_t k;                                                                                                      \
    for (k = 0; k < n && good(status); ++k) values[k] = (double)typed[k];                                           \
    if (n != 1) free(typed);                                                                                       \
    return status;                                                                                                 \
  }
EACH_OTHER_NUMBER(NUMBERS)
#define SET_NUMBERS(type, name, kind, as, least, most) \
  case kind:                                           \
    return set_##name(c, reference, values, n);
#define GET_NUMBERS(type, name, kind, as, least, most) \
  case kind:                                           \
    return get_##name(c, reference, values, n);
static int set_numbers(void* c, int type, unsigned reference, const double* values, size_t n) {
  switch (type) {
    case kReal:
      return inner3.SetFloat64(c, &reference, 1, values, n);
    EACH_OTHER_NUMBER(SET_NUMBERS)
  }
  return kError;
}
static int get_numbers(void* c, int type, unsigned reference, double* values, size_t n) {
  switch (type) {
    case kReal:
      return inner3.GetFloat64(c, &reference, 1, values, n);
    EACH_OTHER_NUMBER(GET_NUMBERS)
  }
  return kError;
}
static int set_text(void* c, const unsigned* references, size_t n, const char* const* values) {
  return inner3.SetString == NULL ? kError : inner3.SetString(c, references, n, values, n);
}
static int new_discrete_states(void* c, EventInfo* info) {
  bool again = false, terminate = false, nominals = false, values = false, next_defined = false;
  double next = 0.0;
  const int status = inner3.UpdateDiscreteStates(c, &again, &terminate, &nominals, &values, &next_defined, &next);
  info->new_discrete_states_needed = again, info->terminate = terminate, info->nominals_changed = nominals;
  info->values_changed = values, info->next_time_defined = next_defined, info->next_time = next;
  return status;
}
static int completed_step(void* c, int no_return, int* event, int* terminate) {
  bool enters = false, ends = false;
  const int status = inner3.CompletedIntegratorStep(c, no_return != 0, &enters, &ends);
  *event = enters, *terminate = ends;
  return status;
}

static const char* look_up(void* library) {
  const char* missing = NULL;
#define FIND3(type, name) inner3.name = (type##Type*)symbol(library, "fmi3" #name);
#define FIND3_TYPED(type, name)                                        \
  inner3.Get##name = (Get##name##Type*)symbol(library, "fmi3Get" #name); \
  inner3.Set##name = (Set##name##Type*)symbol(library, "fmi3Set" #name);
#define NEED3(type, name) \
  if (inner3.name == NULL) missing = "its function fmi3" #name;
#define SAME3(type, name)                                        \
  inner.name = (type##Type*)symbol(library, "fmi3" #name);        \
  if (inner.name == NULL) missing = "its function fmi3" #name;
#define FIND3_NUMBER(type, name, kind, as, least, most) FIND3_TYPED(type, name)
  EACH_NUMBER(FIND3_NUMBER) FIND3_TYPED(Text, String)
#define FIND3_PASSED(name, parameters, arguments) inner3.name = (name##Type*)symbol(library, "fmi3" #name);
  EACH_PASSED_ON(FIND3_PASSED, FIND3_PASSED)
  EACH_NEEDED3(FIND3)
  FIND3(Logging3, SetDebugLogging) FIND3(Count3, GetNumberOfEventIndicators) FIND3(Plain, EvaluateDiscreteStates)
  EACH_NEEDED3(NEED3)
  SAME3(Free, FreeInstance) SAME3(Plain, ExitInitializationMode) SAME3(Plain, EnterEventMode)
  SAME3(Plain, EnterContinuousTimeMode) SAME3(Time, SetTime)
  SAME3(SetVector, SetContinuousStates) SAME3(GetVector, GetContinuousStates)
  SAME3(GetVector, GetNominalsOfContinuousStates) SAME3(GetVector, GetEventIndicators)
  inner.GetDerivatives = (GetVectorType*)symbol(library, "fmi3GetContinuousStateDerivatives");
  if (inner.GetDerivatives == NULL) missing = "its function fmi3GetContinuousStateDerivatives";
  inner.Terminate = (PlainType*)symbol(library, "fmi3Terminate"); /* what few tools call it may lack */
  inner.Reset = (PlainType*)symbol(library, "fmi3Reset");
  inner.EnterConfigurationMode = (PlainType*)symbol(library, "fmi3EnterConfigurationMode");
  inner.ExitConfigurationMode = (PlainType*)symbol(library, "fmi3ExitConfigurationMode");
  inner.SetString = set_text;
  inner.NewDiscreteStates = new_discrete_states, inner.CompletedIntegratorStep = completed_step;
  return missing;
}

EXPORT void* fmi3InstantiateModelExchange(const char* name, const char* token, const char* resources, bool visible,
                                          bool logging, void* environment, Log log) {
  Model* m = NULL;
  char* location = NULL;
  const char* missing = resources == NULL ? "resources" : load(resources);
  if (missing != NULL && log != NULL) log(environment, kError, "the unit within lacks", missing);
  if (missing != NULL || token == NULL || strcmp(token, MODEL_TOKEN) != 0) return NULL;
  m = calloc(1, sizeof *m);
  location = path_of(resources, "/inner/resources/");
  if (m != NULL && location != NULL)
    m->inner = inner3.InstantiateModelExchange(name, INNER_TOKEN, location, visible, logging, environment, log);
  free(location);
  if (m != NULL && m->inner != NULL && reset(m) == kOk) return m;
  if (m != NULL && m->inner != NULL) inner.FreeInstance(m->inner);
  return free(m), NULL;
}
EXPORT void fmi3FreeInstance(void* c) { fmi2FreeInstance(c); }
EXPORT int fmi3Reset(void* c) { return fmi2Reset(c); }
EXPORT int fmi3SetDebugLogging(void* c, bool on, size_t n, const char* const* names) {
  return inner3.SetDebugLogging == NULL ? kOk : inner3.SetDebugLogging(((Model*)c)->inner, on, n, names);
}
EXPORT int fmi3EnterInitializationMode(void* c, bool tolerance_defined, double tolerance, double start,
                                       bool stop_defined, double stop) {
  Model* m = c;
  m->time = start, m->mode = kInitialising, m->known = 0;
  return inner3.EnterInitializationMode(m->inner, tolerance_defined, tolerance, start, stop_defined, stop);
}
EXPORT int fmi3ExitInitializationMode(void* c) { return fmi2ExitInitializationMode(c); }
EXPORT int fmi3EnterEventMode(void* c) { return fmi2EnterEventMode(c); }
EXPORT int fmi3EnterContinuousTimeMode(void* c) { return fmi2EnterContinuousTimeMode(c); }
EXPORT int fmi3Terminate(void* c) { return inner.Terminate == NULL ? kOk : fmi2Terminate(c); }
EXPORT int fmi3EvaluateDiscreteStates(void* c) {
  if (refresh(c) != kOk) return kError;
  ((Model*)c)->known = 0;
  return inner3.EvaluateDiscreteStates == NULL ? kOk : inner3.EvaluateDiscreteStates(((Model*)c)->inner);
}
EXPORT int fmi3UpdateDiscreteStates(void* c, bool* again, bool* terminate, bool* nominals, bool* values,
                                    bool* next_defined, double* next) {
  EventInfo info = {0};
  const int status = fmi2NewDiscreteStates(c, &info);
  *again = info.new_discrete_states_needed != 0, *terminate = info.terminate != 0;
  *nominals = info.nominals_changed != 0, *values = info.values_changed != 0;
  *next_defined = info.next_time_defined != 0, *next = info.next_time;
  return status;
}
EXPORT int fmi3CompletedIntegratorStep(void* c, bool no_return, bool* event, bool* terminate) {
  int enters = 0, ends = 0;
  const int status = fmi2CompletedIntegratorStep(c, no_return, &enters, &ends);
  *event = enters != 0, *terminate = ends != 0;
  return status;
}
EXPORT int fmi3SetTime(void* c, double time) { return fmi2SetTime(c, time); }
EXPORT int fmi3SetContinuousStates(void* c, const double* x, size_t n) { return fmi2SetContinuousStates(c, x, n); }
EXPORT int fmi3GetContinuousStates(void* c, double* x, size_t n) { return fmi2GetContinuousStates(c, x, n); }
EXPORT int fmi3GetNominalsOfContinuousStates(void* c, double* x, size_t n) {
  return fmi2GetNominalsOfContinuousStates(c, x, n);
}
EXPORT int fmi3GetContinuousStateDerivatives(void* c, double* dx, size_t n) { return fmi2GetDerivatives(c, dx, n); }
EXPORT int fmi3GetEventIndicators(void* c, double* z, size_t n) { return fmi2GetEventIndicators(c, z, n); }
EXPORT int fmi3GetNumberOfContinuousStates(void* c, size_t* n) { return (void)c, *n = STATES + HIDDEN, kOk; }
EXPORT int fmi3GetNumberOfEventIndicators(void* c, size_t* n) {
  *n = 0;
  return inner3.GetNumberOfEventIndicators == NULL ? kError
                                                   : inner3.GetNumberOfEventIndicators(((Model*)c)->inner, n);
}

static size_t size_of(Ref reference) {
  const Array* array = array_of(reference);
  return array == NULL ? 1 : (size_t)array->size;
}
/* Numbers come from the other unit, and those that are this one's own take their place. */
#define GET_NUMBER(type, name, kind, as, least, most)                                                           \
  EXPORT int fmi3Get##name(void* c, const Ref* references, size_t n, type* values, size_t size) {                \
    Model* m = c;                                                                                                \
    size_t k, element, done = 0;                                                                                 \
    int status = n > 0 && refresh(m) != kOk ? kError : kOk;                                                      \
    for (k = 0; k < n && good(status); ++k) {                                                                    \
      const size_t count = size_of(references[k]);                                                               \
      if (count > size - done) return kError;                                                                    \
      if (references[k] < OWN)                                                                                   \
        status = inner3.Get##name == NULL                                                                        \
                     ? kError                                                                                    \
                     : inner3.Get##name(m->inner, &references[k], 1, values + done, count);                      \
      for (element = 0; element < count && good(status); ++element) {                                            \
        double own = 0.0;                                                                                        \
        if (own_value(m, references[k], (int)element, &own))                                                     \
          values[done + element] = (type)own;                                                                    \
        else if (references[k] >= OWN)                                                                           \
          status = kError;                                                                                       \
      }                                                                                                          \
      done += count;                                                                                             \
    }                                                                                                            \
    return status;                                                                                               \
  }
/* An array goes to the other unit whole, a number alone where it is not this one's own. */
#define SET_NUMBER(type, name, kind, as, least, most)                                                           \
  EXPORT int fmi3Set##name(void* c, const Ref* references, size_t n, const type* values, size_t size) {          \
    Model* m = c;                                                                                                \
    size_t k, element, done = 0;                                                                                 \
    int status = kOk;                                                                                            \
    for (k = 0; k < n && good(status); ++k) {                                                                    \
      const Array* array = array_of(references[k]);                                                              \
      const size_t count = size_of(references[k]);                                                               \
      int kept = 0;                                                                                              \
      if (count > size - done) return kError;                                                                    \
      m->known = 0;                                                                                              \
      for (element = 0; array != NULL && array->first >= 0 && element < count; ++element)                        \
        m->arrays[(size_t)array->first + element] = (double)values[done + element];                              \
      for (element = 0; element < count && good(status); ++element)                                              \
        kept = keep(m, kind, references[k], (int)element, (double)values[done + element], &status);              \
      if (good(status) && !(array == NULL && kept))                                                              \
        status = inner3.Set##name == NULL                                                                        \
                     ? kError                                                                                    \
                     : inner3.Set##name(m->inner, &references[k], 1, values + done, count);                      \
      done += count;                                                                                             \
    }                                                                                                            \
    return status;                                                                                               \
  }
EACH_NUMBER(GET_NUMBER) EACH_NUMBER(SET_NUMBER)
EXPORT int fmi3GetString(void* c, const Ref* references, size_t n, Text* values, size_t size) {
  if (n > 0 && refresh(c) != kOk) return kError;
  return inner3.GetString == NULL ? kError : inner3.GetString(INNER, references, n, values, size);
}
EXPORT int fmi3SetString(void* c, const Ref* references, size_t n, const Text* values, size_t size) {
  ((Model*)c)->known = 0;
  return inner3.SetString == NULL ? kError : inner3.SetString(INNER, references, n, values, size);
}

#define GET_PASSED(name, parameters, arguments)               \
  EXPORT int fmi3##name parameters {                           \
    if (refresh(c) != kOk) return kError;                      \
    return inner3.name == NULL ? kError : inner3.name arguments; \
  }
#define SET_PASSED(name, parameters, arguments)               \
  EXPORT int fmi3##name parameters {                           \
    ((Model*)c)->known = 0;                                    \
    return inner3.name == NULL ? kError : inner3.name arguments; \
  }
EACH_PASSED_ON(GET_PASSED, SET_PASSED)
EXPORT int fmi3EnterConfigurationMode(void* c) { return (void)c, kError; }
EXPORT int fmi3ExitConfigurationMode(void* c) { return (void)c, kError; }
