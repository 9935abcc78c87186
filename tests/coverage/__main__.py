"""Coverage of the packages that an FMU is made of, by their own tests: writes docs/coverage.md from an LCOV file.

Usage: python tests/coverage LCOV. Fails if a package reaches less than 90 % of its lines, or if a file does whose gaps
nobody has explained in tests/coverage/gaps.toml. Unit tests inside source files do not count as lines.
"""

import re
import sys
import tomllib
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
PAGE = ROOT / "docs/coverage.md"
GAPS = Path(__file__).with_name("gaps.toml")
# So begins the reason of a gap that the tool does not report of each build.
SOMETIMES = "In some builds: "
PACKAGES = ["model", "circuit", "coupled", "fmu/abi", "fmu/export", "fmu/harvester", "fmu/circuit"]
BOUND = 90.0
HEAD = """\
# Coverage

The page shows how many lines of the packages of the FMUs and of the coupled run their own tests reach. `./test.sh coverage` measures this and
writes the page. It fails if a package is below {bound:g} %, or if a file is below and `tests/coverage/gaps.toml` gives no
reason. Unit tests inside source files do not count as lines, nor do const functions that only the compiler evaluates: they make rows of
constants. Lines that the other tests reach through the packaged FMUs are
not counted.
"""


@dataclass
class File:
    name: str
    lines: dict[int, int]

    @property
    def missed(self) -> list[int]:
        return sorted(line for line, count in self.lines.items() if count == 0)

    @property
    def percent(self) -> float:
        return percent(len(self.lines), len(self.missed))

    def functions(self) -> str:
        """Where the missed lines are: functions, with their number of lines."""
        source = (ROOT / self.name).read_text().splitlines()
        places: dict[str, int] = {}
        for line in self.missed:
            found = head(source, line)
            name = found["name"] if found else "outside of functions"
            places[name] = places.get(name, 0) + 1
        return ", ".join(f"`{name}` {count}" for name, count in places.items())


def head(source: list[str], line: int) -> re.Match | None:
    """The head of the function that a line belongs to, up to the brace below its first column."""
    pattern = r"(?P<indent>\s*)(?:pub(?:\([a-z]+\))? )?(?P<words>(?:const |unsafe |extern \"C\" )*)fn (?P<name>\w+)"
    for start in range(line - 1, -1, -1):
        if found := re.match(pattern, source[start]):
            return None if f"{found['indent']}}}" in source[start : line - 1] else found
    return None


def without_compiled(source: str, lines: dict[int, int]) -> dict[int, int]:
    """The lines without those of const functions that never run."""
    heads = {line: head(source.splitlines(), line) for line in lines}
    ran = {found["name"] for line, found in heads.items() if found and lines[line]}

    def is_compiled(found: re.Match | None) -> bool:
        return bool(found and "const " in found["words"] and found["name"] not in ran)

    return {line: count for line, count in lines.items() if not is_compiled(heads[line])}


def percent(lines: int, missed: int) -> float:
    return 100.0 * (lines - missed) / lines if lines else 100.0


def test_lines(source: str) -> int:
    """The line from which on a file holds its own tests."""
    lines = source.splitlines()
    pairs = zip(lines, lines[1:], strict=False)
    starts = (number for number, pair in enumerate(pairs, 1) if pair == ("#[cfg(test)]", "mod tests {"))
    return next(starts, len(lines) + 1)


def read(lcov: Path) -> list[File]:
    files = []
    for record in lcov.read_text().split("end_of_record"):
        found = re.search(r"^SF:(.*)$", record, re.MULTILINE)
        if not found or not Path(found[1]).is_relative_to(ROOT):
            continue
        name = Path(found[1]).relative_to(ROOT).as_posix()
        package = next((it for it in PACKAGES if name.startswith(f"{it}/src/")), None)
        if package is None or re.search(r"(^|[/_])tests?\.rs$", name):
            continue
        source = (ROOT / name).read_text()
        end = test_lines(source)
        counts = ((int(line), int(count)) for line, count in re.findall(r"^DA:(\d+),(\d+)", record, re.MULTILINE))
        files.append(File(name, without_compiled(source, {line: count for line, count in counts if line < end})))
    return sorted((file for file in files if file.lines), key=lambda file: file.name)


def page(files: list[File], gaps: dict[str, str]) -> tuple[str, list[str]]:
    text = HEAD.format(bound=BOUND)
    failures = []
    text += "\n| package | lines | not reached | reached |\n|---|---|---|---|\n"
    for package in PACKAGES:
        inside = [file for file in files if file.name.startswith(f"{package}/src/")]
        lines, missed = sum(len(file.lines) for file in inside), sum(len(file.missed) for file in inside)
        reached = f"{percent(lines, missed):.1f} %" if lines else "no lines to cover"
        text += f"| `{package}` | {lines} | {missed} | {reached} |\n"
        if percent(lines, missed) < BOUND:
            failures.append(f"{package} reaches {percent(lines, missed):.1f} % of its lines, wanted are {BOUND:g} %")
    text += f"\n## Files below {BOUND:g} %\n\n"
    below = [file for file in files if file.percent < BOUND]
    for file in below:
        why = gaps.pop(file.name, None)
        if why is None:
            failures.append(f"{file.name} reaches {file.percent:.1f} % of its lines and tests/coverage/gaps.toml does not say why")
        text += f"- `{file.name}`, {file.percent:.1f} %: {why or 'not explained'}\n  Lines not reached: {file.functions()}.\n"
    if not below:
        text += "None.\n"
    stale = [name for name, why in gaps.items() if not why.startswith(SOMETIMES)]
    failures += [f"tests/coverage/gaps.toml explains {name}, which is not below {BOUND:g} %" for name in stale]
    text += "\n## Other lines not reached\n\n"
    for file in files:
        if file.missed and file not in below:
            text += f"- `{file.name}`, {file.percent:.1f} %: {file.functions()}\n"
    return text, failures


def main() -> None:
    files = read(Path(sys.argv[1]))
    if not files:
        sys.exit(f"{sys.argv[1]} says nothing about {', '.join(PACKAGES)}")
    text, failures = page(files, tomllib.loads(GAPS.read_text()))
    PAGE.write_text(text)
    print(text)
    if failures:
        sys.exit("\n".join(failures))


if __name__ == "__main__":
    main()
