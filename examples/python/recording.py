# %% [markdown]
# # A recorded vibration
#
# An acceleration as a sensor writes it: CSV with the columns `time,acceleration`, here made up of two tones and noise. The harvester's
# cylinder follows it exactly, linear between the samples.

# %%
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import videg

random = np.random.default_rng(1)
time = np.arange(0.0, 20.0, 5e-3)
acceleration = 4.0 * np.cos(4 * np.pi * time) + 1.5 * np.cos(2 * np.pi * 3.1 * time) + random.normal(0.0, 0.3, len(time))
path = Path("shaker.csv").resolve()
np.savetxt(path, np.column_stack((time, acceleration)), delimiter=",", header="time,acceleration", comments="")

# %%
recorded = {"excitation.kind": "motion", "excitation.amplitude": 0.0, "excitation.file": path, "excitation.fileRepeat": True}
run = videg.simulate("fig14", until=60.0, set=recorded, record=["left.capacitance", "right.capacitance", "cylinder.velocity"])
print(f"{run.impacts} impacts in 60 s, <U> = {run.average_voltage_gain:.0f} V/s")
run.plot(window=(40.0, 44.0)).savefig("recording.svg")

# %% [markdown]
# The best load for this vibration, of 40 on a logarithmic scale.

# %%
loads = np.geomspace(1e8, 1e12, 40)
circuit = {"topology": "isolated", "release": "switch", "zener.voltage": 2450.0}
power = videg.evaluate({"load.resistance": loads}, "fig14", until=60.0, set=recorded | circuit, record="net_power")["net_power"]
best = int(np.argmax(power))
print(f"best load {loads[best]:.2g} Ohm: net power {1e6 * power[best]:.1f} uW")
