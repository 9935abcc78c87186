"""The slowest tests by processor time: runs each test of the workspace in a process of its own and prints a table in Markdown.

Usage: python tests/slowest.py [--count N] [CARGO_TEST_OPTION...], such as -p videg-model or --release.

The time is that of the process and of the programs it starts, user and system: other work on the machine hardly changes it.
Tests that are marked as slow are left out, and so are doc tests. The exit code is 1 if a test fails.
"""

import argparse
import json
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
# They have no tests.
BENCHMARKS = {path.stem for path in (ROOT / "benches").glob("*.rs")}


@dataclass
class Binary:
    """A program that cargo builds of tests."""

    package: str
    target: str
    folder: Path
    program: str

    def tests(self) -> list[str]:
        """Names of its tests, without those that are ignored."""

        def names(*options: str) -> list[str]:
            command = [self.program, "--list", "--format", "terse", *options]
            found = subprocess.run(command, cwd=self.folder, capture_output=True, text=True, check=True).stdout
            return [line.removesuffix(": test") for line in found.splitlines() if line.endswith(": test")]

        ignored = set(names("--ignored"))
        return [name for name in names() if name not in ignored]

    def seconds(self, test: str) -> tuple[float, bool]:
        """Processor time of a test, and whether it passes."""
        environment = os.environ | {"CARGO_MANIFEST_DIR": str(self.folder)}
        command = [self.program, "--exact", test, "--quiet"]
        child = subprocess.Popen(
            command, cwd=self.folder, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        _, status, used = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        return used.ru_utime + used.ru_stime, child.returncode == 0


def binaries(options: list[str]) -> list[Binary]:
    """Builds the tests."""
    command = ["cargo", "test", "--no-run", "--message-format", "json-render-diagnostics", *(options or ["--workspace"])]
    lines = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, text=True, check=True).stdout.splitlines()
    found = []
    for message in map(json.loads, lines):
        if message["reason"] == "compiler-artifact" and message["profile"]["test"] and message["executable"]:
            folder = Path(message["manifest_path"]).parent
            package = "." if folder == ROOT else str(folder.relative_to(ROOT))
            found.append(Binary(package, message["target"]["name"], folder, message["executable"]))
    return [binary for binary in found if binary.target not in BENCHMARKS]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=20, metavar="N", help="rows of the table (20)")
    arguments, options = parser.parse_known_args()
    rows, failed = [], []
    for binary in binaries(options):
        for test in binary.tests():
            seconds, passed = binary.seconds(test)
            rows.append((seconds, f"{binary.package}, {binary.target}", test))
            if not passed:
                failed.append(f"{binary.package}, {binary.target}: {test}")
    rows.sort(reverse=True)
    print(f"{len(rows)} tests, {sum(row[0] for row in rows):.0f} s of processor time\n")
    print("| seconds | package, target | test |\n|---|---|---|")
    for seconds, place, test in rows[: arguments.count]:
        print(f"| {seconds:.1f} | {place} | `{test}` |")
    for name in failed:
        print(f"slowest: failed: {name}", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
