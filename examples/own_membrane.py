# Made from docs/howto/membrane.md by `UPDATE_BOOK=1 cargo test --test book`; run in the root of the source tree.

# %%
import sys

sys.path.append("examples")

# %% [markdown]
# # Use your own membrane
#
# You have measured a membrane and want C(t) of a harvester with it. This page fits the parameters $K$, $n$, $r$ and $\varepsilon_r$ and
# writes a case file. It needs the [Python of the FMPy tutorial](../tutorial/fmpy.md). `examples/own_membrane.py` is the same as a script with
# cells. Run either in the root of the source tree, with `videg` on the PATH.
#
# The measurements below are **invented**: a membrane of $K = 1.9\times 10^5$ N/m$^n$, $n = 2.4$, $r = 0.67$, $\varepsilon_r = 4.2$, with noise and
# 3 pF of stray capacitance. So you can compare the fits with the true values. Replace the measurements by yours.
#
# ## Measure
#
# Measure with the ball and the frame of the harvester. $K$ and $n$ depend on both. The paper measured with a frame of
# $R_2 = 6.3$ mm. In Section 5.3 it uses the same values for 8 mm and a larger ball without giving a reason.
#
# - **Force over deflection**: press the ball slowly into the middle. Go as deep as the impacts, see [below](#check-the-measured-range).

# %%
from pathlib import Path

Path("out/membrane/force.csv").parent.mkdir(parents=True, exist_ok=True)
Path("out/membrane/force.csv").write_text(r"""deflection_mm,force_N
0.5,0.022
1.0,0.012
1.5,0.031
2.0,0.058
2.5,0.110
3.0,0.164
3.5,0.233
4.0,0.347
4.5,0.445
5.0,0.574
5.5,0.718
6.0,0.878
""")

# %% [markdown]
# - **Capacitance over deflection**: the same with an LCR meter, at a frequency so low that electrodes of high resistance still charge.

# %%
from pathlib import Path

Path("out/membrane/capacitance.csv").parent.mkdir(parents=True, exist_ok=True)
Path("out/membrane/capacitance.csv").write_text(r"""deflection_mm,capacitance_pF
0.0,62.2
1.0,63.4
2.0,67.3
3.0,74.6
4.0,86.4
5.0,103.3
6.0,126.3
""")

# %% [markdown]
# - **Speed of the ball before and after an impact**, by a high-speed camera. The membrane stands upright and its frame is fixed.

# %%
from pathlib import Path

Path("out/membrane/rebound.csv").parent.mkdir(parents=True, exist_ok=True)
Path("out/membrane/rebound.csv").write_text(r"""before_m_per_s,after_m_per_s
0.30,0.19
0.40,0.26
0.50,0.34
0.60,0.41
0.70,0.47
0.80,0.54
""")

# %% [markdown]
# Also needed: radius and thickness of the membrane before stretching, the pre-stretch, and radius and mass of the ball.

# %%
import csv
from pathlib import Path

import numpy as np


def read(name):
    with open(name, newline="") as file:
        return np.array([[float(cell) for cell in row.values()] for row in csv.DictReader(file)]).T


initial_radius, initial_thickness, prestretch = 2.5e-3, 1e-3, 3.0  # R_1 and h_1 in m, lambda
ball_radius, ball_mass = 5e-3, 3.5e-3  # r_b in m, m in kg
radius, thickness = prestretch * initial_radius, initial_thickness / prestretch**2  # R_2, h_2

# %% [markdown]
# ## Fit K and n, Eq. (2)
#
# For each $n$ the best $K$ is a quotient of sums. The remaining error decides on $n$. A straight line through logarithms would give the noise of
# the smallest forces the largest weight.

# %%
deflection, force = read("out/membrane/force.csv")
deflection *= 1e-3


def best_stiffness(exponent):
    shape = deflection**exponent
    return np.sum(force * shape) / np.sum(shape**2)


def left_over(exponent):
    return np.sqrt(np.mean((force - best_stiffness(exponent) * deflection**exponent) ** 2))


exponent = min(np.arange(1.0, 5.0, 0.001), key=left_over)
stiffness = best_stiffness(exponent)
print(f"K = {stiffness:.4g} N/m^n, n = {exponent:.3f}, {1e3 * left_over(exponent):.1f} mN left over on average")

# %% [markdown]
# The errors of $K$ and $n$ are correlated: a larger $n$ needs a larger $K$. So compare forces at the deflection of the impacts, not $K$.
#
# ## Fit the permittivity, Eq. (1)
#
# $C = C_2 (A_3/A_2)^2$, and wires and meter add a constant stray capacitance. So a straight line over $(A_3/A_2)^2$, Eqs. (3) to (5),
# has the slope $C_2$. The value at rest alone would include the stray capacitance.

# %%
def area_ratio(depth):
    tangent = depth / (radius + np.sqrt(radius**2 + depth * (depth - 2 * ball_radius)))  # of alpha / 2, Eq. (5)
    angle = 2 * np.arctan(tangent)
    cap = 2 * np.pi * ball_radius**2 * (1 - np.cos(angle))
    cone = np.pi * (radius**2 - (ball_radius * np.sin(angle)) ** 2) / np.cos(angle)
    return (cap + cone) / (np.pi * radius**2)


depth, capacitance = read("out/membrane/capacitance.csv")
rest, stray = np.polyfit(area_ratio(1e-3 * depth) ** 2, capacitance, 1)
permittivity = 1e-12 * rest * thickness / (8.8541878128e-12 * np.pi * radius**2)
print(f"C_2 = {rest:.1f} pF and {stray:.1f} pF of stray capacitance: epsilon_r = {permittivity:.2f}")

# %% [markdown]
# If the points leave the line, the membrane is no cone. Then Eq. (1) does not apply; use a table of C(t)
# ([C(t) in ngspice](../tutorial/ngspice.md)). The stray capacitance is a part of your circuit.
#
# ## The restitution, Eq. (11)

# %%
before, after = read("out/membrane/rebound.csv")
restitution = np.sum(before * after) / np.sum(before**2)
print(f"r = {restitution:.3f}; by impact {np.round(after / before, 2)}")

# %% [markdown]
# videg has one $r$ for all speeds. If your $r$ depends on the speed, take its value at the speed of the impacts of your case.
#
# ## Run it

# %%
Path("out/membrane/own.toml").write_text(f"""case = "fig14"
until = 20.0
window = [10.0, 20.0]

[set]
membrane.initialRadius = {initial_radius}
membrane.initialThickness = {initial_thickness}
membrane.prestretch = {prestretch}
membrane.relativePermittivity = {permittivity:.4g}
membrane.stiffness = {stiffness:.5g}
membrane.stiffnessExponent = {exponent:.4g}
membrane.restitution = {restitution:.4g}
ball.radius = {ball_radius}
ball.mass = {ball_mass}
""")

# %%
from find_videg import run

run("videg simulate --case-file out/membrane/own.toml --output out/membrane/run")

# %% [markdown]
# Mass and length of the cylinder, force and frequency are still those of Fig. 14; [Variables](../reference/variables.md) has their names.
# `videg cosim` takes the same file, and with more keys it is a [sweep](../sweep.md).
#
# ## Check the measured range
#
# The power law is a fit and holds only within the measured range:

# %%
with open("out/membrane/run/timeseries.csv", newline="") as file:
    deepest = max(float(row[f"{end}.deflection"]) for row in csv.DictReader(file) for end in ("left", "right"))
print(f"deepest impact {1e3 * deepest:.1f} mm, measured to {1e3 * deflection.max():.1f} mm")

# %% [markdown]
# If impacts go deeper, measure deeper. The run warns if stretch and field exceed the limits of VHB 4910
# ([Limits of the material](../theory/membrane.md#limits-of-the-material)). For another material ignore these warnings.
