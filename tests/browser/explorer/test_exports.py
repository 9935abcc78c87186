"""What the page of `videg explore` exports runs in the tools."""

import contextlib
import io
import json
import re
import subprocess
import sys
import types
from pathlib import Path

import pytest

import harness
from explorer_page import videg


@pytest.fixture
def exported(visit):
    """The files that the page exports, by their endings."""
    visited = visit("#case=fig14&topology=isolated&release=switch&zener.voltage=2700&until=8&from=4&membrane.restitution=0.55")
    files = {}
    for name in visited.page.evaluate("[...document.querySelectorAll('#export button')].map(it => it.textContent)"):
        with visited.page.expect_download() as download:
            visited.page.evaluate("name => [...document.querySelectorAll('#export button')].find(it => it.textContent === name).click()", name)
        files[download.value.suggested_filename.removeprefix("fig14-changed")] = Path(download.value.path()).read_text()
    return visited, files


def assert_python_runs(text, numbers, folder):
    """The script for Python, with a package that asks the command line: the package itself is installed in the stage `python` only."""
    class Run(dict):
        __getattr__ = dict.__getitem__

    def cosim(case, set, until, window):  # noqa: A002
        settings = [part for name, value in set.items() for part in ("--set", f"{name}={value}")]
        run = videg("cosim", "--case", case, *settings, "--until", str(until), "--window", f"{window[0]},{window[1]}", "--json", "--output", str(folder / "python"))
        return Run(json.loads(run))

    module = types.ModuleType("videg")
    module.cosim = cosim
    printed = io.StringIO()
    with pytest.MonkeyPatch.context() as patch, contextlib.redirect_stdout(printed):
        patch.setitem(sys.modules, "videg", module)
        exec(compile(text, "exported.py", "exec"), {})  # noqa: S102 - what our own page wrote
    net = float(re.match(r"net power (\S+) uW", printed.getvalue())[1])
    assert net == pytest.approx(numbers["net_power"] * 1e6, rel=5e-3)


def test_what_is_exported_runs_in_the_tools(exported, tmp_path):
    visited, files = exported
    numbers = visited.numbers()
    (tmp_path / "case.toml").write_text(files[".toml"])
    result = json.loads(videg("cosim", "--case-file", str(tmp_path / "case.toml"), "--json", "--output", str(tmp_path / "cosim")))
    assert result["net_power"] == pytest.approx(numbers["net_power"], rel=5e-3)
    assert result["average_voltage_gain"] == pytest.approx(numbers["average_voltage_gain"], rel=1e-9)

    videg("fmu", "build")
    script = tmp_path / "with_fmpy.py"
    script.write_text(files["-fmpy.py"].replace("target/fmu", str(harness.ROOT / "target/fmu")))
    printed = subprocess.run([harness.ROOT / ".venv/bin/python", script], check=True, capture_output=True, text=True).stdout
    impacts = visited.page.evaluate("""async () => {
        const { values, files } = videg.machine();
        const answer = await videg.engine.ask({ job: 'live', machine: { values, files }, from: 0, until: 8, begin: 0, end: 8, spacing: 0.1 });
        return answer.numbers.impacts;
    }""")
    assert f"{impacts:.0f} impacts" in printed

    assert_python_runs(files[".py"], numbers, tmp_path)
    for ending in (".svg", "-C.csv", "-C.lib", "-C-ltspice.lib", "-C-qspice.lib"):
        assert files[ending], ending
    assert files[".svg"].startswith("<svg") and "NaN" not in files[".svg"]


def test_ngspice_takes_the_exported_subcircuits(exported, tmp_path):
    """A source at 1 kV on a membrane: the charge that flows is the voltage times the change of C."""
    _, files = exported
    (tmp_path / "c.lib").write_text(files["-C.lib"])
    rows = [line.split(",") for line in files["-C.csv"].splitlines()[2:]]
    times, left = ([float(row[k]) for row in rows] for k in (0, 1))
    top = max(range(len(left)), key=lambda k: left[k])
    deck = f"""title
.include c.lib
V1 a 0 1000
Xl a 0 deg_left
Xr a2 0 deg_right
V2 a2 0 1000
.tran 1e-4 {times[top]} 0 1e-4 uic
.measure tran q integ i(V1)
.end
"""
    (tmp_path / "deck.cir").write_text(deck)
    printed = subprocess.run(["ngspice", "-b", "deck.cir"], cwd=tmp_path, check=True, capture_output=True, text=True).stdout
    charge = -float(re.search(r"^q\s*=\s*(\S+)", printed, re.MULTILINE)[1])
    # What the linear part takes at 0 s is not in the integral of a start with uic.
    assert charge == pytest.approx(1000 * (left[top] - left[0]), rel=0.02, abs=1e-11)
