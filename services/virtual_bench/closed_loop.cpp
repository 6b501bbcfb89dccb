#include "services/virtual_bench/closed_loop.hpp"

#include <array>
#include <cmath>
#include <exception>
#include <utility>

#include "services/virtual_bench/rosenbrock.hpp"

namespace sealwatch::bench {
namespace {

constexpr std::size_t kIntegral = Eha::kStates;          // index of U
constexpr std::size_t kCommonStates = Eha::kStates + 1;  // behind them, the sensors' low-passes
constexpr std::size_t kNone = 0;                         // a sensor's index of a low-pass that it has not

/// Usual size of each state, z i omega p_1 p_2 p_A p_B v x U: the integrator sees state / size.
constexpr std::array<double, kCommonStates> kSize = {10.0, 5.0, 50.0, 1e6, 1e6, 1e6, 1e6, 1e-3, 1e-2, 10.0};

double size_of(Quantity quantity) {
  switch (quantity) {
    case Quantity::motor_voltage:
      return kSize[Eha::kZ];
    case Quantity::motor_current:
      return kSize[Eha::kI];
    case Quantity::shaft_speed:
      return kSize[Eha::kOmega];
    case Quantity::pressure_a:
    case Quantity::pressure_b:
    case Quantity::pressure_differential:
      return kSize[Eha::kPA];
    case Quantity::flow:
      return 1e-6;
    case Quantity::position:
      return kSize[Eha::kX];
    case Quantity::velocity:
      return kSize[Eha::kV];
    case Quantity::rod_force:
      return 1e4;
  }
  return 1.0;
}

double load_N(const EhaParameters<double>& p) { return p.phi * (1.0 + p.load_factor); }

double quantity_value(Quantity quantity, const Eha::State<double>& y, double voltage_V, const EhaParameters<double>& p,
                      const BenchPhysics::Added& added) {
  switch (quantity) {
    case Quantity::motor_voltage:
      return voltage_V;
    case Quantity::motor_current:
      return y[Eha::kI];
    case Quantity::shaft_speed:
      return y[Eha::kOmega];
    case Quantity::pressure_a:
      return y[Eha::kPA];
    case Quantity::pressure_b:
      return y[Eha::kPB];
    case Quantity::pressure_differential:
      return y[Eha::kPA] - y[Eha::kPB];
    case Quantity::flow:
      return Eha::valve_flow(y[Eha::kP1], y[Eha::kPA], y[Eha::kP2], p, added[Eha::kDrop1], added[Eha::kCrack1]);
    case Quantity::position:
      return y[Eha::kX];
    case Quantity::velocity:
      return y[Eha::kV];
    case Quantity::rod_force:
      return load_N(p);
  }
  return 0.0;
}

/// Right-hand side on one straight piece of the reference, and what the sensors show.
class Equations {
 public:
  explicit Equations(const ClosedLoop& loop, double ramp_speed_m_s) : loop_(loop), p_(loop.parameters) {
    controller_ = {.setting = loop.controller,
                   .feed_forward_V_s_m = p_.Omega_M * p_.A_C / p_.alpha_P,
                   .ramp_speed_m_s = ramp_speed_m_s};
    size_.assign(kSize.begin(), kSize.end());
    for (const Sensor& sensor : loop.sensors) {
      const bool filtered = sensor.setting.time_constant_s > 0.0;
      low_pass_.push_back(filtered ? size_.size() : kNone);
      if (filtered) size_.push_back(size_of(sensor.quantity));
    }
    for (const Sensor& sensor : loop.sensors) {
      const bool lags = sensor.error.lag_s > 0.0;
      lag_.push_back(lags ? size_.size() : kNone);
      if (lags) size_.push_back(size_of(sensor.quantity));
    }
    first_hidden_ = size_.size();
    size_.insert(size_.end(), loop.physics.hidden_scales().begin(), loop.physics.hidden_scales().end());
    hidden_.resize(loop.physics.hidden_scales().size());
  }

  void follow(double start_s, double reference_m, double speed_m_s) {
    start_s_ = start_s;
    reference_m_ = reference_m;
    speed_m_s_ = speed_m_s;
  }

  void rates(double time_s, const double* scaled, double* out) const {
    const Eha::State<double> y = actuator(scaled);
    const ControllerOutput control = command(scaled, y, time_s);
    const Eha::Input input{control.voltage_V, command_rate_V_s(scaled, y, control, time_s)};
    const BenchPhysics::Added added = physics(scaled, y, input, out + first_hidden_);
    const Eha::State<double> dy =
        loop_.physics.any() ? Eha::derivatives(y, input, p_, added) : Eha::derivatives(y, input, p_);
    for (std::size_t k = 0; k < kIntegral; ++k) out[k] = dy[k] / size_[k];
    out[kIntegral] = control.integral_rate_V_s / size_[kIntegral];
    for (std::size_t k = 0; k < hidden_.size(); ++k) out[first_hidden_ + k] /= size_[first_hidden_ + k];
    for (std::size_t k = 0; k < low_pass_.size(); ++k) {
      double value = quantity_value(loop_.sensors[k].quantity, y, control.voltage_V, p_, added);
      if (const std::size_t own = low_pass_[k]; own != kNone) {
        out[own] = (value / size_[own] - scaled[own]) / loop_.sensors[k].setting.time_constant_s;
        value = scaled[own] * size_[own];
      }
      if (const std::size_t own = lag_[k]; own != kNone)
        out[own] = (value / size_[own] - scaled[own]) / loop_.sensors[k].error.lag_s;
    }
  }

  /// The recording starts: laws whose state does not come to rest by itself begin anew.
  void start_recording(std::vector<double>& scaled) const {
    for (std::size_t k = 0; k < hidden_.size(); ++k)
      if (!loop_.physics.settled(k)) scaled[first_hidden_ + k] = 0.0;
  }

  /// At rest, held at `x_m`: the guess that settling starts from.
  [[nodiscard]] std::vector<double> guess(double x_m) const {
    const double drop = load_N(p_) / p_.A_C;
    const double omega = drop * (1.0 / p_.R_CL + 1.0 / p_.R_PL) / p_.alpha_P;
    const double current = ((p_.f_M + p_.d_P) * omega + p_.alpha_P * drop) / p_.T_M;
    const double voltage = p_.R_M * current + p_.Omega_M * omega;
    const double low = p_.p_0;
    const double p_A = low + std::max(drop, 0.0);
    const double p_B = low + std::max(-drop, 0.0);
    const Eha::State<double> y = {voltage, current, omega, p_A, p_B, p_A, p_B, 0.0, x_m};
    std::vector<double> scaled(size_.size());
    for (std::size_t k = 0; k < kIntegral; ++k) scaled[k] = y[k] / size_[k];
    scaled[kIntegral] = voltage / size_[kIntegral];
    for (std::size_t k = 0; k < low_pass_.size(); ++k)
      for (const std::size_t own : {low_pass_[k], lag_[k]})
        if (own != kNone) scaled[own] = quantity_value(loop_.sensors[k].quantity, y, voltage, p_, {}) / size_[own];
    return scaled;
  }

  void read_sensors(double time_s, const std::vector<double>& scaled, std::size_t sample,
                    std::vector<std::vector<double>>& out) const {
    const Eha::State<double> y = actuator(scaled.data());
    const double voltage = command(scaled.data(), y, time_s).voltage_V;
    const BenchPhysics::Added added = physics(scaled.data(), y, Eha::Input{voltage}, nullptr);
    for (std::size_t k = 0; k < low_pass_.size(); ++k) {
      const std::size_t own = lag_[k] != kNone ? lag_[k] : low_pass_[k];
      out[k][sample] =
          own != kNone ? scaled[own] * size_[own] : quantity_value(loop_.sensors[k].quantity, y, voltage, p_, added);
    }
  }

 private:
  [[nodiscard]] Eha::State<double> actuator(const double* scaled) const {
    Eha::State<double> y;
    for (std::size_t k = 0; k < kIntegral; ++k) y[k] = scaled[k] * size_[k];
    return y;
  }
  [[nodiscard]] ControllerOutput command(const double* scaled, const Eha::State<double>& y, double time_s) const {
    const double reference = reference_m_ + speed_m_s_ * (time_s - start_s_);
    return controller_(reference, y[Eha::kX], y[Eha::kV], scaled[kIntegral] * size_[kIntegral]);
  }

  /// What the asset's laws add; rates of their hidden states, not scaled, go to `rates`.
  [[nodiscard]] BenchPhysics::Added physics(const double* scaled, const Eha::State<double>& y, const Eha::Input& input,
                                            double* rates) const {
    if (!loop_.physics.any()) return {};
    for (std::size_t k = 0; k < hidden_.size(); ++k) hidden_[k] = scaled[first_hidden_ + k] * size_[first_hidden_ + k];
    return loop_.physics.added(y, input, p_, hidden_.data(), rates);
  }

  /// d command / dt, for laws of the driver: over a microsecond along the motion without their own part.
  [[nodiscard]] double command_rate_V_s(const double* scaled, const Eha::State<double>& y,
                                        const ControllerOutput& control, double time_s) const {
    constexpr double kAhead_s = 1e-6;
    if (!loop_.physics.sees_command_rate()) return 0.0;
    const Eha::Input input{control.voltage_V};
    const Eha::State<double> dy = Eha::derivatives(y, input, p_, physics(scaled, y, input, nullptr));
    const double reference = reference_m_ + speed_m_s_ * (time_s + kAhead_s - start_s_);
    const double integral = scaled[kIntegral] * size_[kIntegral] + kAhead_s * control.integral_rate_V_s;
    const double ahead =
        controller_(reference, y[Eha::kX] + kAhead_s * dy[Eha::kX], y[Eha::kV] + kAhead_s * dy[Eha::kV], integral)
            .voltage_V;
    return (ahead - control.voltage_V) / kAhead_s;
  }

  const ClosedLoop& loop_;
  const EhaParameters<double>& p_;
  CascadeController controller_;
  std::vector<double> size_;           ///< of each state
  std::vector<std::size_t> low_pass_;  ///< index of each sensor's low-pass among the states, or kNone
  std::vector<std::size_t> lag_;       ///< and of its lag
  std::size_t first_hidden_ = 0;
  mutable std::vector<double> hidden_;  ///< the laws' hidden states, in their own units
  double start_s_ = 0.0;
  double reference_m_ = 0.0;
  double speed_m_s_ = 0.0;
};

/// Follows the profile after a time of rest; returns each sensor's values at each time.
std::vector<std::vector<double>> run(const ClosedLoop& loop, const Profile& profile,
                                     const std::vector<double>& times_s) {
  std::vector<std::vector<double>> values(loop.sensors.size(), std::vector<double>(times_s.size(), 0.0));
  Equations equations(loop, profile.ramp_speed_m_s);
  const Rates rates = [&](double time_s, const double* y, double* dy) { equations.rates(time_s, y, dy); };
  std::size_t sample = 0;
  const TakeSample take = [&](double time_s, const std::vector<double>& y) {
    equations.read_sensors(time_s, y, sample++, values);
  };
  const StepControl control{.tolerance = loop.relative_tolerance};

  std::vector<double> state = equations.guess(profile.start_m);
  equations.follow(-loop.settling_time_s, profile.start_m, 0.0);
  (void)integrate_rosenbrock(rates, state, -loop.settling_time_s, 0.0, {}, take, control);
  equations.start_recording(state);
  if (!times_s.empty() && times_s.front() == 0.0) take(0.0, state);
  double start_s = 0.0, reference_m = profile.start_m;
  for (const ProfilePiece& piece : profile.pieces) {
    equations.follow(start_s, reference_m, piece.speed_m_s);
    const double end_s = start_s + piece.duration_s;
    (void)integrate_rosenbrock(rates, state, start_s, end_s, times_s, take, control);
    start_s = end_s;
    reference_m += piece.speed_m_s * piece.duration_s;
  }
  // Rounding of the pieces' ends may leave the last sample a hair behind them.
  for (; sample < times_s.size();) take(times_s[sample], state);
  return values;
}

}  // namespace

Result<std::vector<std::vector<double>>> integrate(const ClosedLoop& loop, const Profile& profile,
                                                   const std::vector<double>& times_s) {
  std::vector<std::vector<double>> values;
  try {
    values = run(loop, profile, times_s);
  } catch (const std::exception& problem) {  // Odeint and its matrices report by exceptions
    return fail(std::string("the bench cannot be simulated with these parameters: ") + problem.what());
  }
  for (const std::vector<double>& channel : values)
    for (const double value : channel)
      if (!std::isfinite(value)) return fail("the bench cannot be simulated with these parameters: no finite result");
  return values;
}

}  // namespace sealwatch::bench
