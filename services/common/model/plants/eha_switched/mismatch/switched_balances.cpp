#include "services/common/model/plants/eha_switched/mismatch/switched_balances.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sealwatch/model/eha_switched.hpp"
#include "sealwatch/model/law_sizes.hpp"
#include "sealwatch/model/no_extra.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr double kBlock_s = 0.2;
// A piston that seems to stand may creep by this: its friction is then anything between that of both directions.
constexpr double kCreep_m_s = 2e-4;
constexpr double kFromEnd_m = 5e-4;  // nearer to an end of the stroke its stop may carry the force
constexpr double kShortest = 0.75;   // of a block: shorter ones are cut off by the valves
constexpr double kMoving = 0.15;     // of the largest speed

using Plant = EhaSwitched;
using Parameters = EhaSwitchedParameters<double>;

Parameters parameters_of(const AssetConfig& asset) {
  Parameters p{};
  Parameters::visit(
      [&](std::string_view name, double& value) {
        if (const auto found = asset.parameters.find(std::string(name)); found != asset.parameters.end())
          value = found->second.value;
      },
      p);
  return p;
}

// A law of the asset at its sites, ready to be evaluated.
struct Term {
  const Law* law = nullptr;
  std::vector<std::size_t> sites;
  std::vector<double> parameters;
  Roundings roundings{};
};

struct SensorError {
  double gain = 0.0, bias = 0.0;
  [[nodiscard]] double undo(double measured) const { return (measured - bias) / (1.0 + gain); }
};

// What an asset adds to the balances beside its parameters.
struct Terms {
  std::vector<Term> laws;
  SensorError position, p_A, p_B, speed, angle;

  explicit Terms(const AssetConfig& asset) {
    for (const PhysicsTerm& physics : asset.physics) {
      std::vector<std::string> names;
      for (const auto& [name, setting] : physics.parameters) names.push_back(name);
      const auto law = find_law(physics.id, names, asset.model);
      if (!law || is_of_recording((*law)->kind)) continue;
      if (is_sensor((*law)->kind)) {
        add_sensor(**law, physics);
        continue;
      }
      Term term{.law = *law, .sites = {}, .parameters = {}, .roundings = roundings_of(**law)};
      for (std::size_t k = 0; k < Plant::kSites.size(); ++k)
        if (Plant::kSites[k].element == physics.element && Plant::kSites[k].kind == (*law)->kind)
          term.sites.push_back(k);
      for (const LawParameter& parameter : (*law)->parameters)
        term.parameters.push_back(physics.parameters.at(std::string(parameter.name)).value);
      laws.push_back(std::move(term));
    }
  }

  void add_sensor(const Law& law, const PhysicsTerm& physics) {
    const double value = physics.parameters.begin()->second.value;
    SensorError* sensor = physics.element == "sensor:position"      ? &position
                          : physics.element == "sensor:pressure_a"  ? &p_A
                          : physics.element == "sensor:pressure_b"  ? &p_B
                          : physics.element == "sensor:shaft_speed" ? &speed
                          : physics.element == "sensor:pump_angle"  ? &angle
                                                                    : nullptr;
    if (sensor == nullptr) return;
    if (law.kind == SiteKind::sensor_gain) sensor->gain = value;
    if (law.kind == SiteKind::sensor_bias) sensor->bias = value;
  }

  // Sum of what the laws add at one site.
  [[nodiscard]] double at(std::size_t site, const Plant::State<double>& y, const Plant::Input& input,
                          const Parameters& p) const {
    double sum = 0.0;
    for (const Term& term : laws) {
      if (std::ranges::find(term.sites, site) == term.sites.end() || term.law->hidden) continue;
      const auto signals = Plant::signals<double>(site, y, input, p, NoExtra{});
      sum += term.law->evaluate(law_input(signals, 0.0, term.parameters, term.roundings)).contribution.value;
    }
    return sum;
  }
};

double mean(const std::vector<double>& values, std::size_t begin, std::size_t end) {
  return std::accumulate(values.begin() + static_cast<std::ptrdiff_t>(begin),
                         values.begin() + static_cast<std::ptrdiff_t>(end), 0.0) /
         static_cast<double>(end - begin);
}

// Slope of a straight line through the block's samples.
double slope(const std::vector<double>& time_s, const std::vector<double>& values, std::size_t begin, std::size_t end) {
  const double t = mean(time_s, begin, end), y = mean(values, begin, end);
  double top = 0.0, bottom = 0.0;
  for (std::size_t k = begin; k < end; ++k) {
    top += (time_s[k] - t) * (values[k] - y);
    bottom += (time_s[k] - t) * (time_s[k] - t);
  }
  return bottom > 0.0 ? top / bottom : 0.0;
}

// Pressure lost in one line: laminar pipes and the valve's orifice.
double line_drop(double flow, const Parameters& p) {
  const double K = p.c_D * p.a_V * std::sqrt(2.0 / p.rho);
  return (Plant::pipe_resistance(p.l_supply, p) + Plant::pipe_resistance(p.l_chamber, p)) * flow +
         flow * std::abs(flow) / (K * K);
}

}  // namespace

Result<SwitchedBalances> SwitchedBalances::create(const Data& data) {
  SwitchedBalances balances;
  for (const TimeSeries& samples : data.samples) {
    for (const char* channel :
         {"position", "pressure_a", "pressure_b", "shaft_speed", "pump_angle", "motor_duty", "valve_state"})
      if (!samples.has(channel)) return fail(std::string(channel) + " is not recorded");
    balances.add_rows(samples, balances.recordings_++);
  }
  if (balances.rows_.empty()) return fail("no block of 0.2 s has its valves open");
  balances.mark_motion();
  return balances;
}

void SwitchedBalances::add_rows(const TimeSeries& samples, std::size_t recording) {
  const std::vector<double>& time_s = samples.time_s;
  const auto values = [&](const char* channel) -> const std::vector<double>& { return samples.find(channel)->values; };
  const std::vector<double>& valves = values("valve_state");
  for (std::size_t begin = 0, end = 0; begin < time_s.size(); begin = end) {
    ++end;  // a stretch has one sample at least, whatever it compares like
    while (end < time_s.size() && time_s[end] < time_s[begin] + kBlock_s && valves[end] == valves[begin]) ++end;
    const int way = Plant::direction({0.0, valves[begin]});
    if (time_s[end - 1] - time_s[begin] < kShortest * kBlock_s) continue;
    const auto mean_of = [&](const char* channel) { return mean(values(channel), begin, end); };
    const auto slope_of = [&](const char* channel) { return slope(time_s, values(channel), begin, end); };
    rows_.push_back({.recording = recording,
                     .way = way,
                     .duty = std::abs(mean_of("motor_duty")),
                     .omega = slope_of("pump_angle"),
                     .speed = way * mean_of("shaft_speed"),
                     .p_A = mean_of("pressure_a"),
                     .p_B = mean_of("pressure_b"),
                     .dp_A = slope_of("pressure_a"),
                     .dp_B = slope_of("pressure_b"),
                     .x = mean_of("position"),
                     .v = slope_of("position")});
  }
}

void SwitchedBalances::mark_motion() {
  double fastest_v = 0.0, fastest_omega = 0.0, first = rows_.front().x, last = rows_.front().x;
  for (const Row& row : rows_) {
    first = std::min(first, row.x);
    last = std::max(last, row.x + 2.0 * kFromEnd_m);
    fastest_v = std::max(fastest_v, std::abs(row.v));
    fastest_omega = std::max(fastest_omega, row.omega);
  }
  for (Row& row : rows_) {
    row.moving = std::abs(row.v) > kMoving * fastest_v;
    row.standing = std::abs(row.v) < kCreep_m_s && row.x > first + kFromEnd_m && row.x < last - kFromEnd_m;
    row.turning = row.omega > kMoving * fastest_omega;
  }
}

SwitchedBalances::Residuals SwitchedBalances::residuals(const BalanceModel& model) const {
  const Terms terms(model.asset);
  Parameters p = parameters_of(model.asset);
  std::array<std::vector<double>, kBalances.size()> left;
  for (const Row& row : rows_) {
    const double omega = terms.angle.undo(row.omega), v = row.v / (1.0 + terms.position.gain);
    const double p_A = terms.p_A.undo(row.p_A), p_B = terms.p_B.undo(row.p_B), x = terms.position.undo(row.x);
    const double q = (row.way > 0 ? p.A_A : p.A_B) * std::abs(v), q_other = (row.way > 0 ? p.A_B : p.A_A) * std::abs(v);
    const double p_P = (row.way > 0 ? p_A : p_B) + line_drop(q, p),
                 p_T = (row.way > 0 ? p_B : p_A) - line_drop(q_other, p);
    const double dp = p_P - p_T;
    p.load_factor = model.load_factor[row.recording];
    const Plant::Input input{row.duty, static_cast<double>(row.way)};
    Plant::State<double> y{0.0, omega, 0.0, p_P, p_A, p_B, p_T, v, x};
    const auto extra = [&](std::size_t site) { return terms.laws.empty() ? 0.0 : terms.at(site, y, input, p); };
    const double torque = p.f_M * omega + p.alpha_P * dp + p.T_0 + p.k_T * std::abs(dp);
    y[Plant::kI] = torque / p.Omega_M;
    y[Plant::kI] = (torque + extra(Plant::kShaftTorque)) / p.Omega_M;
    const bool a = row.way > 0;
    const auto compliance = [&](bool of_a) {
      const double volume = p.V_0 + Plant::pipe_volume(p.l_chamber, p) + (of_a ? p.A_A * x : p.A_B * (p.x_C - x));
      return volume *
                 (1.0 / Plant::bulk_modulus(of_a ? p_A : p_B, p) + extra(of_a ? Plant::kModulusA : Plant::kModulusB)) +
             extra(of_a ? Plant::kComplianceA : Plant::kComplianceB);
    };
    const double rate_A = row.dp_A / (1.0 + terms.p_A.gain), rate_B = row.dp_B / (1.0 + terms.p_B.gain);
    const double seal = (p_A - p_B) / p.R_CL + extra(Plant::kSealLeakage);
    if (row.way == 0) {
      left[4].push_back(rate_A + (seal + extra(Plant::kOutflowA)) / compliance(true));
      left[4].push_back(rate_B + (-seal + extra(Plant::kOutflowB)) / compliance(false));
      continue;
    }
    const double flow = p.alpha_P * omega - dp / p.R_PL - extra(Plant::kPumpSlip) - row.way * seal -
                        extra(a ? Plant::kOutflowA : Plant::kOutflowB) - compliance(a) * (a ? rate_A : rate_B);
    left[0].push_back(row.way * v - flow / (a ? p.A_A : p.A_B));
    if (row.moving || row.standing) {
      const auto force_at = [&](double speed) {
        y[Plant::kV] = speed;
        return Plant::load_force(row.standing ? 0.0 : speed, p) + p.f_C * speed + extra(Plant::kPistonForce);
      };
      const double carried = p.A_A * p_A - p.A_B * p_B;
      const double lost =
          row.moving ? force_at(v) : std::clamp(carried, force_at(v - kCreep_m_s), force_at(v + kCreep_m_s));
      left[1].push_back((carried - lost) / (a ? p.A_A : p.A_B));
      y[Plant::kV] = v;
    }
    if (!row.turning) continue;
    left[2].push_back(row.duty - (p.R_M * y[Plant::kI] + p.Omega_M * omega + extra(Plant::kDriverVoltage) +
                                  extra(Plant::kWindingVoltage)) /
                                     p.U_supply);
    left[3].push_back(terms.speed.undo(row.speed) - omega);
  }
  Residuals residuals;
  for (std::size_t b = 0; b < left.size(); ++b)
    residuals[b] = Eigen::Map<Eigen::VectorXd>(left[b].data(), static_cast<Eigen::Index>(left[b].size()));
  return residuals;
}

}  // namespace sealwatch::mismatch
