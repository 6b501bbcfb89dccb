/* A bath that its heater warms; whenever it is at T_hi, a dose of cold water lowers its temperature by `drop` at once. */
#include <math.h>
#define MODEL_TOKEN "{sealwatch-test-dosing}"
#define STATES 1
#define INPUTS 1
#define PARAMETERS 4
#define OUTPUTS 1
#define INDICATORS 1
#define DISCRETES 1
enum { TAU, DROP, GAIN, T_HI };
static const double start_states[] = {320.0};
static const double nominal_states[] = {1.0};
static const double start_inputs[] = {0.0};
static const double start_parameters[] = {200.0, 8.0, 0.05, 330.0};
static void model_derivatives(double t, const double* x, const double* u, const double* p, double* dx) {
  (void)t;
  dx[0] = (293.15 - x[0]) / p[TAU] + p[GAIN] * u[0];
}
static void model_outputs(double t, const double* x, const double* u, const double* p, double* y) {
  (void)t, (void)u, (void)p;
  y[0] = x[0];
}
static void model_indicators(double t, const double* x, const double* u, const double* p, const double* d, double* z) {
  (void)t, (void)u, (void)d;
  z[0] = p[T_HI] - x[0];
}
static int model_event(double t, double* x, const double* u, const double* p, double* d, double* next_time) {
  (void)t, (void)u, (void)d;
  *next_time = INFINITY;
  if (x[0] < p[T_HI]) return 0;
  x[0] -= p[DROP];
  return 1;
}
#include "services/common/fmi/export/fmi2_shell.c"
