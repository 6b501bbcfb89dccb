/* A state that follows the cube of an input of some 1e-9, and an output that shows the input at once. */
#define MODEL_TOKEN "{sealwatch-test-small-input}"
#define STATES 1
#define INPUTS 1
#define PARAMETERS 0
#define OUTPUTS 1
static const double start_states[] = {0.0};
static const double nominal_states[] = {1.0};
static const double start_inputs[] = {0.0};
static const double start_parameters[] = {0.0};
static double share_of(double input) { return input / 1e-9; }
static void model_derivatives(double t, const double* x, const double* u, const double* p, double* dx) {
  const double share = share_of(u[0]);
  (void)t, (void)p;
  dx[0] = share * share * share - x[0];
}
static void model_outputs(double t, const double* x, const double* u, const double* p, double* y) {
  (void)t, (void)p;
  y[0] = x[0] + share_of(u[0]);
}
#include "services/common/fmi/export/fmi2_shell.c"
