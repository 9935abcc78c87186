"""What counts as a difference from the importer that the others are compared with."""

import math

import numpy as np
import pytest

import job
import record

EXPECTED = {"first": np.array([1.0, -2.0]), "second": np.array([4.0, job.NEVER])}


def found(**series: list[float]) -> record.Record:
    worst = job.worst_difference(EXPECTED | {name: np.array(values) for name, values in series.items()}, EXPECTED)
    return record.Record(tool="a", version="1", proves="", fmu="b", seconds=1.0, complaints=[], worst=worst)


def test_equal_series_and_those_within_rounding_pass():
    assert found().passed and found().difference() == "none"
    rounded = found(second=[4.0 + 2e-9, job.NEVER])
    assert rounded.passed and rounded.difference() == "at most 1e-09"


@pytest.mark.parametrize("value", [math.nan, math.inf])
@pytest.mark.parametrize("name", EXPECTED)
def test_what_is_no_number_fails_wherever_it_stands(name, value):
    for place in range(2):
        series = list(EXPECTED[name])
        series[place] = value
        failed = found(**{name: series})
        assert not failed.passed and failed.difference() == "without end" and "FAILED" in failed.line()
