# Made from docs/howto/membrane.md by `UPDATE_BOOK=1 cargo test --test book`; run in the root of the source tree.

# %%
import sys

sys.path.append("examples")

# %% [markdown]
# # Use your own membrane
#
# You have measured a membrane, or you know its material, and want a harvester with it. A measured curve needs no fit: put the file in. It needs the
# [Python of the FMPy tutorial](../tutorial/fmpy.md) only if you want to fit. `examples/own_membrane.py` is the same as a script with
# cells. Run either in the root of the source tree, with `videg` on the PATH.
#
# `examples/film.csv` is **invented**: a membrane of $K = 1.9\times 10^5$ N/m$^n$, $n = 2.4$ and $\varepsilon_r = 4.2$, with noise. So you can compare
# with the true values. Nobody has measured it.
#
# ## Put the CSV in

# %%
from find_videg import run

run("videg simulate --set membrane.law=table --set membrane.file=examples/film.csv \\\n    --set membrane.initialRadius=2.5e-3 --set membrane.prestretch=3 --until 20 --output out/membrane/measured")

# %% [markdown]
# C(t) follows from the same file: each impact presses the membrane in under its measured force, as far as the energy of the ball reaches. `videg cosim`
# takes the same settings, `--vary membrane.file=a.csv,b.csv` compares films in a [sweep](../sweep.md), and a [case file](../sweep.md) has them below
# `[set]`. An FMU with the file in it is the same everywhere:

# %%
from find_videg import run

run("videg fmu build --resource examples/film.csv --output out/membrane/fmu")

# %% [markdown]
# ## The file
#
# A CSV file with a heading, SI units and a decimal point; lines that begin with `#` are comments.
#
# | heading | what |
# |---|---|
# | `deflection,force` | m, N; the capacitance follows from the [geometry](../theory/membrane.md) and $\varepsilon_r$ |
# | `deflection,force,capacitance` | m, N, F; capacitance as it was measured, without that of the wires |
#
# - The first row is that of a flat membrane: deflection 0, force 0.
# - Deflection and force rise from row to row, the capacitance does not fall. If noise makes forces fall, average the passes of the machine, or take rows
#   farther apart.
# - 3 to 1,000,000 rows; a last deflection of at most 20 `membrane.radius`, forces up to 1e9 N, capacitances from 1e-18 to 1 F.
# - Between the rows the curve is a monotone cubic, that of scipy's `PchipInterpolator`; the energy is its exact integral.
# - Beyond the last row force and capacitance go on in straight lines. The log and the report say so when it happens: measure deeper.
#
# What is wrong is refused with its line and value ([Hostile inputs](../hostile-inputs.md)). The name of the file is looked for in the `resources` of the
# FMU first, then from the working folder, or beside the case file that names it.
#
# ## Measure
#
# Measure with the ball and the frame of the harvester: the curve depends on both. The paper measured with a frame of
# $R_2 = 6.3$ mm. In Section 5.3 it uses the same values for 8 mm and a larger ball without giving a reason.
#
# - **Force over deflection**: press the ball slowly into the middle. Go as deep as the impacts.
# - **Capacitance over deflection**: the same with an LCR meter, at a frequency so low that electrodes of high resistance still charge. Subtract the stray
#   capacitance of wires and meter, which is a part of your circuit.
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

# %%
import numpy as np

before, after = np.loadtxt("out/membrane/rebound.csv", delimiter=",", skiprows=1).T
restitution = np.sum(before * after) / np.sum(before**2)
print(f"r = {restitution:.3f}; by impact {np.round(after / before, 2)}")

# %% [markdown]
# `membrane.restitution` is one number for all speeds. If yours depends on the speed, take its value at the speed of the impacts of your case, or describe the film
# by its material, with [viscosity](../theory/contact.md#viscous-films-restitution-follows), from which the restitution follows.
#
# ## Fit K and n, or the constants of a film
#
# A law with few constants smooths noise, and it extrapolates beyond the last point. Fit by least squares of the forces, not of their
# logarithms: these would give the noise of the smallest forces the largest weight.

# %%
from scipy.optimize import curve_fit

deflection, force, capacitance = np.loadtxt("examples/film.csv", delimiter=",", skiprows=2).T
initial_radius, initial_thickness, prestretch, ball = 2.5e-3, 1e-3, 3.0, 5e-3  # R_1, h_1 in m, lambda, r_b in m
radius, thickness = prestretch * initial_radius, initial_thickness / prestretch**2  # R_2, h_2


def area_ratio(depth):
    tangent = depth / (radius + np.sqrt(radius**2 + depth * (depth - 2 * ball)))  # of alpha / 2, Eq. (5)
    angle = 2 * np.arctan(tangent)
    cap = 2 * np.pi * ball**2 * (1 - np.cos(angle))
    cone = np.pi * (radius**2 - (ball * np.sin(angle)) ** 2) / np.cos(angle)
    return (cap + cone) / (np.pi * radius**2)


def power(depth, stiffness, exponent):
    return 1e5 * stiffness * depth**exponent


def gent(depth, modulus, limit):
    stretch = prestretch * np.sqrt(area_ratio(depth))
    room = 1 - (2 * stretch**2 + stretch**-4 - 3) / limit
    stress = 1e3 * modulus * (stretch**2 - stretch**-4) / room
    h = 1e-6
    slope = (area_ratio(depth + h) - area_ratio(depth - h)) / (2 * h)
    return np.pi * radius**2 * thickness * stress * slope / area_ratio(depth)


def fit(law, start, bounds):
    found, _ = curve_fit(law, deflection, force, p0=start, bounds=bounds)
    return found, 1e3 * np.sqrt(np.mean((law(deflection, *found) - force) ** 2))


(stiffness, exponent), error = fit(power, [1, 2], ([1e-3, 1], [1e5, 10]))
print(f"K = {1e5 * stiffness:.3g} N/m^n, n = {exponent:.2f}: {error:.1f} mN left over on average")
largest = prestretch * np.sqrt(area_ratio(deflection[-1]))
least = 1.01 * (2 * largest**2 + largest**-4 - 3)  # a film that was stretched so far is not locked
(modulus, limit), error = fit(gent, [40, 10 * least], ([0.1, least], [1e3, 1e6]))
print(f"mu = {modulus:.1f} kPa, J = {limit:.0f}: {error:.0f} mN left over on average")

# %% [markdown]
# The errors of $K$ and $n$ are correlated: a larger $n$ needs a larger $K$. So compare forces at the deflection of the impacts, not $K$. A pre-stretched
# film is nearly linear at small deflections, this membrane is not: its Gent constants leave more over. The law that leaves least over is yours; if none does, take the table.
#
# The permittivity is the slope of the capacitance over $(A_3/A_2)^2$, Eqs. (1) and (3) to (5); what is left at zero is stray capacitance:

# %%
rest, stray = np.polyfit(area_ratio(deflection) ** 2, 1e12 * capacitance, 1)
permittivity = 1e-12 * rest * thickness / (8.8541878188e-12 * np.pi * radius**2)
print(f"C_2 = {rest:.0f} pF, epsilon_r = {permittivity:.1f}")

# %% [markdown]
# ## Run it with the fit

# %%
from pathlib import Path

Path("out/membrane/own.toml").write_text(f"""case = "fig14"
until = 20.0
window = [10.0, 20.0]

[set]
membrane.initialRadius = {initial_radius}
membrane.initialThickness = {initial_thickness}
membrane.prestretch = {prestretch}
membrane.relativePermittivity = {permittivity:.4g}
membrane.stiffness = {1e5 * stiffness:.5g}
membrane.stiffnessExponent = {exponent:.4g}
membrane.restitution = {restitution:.4g}
""")

# %%
from find_videg import run

run("videg simulate --case-file out/membrane/own.toml --output out/membrane/run")

# %% [markdown]
# Mass and length of the cylinder, force and frequency are still those of Fig. 14; [Variables](../reference/variables.md) has their names.
#
# ## A film by its material
#
# `membrane.law = gent` and `ogden` take the force from the energy of the film in your frame, pre-stretch included
# ([The membrane](../theory/membrane.md#force)). For VHB 4910 a Gent film of 45 kPa with $J = 270$ is often quoted; its constants are the start values.
# `membrane.ogdenModulus1` and `membrane.ogdenExponent1` to `3` have the sign of each other.

# %%
from find_videg import run

run("videg simulate --set membrane.law=gent --until 20 --output out/membrane/gent")

# %% [markdown]
# Such constants come from slow tests of large films. [Figure 4](../theory/membrane.md#force) says how far they are from what the paper measured: 26 times
# the force at 1 mm. If you can, measure. The run warns if stretch, field and tension exceed the
# [limits of the material](../theory/membrane.md#limits-of-the-material); the tension is that of your law.
