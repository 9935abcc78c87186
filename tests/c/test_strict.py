"""Every call of every ordinary sequence returns fmi2OK."""

import pytest

import harness
import strict


@pytest.mark.parametrize("name", ["VibroImpactHarvester", "HarvestingCircuit"])
def test_a_client_that_takes_nothing_but_ok_runs_each_fmu(name, tmp_path):
    code, lines = strict.run(harness.build_fmus()[name], tmp_path)
    assert code == 0 and lines[-1].endswith(" calls, 0 of them other than fmi2OK"), "\n".join(lines)
