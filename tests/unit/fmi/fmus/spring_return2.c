/* With directional derivatives, which LIE makes wrong: it forgets the friction. LIE_BY_INPUT, LIE_OF_OUTPUT, LIE_OF_OUTPUT_BY_INPUT: wrong there. LIE_BEYOND: by this variable wrong where x is above 0.012. OF_STATES_ALONE: none of outputs.
 * ONE_SIDED: its drive gives nothing backwards, which its derivatives say.
 * STEADY: its initial equation is that it rests, wherever its input holds it.
 * STUBBORN: hangs at other
 * parameters. SLOW_TO_REFUSE: refuses them, after 0.2 s. FORKS: starts a process that stays. MUTTERS: prints why it gives no instance. BREAKS: it fails over them, and the instance gives nothing after that. ONCE: one instance in a process's life. TALKS: prints, logs and warns at
 * each call. */
#include <stddef.h>
#include "spring_return.h"
#ifdef DIRECTIONAL
#define MODEL_DIRECTIONAL
#endif
#ifdef NO_LICENCE
#define MODEL_BEFORE_INSTANTIATE(callbacks)                                                            \
  callbacks->logger(callbacks->environment, "test", 3, "licence", "no %s for %d days", "licence", 30); \
  return NULL;
#endif
#ifdef ONCE
static int instances;
#define MODEL_BEFORE_INSTANTIATE(callbacks)                                                      \
  if (instances++ > 0) {                                                                         \
    callbacks->logger(callbacks->environment, "test", 3, "instances", "only once in a process"); \
    return NULL;                                                                                 \
  }
#endif
#ifdef FORKS
#include <unistd.h>
#define MODEL_BEFORE_INSTANTIATE(callbacks) \
  if (fork() == 0) {                        \
    setsid();                               \
    sleep(300);                             \
    _exit(0);                               \
  }
#endif
#ifdef MUTTERS
#include <stdio.h>
#define MODEL_BEFORE_INSTANTIATE(callbacks) \
  printf("no key");                         \
  return NULL;
#endif
#ifdef HANGS
static volatile int for_ever = 1;
#define MODEL_BEFORE_INSTANTIATE(callbacks) \
  while (for_ever) {                        \
  }
#endif
#ifdef BREAKS
#define fmi2GetDerivatives sound_derivatives
#endif
#ifdef TALKS
#include <stdio.h>
static const void* heard_by;
#define MODEL_BEFORE_INSTANTIATE(callbacks) heard_by = callbacks;
#define fmi2GetDerivatives sound_derivatives
#endif
#if defined(STEADY) || defined(STUBBORN) || defined(SLOW_TO_REFUSE)
#define fmi2ExitInitializationMode plain_exit
#endif
#include "services/common/fmi/export/fmi2_shell.c"
#undef fmi2ExitInitializationMode
API int fmi2ExitInitializationMode(void* c);
#if defined(STUBBORN) || defined(SLOW_TO_REFUSE)
#include <unistd.h>
API int fmi2ExitInitializationMode(void* c) {
  Model* m = c;
  if (memcmp(m->p, start_parameters, sizeof start_parameters) == 0) return plain_exit(c);
#ifdef STUBBORN
  for (;;) sleep(100);
#endif
  usleep(200000);
  return kError;
}
#endif
#ifdef TALKS
#undef fmi2GetDerivatives
API int fmi2GetDerivatives(void* c, double* x, size_t n) {
  const Callbacks* to = heard_by;
  printf("LOG_NLS | info | nonlinear system 12 at time %g\n", ((Model*)c)->time);
  to->logger(to->environment, "unit", 1, "logStatusWarning", "residual %g in %s", 1e-9, "nonlinear system 12");
  return sound_derivatives(c, x, n) == kOk ? 1 : kError;
}
#endif
#ifdef STEADY
API int fmi2ExitInitializationMode(void* c) {
  Model* m = c;
  return m->x[0] = m->p[K_F] * m->u[0] / m->p[K_S], m->x[1] = 0.0, plain_exit(c);
}
#endif
#ifdef BREAKS
#undef fmi2GetDerivatives
API int fmi2GetDerivatives(void* c, double* x, size_t n);
static void* broken;
API int fmi2GetDerivatives(void* c, double* x, size_t n) { return c == broken ? kError : sound_derivatives(c, x, n); }
#endif
#ifdef DIRECTIONAL
#ifdef LIE
#define FRICTION 0.0
#else
#define FRICTION (-p[F_V] / p[M_])
#endif
static double partial(const double* p, unsigned unknown, unsigned known) {
#ifdef LIE_BY_INPUT
  if (unknown != 5000U && unknown != 2000U && known != 1000U && known != 1001U) return 2.0 * p[K_F] / p[M_];
#endif
#ifdef LIE_OF_OUTPUT
  if (unknown == 5000U && known == 1000U) return 2.0;
#endif
#ifdef LIE_OF_OUTPUT_BY_INPUT
  if (unknown == 5000U && known != 1000U && known != 1001U) return 0.5;
#endif
  if (unknown == 5000U) return known == 1000U ? 1.0 : 0.0;
  if (unknown == 2000U) return known == 1001U ? 1.0 : 0.0;
  if (known == 1000U) return -p[K_S] / p[M_];
  return known == 1001U ? FRICTION : p[K_F] / p[M_];
}
API int fmi2GetDirectionalDerivative(void* c, const unsigned* unknowns, size_t nu, const unsigned* knowns, size_t nk,
                                     const double* seed, double* sensitivity) {
  size_t row, column;
#ifdef BREAKS
  return broken = c, kError;
#endif
  for (row = 0; row < nu; ++row) {
#ifdef OF_STATES_ALONE
    if (unknowns[row] == 5000U) return kError;
#endif
    sensitivity[row] = 0.0;
    for (column = 0; column < nk; ++column) {
#ifdef LIE_BEYOND
      if (unknowns[row] == 2001U && knowns[column] == LIE_BEYOND && ((Model*)c)->x[0] > 0.012) continue;
#endif
#ifdef ONE_SIDED
      if (unknowns[row] != 5000U && unknowns[row] != 2000U && knowns[column] != 1000U && knowns[column] != 1001U &&
          ((Model*)c)->u[0] <= 0.0)
        continue;
#endif
      sensitivity[row] += partial(((Model*)c)->p, unknowns[row], knowns[column]) * seed[column];
    }
  }
  return kOk;
}
#endif
