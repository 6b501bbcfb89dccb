// The actuator that a blind trial is recorded from: the reference model's datasheet (docs/model.md)
// under this file's own names, so that the truth shares no parameter table with the estimator. A test compares the two.
#pragma once

namespace sealwatch::bench {

/// SI units. What is drawn anew for every trial set stands first.
struct TruthParameters {
  double seal_resistance = 2.6e13;  ///< [Pa s/m3] R_CL
  double piston_viscosity = 2.0e6;  ///< [N s/m] f_C
  double pump_resistance = 5e13;    ///< [Pa s/m3] R_PL
  double motor_viscosity = 8e-4;    ///< [N m s/rad] f_M
  double oil_modulus = 1.2e9;       ///< [Pa] beta
  double winding_resistance = 0.5;  ///< [ohm] R_M
  double load = 6.0e4;              ///< [N] phi (1 + Phi) of the test, positive against +x

  double driver_capacitance = 4e-3;    ///< [F] C_M
  double winding_inductance = 1.5e-3;  ///< [H] L_M
  double back_emf = 0.20;              ///< [V s/rad] Omega_M
  double torque_constant = 0.20;       ///< [N m/A] T_M
  double shaft_inertia = 4e-4;         ///< [kg m2] J_M
  double pump_viscosity = 2e-4;        ///< [N m s/rad] d_P
  double displacement = 3.98e-8;       ///< [m3/rad] alpha_P
  double port_volume = 2e-5;           ///< [m3] V_P
  double valve_discharge = 0.6;        ///< [1] c_D
  double valve_area = 5e-6;            ///< [m2] a_V
  double forward_steepness = 2e-5;     ///< [1/Pa] k_V
  double pilot_steepness = 5e-7;       ///< [1/Pa] g_V
  double cracking_pressure = 5e4;      ///< [Pa] p_crack
  double pilot_ratio = 3.0;            ///< [1] r_pilot
  double orifice_rounding = 1e3;       ///< [Pa] eps
  double oil_density = 870.0;          ///< [kg/m3] rho
  double reservoir_pressure = 1.0e6;   ///< [Pa] p_0
  double make_up_conductance = 1e-11;  ///< [m3/(s Pa)] K_MU
  double make_up_rounding = 2e4;       ///< [Pa] s
  double piston_area = 5.89e-3;        ///< [m2] A_C
  double dead_volume = 5e-5;           ///< [m3] V_0
  double stroke = 0.080;               ///< [m] x_C
  double moving_mass = 50.0;           ///< [kg] m_C
};

}  // namespace sealwatch::bench
