"""How closely circuits and masters agree, and how they converge: docs/coupling.md and its figure. Ends with 1 if a bound is
exceeded.

    python tests/coupling
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

import agreement  # noqa: E402
import convergence  # noqa: E402
import harness  # noqa: E402

PAGE = harness.ROOT / "docs" / "coupling.md"
FIGURE = PAGE.with_suffix(".svg")

HEADER = """\
# Coupling of harvester and circuit

Written by `./test.sh conformance`; do not edit. The paper's Fig. 14, circuit of Fig. 8(a), 1 Gohm.

"""


def write(path: Path, text: str) -> None:
    """Writes a file if it says something new."""
    if not path.exists() or path.read_text() != text:
        path.write_text(text)
        print(f"{path} has changed: commit it if that is right")


def main() -> int:
    comparisons = agreement.compare()
    for found in comparisons:
        print(found.line())
    fixed, adaptive = convergence.measure()
    write(PAGE, HEADER + agreement.section(comparisons) + convergence.section(fixed, adaptive, FIGURE.name))
    write(FIGURE, convergence.figure(fixed, adaptive))
    failed = sum(not found.passed for found in comparisons)
    print(f"coupling: {len(comparisons) - failed} passed, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
