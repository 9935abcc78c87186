"""Writes two recordings of an excitation, which nobody has measured: their spectra stand below, and a fixed seed draws the rest.

    python examples/recordings/synthesise.py [FOLDER]

walking.csv, 10 s at 200 Hz: a harvester on the hip of a person who walks with 2 steps a second. The forces of walking have harmonics of
some 0.4, 0.1 and 0.1 of the weight at 1, 2 and 3 times that rate (Bachmann and Ammann, Vibrations in Structures, 1987), so the body
accelerates by that share of g. Each step takes 2 % more or less than half a second, and its heel strike adds half a sine of 15 ms and
8 m/s2, some 0.8 g.

machine.csv, 4 s at 1000 Hz: a vibrating screen that turns 1500 times a minute. Such screens shake with some 4 g at that frequency, 25 Hz;
at 50 Hz there is a fifth of it, and between 10 and 200 Hz a noise of 3 m/s2 (root mean square): lines 0.25 Hz apart with one amplitude
and phases drawn at random.

Both go over into themselves at their end, so they can be repeated, and have no mean, which would let the harvester run away.
"""

import math
import random
import sys
from pathlib import Path

GRAVITY = 9.80665

STEP_RATE = 2.0
STEPS = 20
WALKING_SHARES = (0.4, 0.1, 0.1)
SCATTER = 0.02
STRIKE, STRIKE_TIME = 8.0, 0.015

ROTATION = 25.0
LINES = {ROTATION: 40.0, 2 * ROTATION: 8.0}
NOISE, BAND, MACHINE_TIME = 3.0, (10.0, 200.0), 4.0


def walking(draw: random.Random) -> list[tuple[float, float]]:
    """Time, s, and acceleration, m/s2."""
    lengths = [1.0 + SCATTER * draw.uniform(-1.0, 1.0) for _ in range(STEPS)]
    duration = STEPS / STEP_RATE
    scale = duration / sum(lengths)
    begins = [scale * sum(lengths[:k]) for k in range(STEPS + 1)]
    samples = []
    for k in range(round(200 * duration) + 1):
        time = k / 200
        step = max(n for n in range(STEPS) if begins[n] <= time)
        phase = (time - begins[step]) / (begins[step + 1] - begins[step])
        value = sum(share * GRAVITY * math.cos(math.tau * (n + 1) * phase) for n, share in enumerate(WALKING_SHARES))
        since = time - begins[step] if time < duration else 0.0
        if since < STRIKE_TIME:
            value += STRIKE * math.sin(math.pi * since / STRIKE_TIME)
        samples.append((time, value))
    return samples


def machine(draw: random.Random) -> list[tuple[float, float]]:
    """Time, s, and acceleration, m/s2."""
    first, last = (round(edge * MACHINE_TIME) for edge in BAND)
    amplitude = NOISE * math.sqrt(2.0 / (last - first + 1))
    noise = [(n / MACHINE_TIME, amplitude, draw.uniform(0.0, math.tau)) for n in range(first, last + 1)]
    lines = [(frequency, size, draw.uniform(0.0, math.tau)) for frequency, size in LINES.items()]
    return [
        (k / 1000, sum(size * math.cos(math.tau * frequency * k / 1000 + phase) for frequency, size, phase in lines + noise))
        for k in range(round(1000 * MACHINE_TIME) + 1)
    ]


def write(path: Path, samples: list[tuple[float, float]]) -> None:
    # The last sample is the first one of the next repetition.
    mean = sum(value for _, value in samples[:-1]) / (len(samples) - 1)
    rows = [f"{time:g},{value - mean:.3f}\n" for time, value in samples]
    path.write_text("time,acceleration\n" + "".join(rows), encoding="utf-8")
    print(path)


if __name__ == "__main__":
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent)
    write(folder / "walking.csv", walking(random.Random(1)))
    write(folder / "machine.csv", machine(random.Random(2)))
