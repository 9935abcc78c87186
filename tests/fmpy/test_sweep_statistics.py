"""statistics.csv against NumPy and SciPy, and how often its intervals contain the mean of all runs."""

import csv
import math
import random
import subprocess
from pathlib import Path

import numpy as np
import pytest
from scipy import optimize, stats

import harness

NOISE = ["--set", "excitation.phaseNoise=0.5", "--set", "excitation.noiseHold=1e-3"]
RESULTS = ["average_voltage_gain", "average_power_eq13", "impacts", "ball.velocity"]


def sweep(folder: Path, *arguments: str) -> None:
    command = [*harness.VIDEG, "sweep", *arguments, "--record", "ball.velocity", "--output", str(folder)]
    subprocess.run(command, cwd=harness.ROOT, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def table(path: Path) -> list[dict[str, str]]:
    with open(path) as file:
        return list(csv.DictReader(file))


def interval(values: np.ndarray, confidence: float) -> tuple[float, float]:
    """Ends of Hall's interval: where his transformation of Student's t is the quantile of that, found by a search."""
    n, mean, deviation = len(values), values.mean(), values.std(ddof=1)
    if deviation == 0:
        return mean, mean
    skewness = stats.skew(values, bias=False) if n > 2 else 0.0
    quantile = stats.t.ppf(0.5 + confidence / 2, n - 1)

    def transformed(t: float) -> float:
        root = math.sqrt(n)
        return t + skewness * t**2 / (3 * root) + skewness**2 * t**3 / (27 * n) + skewness / (6 * root)

    def t(value: float) -> float:
        return optimize.brentq(lambda t: transformed(t) - value, -1e6, 1e6, xtol=1e-13, rtol=1e-14)

    error = deviation / math.sqrt(n)
    return mean - t(quantile) * error, mean - t(-quantile) * error


def spoil(line: str, rng: random.Random, columns: list[str]) -> str:
    """A line of results whose run has failed, or which has a value that is no number."""
    cells = line.split(",")
    first = columns.index(RESULTS[0])
    if rng.random() < 0.5:
        return ",".join(cells[:first] + [""] * len(RESULTS) + ["took too long"])
    cells[columns.index("ball.velocity")] = rng.choice(["NaN", "inf"])
    return ",".join(cells)


@pytest.mark.parametrize("seed", range(8))
def test_random_shapes_with_failures_and_values_that_are_no_numbers(seed, tmp_path):
    rng = random.Random(seed)
    points, samples = rng.randint(1, 4), rng.choice([2, 3, 4, 7, 20, 50])
    confidence = rng.choice([0.5, 0.9, 0.95, 0.999])
    values = ",".join(str(round(rng.uniform(0.3, 0.9), 3)) for _ in range(points))
    what = ["--until", "2", "--vary", f"membrane.restitution={values}", *NOISE]
    what += ["--samples", str(samples), "--confidence", str(confidence)]
    whole, spoilt = tmp_path / "whole", tmp_path / "spoilt"
    sweep(whole, *what)
    lines = (whole / "sweep.csv").read_text().splitlines()
    columns = lines[0].split(",")
    # All but the last run, which is made again; the one before it must be as it was.
    kept = [spoil(line, rng, columns) if rng.random() < 0.3 else line for line in lines[1:-2]]
    spoilt.mkdir()
    (spoilt / "sweep.json").write_bytes((whole / "sweep.json").read_bytes())
    (spoilt / "sweep.csv.part").write_text("\n".join([lines[0], *kept, lines[-2]]) + "\n")
    sweep(spoilt, *what)
    runs = table(spoilt / "sweep.csv")
    found = table(spoilt / "statistics.csv")
    assert len(found) == points
    for point, row in enumerate(found):
        own = [run for run in runs if run["point"] == str(point)]
        good = [run for run in own if not run["error"]]
        assert (int(row["succeeded"]), int(row["failed"])) == (len(good), len(own) - len(good))
        assert row["membrane.restitution"] == own[0]["membrane.restitution"]
        for name in RESULTS:
            compare(row, name, np.array([float(run[name]) for run in good]), confidence)


def compare(row: dict[str, str], name: str, values: np.ndarray, confidence: float) -> None:
    of = ["mean", "low", "high", "deviation", "q05", "q50", "q95"]
    cells = [row[f"{name}.{it}"] for it in of]
    if len(values) == 0:
        assert cells == [""] * 7
        return
    if not np.isfinite(values).all():
        assert all(not math.isfinite(float(cell)) for cell in cells if cell)
        return
    quantiles = [float(it) for it in np.quantile(values, [0.05, 0.5, 0.95])]
    if len(values) == 1:
        assert cells[1:4] == ["", "", ""]
        assert [float(cells[0]), *map(float, cells[4:])] == pytest.approx([values[0], *quantiles], rel=1e-12)
        return
    low, high = interval(values, confidence)
    # Differences of close numbers: to some bits of the largest of them.
    scale = np.abs(values).max()
    expected = [values.mean(), low, high, values.std(ddof=1), *quantiles]
    assert [float(cell) for cell in cells] == pytest.approx(expected, rel=1e-9, abs=1e-9 * scale)


@pytest.mark.parametrize("noise", ["0.7071", "3.1623"])
def test_intervals_contain_the_mean_of_all_runs_as_often_as_they_say(noise, tmp_path):
    """Of D = 0.5 and D = 10 as in Fig. 17: 200 times 20 and 50 samples of 500 runs, and as many as a precision takes."""
    what = ["--set", "membrane.restitution=1", "--set", "excitation.amplitude=2.1626", "--samples", "500", "--until", "20"]
    what += ["--set", f"excitation.phaseNoise={noise}", "--set", "excitation.noiseHold=1e-4"]
    sweep(tmp_path, *what)
    values = np.array([float(run["average_voltage_gain"]) for run in table(tmp_path / "sweep.csv")])
    rng = np.random.default_rng(1)

    def hit(drawn: np.ndarray) -> bool:
        low, high = interval(drawn, 0.95)
        return low <= values.mean() <= high

    def adaptive(precision: float) -> np.ndarray:
        drawn = rng.choice(values, 10_000)
        count = 50
        while count < len(drawn):
            low, high = interval(drawn[:count], 0.95)
            if 0.5 * (high - low) <= precision * abs(drawn[:count].mean()):
                break
            count = -(-count * 3 // 2)
        return drawn[:count]

    for samples in (20, 50):
        hits = sum(hit(rng.choice(values, samples)) for _ in range(200))
        assert 180 <= hits <= 198, f"{samples} samples: {hits} of 200"
    for precision in (0.1, 0.2):
        hits = sum(hit(adaptive(precision)) for _ in range(200))
        assert 180 <= hits <= 198, f"until {precision}: {hits} of 200"
