# %% [markdown]
# # First steps: C(t) of three restitutions
#
# The harvester of Fig. 14 with membranes that give back more or less of the ball's speed. Quantities are in SI units.

# %%
import matplotlib.pyplot as plt
import videg

runs = {r: videg.simulate("fig14", set={"membrane.restitution": r}) for r in (0.3, 0.6, 0.9)}
for r, run in runs.items():
    print(f"r = {r}: {run.impacts} impacts in 100 s, <U> = {run.average_voltage_gain:.1f} V/s")

# %% [markdown]
# A run is a mapping from names of variables to arrays of numpy. These are the last two periods of the excitation.

# %%
figure, axes = plt.subplots(3, 1, sharex=True, sharey=True, figsize=(7, 5), layout="constrained")
for axis, (r, run) in zip(axes, runs.items(), strict=True):
    shown = run.time >= 99.0
    for side, colour in (("left", "#1b6ca8"), ("right", "#c0504d")):
        axis.plot(run.time[shown], 1e12 * run[f"{side}.capacitance"][shown], color=colour, label=side)
    axis.set_title(f"r = {r}", loc="left", fontsize="medium")
    axis.set_ylabel("C, pF")
axes[0].legend(ncols=2, loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.0, frameon=False)
axes[-1].set_xlabel("time, s")
figure.savefig("first_steps.svg")

# %% [markdown]
# With a circuit: the net power is what a user gains. The circuit of the paper loses; isolated membranes and a switch at 2450 V gain.

# %%
paper = videg.cosim("fig14")
better = videg.cosim("fig14", set={"topology": "isolated", "release": "switch", "zener.voltage": 2450.0})
print(f"net power: {1e6 * paper.net_power:.1f} uW with the circuit of the paper, {1e6 * better.net_power:.1f} uW with a switch")
