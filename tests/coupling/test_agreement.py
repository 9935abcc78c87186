"""What counts as agreement."""

import math

import numpy as np
import pytest

import agreement

EXPECTED = {"gain.voltage": np.array([1.0, 2.0]), "load.energy": np.array([0.5, 4.0]), "stored.energy": np.array([0.0, 1.0])}


def compared(**series: list[float]) -> agreement.Comparison:
    other = {name.replace("_", "."): np.array(values) for name, values in series.items()}
    worst = agreement.worst_difference(EXPECTED | other, EXPECTED)
    return agreement.Comparison("this", "that", 1e-9, "rounding", worst)


def test_energies_are_compared_with_the_largest_of_them():
    assert compared().passed and "none" in compared().row()
    assert "at most 1e-09" in compared(stored_energy=[0.0, 1.0 + 2e-9]).row()
    assert not compared(gain_voltage=[1.0, 2.1]).passed


@pytest.mark.parametrize("value", [math.nan, math.inf])
@pytest.mark.parametrize("name", ["gain_voltage", "load_energy", "stored_energy"])
def test_what_is_no_number_differs_wherever_it_stands(name, value):
    differs = compared(**{name: [0.0, value]})
    assert not differs.passed and "| DIFFERS |" in differs.row() and "without end" in differs.row()
