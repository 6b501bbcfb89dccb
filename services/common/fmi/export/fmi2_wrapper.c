/* The functions of FMI 2.0 for Model Exchange around another unit for Model Exchange, with laws added to its derivatives
 * and inputs. The other unit lies in resources/inner, as it came: its binary is loaded from there and does all the rest.
 * The model's file defines, before it includes this one:
 *
 *   MODEL_TOKEN, INNER_TOKEN, INNER_NAME               guids of both; name of the other's binary
 *   STATES, VARIABLES                                  of the other unit, which laws see: derivatives and variables
 *   HIDDEN                                             states of the laws, behind its own
 *   CHANNELS, PARAMETERS, INPUTS, CALCULATED, OUTPUTS  values u and p of the plant; inputs and parameters of the other unit
 *                                                      that follow from them; outputs y beside those that it has
 *   SITES                                              all that `e` holds: STATES, VARIABLES, then what laws add
 *   OWN                                                first value reference that the other unit does not have: hidden
 *                                                      states, their rates, channels, parameters, outputs, in this order
 *   Port, Setting, and their types: kReal, kInteger, kBoolean, kText, and of FMI 3.0 kSingle, kInt8 ... kUInt64;
 *                                                      continuous: a real that changes between events, too
 *   static const Port state_ports[], rate_ports[], variable_ports[], input_ports[], calculated_ports[], channel_ports[],
 *                     parameter_ports[];
 *   static const Array arrays[]                        of numbers, which FMI 3.0 alone has: their sizes and, of those that can
 *                                                      be set, their place among IN_ARRAYS numbers, else -1; ends with a
 *                                                      size of -1; LARGEST of the sizes
 *   static const Setting settings[]                    SETTINGS of them, the first STRUCTURAL of structural parameters
 *   static const double start_channels[], start_parameters[], start_arrays[], hidden_sizes[];
 *   static void plant_rates, plant_inputs, plant_parameters, plant_outputs
 *       (double t, const double* x, const double* u, const double* p, const double* e, double* result);
 *   static int model_laws(void* model, double t, const double* x, const double* u, const double* p, double* e,
 *                         double* hidden_rates);       what laws add, into the end of e; calls inner_values()
 *
 * All of these are SI: SI = factor * value + offset, by the port of a value.
 *
 * With FMI3 defined the other unit is one of FMI 3.0, and so is this one: fmi3_wrapper.c, behind this text, has the
 * functions of that standard, and these work for them.
 */
#if defined(_WIN32)
#include <windows.h>
#define API __declspec(dllexport)
#if defined(FMI3)
#define PLATFORM (sizeof(void*) == 8 ? "x86_64-windows" : "x86-windows")
#else
#define PLATFORM (sizeof(void*) == 8 ? "win64" : "win32")
#endif
#define SUFFIX ".dll"
#else
#include <dlfcn.h>
#define API __attribute__((visibility("default")))
#if defined(__APPLE__)
#define SUFFIX ".dylib"
#else
#define SUFFIX ".so"
#endif
#if defined(FMI3) && defined(__APPLE__)
#define PLATFORM "x86_64-darwin"
#elif defined(FMI3) && defined(__aarch64__)
#define PLATFORM "aarch64-linux"
#elif defined(FMI3)
#define PLATFORM (sizeof(void*) == 8 ? "x86_64-linux" : "x86-linux")
#elif defined(__APPLE__)
#define PLATFORM "darwin64"
#else
#define PLATFORM (sizeof(void*) == 8 ? "linux64" : "linux32")
#endif
#endif
#if defined(FMI3)
#undef API
#define API static
#endif
#include <stdlib.h>
#include <string.h>

#define ROOM(count) ((count) + 1)

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
enum { kOk = 0, kWarning = 1, kError = 3 };
enum { kInstantiated, kInitialising, kRunning };

typedef void* InstantiateType(const char*, int, const char*, const char*, const Callbacks*, int, int);
typedef void FreeType(void*);
typedef int PlainType(void*);
typedef int LoggingType(void*, int, size_t, const char* const*);
typedef int SetupType(void*, int, double, double, int, double);
typedef int EventType(void*, EventInfo*);
typedef int StepType(void*, int, int*, int*);
typedef int TimeType(void*, double);
typedef int GetRealType(void*, const unsigned*, size_t, double*);
typedef int SetRealType(void*, const unsigned*, size_t, const double*);
typedef int GetIntType(void*, const unsigned*, size_t, int*);
typedef int SetIntType(void*, const unsigned*, size_t, const int*);
typedef int GetTextType(void*, const unsigned*, size_t, const char**);
typedef int SetTextType(void*, const unsigned*, size_t, const char* const*);
typedef int GetVectorType(void*, double*, size_t);
typedef int SetVectorType(void*, const double*, size_t);

/* The other unit's functions; what few tools call it may lack. */
#define EACH_FUNCTION(X)                                                                                          \
  X(Instantiate, Instantiate) X(Free, FreeInstance) X(Setup, SetupExperiment)                                      \
  X(Plain, EnterInitializationMode) X(Plain, ExitInitializationMode)                     \
  X(Plain, EnterEventMode) X(Plain, EnterContinuousTimeMode) X(Plain, Terminate) X(Event, NewDiscreteStates)       \
  X(Step, CompletedIntegratorStep) X(Time, SetTime) X(SetVector, SetContinuousStates)                              \
  X(GetVector, GetContinuousStates) X(GetVector, GetNominalsOfContinuousStates) X(GetVector, GetDerivatives)       \
  X(GetVector, GetEventIndicators) X(GetReal, GetReal) X(SetReal, SetReal) X(GetInt, GetInteger)                   \
  X(SetInt, SetInteger) X(GetInt, GetBoolean) X(SetInt, SetBoolean)
#define EACH_RARE_FUNCTION(X) \
  X(Plain, Reset) X(Logging, SetDebugLogging) X(GetText, GetString) X(SetText, SetString)
static struct {
#define FIELD(type, name) type##Type* name;
  EACH_FUNCTION(FIELD) EACH_RARE_FUNCTION(FIELD)
  PlainType *EnterConfigurationMode, *ExitConfigurationMode; /* FMI 3.0 alone has them */
} inner;

typedef struct {
  void* inner;
  int mode, known; /* known: x, e, dx are those of the present point */
  double time, x[ROOM(STATES + HIDDEN)], dx[ROOM(STATES + HIDDEN)], u[ROOM(CHANNELS)], p[ROOM(PARAMETERS)], e[ROOM(SITES)];
  double arrays[ROOM(IN_ARRAYS)], one_array[LARGEST];
} Model;

static double to_si(const Port* port, double value) { return port->factor * value + port->offset; }
static double from_si(const Port* port, double value) { return (value - port->offset) / port->factor; }
static int good(int status) { return status == kOk || status == kWarning; }

/* The array of that reference; NULL: it is of a single number. */
static const Array* array_of(unsigned reference) {
  const Array* array = arrays;
  while (array->size >= 0 && array->reference != reference) ++array;
  return array->size >= 0 ? array : NULL;
}
/* All numbers of a variable of the other unit. */
#if defined(FMI3)
static int set_numbers(void* c, int type, unsigned reference, const double* values, size_t n);
static int get_numbers(void* c, int type, unsigned reference, double* values, size_t n);
#else
static int set_numbers(void* c, int type, unsigned reference, const double* values, size_t n) {
  const int whole = (int)(*values < 0.0 ? *values - 0.5 : *values + 0.5), yes = *values != 0.0;
  if (type == kReal) return inner.SetReal(c, &reference, n, values);
  if (type == kInteger) return inner.SetInteger(c, &reference, n, &whole);
  return inner.SetBoolean(c, &reference, n, &yes);
}
static int get_numbers(void* c, int type, unsigned reference, double* values, size_t n) {
  int whole = 0, status;
  if (type == kReal) return inner.GetReal(c, &reference, n, values);
  status = (type == kInteger ? inner.GetInteger : inner.GetBoolean)(c, &reference, n, &whole);
  *values = whole;
  return status;
}
#endif

static int set_port(Model* m, const Port* port, double si) {
  const double value = from_si(port, si);
  const Array* array = port->size == 1 ? NULL : array_of(port->reference);
  if (array == NULL) return set_numbers(m->inner, port->type, port->reference, &value, 1);
  m->arrays[array->first + port->element] = value;
  return set_numbers(m->inner, port->type, port->reference, m->arrays + array->first, (size_t)array->size);
}
/* As the other unit counts. */
static int get_number(Model* m, const Port* port, double* value) {
  const int status = get_numbers(m->inner, port->type, port->reference, m->one_array, (size_t)port->size);
  *value = m->one_array[port->element];
  return status;
}

/* With what the laws add so far: the other unit's inputs are set, its derivatives and variables go to the begin of e. */
static int inner_values(void* model) {
  Model* m = model;
  double inputs[ROOM(INPUTS)], rates[ROOM(STATES)];
  int k;
  plant_inputs(m->time, m->x, m->u, m->p, m->e, inputs);
  for (k = 0; k < INPUTS; ++k)
    if (!good(set_port(m, &input_ports[k], inputs[k]))) return kError;
  if (m->mode == kRunning && STATES > 0 && !good(inner.GetDerivatives(m->inner, rates, STATES))) return kError;
  for (k = 0; k < STATES; ++k) {
    if (m->mode != kRunning && !good(get_number(m, &rate_ports[k], &rates[k]))) return kError;
    m->e[k] = state_ports[k].factor * rates[k];
  }
  for (k = 0; k < VARIABLES; ++k) {
    double value = 0.0;
    if (!good(get_number(m, &variable_ports[k], &value))) return kError;
    m->e[STATES + k] = to_si(&variable_ports[k], value);
  }
  return kOk;
}

/* Everything at the present point. */
static int refresh(Model* m) {
  double x[ROOM(STATES)];
  int k;
  if (m->known || m->mode == kInstantiated) return kOk;
  if (m->mode == kRunning && STATES > 0 && !good(inner.GetContinuousStates(m->inner, x, STATES))) return kError;
  for (k = 0; k < STATES; ++k) {
    if (m->mode != kRunning && !good(get_number(m, &state_ports[k], &x[k]))) return kError;
    m->x[k] = to_si(&state_ports[k], x[k]);
  }
  memset(m->e, 0, sizeof m->e);
  if (model_laws(m, m->time, m->x, m->u, m->p, m->e, m->dx + STATES) != kOk) return kError;
  if (inner_values(m) != kOk) return kError;
  plant_rates(m->time, m->x, m->u, m->p, m->e, m->dx);
  m->known = 1;
  return kOk;
}

/* Parameters of the other unit that follow from those of the plant. */
static int push_parameters(Model* m) {
  double values[ROOM(CALCULATED)];
  int k;
  plant_parameters(m->time, m->x, m->u, m->p, m->e, values);
  for (k = 0; k < CALCULATED; ++k)
    if (!good(set_port(m, &calculated_ports[k], values[k]))) return kError;
  return kOk;
}

static int apply_settings(Model* m, int k, int end) {
  for (; k < end; ++k) {
    const Setting* setting = &settings[k];
    if (setting->port.type == kText
            ? inner.SetString == NULL || !good(inner.SetString(m->inner, &setting->port.reference, 1, &setting->text))
            : !good(set_port(m, &setting->port, setting->value)))
      return kError;
  }
  return kOk;
}
/* The sizes of arrays, which are set in a mode of their own. */
static int apply_structure(Model* m) {
  if (STRUCTURAL == 0) return kOk;
  if (inner.EnterConfigurationMode == NULL || inner.ExitConfigurationMode == NULL) return kError;
  if (!good(inner.EnterConfigurationMode(m->inner)) || apply_settings(m, 0, STRUCTURAL) != kOk) return kError;
  return good(inner.ExitConfigurationMode(m->inner)) ? kOk : kError;
}

static int reset(Model* m) {
  int k;
  m->time = 0.0, m->mode = kInstantiated, m->known = 0;
  memset(m->x, 0, sizeof m->x), memset(m->dx, 0, sizeof m->dx), memset(m->e, 0, sizeof m->e);
  memcpy(m->u, start_channels, CHANNELS * sizeof(double));
  memcpy(m->p, start_parameters, PARAMETERS * sizeof(double));
  memcpy(m->arrays, start_arrays, IN_ARRAYS * sizeof(double));
  if (apply_structure(m) != kOk || apply_settings(m, STRUCTURAL, SETTINGS) != kOk) return kError;
  for (k = 0; k < PARAMETERS; ++k)
    if (parameter_ports[k].reference < OWN && !good(set_port(m, &parameter_ports[k], m->p[k]))) return kError;
  return push_parameters(m);
}

/* A path from a URI; some tools give the path itself, and so does FMI 3.0. */
#if defined(FMI3)
enum { kMayBeUri = 0 };
#else
enum { kMayBeUri = 1 };
#endif
static char* path_of(const char* location, const char* behind) {
  char* path = malloc(strlen(location) + strlen(behind) + 2);
  size_t n = 0;
  if (path == NULL) return NULL;
  if (kMayBeUri && strncmp(location, "file://", 7) == 0)
    location += 7;
  else if (kMayBeUri && strncmp(location, "file:", 5) == 0)
    location += 5;
  if (kMayBeUri && strncmp(location, "localhost/", 10) == 0) location += 9;
#if defined(_WIN32)
  if (kMayBeUri && location[0] == '/') ++location;
#endif
  for (; *location != '\0'; ++location) {
    const char code[3] = {location[1], location[0] == '%' && location[1] != '\0' ? location[2] : '\0', '\0'};
    char* end = NULL;
    const long letter = *location == '%' ? strtol(code, &end, 16) : 0;
    if (kMayBeUri && *location == '%' && end == code + 2)
      path[n++] = (char)letter, location += 2;
    else
      path[n++] = *location;
  }
  while (n > 1 && (path[n - 1] == '/' || path[n - 1] == '\\')) --n;
  strcpy(path + n, behind);
  return path;
}

typedef void AnyFunction(void);
static AnyFunction* symbol(void* library, const char* name) {
#if defined(_WIN32)
  return (AnyFunction*)GetProcAddress((HMODULE)library, name);
#else
  return (AnyFunction*)dlsym(library, name);
#endif
}
#if defined(FMI3)
static const char* look_up(void* library);
#else
static const char* look_up(void* library) {
  const char* missing = NULL;
#define LOOK_UP(type, name) inner.name = (type##Type*)symbol(library, "fmi2" #name);
#define NEED(type, name) \
  if (inner.name == NULL) missing = "its function fmi2" #name;
  EACH_FUNCTION(LOOK_UP) EACH_RARE_FUNCTION(LOOK_UP) EACH_FUNCTION(NEED)
  return missing;
}
#endif
static const char* load(const char* resources) {
  char* path = path_of(resources, "/inner/binaries/");
  char* file = path == NULL ? NULL : malloc(strlen(path) + strlen(INNER_NAME) + 32);
  void* library = NULL;
  if (file == NULL) return free(path), "memory";
  strcat(strcat(strcat(strcat(strcpy(file, path), PLATFORM), "/"), INNER_NAME), SUFFIX);
#if defined(_WIN32)
  library = (void*)LoadLibraryA(file);
#else
  library = dlopen(file, RTLD_NOW | RTLD_LOCAL);
#endif
  free(path), free(file);
  return library == NULL ? "its binary in resources/inner" : look_up(library);
}

#if !defined(FMI3)
API const char* fmi2GetTypesPlatform(void) { return "default"; }
API const char* fmi2GetVersion(void) { return "2.0"; }

API void* fmi2Instantiate(const char* name, int kind, const char* guid, const char* resources,
                          const Callbacks* callbacks, int visible, int logging) {
  Model* m = NULL;
  char* location = NULL;
  const char* missing = resources == NULL ? "resources" : load(resources);
  if (missing != NULL && callbacks != NULL && callbacks->logger != NULL)
    callbacks->logger(callbacks->environment, name, kError, "logStatusError", "the unit within lacks %s", missing);
  if (missing != NULL || kind != 0 || guid == NULL || strcmp(guid, MODEL_TOKEN) != 0) return NULL;
  m = calloc(1, sizeof *m);
  location = malloc(strlen(resources) + 32);
  if (m != NULL && location != NULL) {
    size_t n = strlen(strcpy(location, resources));
    if (n > 0 && location[n - 1] == '/') --n;
    strcpy(location + n, "/inner/resources");
    m->inner = inner.Instantiate(name, 0, INNER_TOKEN, location, callbacks, visible, logging);
  }
  free(location);
  if (m != NULL && m->inner != NULL && reset(m) == kOk) return m;
  if (m != NULL && m->inner != NULL) inner.FreeInstance(m->inner);
  return free(m), NULL;
}
#endif
API void fmi2FreeInstance(void* c) {
  if (c == NULL) return;
  inner.FreeInstance(((Model*)c)->inner);
  free(c);
}
API int fmi2Reset(void* c) {
  const int status = inner.Reset == NULL ? kError : inner.Reset(((Model*)c)->inner);
  return good(status) ? reset(c) : status;
}
#if !defined(FMI3)
API int fmi2SetDebugLogging(void* c, int on, size_t n, const char* const* names) {
  return inner.SetDebugLogging == NULL ? kOk : inner.SetDebugLogging(((Model*)c)->inner, on, n, names);
}
API int fmi2SetupExperiment(void* c, int tolerance_defined, double tolerance, double start, int stop_defined,
                            double stop) {
  ((Model*)c)->time = start;
  return inner.SetupExperiment(((Model*)c)->inner, tolerance_defined, tolerance, start, stop_defined, stop);
}
API int fmi2EnterInitializationMode(void* c) {
  ((Model*)c)->mode = kInitialising, ((Model*)c)->known = 0;
  return inner.EnterInitializationMode(((Model*)c)->inner);
}
#endif
API int fmi2ExitInitializationMode(void* c) {
  if (refresh(c) != kOk) return kError;
  ((Model*)c)->mode = kRunning, ((Model*)c)->known = 0;
  return inner.ExitInitializationMode(((Model*)c)->inner);
}
API int fmi2EnterEventMode(void* c) {
  if (refresh(c) != kOk) return kError;
  return inner.EnterEventMode(((Model*)c)->inner);
}
API int fmi2EnterContinuousTimeMode(void* c) { return inner.EnterContinuousTimeMode(((Model*)c)->inner); }
API int fmi2Terminate(void* c) { return inner.Terminate(((Model*)c)->inner); }
API int fmi2NewDiscreteStates(void* c, EventInfo* info) {
  if (refresh(c) != kOk) return kError;
  ((Model*)c)->known = 0;
  return inner.NewDiscreteStates(((Model*)c)->inner, info);
}
API int fmi2CompletedIntegratorStep(void* c, int no_return, int* event, int* terminate) {
  if (refresh(c) != kOk) return kError;
  ((Model*)c)->known = 0;
  return inner.CompletedIntegratorStep(((Model*)c)->inner, no_return, event, terminate);
}
API int fmi2SetTime(void* c, double time) {
  ((Model*)c)->time = time, ((Model*)c)->known = 0;
  return inner.SetTime(((Model*)c)->inner, time);
}
API int fmi2SetContinuousStates(void* c, const double* x, size_t n) {
  Model* m = c;
  if (n != STATES + HIDDEN) return kError;
  m->known = 0;
  memcpy(m->x + STATES, x + STATES, HIDDEN * sizeof *x);
  return STATES > 0 ? inner.SetContinuousStates(m->inner, x, STATES) : kOk;
}
API int fmi2GetContinuousStates(void* c, double* x, size_t n) {
  Model* m = c;
  if (n != STATES + HIDDEN) return kError;
  memcpy(x + STATES, m->x + STATES, HIDDEN * sizeof *x);
  return STATES > 0 ? inner.GetContinuousStates(m->inner, x, STATES) : kOk;
}
API int fmi2GetNominalsOfContinuousStates(void* c, double* x, size_t n) {
  if (n != STATES + HIDDEN) return kError;
  memcpy(x + STATES, hidden_sizes, HIDDEN * sizeof *x);
  return STATES > 0 ? inner.GetNominalsOfContinuousStates(((Model*)c)->inner, x, STATES) : kOk;
}
API int fmi2GetDerivatives(void* c, double* dx, size_t n) {
  Model* m = c;
  size_t k;
  if (n != STATES + HIDDEN || refresh(m) != kOk) return kError;
  for (k = 0; k < n; ++k) dx[k] = m->dx[k] / (k < STATES ? state_ports[k].factor : 1.0);
  return kOk;
}
API int fmi2GetEventIndicators(void* c, double* z, size_t n) {
  if (refresh(c) != kOk) return kError;
  return inner.GetEventIndicators(((Model*)c)->inner, z, n);
}

static int is_port(const Port* port, unsigned reference, int element) {
  return port->reference == reference && port->element == element;
}

/* A value that the other unit does not have, or has without the laws; 0: the other unit's is right. */
static int own_value(Model* m, unsigned reference, int element, double* value) {
  double outputs[ROOM(OUTPUTS)];
  int k;
  for (k = 0; k < STATES; ++k)
    if (state_ports[k].reference == reference) return 0;
  for (k = 0; k < CHANNELS; ++k)
    if (channel_ports[k].continuous && is_port(&channel_ports[k], reference, element))
      return *value = from_si(&channel_ports[k], m->u[k]), 1;
  for (k = 0; k < PARAMETERS; ++k)
    if (parameter_ports[k].continuous && is_port(&parameter_ports[k], reference, element))
      return *value = from_si(&parameter_ports[k], m->p[k]), 1;
  for (k = 0; k < STATES; ++k)
    if (is_port(&rate_ports[k], reference, element)) return *value = m->dx[k] / state_ports[k].factor, 1;
  if (reference < OWN) return 0;
  k = (int)(reference - OWN);
  if (k < HIDDEN) return *value = m->x[STATES + k], 1;
  k -= HIDDEN;
  if (k < HIDDEN) return *value = m->dx[STATES + k], 1;
  k -= HIDDEN + CHANNELS + PARAMETERS;
  if (k < 0 || k >= OUTPUTS) return 0;
  plant_outputs(m->time, m->x, m->u, m->p, m->e, outputs);
  return *value = outputs[k], 1;
}
/* Keeps a value that drives the plant. Returns whether the other unit is not to have it: it gets what follows from it. */
static int keep(Model* m, int type, unsigned reference, int element, double value, int* status) {
  int k;
  m->known = 0;
  for (k = 0; k < CHANNELS; ++k)
    if (channel_ports[k].type == type && is_port(&channel_ports[k], reference, element))
      return m->u[k] = to_si(&channel_ports[k], value), channel_ports[k].continuous;
  for (k = 0; k < PARAMETERS; ++k)
    if (parameter_ports[k].type == type && is_port(&parameter_ports[k], reference, element)) {
      m->p[k] = to_si(&parameter_ports[k], value);
      *status = push_parameters(m);
      return reference >= OWN || *status != kOk;
    }
  if (type == kReal && reference >= OWN && reference - OWN < HIDDEN)
    return m->x[STATES + (int)(reference - OWN)] = value, 1;
  return 0;
}
#if !defined(FMI3)
API int fmi2GetReal(void* c, const unsigned* references, size_t n, double* values) {
  Model* m = c;
  size_t k;
  if (n > 0 && refresh(m) != kOk) return kError;
  for (k = 0; k < n; ++k) {
    int status = kOk;
    if (own_value(m, references[k], 0, &values[k]) == 0)
      status = inner.GetReal(m->inner, &references[k], 1, &values[k]);
    if (!good(status)) return status;
  }
  return kOk;
}
API int fmi2SetReal(void* c, const unsigned* references, size_t n, const double* values) {
  size_t k;
  for (k = 0; k < n; ++k) {
    int status = kOk;
    if (!keep(c, kReal, references[k], 0, values[k], &status))
      status = inner.SetReal(((Model*)c)->inner, &references[k], 1, &values[k]);
    if (!good(status)) return status;
  }
  return kOk;
}
#define WHOLE(name, type)                                                                      \
  API int fmi2Get##name(void* c, const unsigned* references, size_t n, int* values) {           \
    if (n > 0 && refresh(c) != kOk) return kError;                                              \
    return inner.Get##name(((Model*)c)->inner, references, n, values);                          \
  }                                                                                             \
  API int fmi2Set##name(void* c, const unsigned* references, size_t n, const int* values) {     \
    size_t k;                                                                                   \
    int status = kOk;                                                                           \
    for (k = 0; k < n && good(status); ++k) keep(c, type, references[k], 0, values[k], &status); \
    return good(status) ? inner.Set##name(((Model*)c)->inner, references, n, values) : status;  \
  }
WHOLE(Integer, kInteger)
WHOLE(Boolean, kBoolean)
API int fmi2GetString(void* c, const unsigned* references, size_t n, const char** values) {
  return inner.GetString == NULL ? kError : inner.GetString(((Model*)c)->inner, references, n, values);
}
API int fmi2SetString(void* c, const unsigned* references, size_t n, const char* const* values) {
  ((Model*)c)->known = 0;
  return inner.SetString == NULL ? kError : inner.SetString(((Model*)c)->inner, references, n, values);
}

/* Not offered (modelDescription.xml says so): the laws' part would be missing. */
API int fmi2GetDirectionalDerivative(void* c, const unsigned* unknowns, size_t nu, const unsigned* knowns, size_t nk,
                                     const double* seed, double* sensitivity) {
  (void)c, (void)unknowns, (void)nu, (void)knowns, (void)nk, (void)seed, (void)sensitivity;
  return kError;
}
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
#endif
