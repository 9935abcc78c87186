# %% [markdown]
# # Which parameter matters? Sobol indices with SALib
#
# The net power of an isolated pair of membranes with a switch, where each parameter is known to some per cent only. The first-order
# index is the share of the variance that a parameter has by itself, the total index its share with all others.

# %%
import matplotlib.pyplot as plt
import numpy as np
import videg
from SALib.analyze import sobol as analysis
from SALib.sample import sobol as sampling

CIRCUIT = {"topology": "isolated", "release": "switch", "zener.voltage": 2450.0}
problem = {
    "names": ["ball.mass", "membrane.restitution", "membrane.stiffness", "membrane.prestretch", "excitation.amplitude"],
    "bounds": [[3.3e-3, 3.7e-3], [0.55, 0.65], [3.7e5, 4.5e5], [1.95, 2.05], [0.48, 0.52]],
}
problem["num_vars"] = len(problem["names"])
points = sampling.sample(problem, 512, calc_second_order=False, seed=1)

# %% [markdown]
# All points are evaluated at once, on all cores.

# %%
found = videg.evaluate(dict(zip(problem["names"], points.T, strict=True)), "fig14", set=CIRCUIT, record="net_power")
power = found["net_power"]
assert not found.errors
indices = analysis.analyze(problem, power, calc_second_order=False, seed=1)
print(f"{len(points)} runs: net power {1e6 * power.mean():.1f} uW, standard deviation {1e6 * power.std():.1f} uW")
for name, first, total in zip(problem["names"], indices["S1"], indices["ST"], strict=True):
    print(f"{name:24} first order {first:5.2f}, total {total:5.2f}")

# %%
figure, axis = plt.subplots(figsize=(7, 2.8), layout="constrained")
places = np.arange(problem["num_vars"])
axis.barh(places + 0.2, indices["S1"], 0.38, xerr=indices["S1_conf"], color="#1b6ca8", label="first order")
axis.barh(places - 0.2, indices["ST"], 0.38, xerr=indices["ST_conf"], color="#e0a458", label="total")
axis.set_yticks(places, problem["names"])
axis.invert_yaxis()
axis.set_xlabel("Sobol index of the net power (bars: 95 % intervals)")
axis.legend()
figure.savefig("sensitivity.svg")
