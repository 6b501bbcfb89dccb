/* A mass with dry friction that switches where it turns, without a hysteresis: where it sticks, events chatter. */
#include <math.h>
#define MODEL_TOKEN "{sealwatch-test-bouncing}"
#define STATES 2
#define INPUTS 0
#define PARAMETERS 3
#define OUTPUTS 1
#define INDICATORS 1
#define DISCRETES 1
static const double start_states[] = {0.02, 0.0};
static const double nominal_states[] = {1.0, 1.0};
static const double start_inputs[] = {0.0};
static const double start_parameters[] = {9.81, 0.7, 50.0};
static void model_derivatives(double t, const double* x, const double* u, const double* p, double* dx) {
  (void)t, (void)u;
  dx[0] = x[1];
  dx[1] = -(p[2] * (x[1] > 0.0 ? 1.0 : -1.0) + 1e3 * p[1] * x[0]) / p[0];
}
static void model_outputs(double t, const double* x, const double* u, const double* p, double* y) {
  (void)t, (void)u, (void)p;
  y[0] = x[0];
}
static void model_indicators(double t, const double* x, const double* u, const double* p, const double* d, double* z) {
  (void)t, (void)u, (void)p, (void)d;
  z[0] = x[1];
}
static int model_event(double t, double* x, const double* u, const double* p, double* d, double* next_time) {
  (void)t, (void)x, (void)u, (void)p, (void)d;
  *next_time = INFINITY;
  return 0;
}
#include "services/common/fmi/export/fmi2_shell.c"
