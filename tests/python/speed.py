"""How fast the package is beside the library and the command-line tool, in one sitting. Run it where the package is installed, in the root of the
source tree: the library's time is that of `cargo run --profile dist --example simulate`. Prints a table in Markdown."""

import argparse
import json
import os
import resource
import subprocess
import tempfile
import time

import videg

VARY = "membrane.restitution=0.2:0.9:{runs}"


def shortest(count: int, work) -> float:
    times = []
    for _ in range(count):
        started = time.perf_counter()
        work()
        times.append(time.perf_counter() - started)
    return min(times)


def sweep(runs: int, jobs: int | None = None) -> float:
    return shortest(1, lambda: videg.sweep(vary={"membrane.restitution": videg.Range(0.2, 0.9, runs)}, jobs=jobs, progress=False))


def tool(runs: int) -> float:
    with tempfile.TemporaryDirectory() as folder:
        arguments = ["sweep", "--vary", VARY.format(runs=runs), "--output", folder, "--json"]
        done = subprocess.run([videg.program(), *arguments], capture_output=True, text=True, check=True)
    return json.loads(done.stdout)["elapsed_s"]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=100_000, help="runs of the sweeps [default: 100000]")
    runs = parser.parse_args().runs
    command = ["cargo", "run", "--quiet", "--profile", "dist", "--example", "simulate"]
    library = float(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
    package = shortest(30, videg.simulate)
    both = [(sweep(runs), tool(runs)) for _ in range(2)]
    swept, of_tool = (min(times) for times in zip(*both, strict=True))
    one, two = sweep(runs // 5, 1), sweep(runs // 5, 2)
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    videg.evaluate({"membrane.restitution": [0.2 + 0.7 * k / runs for k in range(runs)]})
    grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - memory
    print(f"| what | time | beside | ratio |\n|---|---|---|---|\n"
          f"| `videg.simulate()`, 100 s of Fig. 14, 100,001 rows | {1e3 * package:.1f} ms | the library {1e3 * library:.1f} ms | {package / library:.2f} |\n"
          f"| `videg.sweep` of {runs:,} runs of 100 s | {swept:.1f} s | `videg sweep` {of_tool:.1f} s | {swept / of_tool:.2f} |\n"
          f"| the same of {runs // 5:,} runs, two threads | {two:.1f} s | one thread {one:.1f} s | {one / two:.2f} |\n"
          f"| memory that {runs:,} more runs take, {os.cpu_count()} cores | {grown / 1024:.1f} MiB | | |")


if __name__ == "__main__":
    main()
