"""Whatever is given, an exception names it; the process goes on."""

import contextlib
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import videg

WRONG = [
    # What is called, how, the exception, what its message has.
    (videg.simulate, {"case": "fig99"}, videg.Error, "case fig99: no such case"),
    (videg.simulate, {"case": 7}, TypeError, "case = 7"),
    (videg.simulate, {"case": "none.toml"}, videg.Error, "none.toml"),
    (videg.simulate, {"until": float("nan")}, videg.Error, "until = NaN s"),
    (videg.simulate, {"until": -1}, videg.Error, "until = -1 s: must lie"),
    (videg.simulate, {"until": "long"}, TypeError, "until = 'long'"),
    (videg.simulate, {"until": 1e10}, videg.Error, "until = 10000000000 s: must lie"),
    (videg.simulate, {"set": {"membrane.restitution": 2}}, videg.Error, "membrane.restitution = 2 is out of range: allowed is 0 .. 1"),
    (videg.simulate, {"set": {"membrane.restitution": None}}, TypeError, "membrane.restitution = None"),
    (videg.simulate, {"set": {"membrane.restitution": [0.5]}}, TypeError, "membrane.restitution = [0.5]"),
    (videg.simulate, {"set": {"membrane.restitution": np.zeros(10**6)}}, TypeError, "membrane.restitution"),
    (videg.simulate, {"set": {"membrane.restitution": "a\0b"}}, videg.Error, "membrane.restitution"),
    (videg.simulate, {"set": {"membrane.restitution": float("nan")}}, videg.Error, "membrane.restitution"),
    (videg.simulate, {"set": {"restitution": 0.5}}, videg.Error, "did you mean membrane.restitution?"),
    (videg.simulate, {"set": {7: 0.5}}, TypeError, "7 is no name"),
    (videg.simulate, {"set": ["membrane.restitution"]}, TypeError, "must be a dict"),
    (videg.simulate, {"set": {"": 1}}, videg.Error, "set =1"),
    (videg.simulate, {"record": "left.capacitanc"}, videg.Error, "did you mean left.capacitance?"),
    (videg.simulate, {"record": ["excitation.file"]}, videg.Error, "is a text, not a number"),
    (videg.simulate, {"record": 5}, TypeError, "record = 5"),
    (videg.simulate, {"record": [5]}, TypeError, "5 is no name"),
    (videg.simulate, {"sample": 0}, videg.Error, "sample 0 s: must lie"),
    (videg.simulate, {"sample": 1e-7, "until": 1e3}, videg.Error, "a table has 20000000 at most"),
    (videg.simulate, {"knots": 0}, videg.Error, "error of C(t) = 0"),
    (videg.simulate, {"until": 10**400}, videg.Error, "until: a number that is too large"),
    (videg.simulate, {"set": {"ball.mass": 10**5000}}, videg.Error, "ball.mass: an integer of more than 64 bits"),
    (videg.simulate, {"set": {"excitation.file": "\udcff"}}, TypeError, "excitation.file"),
    (videg.evaluate, {"points": {}}, videg.Error, "there is no variable"),
    (videg.evaluate, {"points": {"ball.mass": []}}, videg.Error, "ball.mass has 0"),
    (videg.evaluate, {"points": {"ball.mass": [1.0], "biasVoltage": [1.0, 2.0]}}, videg.Error, "biasVoltage has 2"),
    (videg.evaluate, {"points": {"ball.mass": ["1"]}}, TypeError, "ball.mass"),
    (videg.evaluate, {"points": {"excitation.seed": [1, 2]}}, videg.Error, "excitation.seed: is of type Integer"),
    (videg.evaluate, {"points": {"nothing": [1.0]}}, videg.Error, "nothing"),
    (videg.evaluate, {"points": [1.0]}, TypeError, "points: must be a dict"),
    (videg.sweep, {"vary": {"nothing": [1]}, "output": "x"}, videg.Error, "nothing"),
    (videg.simulate, {"sample": 1, "knots": 1}, TypeError, "give one of them"),
    (videg.simulate, {"window": (2, 1)}, videg.Error, "window end = 1 s"),
    (videg.simulate, {"window": 5}, TypeError, "window = 5"),
    (videg.simulate, {"window": (1, 2, 3)}, TypeError, "must be two times"),
    (videg.cosim, {"master": "x"}, videg.Error, 'master = "x"'),
    (videg.cosim, {"circuit": "x"}, videg.Error, "circuit = 'x'"),
    (videg.cosim, {"record": ["left.volt"]}, videg.Error, "left.volt: no such column; did you mean left.voltage?"),
    (videg.cosim, {"adaptive": -1}, videg.Error, "adaptive -1"),
    (videg.cosim, {"step": 0}, videg.Error, "step = 0 s"),
    (videg.cosim, {"set": {"load.resistance": -1}}, videg.Error, "load.resistance"),
    (videg.sweep, {"vary": {}, "design": "x"}, videg.Error, 'design = "x"'),
    (videg.sweep, {"vary": ["membrane.restitution"]}, TypeError, "vary: must be a dict"),
    (videg.sweep, {"vary": {"membrane.restitution": []}}, videg.Error, "there are no values"),
    (videg.sweep, {"vary": {"membrane.restitution": 0.5}}, TypeError, "must be values"),
    (videg.sweep, {"vary": {"membrane.restitution": [None]}}, TypeError, "membrane.restitution = None"),
    (videg.sweep, {"vary": {"membrane.restitution": ["a,b"]}}, videg.Error, "no commas"),
    (videg.sweep, {"vary": {"membrane.restitution": np.zeros((2, 2))}}, TypeError, "membrane.restitution"),
    (videg.sweep, {"vary": {"membrane.restitution": videg.Range(0, 1, -1)}}, videg.Error, "count = -1"),
    (videg.sweep, {"vary": {"nothing": [1]}}, videg.Error, "nothing"),
    (videg.sweep, {"vary": {"membrane.restitution": [0.5]}, "samples": 1.5}, TypeError, "samples = 1.5"),
    (videg.sweep, {"vary": {"membrane.restitution": [0.5]}, "samples": 2**70}, videg.Error, "samples"),
    (videg.sweep, {"vary": {"membrane.restitution": [0.5]}, "jobs": 0}, videg.Error, "jobs = 0"),
    (videg.sweep, {"vary": {"membrane.restitution": [0.5]}, "record": "nothing"}, videg.Error, "nothing"),
    (videg.export, {"path": "x.csv", "format": "xls"}, videg.Error, "format = 'xls'"),
    (videg.export, {"path": "/nowhere/at/all.csv", "until": 1}, videg.Error, "/nowhere/at/all.csv"),
    (videg.netlist, {"path": "x.lib", "simulator": "x"}, videg.Error, "simulator = 'x'"),
    (videg.fmu, {"name": "../../etc/passwd"}, videg.Error, "there are VibroImpactHarvester"),
    (videg.Harvester, {"set": {"load.resistance": 1e9}}, videg.Error, "load.resistance"),
    (videg.Circuit, {"set": {"load.resistanc": 1e9}}, videg.Error, "load.resistance"),
    (videg.Circuit, {"set": {"load.resistance": "much"}}, videg.Error, "load.resistance"),
    (videg.start_values, {"case": "fig99"}, videg.Error, "no such case"),
]


@pytest.mark.parametrize(("call", "arguments", "kind", "said"), WRONG, ids=range(len(WRONG)))
def test_what_is_wrong_is_named(call, arguments: dict, kind: type, said: str, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(kind) as raised:
        call(**arguments)
    assert said in str(raised.value)
    assert not list(tmp_path.iterdir()), "something was left"


def test_bad_calls_on_an_instance() -> None:
    harvester = videg.Harvester()
    state = harvester.save()
    for call, kind, said in [
        (lambda: harvester.step(0), videg.Error, "step = 0 s"),
        (lambda: harvester.step(float("inf")), videg.Error, "step = inf s"),
        (lambda: harvester.step(None), TypeError, "step = None"),
        (lambda: harvester["nothing"], videg.Error, "nothing"),
        (lambda: harvester.get(["impact.count"]), videg.Error, "impact.count"),
        (lambda: harvester.get("nothing"), videg.Error, "nothing"),
        (lambda: harvester.__setitem__("left.voltage", None), TypeError, "left.voltage = None"),
        (lambda: harvester.__setitem__("ball.position", 1.0), videg.Error, "ball.position"),
        (lambda: harvester.restore(b"state"), TypeError, "save"),
        (lambda: harvester.restore(videg.State(0.0, b"")), videg.Error, "state"),
        (lambda: harvester.restore(videg.State(0.0, state.data[:-1])), videg.Error, "state"),
        (lambda: harvester.restore(videg.State(0.0, bytes(10**7))), videg.Error, "state"),
        (lambda: harvester.derivative("ball.position", "nothing"), videg.Error, "nothing"),
    ]:
        with pytest.raises(kind) as raised:
            call()
        assert said in str(raised.value)
    again = videg.Harvester()
    again.restore(state)
    again.step(1.0)


def test_states_with_wrong_bytes_are_refused() -> None:
    """Each byte of a state changed: refused, or another valid state; never a crash."""
    with videg.Harvester() as harvester:
        harvester.step(0.5)
        state = harvester.save()
    refused = 0
    for index in range(0, len(state.data), 7):
        changed = bytearray(state.data)
        changed[index] ^= 0x55
        with videg.Harvester() as other:
            try:
                other.restore(videg.State(state.time, bytes(changed)))
            except videg.Error:
                refused += 1
                continue
            # Another valid state may be one that the model cannot go on from.
            with contextlib.suppress(videg.Error):
                other.step(0.1)
    assert refused > 0


@pytest.mark.skipif(sys.platform == "win32", reason="signals of Unix")
@pytest.mark.parametrize(
    "call",
    [
        "videg.simulate(until=1e6, sample=1)",
        "videg.simulate(until=1e6, sample=1e6, set={'excitation.phaseNoise': 1.0})",
        "videg.simulate(until=1e6, knots=1e-3)",
        "videg.evaluate({'membrane.restitution': [0.1 + 1e-6 * k for k in range(500000)]})",
        "videg.export('x.csv', until=1e6, sample=1)",
        "videg.cosim(until=1e5)",
        "videg.sweep(vary={'membrane.restitution': videg.Range(0.1, 0.9, 1000000)})",
        "videg.Harvester().step(1e8)",
    ],
)
def test_ctrl_c_ends_a_run(call: str) -> None:
    program = f"""
import signal, threading, time, os, videg
# Programs in the background of a shell ignore it.
signal.signal(signal.SIGINT, signal.default_int_handler)
threading.Timer(1.0, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
begun = time.monotonic()
try:
    {call}
except KeyboardInterrupt:
    print("ended after", time.monotonic() - begun)
print(videg.simulate(until=1.0).impacts)
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    took = float(done.stdout.split()[2])
    # Far sooner than the run would end, on a busy machine, too.
    assert 0.9 < took < 30.0, done.stdout


def test_an_error_of_the_progress_ends_the_run() -> None:
    from videg import _videg

    def fail(_done: int, _total: int) -> None:
        raise ZeroDivisionError("not me")

    run = {"case": None, "case_file": None, "settings": [], "until": 1e6, "step": None, "window": None}
    with pytest.raises(ZeroDivisionError, match="not me"):
        _videg.simulate(videg.fmu(), run, [], ("sample", 10.0), fail)


def test_nothing_stays_in_the_folder_for_temporary_files(tmp_path: Path) -> None:
    alone = "import videg; videg.simulate(until=1.0); videg.sweep(vary={'membrane.restitution': [0.5]}, until=1.0)"
    pool = """
import multiprocessing, videg
def run(_): return videg.simulate(until=1.0).impacts
if __name__ == "__main__":
    run(0)
    for method in ("fork", "spawn", "forkserver"):
        with multiprocessing.get_context(method).Pool(2) as pool:
            assert len(set(pool.map(run, range(4)))) == 1
            pool.close()
            pool.join()
"""
    for index, program in enumerate((alone, pool)):
        folder = tmp_path / str(index)
        folder.mkdir()
        script = tmp_path / "it.py"
        script.write_text(program)
        subprocess.run([sys.executable, script], env={"TMPDIR": str(folder), "PATH": ""}, check=True)
        assert not list(folder.glob("videg*")), index
