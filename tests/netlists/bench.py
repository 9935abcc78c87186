"""A netlist of `ngspice_netlists/circuits` in ngspice, with membranes whose capacitances are triangles over the time."""

import subprocess
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from harness import ROOT

CIRCUITS = ROOT / "ngspice_netlists" / "circuits"

TIMEOUT = 60
"""Longest run of ngspice, s."""

OPTIONS = "gmin=1e-20 abstol=1e-11 vntol=1e-6 chgtol=6e-8 reltol=1e-8 trtol=1 method=gear"
"""What videg sets where a netlist does not."""


@dataclass(frozen=True)
class Pulses:
    """C(t) of a membrane, F and s: `rest` but for triangles up to `peaks[k]` that begin at `starts[k]`."""

    rest: float
    peaks: tuple[float, ...] = ()
    starts: tuple[float, ...] = ()
    rise: float = 5e-3
    fall: float = 5e-3

    def corners(self) -> list[tuple[float, float]]:
        points = [(0.0, self.rest)]
        for start, peak in zip(self.starts, self.peaks, strict=True):
            points += [(start, self.rest), (start + self.rise, peak), (start + self.rise + self.fall, self.rest)]
        return points

    def ends(self) -> np.ndarray:
        return np.array(self.starts) + self.rise + self.fall

    def subcircuit(self, name: str) -> str:
        points = "\n".join(f"+ {time:.17g} {1e12 * capacitance:.17g}" for time, capacitance in self.corners())
        return (
            f".subckt {name} p n\nVc c 0 PWL(\n{points}\n+ )\nCfix p n {self.rest:.17g}\n"
            f"Cvar p n Q='(V(c)-{1e12 * self.rest:.17g})*1e-12*V(p,n)'\n.ends\n"
        )


@dataclass
class Waveforms:
    """Vectors of ngspice over the time points that it chose."""

    values: dict[str, np.ndarray]

    def at(self, name: str, times) -> np.ndarray:
        """A voltage or current at `times`, s."""
        return np.interp(times, self.values["time"], self.values[name])

    def integral(self, *names: str, start=0.0, end=np.inf) -> float:
        """Integral of the product of vectors, by the trapezoidal rule."""
        time = self.values["time"]
        chosen = (time >= start) & (time <= end)
        return float(np.trapezoid(np.prod([self.values[name][chosen] for name in names], axis=0), time[chosen]))


@dataclass
class Bench:
    """A netlist with other values of some elements."""

    name: str
    changes: dict[str, str] = field(default_factory=dict)

    def netlist(self) -> str:
        """The netlist; a change replaces the line of the element, or of the model or command, that begins with its key."""
        lines = (CIRCUITS / f"{self.name}.cir").read_text().splitlines()
        for start, line in self.changes.items():
            (index,) = [k for k, old in enumerate(lines) if old.startswith(start + " ")]
            lines[index] = line
        return "\n".join(lines)

    def run(self, folder: Path, left: Pulses, right: Pulses, until: float, saved: str, step: float = 1e-3) -> Waveforms:
        body, end, _ = self.netlist().rpartition(".end")
        assert end, "a netlist ends with .end"
        deck = (
            f"{body}{left.subcircuit('deg_left')}{right.subcircuit('deg_right')}.options {OPTIONS}\n"
            f".save {saved}\n.tran {step:.17g} {until:.17g} 0 {step:.17g} uic\n.end\n"
        )
        (folder / "deck.cir").write_text(deck)
        command = ["ngspice", "-n", "-b", "-r", "deck.raw", "deck.cir"]
        ended = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=TIMEOUT)
        messages = ended.stdout + ended.stderr
        faults = [line for line in messages.splitlines() if any(word in line.lower() for word in ("warning", "error", "abort", "singular"))]
        assert ended.returncode == 0 and not faults, messages
        found = read_raw(folder / "deck.raw")
        assert found["time"][-1] >= until * (1 - 1e-9), messages
        return Waveforms(found)


def read_raw(path: Path) -> dict[str, np.ndarray]:
    """Vectors of a binary file of ngspice: a header of text, then doubles, point by point."""
    header, _, data = path.read_bytes().partition(b"Binary:\n")
    lines = header.decode().splitlines()
    count = int(next(line for line in lines if line.startswith("No. Variables:")).split(":")[1])
    first = lines.index("Variables:") + 1
    names = [line.split()[1] for line in lines[first : first + count]]
    table = np.frombuffer(data, dtype="<f8").reshape(-1, count)
    return {name: table[:, column] for column, name in enumerate(names)}
