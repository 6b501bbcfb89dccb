// Balances of plant `eha_switched` with the recorded states put in: what each of its equations leaves over, block by
// block of 0.2 s. Nothing is integrated, so that nothing drifts, sticks or runs away: where a simulation from the
// datasheet's parameters stands still, these equations still say which of them is wrong, and by how much.
//
//   volume    alpha_P omega - dp/R_PL - slip - q_CL s - outflow_j - C_j dp_j/dt - A_j |v|        [m3/s]  valves open
//   force     A_A p_A - A_B p_B - phi (1 + Phi_k) (extending) - f_C v - force laws                [N]      any motion
//   voltage   U_supply |duty| - R_M i - Omega_M omega - voltage laws                              [V]      turning
//             i = (f_M omega + alpha_P dp + T_0 + k_T |dp| + torque laws) / Omega_M
//   speed     recorded |shaft_speed| - omega                                                      [rad/s] turning
//   closed    C_A dp_A/dt + q_CL + outflow_A, C_B dp_B/dt - q_CL + outflow_B, as pressure rates   [Pa/s]
//             valves closed
//
// Where the piston stands, away from its ends, the force may be anything between the laws' at a creeping speed in
// either direction. volume is stated as a piston speed, force as the joined chamber's pressure, voltage as a share of
// the supply's, so that no balance gets smaller with its own parameters.
//
// j: the chamber that the valves join to the pump (A for s = +1); dp = p_j - p_other + both lines' drops; omega, v and
// dp_j/dt are differences over the block of recorded shaft angle, position and pressure. Laws with a hidden state need
// a simulation and take no part.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string_view>
#include <vector>

#include "services/common/mismatch/fitted_model.hpp"

namespace sealwatch::mismatch {

struct BalanceDescription {
  std::string_view name, element, unit;
};

/// A datasheet value that a balance rests on, and the element that it belongs to.
struct DatasheetValue {
  std::string_view name, element;
  /// Times. Three: catalogue figures of pumps and motors are of another operating point, or of another size. A value
  /// that is further off is not wrong: something else is.
  double off_by_at_most = 3.0;
};

/// An asset, its laws included, with the load factor of each recording.
struct BalanceModel {
  AssetConfig asset;
  std::vector<double> load_factor;
};

class SwitchedBalances {
 public:
  static constexpr std::string_view kPlant = "eha_switched";
  static constexpr std::array<BalanceDescription, 5> kBalances = {{{"volume", "pump", "m/s"},
                                                                   {"force", "piston", "Pa"},
                                                                   {"voltage", "winding", "1"},
                                                                   {"speed", "shaft", "rad/s"},
                                                                   {"closed", "piston_seal", "Pa/s"}}};
  static constexpr std::array<DatasheetValue, 12> kDatasheet = {{{"alpha_P", "pump"},
                                                                 {"R_PL", "pump"},
                                                                 {"A_A", "chamber_a"},
                                                                 {"A_B", "chamber_b"},
                                                                 {"R_CL", "piston_seal"},
                                                                 {"f_C", "piston"},
                                                                 {"U_supply", "driver", 1.2},  // anyone can measure it
                                                                 {"R_M", "winding"},
                                                                 {"Omega_M", "winding"},
                                                                 {"T_0", "shaft"},
                                                                 {"k_T", "shaft"},
                                                                 {"f_M", "shaft"}}};

  /// Channels that a balance compares with one another.
  static constexpr std::array<std::string_view, 2> kCompared = {"shaft_speed", "pump_angle"};

  /// An Error when a channel that the balances need is not recorded.
  [[nodiscard]] static Result<SwitchedBalances> create(const Data& data);

  /// What every balance leaves over, one vector for each of kBalances.
  using Residuals = std::array<Eigen::VectorXd, kBalances.size()>;
  [[nodiscard]] Residuals residuals(const BalanceModel& model) const;

  [[nodiscard]] std::size_t recordings() const { return recordings_; }

 private:
  struct Row {
    std::size_t recording = 0;
    int way = 0;
    double duty = 0.0, omega = 0.0, speed = 0.0, p_A = 0.0, p_B = 0.0, dp_A = 0.0, dp_B = 0.0, x = 0.0, v = 0.0;
    bool turning = false, moving = false, standing = false;
  };
  void add_rows(const TimeSeries& samples, std::size_t recording);
  void mark_motion();

  std::vector<Row> rows_;
  std::size_t recordings_ = 0;
};

}  // namespace sealwatch::mismatch
