"""When to communicate, to the last bit as `videg cosim` does (run/src/cosim/schedule.rs)."""

import math

from tool import Problem

CLOSEST = 1e-3
"""Shortest step, in units of the regular one: closer to a communication point no knot is landed on."""

SHORTEST = 2e-6
"""HELICS counts nanoseconds, and two communication points may lie as close as a thousandth of a step, s."""


class Schedule:
    """A grid of `step`, s, up to `until`, s, with the edges of the window that `videg cosim` averages over by default,
    and the knots of C(t)."""

    def __init__(self, step: float, until: float):
        if not (math.isfinite(until) and until > 0.0):
            raise Problem(f"--until {until} s: must be positive")
        if not SHORTEST <= step <= until:
            raise Problem(
                f"--step {step} s: must lie from {SHORTEST} s (HELICS counts nanoseconds) to --until = {until} s"
            )
        self.step, self.until = step, until
        self.window = (50.0, 100.0) if until >= 100.0 else (until / 2.0, until)
        self.closest = CLOSEST * step

    def next(self, now: float, knot: float = math.inf) -> float:
        """The communication point after `now`, s, if a capacitance has a kink or an extremum at `knot`, s."""
        target = (math.floor((now + self.closest) / self.step) + 1.0) * self.step
        target = min(target, self.until, *(edge for edge in self.window if edge > now + self.closest))
        if self.until - target < self.closest:
            target = self.until
        landing = max(knot, now + self.closest)
        return landing if landing < target - self.closest else target
