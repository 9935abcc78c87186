# Made from docs/tutorial/ngspice.md by `UPDATE_BOOK=1 cargo test --test book`; run in the root of the source tree.

# %%
import sys

sys.path.append("examples")

# %% [markdown]
# # C(t) in ngspice
#
# You use the capacitances of the harvester in a circuit of your own in ngspice, compute its gain, and compare it with the
# embedded solver. You need ngspice (Debian: `apt install ngspice libngspice0`) and, for the sweep at the end, Python with
# `matplotlib`. `examples/ngspice_coupling.py` is the same as a script with cells. Run either in the root of the source tree, with `videg` on
# the PATH (`export PATH=$PWD/target/release:$PATH`).
#
# Under the paper's contact law the circuit does not act on the mechanics. So C(t) can be computed once, and circuits later, as often
# as you like.
#
# `videg export` writes C(t) as subcircuits that ngspice includes ([Export C(t)](../howto/export.md)); `videg cosim --netlist` runs your netlist in step
# with the harvester ([Run a netlist of your own](../howto/netlist.md)). This page shows what is behind both, by hand.
#
# ## Get C(t)

# %%
from find_videg import run

run("videg simulate --case fig14 --until 10 --output out/ngspice")

# %% [markdown]
# The time series has the columns `left.capacitance` and `right.capacitance` in F, a row each millisecond and at each kink and peak
# ([time series](../reference/files.md#time-series)).
# ngspice reads tables of numbers, here in pF, so that 1 V stands for 1 pF:

# %%
import csv
from pathlib import Path

with open("out/ngspice/timeseries.csv", newline="") as file:
    rows = [[float(row[name]) for name in ("time", "left.capacitance", "right.capacitance")] for row in csv.DictReader(file)]
with open("out/ngspice/capacitance.tab", "w") as table:
    for time, left, right in rows:
        table.write(f"{time!r} {1e12 * left!r} {1e12 * right!r}\n")
rest = sum(rows[0][1:])
print(f"{len(rows)} rows; both membranes at rest: {1e12 * rest:.6f} pF")

# %% [markdown]
# ## A circuit of your own
#
# Here the membranes lie between a supply of 2 kV and a storage at 2.2 kV, with a diode on either side
# ([schematic](../theory/circuit.md)). Save this as `out/ngspice/own.cir`:

# %%
from pathlib import Path

Path("out/ngspice/own.cir").parent.mkdir(parents=True, exist_ok=True)
Path("out/ngspice/own.cir").write_text(r"""* Supply, diode, both membranes, diode, storage
* Voltages in V; capacitance of one membrane at 0 s in pF, half of what the script printed.
.param supply=2000 storage=2200 rest=15.0147674

Vin in 0 {supply}
Vs in anode 0
Dcharge anode de diode

* C(t): time in s, left and right capacitance in pF, linear between the rows; 1 V = 1 pF.
Atable %v([cl cr]) table
.model table filesource (file="capacitance.tab" amploffset=[0 0] amplscale=[1 1])

* The capacitance at 0 s as a capacitor, the rest of C(t) as a charge. C='...' would be wrong: ngspice makes
* I = C dV/dt of it and loses V dC/dt.
Cfix de 0 {2*rest*1e-12}
Cvar de 0 Q='(V(cl)+V(cr)-2*rest)*1e-12*V(de)'

Vr de out_anode 0
Dstorage out_anode out diode
Vstorage out 0 {storage}

.model diode D(IS=1e-13 N=1 RS=0 CJO=0)
.ic v(in)={supply} v(anode)={supply} v(de)={supply} v(out)={storage} v(cl)={rest} v(cr)={rest}
.options gmin=1e-20 abstol=1e-11 vntol=1e-6 chgtol=1e-13 reltol=1e-7 method=trap

.control
tran 1e-4 10 0 1e-4 uic
meas tran q_supply integ i(vs) from=0 to=10
meas tran q_storage integ i(vr) from=0 to=10
let from_supply = v(in)[0]*q_supply
let to_storage = v(out)[0]*q_storage
print from_supply to_storage
quit
.endc
.end
""")

# %% [markdown]
# Set another membrane or other voltages in the line `.param`. The options matter at 2 kV:
#
# - `gmin` at its default of 1e-12 would leak 2 nA, some percent of the harvested current.
# - `reltol` times 2 kV must stay well below N Vt (26 mV for `N=1`), over which the current of a diode changes by e. Above that Newton's
#   iteration stops at false solutions without a message: with `N=0.01` and `reltol=1e-5` the gain at 2050 V is off by 15 %. A run with
#   a tenth of `reltol` must give the same result.
# - A diode with `N=1` takes about 0.3 V of the 2 kV. A more ideal diode needs a smaller `reltol`, and then a larger `chgtol`: otherwise
#   no step across a corner of C(t) is short enough, and ngspice ends with "Timestep too small" and exit code 0. `N=0.01`,
#   `reltol=1e-8`, `method=gear` and `chgtol=6e-8`, the charge of the membranes, give 1.76425e-03 and 1.89513e-03.
#
# `ngspice_netlists/README.md` in the source tree describes the options of videg's own netlists.

# %%
from find_videg import run

run("cd out/ngspice && ngspice -b own.cir 2>/dev/null | grep \"^from\\|^to\"")

# %% [markdown]
# The storage gets more than the supply gives. The difference comes from the mechanics.
#
# ## The same from videg

# %%
from find_videg import run

run("videg cosim --until 10 --set release=storage --set storage.voltage=2200 --json | grep -m 1 -A 2 '\"energy\"'")

# %% [markdown]
# `supply` and `load` (the storage) agree with the two numbers of ngspice, in J, to 0.1 %. Their difference, the gain, is a tenth of
# either: 0.1307 mJ in ngspice and 0.1309 mJ here, 0.1 % apart. videg also runs ngspice as a shared library that steps together with
# the harvester. A circuit that acts on the ball needs this:

# %%
from find_videg import run

run("videg cosim --circuit ngspice --until 10 --set release=storage --set storage.voltage=2200 --json | grep -m 1 -A 2 '\"energy\"'")

# %% [markdown]
# `videg crosscheck` compares closed forms, embedded solver, ngspice as a program and ngspice as a library, claim by claim
# ([Cross-check with ngspice](../results/crosscheck.md)). With `--export` it writes a folder for a user who has only ngspice: netlists, C(t) and
# expected values.

# %%
from find_videg import run

run("videg crosscheck --until 10 --export out/for-ngspice >/dev/null && ls out/for-ngspice")

# %% [markdown]
# ## The best storage voltage
#
# A quick release gains (C3 U_in - C2 U_out)(U_out - U_in), with C2 + C2 for C2 and C3 + C2 for C3 on one node, as here. So there is a best
# voltage between U_in and the peak at constant charge ([Circuit and energy](../theory/circuit.md#which-voltage)). The script computes the gain in
# ngspice, and in videg with the diodes of the netlist and with ideal diodes:

# %%
import json
import os
import subprocess

import matplotlib.pyplot as plt

figures = Path(os.environ.get("FIGURES", "out/ngspice"))
figures.mkdir(parents=True, exist_ok=True)
netlist = Path("out/ngspice/own.cir").read_text()
NETLIST_DIODES = ["--set", "diode.model=exponential", "--set", "diode.emissionCoefficient=1"]


def by_ngspice(voltage):
    Path("out/ngspice/sweep.cir").write_text(netlist.replace("storage=2200", f"storage={voltage}"))
    run = subprocess.run(["ngspice", "-b", "sweep.cir"], cwd="out/ngspice", capture_output=True, text=True, check=True)
    value = {words[0]: float(words[2]) for words in map(str.split, run.stdout.splitlines()) if words[1:2] == ["="]}
    return 1e3 * (value["to_storage"] - value["from_supply"])


def by_videg(voltage, *options):
    command = ["videg", "cosim", "--until", "10", "--json", "--set", "release=storage", "--set", f"storage.voltage={voltage}"]
    run = subprocess.run([*command, *options], capture_output=True, text=True, check=True)
    return 1e3 * json.loads(run.stdout)["energy"]["surplus"]


voltages, gains = [2050, 2200, 2350, 2500, 2650, 2800], []
print("gain in 10 s, mJ    ngspice   videg, same diodes   videg, ideal diodes")
for voltage in voltages:
    gain, same, ideal = by_ngspice(voltage), by_videg(voltage, *NETLIST_DIODES), by_videg(voltage)
    assert abs(gain - same) < 2e-3 * same, f"at {voltage} V ngspice has not converged, or has stopped before the end"
    gains.append(gain)
    print(f"storage at {voltage} V  {gain:8.5f}   {same:18.5f}   {ideal:19.5f}")

# %% [markdown]
# ngspice and videg agree to 0.1 % with the same diodes. The last column shows the effect of the diodes.

# %%
figure, axes = plt.subplots(figsize=(6, 3.5), layout="constrained")
axes.plot([1e-3 * voltage for voltage in voltages], gains, "o-")
axes.axhline(0, color="tab:gray", linewidth=0.8)
axes.set_xlabel("voltage of the storage (kV)")
axes.set_ylabel("gain in 10 s (mJ)")
figure.savefig(figures / "storage.svg")

# %% [markdown]
# `videg crosscheck --sweep` draws such curves for Zener diodes, switches and storages. `videg reproduce tuning` maps voltage and load for
# the circuit of the paper and for isolated membranes with a switch.
