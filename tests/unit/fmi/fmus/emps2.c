/* An electro-mechanical positioning drive without dry friction: M dv/dt = k_F u - F_v v, dx/dt = v. */
#define MODEL_TOKEN "{sealwatch-test-emps}"
#define STATES 2
#define INPUTS 1
#define PARAMETERS 3
#define OUTPUTS 1
enum { M_, F_V, K_F };
static const double start_states[] = {0.0, 0.0};
static const double nominal_states[] = {1.0, 1.0};
static const double start_inputs[] = {0.0};
static const double start_parameters[] = {95.1, 203.5, 35.15};
static void model_derivatives(double t, const double* x, const double* u, const double* p, double* dx) {
  (void)t;
  dx[0] = x[1];
  dx[1] = (p[K_F] * u[0] - p[F_V] * x[1]) / p[M_];
}
static void model_outputs(double t, const double* x, const double* u, const double* p, double* y) {
  (void)t, (void)u, (void)p;
  y[0] = x[0];
}
#include "services/common/fmi/export/fmi2_shell.c"
