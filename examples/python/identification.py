# %% [markdown]
# # Identification: stiffness, exponent and restitution from a record
#
# Two kinds of records of a device are fitted: the voltages of both membranes, which keep their charge - U = U_in C_2/C(t) -, and the
# times of the impacts alone. A fit gives intervals, and says so if the record does not determine a parameter.

# %%
from collections.abc import Callable
from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy as np
import videg
from scipy.optimize import least_squares
from scipy.stats import t as student

NAMES = ("membrane.stiffness", "membrane.stiffnessExponent", "membrane.restitution")
TRUE = np.array([408470.0, 2.6, 0.6])
BIAS = 2000.0  # V
SAMPLE = 1e-3  # s

# %% [markdown]
# The stiffness K in N/m^n and the exponent n of f = K x^n belong together: with K alone the unit changes with n. So the fit takes the
# force at a deflection of 2 mm in place of K, and the logarithms of all three.

# %%
DEFLECTION = 2e-3


def to_fitted(values: np.ndarray) -> np.ndarray:
    stiffness, exponent, restitution = values
    return np.log([stiffness * DEFLECTION**exponent, exponent, restitution])


def from_fitted(fitted: np.ndarray) -> np.ndarray:
    force, exponent, restitution = np.exp(fitted)
    return np.array([force / DEFLECTION**exponent, exponent, min(restitution, 1.0)])


def voltages(values: np.ndarray, until: float) -> np.ndarray:
    """Voltages of both membranes, V, one after the other, each `SAMPLE`."""
    run = videg.simulate("fig14", until=until, sample=SAMPLE, set=dict(zip(NAMES, values, strict=True)))
    rest = run.summary["rest_capacitance"]
    return np.concatenate([BIAS * rest / run[f"{side}.capacitance"] for side in ("left", "right")])


def impact_times(values: np.ndarray, until: float) -> np.ndarray:
    """Times of the impacts, s: before each, the harvester knew its time."""
    names = ["impact.count", "impact.nextTime"]
    run = videg.simulate("fig14", until=until, sample=SAMPLE, record=names, set=dict(zip(NAMES, values, strict=True)))
    follows = np.flatnonzero(np.diff(run["impact.count"]) > 0)
    return run["impact.nextTime"][follows]


# %% [markdown]
# Motions that part at an impact go their own ways: far from the solution a long record misleads. So the fit begins with the first tenth
# of the record, and goes on from there with longer ones. Whether a parameter is determined is read off the derivatives: a direction
# of the parameters that changes the record less than the noise does, for a change by a factor of e, is not.


# %%
@dataclass
class Fit:
    values: np.ndarray
    """K, n, r."""
    low: np.ndarray
    """Lower ends of the 95 % intervals; NaN of a parameter that is not determined."""
    high: np.ndarray
    determined: np.ndarray
    noise: float
    """Standard deviation of the residuals."""

    def __str__(self) -> str:
        lines = []
        for name, value, low, high, known in zip(NAMES, self.values, self.low, self.high, self.determined, strict=True):
            said = f"{value:.5g}, 95 % from {low:.5g} to {high:.5g}" if known else "not determined by this record"
            lines.append(f"{name:28} {said}")
        return "\n".join(lines)


def fit(
    model: Callable[[np.ndarray, float], np.ndarray], record: Callable[[float], np.ndarray], guess: np.ndarray, spans: list[float]
) -> Fit:
    """Fits `model(values, until)` to `record(until)` over longer and longer spans, s."""
    at = to_fitted(guess)
    for until in spans:
        seen = record(until)

        def residuals(fitted: np.ndarray, until: float = until, seen: np.ndarray = seen) -> np.ndarray:
            found = model(from_fitted(fitted), until)
            # A trial with another number of impacts: those that both have, and a penalty for each other one.
            both = min(len(found), len(seen))
            return np.concatenate([found[:both] - seen[:both], np.full(len(seen) - both, np.ptp(seen))])

        # What the model takes, and of the force what the guess may be off.
        low, high = [at[0] - 3.0, np.log(1.0 + 1e-6), np.log(1e-3)], [at[0] + 3.0, np.log(10.0 - 1e-6), 0.0]
        result = least_squares(residuals, at, bounds=(low, high), x_scale=0.01, diff_step=1e-5, xtol=1e-10, ftol=1e-10)
        at = result.x
    freedom = len(result.fun) - len(at)
    noise = float(np.sqrt(np.sum(result.fun**2) / freedom))
    _, sizes, directions = np.linalg.svd(result.jac, full_matrices=False)
    unknown = sizes < max(noise, 1e-12 * np.abs(seen).max())
    determined = ~np.any(np.abs(directions[unknown]) > 0.01, axis=0)
    inverse = np.where(unknown, 0.0, 1.0 / np.where(unknown, 1.0, sizes))
    covariance = noise**2 * (directions.T * inverse**2) @ directions
    # Of K itself: ln K = ln force - n ln(deflection).
    exponent = np.exp(at[1])
    gradient = np.array([1.0, -exponent * np.log(DEFLECTION), 0.0])
    errors = np.sqrt(np.diag(covariance))
    errors[0] = np.sqrt(gradient @ covariance @ gradient)
    determined[0] = determined[0] and determined[1]
    width = student.ppf(0.975, freedom) * errors
    values = from_fitted(at)
    low, high = values * np.exp(-width), values * np.exp(width)
    return Fit(values, np.where(determined, low, np.nan), np.where(determined, high, np.nan), determined, noise)


# %% [markdown]
# A synthetic record with noise of 1 % of the largest change, so that the true values are known; the first guess is up to 15 % off.


# %%
def synthetic(seed: int, until: float = 2.0) -> tuple[Callable[[float], np.ndarray], np.ndarray]:
    """A record of voltages with noise, by its length, and a first guess."""
    random = np.random.default_rng(seed)
    clean = voltages(TRUE, until).reshape(2, -1)
    noisy = clean + random.normal(0.0, 0.01 * np.ptp(clean), clean.shape)
    force, exponent, restitution = np.exp(to_fitted(TRUE)) * random.uniform(0.85, 1.15, 3)
    guess = from_fitted(np.log([force, exponent, restitution]))
    return lambda span: noisy[:, : round(span / SAMPLE) + 1].ravel(), guess


def main() -> None:
    record, guess = synthetic(1)
    found = fit(voltages, record, guess, [0.3, 0.8, 2.0])
    print(f"from voltages, noise of {found.noise:.2f} V:\n{found}")

    random = np.random.default_rng(2)
    until = 2.0
    times = impact_times(TRUE, until)
    seen = times + random.normal(0.0, 1e-4, len(times))
    alone = fit(impact_times, lambda _: seen, guess, [until])
    print(f"from {len(times)} impact times:\n{alone}")

    figure, axis = plt.subplots(figsize=(7, 3), layout="constrained")
    time = SAMPLE * np.arange(round(2.0 / SAMPLE) + 1)
    shown = (time >= 0.2) & (time <= 0.6)
    axis.plot(time[shown], record(2.0)[: len(time)][shown], ".", markersize=3, color="#999999", label="record, left membrane")
    axis.plot(time[shown], voltages(found.values, 2.0)[: len(time)][shown], color="#1b6ca8", linewidth=0.9, label="fit")
    axis.set_xlabel("time, s")
    axis.set_ylabel("U, V")
    axis.legend(loc="lower left")
    figure.savefig("identification.svg")


if __name__ == "__main__":
    main()
