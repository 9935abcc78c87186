"""FMPy and the FMU HarvestingCircuit, alone and coupled with the harvester."""

import csv

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu

import harness

CIRCUIT = "HarvestingCircuit"
INPUTS = ["left.capacitance", "right.capacitance"]
REST_CAPACITANCE = 1.501476744842152e-11


def test_fmpy_finds_no_problem_in_the_fmu(fmus):
    assert validate_fmu(fmus[CIRCUIT]) == []


def test_the_circuit_alone_follows_a_table(fmus):
    """The left capacitance swings twice between its value at rest and twice that.

    Without input derivatives: FMPy 0.3.32 cannot set those of more than one input from a table.
    """
    times = np.arange(5.0)
    rows = [(time, REST_CAPACITANCE * (1.0 + time % 2.0), REST_CAPACITANCE) for time in times]
    table = np.array(rows, dtype=[("time", float)] + [(name, float) for name in INPUTS])
    result = fmpy.simulate_fmu(
        fmus[CIRCUIT],
        stop_time=4.0,
        output_interval=0.01,
        input=table,
        output=["supply.energy", "load.energy", "zener.energy", "diode.energy", "stored.energy", "mechanical.energy"],
    )
    end = result[-1]
    assert end["supply.energy"] > 0.0 and end["load.energy"] > 0.0 and end["zener.energy"] > 0.0
    into = end["supply.energy"] + end["mechanical.energy"]
    out = end["load.energy"] + end["zener.energy"] + end["diode.energy"] + end["stored.energy"]
    assert into == pytest.approx(out, rel=1e-9)


def communication_points(folder) -> list[float]:
    with open(folder / "timeseries.csv", newline="") as file:
        return [float(row["time"]) for row in csv.DictReader(file)]


def couple(harvester, circuit, times) -> None:
    """Step both as a Gauss-Seidel master: the harvester first, then the circuit with both ends of C(t)."""
    before = harvester.get(*INPUTS)
    for now, then in zip(times, times[1:]):
        step = then - now
        harvester.doStep(now, step)
        after = harvester.get(*INPUTS)
        circuit.set(dict(zip(INPUTS, before)))
        circuit.set_rates({name: (end - start) / step for name, start, end in zip(INPUTS, before, after)})
        circuit.doStep(now, step)
        before = after


def test_fmpy_as_the_master_gets_the_energies_of_the_command_line(slave, tmp_path):
    arguments = ["cosim", "--case", "fig14", "--until", "10", "--sample", "step", "--output", str(tmp_path)]
    expected = harness.videg(*arguments)
    harvester, circuit = slave("VibroImpactHarvester"), slave(CIRCUIT)
    harvester.start(harness.fig14())
    circuit.start(dict(zip(INPUTS, harvester.get(*INPUTS))))
    couple(harvester, circuit, communication_points(tmp_path))
    found = circuit.outputs()
    for group in ("energy", "charge"):
        scale = expected[group]["supply"]
        for key, value in expected[group].items():
            if f"{key}.{group}" in found:
                assert found[f"{key}.{group}"] == pytest.approx(value, abs=1e-9 * scale), f"{key}.{group}"
    assert harvester.get("gain.energyEq13") == [expected["energy"]["eq13"]]


def test_the_fmu_within_the_command_line_agrees_with_the_embedded_circuit(tmp_path):
    def run(circuit):
        return harness.videg("cosim", "--until", "10", "--circuit", circuit, "--output", str(tmp_path / circuit))["energy"]

    embedded = run("embedded")
    assert run("fmu") == pytest.approx(embedded, abs=1e-9 * embedded["supply"])


def test_a_restored_state_goes_on_to_the_same_bits(slave):
    circuit = slave(CIRCUIT)
    circuit.start()

    def squeeze(times):
        for time in times:
            circuit.set({INPUTS[0]: REST_CAPACITANCE * (1.5 + np.sin(time))})
            circuit.doStep(time, 0.01)
        return circuit.outputs()

    before = squeeze(0.01 * np.arange(500))
    state = circuit.getFMUstate()
    first = squeeze(0.01 * np.arange(500, 1000))
    circuit.setFMUstate(state)
    assert circuit.outputs() == before
    assert squeeze(0.01 * np.arange(500, 1000)) == first
    assert first["load.energy"] > before["load.energy"]
    circuit.freeFMUstate(state)
