# Made from docs/tutorial/fmpy.md by `UPDATE_BOOK=1 cargo test --test book`; run in the root of the source tree.

# %%
import sys

sys.path.append("examples")

# %% [markdown]
# # C(t) in FMPy
#
# You load the harvester into [FMPy](https://fmpy.readthedocs.io), get its capacitances C(t), change parameters, go back in time,
# get derivatives, and couple it with the circuit. This takes a quarter of an hour. You need the FMUs and Python 3.11 or later with FMPy and
# matplotlib, in the versions of this page:

# %% [markdown]
# `./test.sh setup` makes the same `.venv`, but installs all packages of the tests into it, and Debian packages as well.
#
# `examples/fmpy_tutorial.py` is the same as a script with cells, for an editor or Jupyter. Run either in the root of the source tree.
#
# ## Get the FMUs
#
# A release has them. `videg`, from a release or built from the sources (`cargo run --release --` stands for it), writes them into `target/fmu`:

# %% [markdown]
# `examples/find_videg.py` takes them from there, or from the folder `VIDEG_FMUS`. If they are not there, it runs the `videg` on the PATH or in
# `target/release`. If there is none, it prints the command to run.
#
# ## Read the variables

# %%
import os
import sys
from pathlib import Path

import fmpy
import matplotlib.pyplot as plt
import numpy as np

figures = Path(os.environ.get("FIGURES", "out/fmpy"))
figures.mkdir(parents=True, exist_ok=True)

sys.path.append("examples")
from find_videg import find, fmu

HARVESTER = fmu("VibroImpactHarvester")
description = fmpy.read_model_description(HARVESTER)
print(f"{description.modelName}, FMI {description.fmiVersion}: {description.description}")
for variable in description.modelVariables:
    if variable.name.startswith("left."):
        print(f"  {variable.causality:7} {variable.name:19} [{variable.unit or 1}] {variable.description}")

# %% [markdown]
# [Variables](../reference/variables.md) has unit, bounds and place in the paper of every variable.
#
# ## Simulate
#
# The parameters start as in Section 4.2 of the paper, and the ball rests in the middle. Fig. 14 begins with the ball at one membrane,
# at the speed of the saw-tooth motion:

# %%
amplitude, frequency, mass, travel = 0.5, 2.0, 0.1245, 0.044  # A, f_0, M, s
cylinder = -amplitude / (mass * (2 * np.pi * frequency) ** 2)  # z_M(0)
ball = cylinder + travel / 2  # z_m(0)
fig14 = {
    "initial.cylinderPosition": cylinder,
    "initial.ballPosition": ball,
    "initial.ballVelocity": -4 * frequency * ball,
}

result = fmpy.simulate_fmu(
    HARVESTER,
    stop_time=100.0,
    output_interval=1e-3,
    start_values=fig14,
    output=["left.capacitance", "right.capacitance", "relativeDisplacement", "gain.voltage", "impact.count"],
)
gain = result["gain.voltage"]
print(f"{result['impact.count'][-1]} impacts, <U> = {(gain[100_000] - gain[50_000]) / 50:.1f} V/s from 50 to 100 s")

# %% [markdown]
# `videg cases fig14 --format python` prints every parameter of the case as such a dict, with unit and meaning (`--format json` and `toml` print it for others), and
# `videg cases` lists the cases.
#
# The paper prints 8079 V/s in Table 2. `output_interval` sets only the times of the output. The motion between events is a closed form,
# so another interval gives the same numbers to the last bit.

# %%
last = result["time"] >= 98.5
figure, (top, bottom) = plt.subplots(2, sharex=True, figsize=(8, 5), layout="constrained")
top.plot(result["time"][last], 1e3 * result["relativeDisplacement"][last], color="tab:gray")
top.set_ylabel("$z_M - z_m$ (mm)")
for side in ("left", "right"):
    bottom.plot(result["time"][last], 1e12 * result[f"{side}.capacitance"][last], label=side)
bottom.set_ylabel("capacitance (pF)")
bottom.set_xlabel("time (s)")
bottom.legend()
figure.savefig(figures / "capacitance.svg")

# %% [markdown]
# Each impact presses a membrane in: its area grows, it becomes thinner, and its capacitance rises from 15 pF and falls back.
#
# ## Change parameters
#
# Parameters have names. This is the output over the restitution r of the membrane:

# %%
restitutions = [0.3, 0.45, 0.6, 0.75, 0.9]
gains = []
for restitution in restitutions:
    run = fmpy.simulate_fmu(
        HARVESTER,
        stop_time=60.0,
        output_interval=10.0,
        start_values={**fig14, "membrane.restitution": restitution},
        output=["gain.voltage"],
    )
    gains.append((run["gain.voltage"][-1] - run["gain.voltage"][-4]) / 30)
    print(f"r = {restitution:4}: <U> = {gains[-1]:6.0f} V/s from 30 to 60 s")

# %% [markdown]
# For thousands of runs use [`videg sweep`](../sweep.md), on all cores.
#
# FMPy takes the number of an item of an enumeration, not its name; [Variables](../reference/variables.md) has both. A contact
# with a duration, `contact.law = compliant`:

# %%
compliant = fmpy.simulate_fmu(
    HARVESTER,
    stop_time=60.0,
    output_interval=10.0,
    start_values={**fig14, "contact.law": 2},
    output=["gain.voltage"],
)
print(f"compliant: <U> = {(compliant['gain.voltage'][-1] - compliant['gain.voltage'][-4]) / 30:.0f} V/s from 30 to 60 s")

# %% [markdown]
# A value out of bounds is refused, and the message gives the reason:

# %%
try:
    fmpy.simulate_fmu(HARVESTER, start_values={"membrane.restitution": 1.5}, debug_logging=False)
except Exception as error:
    print(f"{type(error).__name__}: not run")

# %% [markdown]
# ## Go step by step
#
# `simulate_fmu` hides the calls. A master of your own makes them one by one. This class maps names to value references:

# %%
import tempfile

from fmpy.fmi2 import FMU2Slave


class FMU2Named(FMU2Slave):
    """A slave whose variables go by their names."""

    def __init__(self, file, start_values):
        description = fmpy.read_model_description(file)
        self.folder = tempfile.TemporaryDirectory()
        super().__init__(
            guid=description.guid,
            unzipDirectory=fmpy.extract(file, self.folder.name),
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName=description.modelName,
        )
        self.references = {variable.name: variable.valueReference for variable in description.modelVariables}
        self.instantiate()
        self.setupExperiment(startTime=0.0)
        self.set(start_values)
        self.enterInitializationMode()
        self.exitInitializationMode()

    def set(self, values):
        self.setReal([self.references[name] for name in values], list(values.values()))

    def get(self, *names):
        return np.array(self.getReal([self.references[name] for name in names]))


slave = FMU2Named(HARVESTER, fig14)
slave.doStep(0.0, 3.0)
for name in ("ball.position", "impact.lastVelocity", "impact.nextTime", "pulse.nextKnot"):
    print(f"{name:19} {slave.get(name)[0]:.6f}")

# %% [markdown]
# `impact.nextTime` is the time of the next impact, `pulse.nextKnot` that of the next kink or peak of C(t), or of the release of a resting ball. They follow
# the inputs as soon as these are set, and look ahead as far as `pulse.knownUntil`: one period of the excitation, or less. A master that sets its inputs,
# steps to these times and never beyond `pulse.knownUntil` has every impact, peak and release at the end of a step. With phase noise that is 512 hold
# intervals ahead, or only the end of the present one; the description of [`impact.nextTime`](../reference/variables.md) has the rule.
#
# ## Go back in time
#
# The complete state can be saved and restored. A master can therefore try a step and undo it:

# %%
state = slave.getFMUstate()
before = slave.get("ball.position", "left.capacitance", "gain.voltage")
slave.doStep(3.0, 20.0)
later = slave.get("ball.position", "left.capacitance", "gain.voltage")

slave.setFMUstate(state)
print("back to the same bits:   ", np.array_equal(slave.get("ball.position", "left.capacitance", "gain.voltage"), before))
times = np.linspace(3.0, 23.0, 201)
for now, then in zip(times, times[1:]):
    slave.doStep(now, then - now)
print("and on to the same bits: ", np.array_equal(slave.get("ball.position", "left.capacitance", "gain.voltage"), later))

# %% [markdown]
# `serializeFMUstate` converts a state to bytes. A process on another machine can go on from them.
#
# ## Get derivatives
#
# Directional derivatives tell how the outputs at the end of a step depend on the force during it. With the law and mount of the paper they are exact, also through impacts ([others](../theory/motion.md#derivatives)).
# This step of 0.15 s begins before an impact and ends while the membrane is pressed in. The difference of two runs confirms the result:

# %%
step, force = 0.15, 1e-6
outputs = ["ball.position", "ball.velocity", "left.capacitance", "right.capacitance"]


def run_with(push):
    slave.setFMUstate(state)
    slave.set({"externalForce": push})
    slave.doStep(3.0, step)
    return slave.get(*outputs)


difference = (run_with(force) - run_with(-force)) / (2 * force)
run_with(0.0)
exact = slave.getDirectionalDerivative(
    vUnknown_ref=[slave.references[name] for name in outputs],
    vKnown_ref=[slave.references["externalForce"]],
    dvKnown=[1.0],
)
for name, unit, by_fmu, by_difference in zip(outputs, ["m/N", "m/(s N)", "F/N", "F/N"], exact, difference):
    print(f"d {name:17} / dF: {by_fmu:.5e} {unit}, by difference {by_difference:.5e} {unit}")
slave.freeFMUstate(state)
slave.terminate()
slave.freeInstance()

# %% [markdown]
# ## Couple it with the circuit
#
# The second FMU is the circuit of the paper's Fig. 8(a). This is a Gauss-Seidel master. The harvester steps first, to the next point
# of the grid or the next kink of C(t), whichever comes first. Then the circuit steps, with C(t) linear between both ends of the
# step, as a value and a rate.

# %%
CAPACITANCES = ["left.capacitance", "right.capacitance"]
BOOKS = ["supply.energy", "load.energy", "zener.energy", "converted.energy"]

harvester = FMU2Named(HARVESTER, fig14)
circuit = FMU2Named(fmu("HarvestingCircuit"), dict(zip(CAPACITANCES, harvester.get(*CAPACITANCES))))
rates = [circuit.references[name] for name in CAPACITANCES]

time, end, grid = 0.0, 20.0, 1e-3
rows = []
start = harvester.get(*CAPACITANCES)
while time < end - 1e-9:
    regular = (np.floor(time / grid + 1e-6) + 1) * grid
    knot = max(harvester.get("pulse.nextKnot")[0], time + 1e-3 * grid)
    to = min(regular, knot, end)
    step = to - time
    harvester.doStep(time, step)
    stop = harvester.get(*CAPACITANCES)
    circuit.set(dict(zip(CAPACITANCES, start)))
    circuit.setRealInputDerivatives(rates, [1, 1], list((stop - start) / step))
    circuit.doStep(time, step)
    time, start = to, stop
    rows.append([time, *circuit.get("left.voltage", *BOOKS)])

times, voltage, *books = np.array(rows).T
for name, values in zip(BOOKS, books):
    print(f"{name:17} {1e3 * values[-1]:7.4f} mJ after {end:.0f} s")

# %% [markdown]
# The tool does the same in one call, with the same result:

# %%
import json
import subprocess

if videg := find():
    run = subprocess.run([videg, "cosim", "--until", "20", "--json"], stdout=subprocess.PIPE, check=True)
    energy = json.loads(run.stdout)["energy"]
    print({name: round(1e3 * energy[name], 4) for name in ("supply", "load", "zener", "converted")})

# %% [markdown]
# The load gets less than the supply gives: the Zener diode burns the energy that the paper's Eq. (13) counts as gain.
# [Circuit and energy](../theory/circuit.md) explains this and shows circuits that gain.

# %%
last = times >= 18.0
figure, (top, bottom) = plt.subplots(2, sharex=True, figsize=(8, 5), layout="constrained")
top.plot(times[last], 1e-3 * voltage[last], color="tab:gray")
top.set_ylabel("voltage (kV)")
for name, values, style in zip(BOOKS, books, ("-", "-", "--", "-")):
    bottom.plot(times[last], 1e3 * (values[last] - values[last][0]), style, label=name)
bottom.set_ylabel("energy since 18 s (mJ)")
bottom.set_xlabel("time (s)")
bottom.legend()
figure.savefig(figures / "energy.svg")
for instance in (harvester, circuit):
    instance.terminate()
    instance.freeInstance()

# %% [markdown]
# [The harvester in your own system](system.md) uses harvester and circuit in other masters: C, HELICS, system packages.
