/* A ball that falls from 1 m and is thrown up again by a hand every 0.7 s: a state event (it touches the ground and
 * bounces with the factor e) and a time event (its velocity becomes w). */
#ifndef FIRST_THROW
#define FIRST_THROW 0.7
#endif
#define MODEL_TOKEN "{sealwatch-test-bouncing}"
#define STATES 2
#define INPUTS 0
#define PARAMETERS 3
#define OUTPUTS 1
#define INDICATORS 1
#define DISCRETES 1
enum { GRAVITY, E_, W_ };
static const double start_states[] = {1.0, 0.0};
static const double nominal_states[] = {1.0, 1.0};
static const double start_inputs[] = {0.0};
static const double start_parameters[] = {9.81, 0.7, 3.0};
static void model_derivatives(double t, const double* x, const double* u, const double* p, double* dx) {
  (void)t, (void)u;
  dx[0] = x[1];
  dx[1] = -p[GRAVITY];
}
static void model_outputs(double t, const double* x, const double* u, const double* p, double* y) {
  (void)t, (void)u, (void)p;
  y[0] = x[0];
}
static void model_indicators(double t, const double* x, const double* u, const double* p, const double* d, double* z) {
  (void)t, (void)u, (void)p, (void)d;
  z[0] = x[0] < 0.0 || (x[0] == 0.0 && x[1] < 0.0) ? -1.0 : x[0] + 1e-300;
}
static int model_event(double t, double* x, const double* u, const double* p, double* d, double* next_time) {
  int changed = 0;
  (void)u;
  if (x[0] <= 0.0 && x[1] < 0.0) {
    x[0] = 0.0;
    x[1] = -p[E_] * x[1];
    changed = 1;
  }
  if (t >= FIRST_THROW + 0.7 * d[0] - 1e-12) {
    d[0] += 1.0;
    x[1] = p[W_];
    changed = 1;
  }
  *next_time = FIRST_THROW + 0.7 * d[0];
  return changed;
}
