"""How the energy that the mechanics give converges with the communication step, fixed and adaptive."""

import math
from dataclasses import dataclass

import harness

SECONDS = 5
STEPS = ("4e-3", "2e-3", "1e-3", "5e-4", "2.5e-4", "1.25e-4")
TOLERANCES = ("1e-2", "1e-3", "1e-4", "1e-5")
REFERENCE = "1e-5"
MASTERS = ("gauss-seidel", "jacobi", "plain")
ADAPTIVE = ("gauss-seidel", "jacobi")


@dataclass
class Run:
    option: str
    steps: int
    error: float
    """Relative, signed."""
    residual: float
    """Of the coupling, relative to the energy moved, signed."""


Runs = dict[str, list[Run]]


def cosim(*arguments: str) -> dict:
    folder = str(harness.ROOT / "target" / "coupling")
    return harness.videg("cosim", "--until", str(SECONDS), "--output", folder, "--fresh", *arguments)


def run(exact: float, option: str, *arguments: str) -> Run:
    result = cosim(*arguments)
    coupling = result["coupling"]
    error = result["energy"]["converted"] / exact - 1.0
    residual = math.copysign(coupling["relative_residual"], coupling["residual"])
    return Run(option, coupling["steps"] + coupling["rejected"], error, residual)


def measure() -> tuple[Runs, Runs]:
    """Runs with fixed and with adaptive steps, by master."""
    exact = cosim("--step", REFERENCE)["energy"]["converted"]
    fixed = {it: [run(exact, step, "--master", it, "--step", step) for step in STEPS] for it in MASTERS}
    adaptive = {
        it: [run(exact, tolerance, "--master", it, "--adaptive", tolerance) for tolerance in TOLERANCES]
        for it in ADAPTIVE
    }
    return fixed, adaptive


TEXT = """
## Convergence

The error is that of the energy from the mechanics in {seconds} s (`energy.converted`), relative to Gauss-Seidel with steps of {reference} s.
The residual is the work -1/2 U^2 dC as computed by the circuit less that of the harvester, relative to all energy
moved. Steps include those undone. With short steps, Gauss-Seidel and Jacobi are of second order in both, plain is of first
order (`cargo test --test masters` compares finer steps). The table has errors and residuals without sign. Where the
sign changes, a value is small by chance, and the next one may be larger:

{changes}

![Error of the converted energy over the number of steps]({figure})

| master | step, s | steps | error | residual |
|---|---|---|---|---|
{fixed}
The adaptive step is chosen by the error of C(t) within it, which is estimated from dC/dt at both ends. Steps end at impacts and peaks. The
last column has the number of fixed steps that the same master needs for this error, from a line through its last two
rows above.

| master | tolerance | steps | error | residual | fixed steps for this error |
|---|---|---|---|---|---|
{adaptive}"""


def fixed_steps(error: float, runs: list[Run]) -> float:
    """Number of fixed steps with this error, by the slope of the last two runs."""
    first, last = runs[-2:]
    order = math.log(first.error / last.error) / math.log(last.steps / first.steps)
    return last.steps * abs(last.error / error) ** (1.0 / order)


def changes(fixed: Runs) -> str:
    """A list of where the sign changes from one fixed step to the next."""
    found = [
        f"- {master}: {what}, between {before.option} and {after.option} s"
        for master, runs in fixed.items()
        for what in ("error", "residual")
        for before, after in zip(runs, runs[1:])
        if getattr(before, what) * getattr(after, what) < 0.0
    ]
    return "\n".join(found) if found else "- nowhere"


def two_digits(number: float) -> str:
    return f"{float(f'{number:.1e}'):.0f}"


def row(master: str, found: Run, *more: str) -> str:
    cells = [master, found.option, str(found.steps), f"{abs(found.error):.1e}", f"{abs(found.residual):.1e}", *more]
    return f"| {' | '.join(cells)} |\n"


def section(fixed: Runs, adaptive: Runs, figure: str) -> str:
    of_fixed = "".join(row(master, found) for master, runs in fixed.items() for found in runs)
    of_adaptive = "".join(
        row(master, found, two_digits(fixed_steps(found.error, fixed[master])))
        for master, runs in adaptive.items()
        for found in runs
    )
    return TEXT.format(
        seconds=SECONDS, reference=REFERENCE, figure=figure, changes=changes(fixed), fixed=of_fixed, adaptive=of_adaptive
    )


# --- figure ----------------------------------------------------------------------------------------------------------

WIDTH, HEIGHT = 640, 420
LEFT, RIGHT, TOP, BOTTOM = 80, 20, 20, 60
DECADES_X, DECADES_Y = (2, 5), (-6, 0)
COLOURS = {"gauss-seidel": "#1f77b4", "jacobi": "#d62728", "plain": "#7f7f7f"}


def place(steps: float, error: float) -> tuple[float, float]:
    def part(value: float, decades: tuple[int, int]) -> float:
        return (math.log10(value) - decades[0]) / (decades[1] - decades[0])

    x = LEFT + part(steps, DECADES_X) * (WIDTH - LEFT - RIGHT)
    return x, HEIGHT - BOTTOM - part(error, DECADES_Y) * (HEIGHT - TOP - BOTTOM)


def line(runs: list[Run], colour: str, style: str) -> str:
    points = [place(found.steps, abs(found.error)) for found in runs]
    path = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    dots = "".join(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{colour}"/>' for x, y in points)
    return f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="1.5"{style}/>{dots}\n'


def axes() -> str:
    text = ""
    for decade in range(DECADES_X[0], DECADES_X[1] + 1):
        x, y = place(10.0**decade, 10.0 ** DECADES_Y[0])
        text += f'<line x1="{x:.1f}" y1="{TOP}" x2="{x:.1f}" y2="{y:.1f}" stroke="#ddd"/>'
        text += f'<text x="{x:.1f}" y="{y + 18:.1f}" text-anchor="middle">1e{decade}</text>\n'
    for decade in range(DECADES_Y[0], DECADES_Y[1] + 1):
        x, y = place(10.0 ** DECADES_X[0], 10.0**decade)
        text += f'<line x1="{x:.1f}" y1="{y:.1f}" x2="{WIDTH - RIGHT}" y2="{y:.1f}" stroke="#ddd"/>'
        text += f'<text x="{x - 8:.1f}" y="{y + 4:.1f}" text-anchor="end">1e{decade}</text>\n'
    text += f'<text x="{(LEFT + WIDTH) / 2:.0f}" y="{HEIGHT - 16}" text-anchor="middle">communication steps in {SECONDS} s</text>'
    middle = (HEIGHT - BOTTOM + TOP) / 2
    return text + f'<text transform="translate(20 {middle:.0f}) rotate(-90)" text-anchor="middle">relative error of the converted energy</text>\n'


def legend(entries: list[tuple[str, str, str]]) -> str:
    text = ""
    for index, (label, colour, style) in enumerate(entries):
        x, y = LEFT + 16, HEIGHT - BOTTOM - 12 - 18 * (len(entries) - 1 - index)
        text += f'<line x1="{x}" y1="{y - 4}" x2="{x + 28}" y2="{y - 4}" stroke="{colour}" stroke-width="1.5"{style}/>'
        text += f'<text x="{x + 36}" y="{y}">{label}</text>\n'
    return text


def figure(fixed: Runs, adaptive: Runs) -> str:
    dashed = ' stroke-dasharray="6 4"'
    curves = [(f"{master}, fixed step", runs, COLOURS[master], "") for master, runs in fixed.items()]
    curves += [(f"{master}, adaptive step", runs, COLOURS[master], dashed) for master, runs in adaptive.items()]
    body = axes() + "".join(line(runs, colour, style) for _, runs, colour, style in curves)
    body += legend([(label, colour, style) for label, _, colour, style in curves])
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" font-size="12">\n'
    return f'{head}<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>\n{body}</svg>\n'
