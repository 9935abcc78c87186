# %% [markdown]
# # The harvester in a system of your own, with an ODE solver of scipy
#
# A machine of 2 kg on a spring and a damper shakes at 2 Hz; the harvester's cylinder hangs on it by a softer spring. The machine is an
# ordinary differential equation that scipy solves, the cylinder, its ball and the membranes are the harvester. Both act on each
# other: the force of the spring between them is an input of the one, its reaction an input of the other.

# %%
import matplotlib.pyplot as plt
import numpy as np
import videg
from scipy.integrate import solve_ivp

MASS, STIFFNESS, DAMPING = 2.0, 500.0, 4.0  # kg, N/m, N.s/m
MOUNT, MOUNT_DAMPING = 60.0, 0.4  # N/m, N.s/m


def machine(time: float, state: np.ndarray, reaction: float) -> list[float]:
    position, velocity = state
    driven = 4.0 * np.cos(4 * np.pi * time)
    return [velocity, (driven - reaction - STIFFNESS * position - DAMPING * velocity) / MASS]


def run(step: float, end: float) -> np.ndarray:
    """Times, positions of machine and cylinder, capacitances; the harvester's own excitation is off."""
    at_rest = {
        "excitation.amplitude": 0.0,
        "initial.cylinderPosition": 0.0,
        "initial.ballPosition": 0.0,
        "initial.ballVelocity": 0.0,
    }
    names = ["cylinder.position", "cylinder.velocity", "left.capacitance", "right.capacitance"]
    state, force, rows = np.zeros(2), 0.0, []
    with videg.Harvester(set=at_rest) as harvester:
        for k in range(round(end / step)):
            time = k * step
            solved = solve_ivp(machine, (time, time + step), state, args=(force,), rtol=1e-8, atol=1e-10)
            state = solved.y[:, -1]
            harvester["externalForce"] = force
            harvester.step(step)
            position, velocity, *capacitances = harvester.get(names)
            force = MOUNT * (state[0] - position) + MOUNT_DAMPING * (state[1] - velocity)
            rows.append([harvester.time, state[0], position, *capacitances])
        print(f"step {step:g} s: {harvester['impact.count']} impacts in {end:g} s, sum of U - U_in {harvester['gain.voltage']:.0f} V")
    return np.array(rows)


# %% [markdown]
# The error of the coupling is of first order in the step: half the step is the check.

# %%
table = run(1e-3, 10.0)
finer = run(5e-4, 10.0)
before = table[:, 0] < 1.0
difference = np.abs(table[before, 2] - finer[1::2][before, 2]).max()
print(f"position of the cylinder in the first second: largest difference {1e3 * difference:.2f} mm")

# %%
shown = table[:, 0] >= 7.0
figure, axes = plt.subplots(2, 1, sharex=True, figsize=(7, 4), layout="constrained")
axes[0].plot(table[shown, 0], 1e3 * table[shown, 1], color="#444444", label="machine")
axes[0].plot(table[shown, 0], 1e3 * table[shown, 2], color="#1b6ca8", label="cylinder")
axes[0].set_ylabel("position, mm")
axes[1].plot(table[shown, 0], 1e12 * table[shown, 3], color="#1b6ca8", linewidth=0.8, label="left")
axes[1].plot(table[shown, 0], 1e12 * table[shown, 4], color="#c0504d", linewidth=0.8, label="right")
axes[1].set_ylabel("C, pF")
axes[1].set_xlabel("time, s")
for axis in axes:
    axis.legend(ncols=2, loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.0, frameon=False)
figure.savefig("own_system.svg")
