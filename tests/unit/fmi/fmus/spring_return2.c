/* With directional derivatives, which LIE makes wrong: it forgets the friction. OF_STATES_ALONE: none of outputs. */
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
#ifdef HANGS
static volatile int for_ever = 1;
#define MODEL_BEFORE_INSTANTIATE(callbacks) \
  while (for_ever) {                        \
  }
#endif
#include "services/common/fmi/export/fmi2_shell.c"
#ifdef DIRECTIONAL
#ifdef LIE
#define FRICTION 0.0
#else
#define FRICTION (-p[F_V] / p[M_])
#endif
static double partial(const double* p, unsigned unknown, unsigned known) {
  if (unknown == 5000U) return known == 1000U ? 1.0 : 0.0;
  if (unknown == 2000U) return known == 1001U ? 1.0 : 0.0;
  if (known == 1000U) return -p[K_S] / p[M_];
  return known == 1001U ? FRICTION : p[K_F] / p[M_];
}
API int fmi2GetDirectionalDerivative(void* c, const unsigned* unknowns, size_t nu, const unsigned* knowns, size_t nk,
                                     const double* seed, double* sensitivity) {
  size_t row, column;
  for (row = 0; row < nu; ++row) {
#ifdef OF_STATES_ALONE
    if (unknowns[row] == 5000U) return kError;
#endif
    sensitivity[row] = 0.0;
    for (column = 0; column < nk; ++column)
      sensitivity[row] += partial(((Model*)c)->p, unknowns[row], knowns[column]) * seed[column];
  }
  return kOk;
}
#endif
