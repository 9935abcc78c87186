"""The package gives the bits of the command line for the same settings, on random parameters."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import videg
from conftest import draws, options

SCALARS = ("impacts", "average_voltage_gain", "average_power_eq13")


@pytest.mark.parametrize("settings", draws(12))
def test_simulate(settings: dict, command) -> None:
    ours = videg.simulate("fig14", until=7.0, set=settings, sample=0.013)
    theirs = command("simulate", "--until", "7", "--format", "none", *options(settings))
    assert {name: ours.summary[name] for name in SCALARS} == {name: theirs[name] for name in SCALARS}
    own = set(ours.summary) - {"rest_capacitance"}
    assert own <= set(theirs), own - set(theirs)


@pytest.mark.parametrize("settings", draws(4))
def test_columns(settings: dict, command, tmp_path: Path) -> None:
    names = ["left.capacitance", "ball.position", "impact.count"]
    ours = videg.simulate(until=3.0, set=settings, sample=0.01, record=names).to_dataframe()
    command("export", "--format", "csv", "--until", "3", "--sample", "0.01", "--columns", ",".join(names),
            "--output", "table.csv", *options(settings))
    theirs = pd.read_csv(tmp_path / "table.csv", comment="#", index_col="time")
    pd.testing.assert_frame_equal(ours, theirs.astype(float), check_exact=True)


@pytest.mark.parametrize("circuit", ["embedded", "fmu"])
@pytest.mark.parametrize("settings", draws(3))
def test_cosim(settings: dict, circuit: str, command, tmp_path: Path) -> None:
    electrical = {"load.resistance": 3.3e9, "topology": "isolated", "release": "switch"}
    ours = videg.cosim(until=2.0, set=settings | electrical, circuit=circuit, sample=0.01)
    theirs = command("cosim", "--until", "2", "--circuit", circuit, "--sample", "0.01", "--output", "here",
                     *options(settings | electrical))
    for name in (*SCALARS, "net_power", "load_power", "supply_power", "energy", "charge", "comparison", "circuit"):
        assert ours.summary[name] == theirs[name], name
    series = pd.read_csv(tmp_path / "here/timeseries.csv")
    assert list(series) == list(ours)
    for name, column in ours.items():
        np.testing.assert_array_equal(column, series[name].to_numpy(), err_msg=name)


def test_sweep(command, tmp_path: Path) -> None:
    mechanical = {"membrane.restitution": videg.Range(0.2, 0.9, 5), "excitation.phaseNoise": [0.0, 1.5]}
    coupled = mechanical | {"load.resistance": videg.Range(1e8, 1e10, 3, log=True)}
    for vary, texts in (
        (mechanical, ["membrane.restitution=0.2:0.9:5", "excitation.phaseNoise=0.0,1.5"]),
        (coupled, ["membrane.restitution=0.2:0.9:5", "excitation.phaseNoise=0.0,1.5", "load.resistance=log:1e8:1e10:3"]),
    ):
        folder = tmp_path / f"ours-{len(vary)}"
        ours = videg.sweep(vary=vary, until=3, samples=2, output=folder)
        varied = [part for text in texts for part in ("--vary", text)]
        command("sweep", "--until", "3", "--samples", "2", "--output", f"theirs-{len(vary)}", *varied)
        for name in ("sweep.csv", "statistics.csv", "sweep.json"):
            one, two = [(tmp_path / f"{who}-{len(vary)}" / name).read_bytes() for who in ("ours", "theirs")]
            assert one == two, name
        assert len(ours) == ours.attrs["runs"] and ours.attrs["failed"] == 0
        in_memory = videg.sweep(vary=vary, until=3, samples=2)
        pd.testing.assert_frame_equal(ours, in_memory, check_exact=True)
        # The folder is complete: nothing is computed again.
        assert videg.sweep(vary=vary, until=3, samples=2, output=folder).attrs["resumed_from"] == len(ours)


def test_start_values_and_cases(command) -> None:
    listed = command("cases", "--format", "json")
    assert [case.name for case in videg.cases()] == [case["case"] for case in listed]
    for case in videg.cases():
        ours = {name: it.value for name, it in videg.start_values(case.name).items()}
        assert ours == command("cases", case.name, "--format", "json")["start_values"]
