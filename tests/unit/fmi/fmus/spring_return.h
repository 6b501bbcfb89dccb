/* A valve positioner with a return spring: M dv/dt = k_F u - F_v v - k_s x, dx/dt = v. NOWHERE: x begins as no number. UNSET: so does F_v. SATURATES: the sensor of x at 0.5.
 * FEELS: it gives its acceleration in g, the force of its drive, that of spring and friction, its velocity, and the
 * net force too. */
#define MODEL_TOKEN "{sealwatch-test-spring-return}"
#define STATES 2
#define INPUTS 1
#define PARAMETERS 4
#ifdef FEELS
#define OUTPUTS 6
#else
#define OUTPUTS 1
#endif
enum { M_, F_V, K_S, K_F };
#ifdef NOWHERE
static const double start_states[] = {0.0 / 0.0, 0.0};
#else
static const double start_states[] = {0.0, 0.0};
#endif
static const double nominal_states[] = {1.0, 1.0};
static const double start_inputs[] = {0.0};
#ifdef UNSET
static const double start_parameters[] = {20.0, 0.0 / 0.0, 1e4, 100.0};
#else
static const double start_parameters[] = {20.0, 2e3, 1e4, 100.0};
#endif

#ifndef DERIVATIVES_BEGIN
#define DERIVATIVES_BEGIN
#endif
static void model_derivatives(double t, const double* x, const double* u, const double* p, double* dx) {
  (void)t;
  DERIVATIVES_BEGIN
  dx[0] = x[1];
#ifdef ONE_SIDED
  dx[1] = (p[K_F] * (u[0] > 0.0 ? u[0] : 0.0) - p[F_V] * x[1] - p[K_S] * x[0]) / p[M_];
#else
  dx[1] = (p[K_F] * u[0] - p[F_V] * x[1] - p[K_S] * x[0]) / p[M_];
#endif
}
static void model_outputs(double t, const double* x, const double* u, const double* p, double* y) {
  (void)t, (void)u, (void)p;
#ifdef SATURATES
  y[0] = x[0] < 0.5 ? x[0] : 0.5;
#else
  y[0] = x[0];
#endif
#ifdef FEELS
  y[1] = (p[K_F] * u[0] - p[F_V] * x[1] - p[K_S] * x[0]) / p[M_] / 9.81;
  y[2] = p[K_F] * u[0];
  y[3] = p[F_V] * x[1] + p[K_S] * x[0];
  y[4] = x[1];
  y[5] = p[K_F] * u[0] - p[F_V] * x[1] - p[K_S] * x[0];
#endif
}
