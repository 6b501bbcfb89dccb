/* A rod of twelve cells that is heated at one end: each cell feels its neighbours alone, but where it is built to feel
 * one more: HIDES: always; HIDES_BEYOND: where that one is hot. The output `calls` counts what is asked of the model. */
#define MODEL_TOKEN "{sealwatch-test-rod}"
#define STATES 12
#define INPUTS 1
#define PARAMETERS 2
#define OUTPUTS 2
enum { CAPACITY, CONDUCTANCE };
static const double start_states[STATES] = {0.0};
static const double nominal_states[STATES] = {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1};
static const double start_inputs[] = {0.0};
static const double start_parameters[] = {1.0, 50.0};
static double calls;
static void model_derivatives(double t, const double* x, const double* u, const double* p, double* dx) {
  int k;
  (void)t;
  ++calls;
  for (k = 0; k < STATES; ++k) {
    double heat = k == 0 ? u[0] : 0.0;
    if (k > 0) heat += p[CONDUCTANCE] * (x[k - 1] - x[k]);
    if (k + 1 < STATES) heat += p[CONDUCTANCE] * (x[k + 1] - x[k]);
#if defined(HIDES)
    if (k == 2) heat += 5.0 * x[9];
#elif defined(HIDES_BEYOND)
    if (k == 2 && x[9] > 0.5) heat -= 60.0 * (x[9] - 0.5);
#endif
    dx[k] = heat / p[CAPACITY];
  }
}
static void model_outputs(double t, const double* x, const double* u, const double* p, double* y) {
  (void)t, (void)u, (void)p;
  y[0] = x[0];
  y[1] = calls;
}
#ifdef PARTIALS
#define MODEL_PARTIALS
#include <stddef.h>
static int model_directional(double t, const double* x, const double* u, const double* p, const unsigned* unknowns,
                             size_t nu, const unsigned* knowns, size_t nk, const double* seed, double* sensitivity) {
  double along[STATES] = {0.0}, in[INPUTS] = {0.0}, rate[STATES];
  size_t k;
  (void)x, (void)u;
  for (k = 0; k < nk; ++k) {
    if (knowns[k] >= 3000U)
      in[knowns[k] - 3000U] = seed[k];
    else
      along[knowns[k] - 1000U] = seed[k];
  }
  model_derivatives(t, along, in, p, rate);
  for (k = 0; k < nu; ++k)
    sensitivity[k] = unknowns[k] == 5000U ? along[0] : unknowns[k] == 5001U ? 0.0 : rate[unknowns[k] - 2000U];
  return 1;
}
#endif
#include "services/common/fmi/export/fmi2_shell.c"
