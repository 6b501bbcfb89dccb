/* The functions of FMI 3.0 that no exported unit offers (its modelDescription.xml says so), there as importers look for
 * every function. This text stands behind fmi3_shell.c or fmi3_wrapper.c, which define EXPORT, Ref, Log and kError. */
EXPORT const char* fmi3GetVersion(void) { return "3.0"; }
EXPORT void* fmi3InstantiateCoSimulation(const char* name, const char* token, const char* resources, bool visible,
                                         bool logging, bool event_mode, bool early_return, const Ref* intermediate,
                                         size_t n, void* environment, Log log, void* update) {
  (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)event_mode, (void)early_return;
  (void)intermediate, (void)n, (void)environment, (void)log, (void)update;
  return NULL;
}
EXPORT void* fmi3InstantiateScheduledExecution(const char* name, const char* token, const char* resources, bool visible,
                                               bool logging, void* environment, Log log, void* update, void* lock,
                                               void* unlock) {
  (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)environment, (void)log;
  (void)update, (void)lock, (void)unlock;
  return NULL;
}

#define FAILS(name, ...) \
  EXPORT int fmi3##name(void* c, __VA_ARGS__) { return (void)c, kError; }
#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif
#if !defined(FMI3) /* a unit within may have what a model in plain C does not */
FAILS(GetBinary, const Ref* references, size_t n, size_t* sizes, const uint8_t** values, size_t size)
FAILS(SetBinary, const Ref* references, size_t n, const size_t* sizes, const uint8_t* const* values, size_t size)
FAILS(GetClock, const Ref* references, size_t n, bool* values)
FAILS(SetClock, const Ref* references, size_t n, const bool* values)
FAILS(GetIntervalDecimal, const Ref* references, size_t n, double* intervals, int* qualifiers)
FAILS(GetIntervalFraction, const Ref* references, size_t n, uint64_t* counters, uint64_t* resolutions, int* qualifiers)
FAILS(GetShiftDecimal, const Ref* references, size_t n, double* shifts)
FAILS(GetShiftFraction, const Ref* references, size_t n, uint64_t* counters, uint64_t* resolutions)
FAILS(SetIntervalDecimal, const Ref* references, size_t n, const double* intervals)
FAILS(SetIntervalFraction, const Ref* references, size_t n, const uint64_t* counters, const uint64_t* resolutions)
FAILS(SetShiftDecimal, const Ref* references, size_t n, const double* shifts)
FAILS(SetShiftFraction, const Ref* references, size_t n, const uint64_t* counters, const uint64_t* resolutions)
#endif
FAILS(ActivateModelPartition, Ref clock, double activation)
FAILS(GetNumberOfVariableDependencies, Ref reference, size_t* n)
FAILS(GetVariableDependencies, Ref dependent, size_t* elements, Ref* independents, size_t* their_elements, int* kinds,
      size_t n)
FAILS(GetFMUState, void** state)
FAILS(SetFMUState, void* state)
FAILS(FreeFMUState, void** state)
FAILS(SerializedFMUStateSize, void* state, size_t* size)
FAILS(SerializeFMUState, void* state, uint8_t* bytes, size_t size)
FAILS(DeserializeFMUState, const uint8_t* bytes, size_t size, void** state)
#if !defined(MODEL_PARTIALS)
FAILS(GetDirectionalDerivative, const Ref* unknowns, size_t nu, const Ref* knowns, size_t nk, const double* seed,
      size_t n_seed, double* sensitivity, size_t n_sensitivity)
#endif
FAILS(GetAdjointDerivative, const Ref* unknowns, size_t nu, const Ref* knowns, size_t nk, const double* seed,
      size_t n_seed, double* sensitivity, size_t n_sensitivity)
FAILS(GetOutputDerivatives, const Ref* references, size_t n, const int32_t* orders, double* values, size_t size)
FAILS(DoStep, double time, double step, bool no_set_before, bool* event_needed, bool* terminate, bool* early,
      double* last_time)
EXPORT int fmi3EnterStepMode(void* c) { return (void)c, kError; }
