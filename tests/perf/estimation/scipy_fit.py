#!/usr/bin/python3
"""The fit of estimation_benchmark as a SciPy user writes it: LSODA, least_squares, differences for derivatives.

Same equations (docs/model.md), channels, noise, unknowns and start as fit_actuator; linear input between samples.
Usage: scipy_fit.py RECORDING.csv
"""
import sys

import numpy as np
from scipy.integrate import odeint
from scipy.optimize import least_squares
from scipy.signal import lfilter

FIXED = dict(C_M=4e-3, L_M=1.5e-3, Omega_M=0.20, T_M=0.20, J_M=4e-4, d_P=2e-4, alpha_P=3.98e-8, V_P=2e-5, c_D=0.6, a_V=5e-6,
             k_V=2e-5, g_V=5e-7, p_crack=5e4, r_pilot=3.0, eps=1e3, rho=870.0, p_0=1e6, K_MU=1e-11, s=2e4, A_C=5.89e-3,
             x_C=0.080, m_C=50.0, phi=6e4, V_0=5e-5)
START = dict(R_M=0.5, f_M=8e-4, R_PL=5e13, beta=1.2e9, R_CL=2.6e13, f_C=2e6)
CHANNELS = dict(motor_current=(0.02, 0.0), shaft_speed=(0.5, 0.0), pressure_a=(1e4, 5e-3), pressure_b=(1e4, 5e-3),
                flow=(4e-8, 50e-3), position=(5e-6, 2e-3), velocity=(1e-5, 5e-3))
# Absolute tolerances: the loosest that keep the error of every output, against rtol 1e-9, below a hundredth of its sigma.
ABSOLUTE = np.array([1e-4, 1e-4, 1e-3, 100, 100, 100, 100, 1e-8, 1e-8])


def valve(port, chamber, other, p):
    drop = port - chamber
    forward = 0.5 * (1 + np.tanh(p["k_V"] * (drop - p["p_crack"])))
    pilot = 0.5 * (1 + np.tanh(p["g_V"] * (p["r_pilot"] * (other - p["p_0"]) - (chamber - p["p_0"]))))
    area = p["a_V"] * np.maximum(forward, pilot)
    return p["c_D"] * area * np.sqrt(2 / p["rho"]) * drop / np.sqrt(np.abs(drop) + p["eps"])


def make_up(pressure, p):
    return p["K_MU"] * p["s"] * np.logaddexp(0.0, (p["p_0"] - pressure) / p["s"])


def derivatives(y, t, times, voltage, p):
    z, i, omega, p_1, p_2, p_a, p_b, v, x = y
    u = np.interp(t, times, voltage)
    q_pl, q_cl = (p_1 - p_2) / p["R_PL"], (p_a - p_b) / p["R_CL"]
    q_1, q_2 = valve(p_1, p_a, p_2, p), valve(p_2, p_b, p_1, p)
    volume_a, volume_b = p["V_0"] + p["A_C"] * x, p["V_0"] + p["A_C"] * (p["x_C"] - x)
    beta = p["beta"]
    return [(u - z) / (p["R_M"] * p["C_M"]),
            (z - p["R_M"] * i - p["Omega_M"] * omega) / p["L_M"],
            (p["T_M"] * i - (p["f_M"] + p["d_P"]) * omega - p["alpha_P"] * (p_1 - p_2)) / p["J_M"],
            beta / p["V_P"] * (p["alpha_P"] * omega - q_pl - q_1 + make_up(p_1, p)),
            beta / p["V_P"] * (-p["alpha_P"] * omega + q_pl - q_2 + make_up(p_2, p)),
            beta / volume_a * (q_1 - p["A_C"] * v - q_cl),
            beta / volume_b * (q_2 + p["A_C"] * v + q_cl),
            (p["A_C"] * (p_a - p_b) - p["f_C"] * v - p["phi"] * (1 + p["Phi"])) / p["m_C"],
            v]


def low_pass(times, signal, tau):
    """Exact for a signal that is linear between evenly spaced samples."""
    if tau == 0:
        return signal
    h = (times[-1] - times[0]) / (len(times) - 1)
    decay = np.exp(-h / tau)
    now, before = 1 - tau / h * (1 - decay), tau / h * (1 - decay) - decay
    return signal[0] + lfilter([now, before], [1, -decay], signal - signal[0])


def simulate(unknowns, times, voltage, first):
    p = dict(FIXED)
    for name, value in zip(START, unknowns):
        p[name] = START[name] * np.exp(value - 1)  # start at one: least_squares takes steps relative to the value
    p["Phi"] = unknowns[6] - 1
    p_a, p_b, x = unknowns[7] * first["pressure_a"], unknowns[8] * first["pressure_b"], unknowns[9] * first["position"]
    omega, i = first["shaft_speed"], first["motor_current"]
    y0 = [voltage[0], i, omega, p_a, p_b, p_a, p_b, 0.0, x]
    y = odeint(derivatives, y0, times, args=(times, voltage, p), rtol=1e-6, atol=ABSOLUTE, mxstep=100000)
    flow = valve(y[:, 3], y[:, 5], y[:, 4], p)
    outputs = dict(motor_current=y[:, 1], shaft_speed=y[:, 2], pressure_a=y[:, 5], pressure_b=y[:, 6], flow=flow,
                   position=y[:, 8], velocity=y[:, 7])
    return {name: low_pass(times, outputs[name], CHANNELS[name][1]) for name in CHANNELS}


def main():
    data = np.genfromtxt(sys.argv[1], delimiter=",", names=True)
    times, voltage = data["time"], data["motor_voltage"]
    first = {name: np.mean(data[name][:3]) for name in CHANNELS}

    def residuals(unknowns):
        outputs = simulate(unknowns, times, voltage, first)
        return np.concatenate([(outputs[name] - data[name]) / CHANNELS[name][0] for name in CHANNELS])

    start = np.ones(10)
    fit = least_squares(residuals, start, method="trf", x_scale="jac", diff_step=1e-4, ftol=1e-5)
    names = list(START)
    print("SciPy:", ", ".join(f"{name} {START[name] * np.exp(value - 1):.4g}" for name, value in zip(names, fit.x)),
          f"Phi {fit.x[6] - 1:.4f}, rms {np.sqrt(2 * fit.cost / fit.fun.size):.3f}, {fit.nfev} steps")


main()
