"""The start values that `videg cases` prints, in FMPy."""

import subprocess

import fmpy
import pytest

import harness


@pytest.mark.parametrize("case", ["fig14", "table3-2hz", "capsule-soft"])
def test_fmpy_starts_from_the_printed_dict_with_the_result_of_the_command_line(fmus, tmp_path, case):
    command = [*harness.VIDEG, "cases", case, "--format", "python"]
    text = subprocess.run(command, cwd=harness.ROOT, check=True, capture_output=True, text=True).stdout
    scope: dict = {}
    exec(text, scope)  # noqa: S102
    expected = harness.videg("simulate", "--case", case, "--until", "2", "--output", str(tmp_path))
    result = fmpy.simulate_fmu(
        fmus["VibroImpactHarvester"],
        stop_time=2.0,
        output_interval=1.0,
        start_values=scope["start_values"],
        output=["gain.voltage", "impact.count"],
    )
    assert result["impact.count"][-1] == expected["impacts"]
    gained = result["gain.voltage"][-1] - result["gain.voltage"][-2]
    assert gained == pytest.approx(expected["average_voltage_gain"], rel=1e-12)
