# %% [markdown]
# # Optimisation: the best net power within the limits of the film
#
# Gap, mass of the ball, load and release voltage of an isolated pair of membranes with a switch. Three questions: which design is best,
# what less stretch of the film costs, and which design is best if the excitation is noisy.

# %%
import matplotlib.pyplot as plt
import numpy as np
import videg
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.core.problem import Problem
from pymoo.optimize import minimize
from scipy.optimize import differential_evolution

CIRCUIT = {"topology": "isolated", "release": "switch"}
NAMES = ("cylinder.length", "ball.mass", "load.resistance", "zener.voltage")
# How much is taken of each limit of the film; above 1 it ruptures, breaks down or is slack.
LIMITS = ("area_ratio_over_limit", "field_over_limit", "stress_over_limit")


def bounds(case: str) -> list[tuple[float, float]]:
    """m, kg, the exponent of ten of Ohm, V: around the values of the case; a load is searched for on a logarithmic scale."""
    values = videg.start_values(case)
    length, mass, supply = (values[name].value for name in ("cylinder.length", "ball.mass", "biasVoltage"))
    return [(0.85 * length, 1.4 * length), (0.6 * mass, 1.7 * mass), (8.0, 12.0), (supply, 2.0 * supply)]


def evaluate(designs: np.ndarray, case: str, **options) -> videg.Evaluation:
    """`designs`, shape (designs, 4), on all cores."""
    columns = [*designs.T[:2], 10.0 ** designs.T[2], designs.T[3]]
    settings = CIRCUIT | options.pop("set", {})
    return videg.evaluate(dict(zip(NAMES, columns, strict=True)), case, set=settings, record=("net_power", *LIMITS), **options)


def objective(designs: np.ndarray, case: str, **options) -> np.ndarray:
    """What is minimised, W, shape (designs,): the mean loss over the samples; beyond a limit it grows with the excess."""
    found = evaluate(designs, case, **options)
    excess = sum(np.fmax(found[limit] - 1.0, 0.0) for limit in LIMITS)
    loss = np.where(excess > 0.0, 1.0 + excess, -found["net_power"])
    loss = np.where(np.isnan(loss), 10.0, loss)
    return loss if loss.ndim == 1 else loss.mean(axis=1)


# %% [markdown]
# ## The best design
#
# `vectorized` hands a whole generation over at once. The landscape is rugged, since small changes lead to other motions; so the
# population is large, and no gradients are used to polish.


# %%
def best(case: str, seed: int = 1, size: int = 30, generations: int = 120, **options) -> tuple[np.ndarray, float]:
    """The best design and its objective."""
    result = differential_evolution(
        lambda columns: objective(columns.T, case, **options),
        bounds(case),
        popsize=size,
        maxiter=generations,
        mutation=(0.4, 0.9),
        recombination=0.8,
        tol=1e-6,
        polish=False,
        updating="deferred",
        vectorized=True,
        init="sobol",
        rng=seed,
    )
    return result.x, float(result.fun)


def described(design: np.ndarray) -> str:
    length, mass, load, voltage = design
    return f"length {1e3 * length:.2f} mm, ball {1e3 * mass:.2f} g, load {10**load:.2g} Ohm, release at {voltage:.0f} V"


# %% [markdown]
# ## Power against stretch
#
# The less the film is stretched, the longer it lives. NSGA-II finds designs of which none is better in both.


# %%
class PowerAndStretch(Problem):
    def __init__(self, case: str) -> None:
        low, high = np.transpose(bounds(case))
        super().__init__(n_var=4, n_obj=2, n_ieq_constr=len(LIMITS), xl=low, xu=high)
        self.case = case

    def _evaluate(self, designs, out, *_arguments, **_options) -> None:
        found = evaluate(designs, self.case)
        out["F"] = np.column_stack([-found["net_power"], found["area_ratio_over_limit"]])
        out["G"] = np.column_stack([found[limit] - 1.0 for limit in LIMITS])


def main() -> None:
    design, loss = best("fig14")
    print(f"best: net power {-1e6 * loss:.1f} uW\n  {described(design)}")

    front = minimize(PowerAndStretch("fig14"), NSGA2(pop_size=60), ("n_gen", 60), seed=1)
    order = np.argsort(front.F[:, 1])
    power, stretch = -1e6 * front.F[order, 0], front.F[order, 1]
    half = power[np.searchsorted(stretch, 0.5 * (stretch[0] + stretch[-1]))]
    print(f"{len(power)} designs from {power[0]:.1f} to {power[-1]:.1f} uW; {half:.1f} uW at half of the way in stretch")

    # Under phase noise each design runs with the same eight records of noise (common random numbers), so that differences are those of
    # the designs.
    noisy = {"samples": 8, "set": {"excitation.phaseNoise": 1.0, "excitation.noiseHold": 1e-3}}
    quiet = -objective(design[None], "fig14", **noisy)[0]
    robust, loss = best("fig14", size=8, generations=20, **noisy)
    print(f"under noise: the design above gives {1e6 * quiet:.1f} uW, the best one {-1e6 * loss:.1f} uW\n  {described(robust)}")

    figure, axis = plt.subplots(figsize=(7, 3), layout="constrained")
    axis.plot(100 * stretch, power, ".", color="#1b6ca8")
    axis.set_xlabel("largest area ratio, % of that at rupture")
    axis.set_ylabel("net power, uW")
    figure.savefig("optimisation.svg")


if __name__ == "__main__":
    main()
