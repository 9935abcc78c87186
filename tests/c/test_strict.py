"""Every call of every ordinary sequence returns fmi2OK, and no floating-point exception comes, with every law and every mount."""

import shutil

import pytest

import harness
import strict

GENT, OGDEN, TABLE = ({"membrane.law": law} for law in ("3", "4", "2"))
COMPLIANT = {"contact.law": "2"}
MOUNT = {
    "cylinder.inclination": "0.4",
    "ball.friction": "0.1",
    "cylinder.suspensionStiffness": "40",
    "cylinder.suspensionDamping": "0.3",
    "contact.reaction": "true",
}
SETTINGS = {
    "as they start": {},
    "Gent": GENT,
    "Gent, compliant": GENT | COMPLIANT,
    "viscous": GENT | COMPLIANT | {"membrane.viscousModulus": "33e3", "membrane.relaxationTime": "0.02"},
    "Ogden": OGDEN | {"membrane.ogdenModulus2": "-2e3", "membrane.ogdenExponent2": "-1.5"},
    "measured": TABLE | {"membrane.file": "film.csv"},
    "measured, compliant": TABLE | COMPLIANT | {"membrane.file": "film.csv"},
    "any mount": MOUNT,
    "any mount, compliant, feedback": MOUNT | COMPLIANT | {"contact.electrostaticFeedback": "true"},
    "shaken": {"excitation.kind": "2", "excitation.acceleration": "5", "cylinder.inclination": "0.4"},
    "recorded": {"excitation.file": "shaker.csv", "excitation.fileRepeat": "true", "cylinder.suspensionStiffness": "40"},
}


def check(name, folder, values):
    code, lines = strict.run(harness.build_fmus()[name], folder, values)
    assert code == 0 and lines[-1].endswith(" calls, 0 of them other than fmi2OK"), "\n".join(lines)


@pytest.mark.parametrize("setting", SETTINGS)
def test_a_client_that_takes_nothing_but_ok_runs_the_harvester(setting, tmp_path):
    shutil.copy(harness.ROOT / "examples" / "film.csv", tmp_path)
    (tmp_path / "shaker.csv").write_text("time,force\n0,0.3\n0.1,-0.4\n0.25,0.3\n")
    check("VibroImpactHarvester", tmp_path, SETTINGS[setting])


@pytest.mark.parametrize("leakage", ["0", "0.5"])
def test_a_client_that_takes_nothing_but_ok_runs_the_circuit(leakage, tmp_path):
    check("HarvestingCircuit", tmp_path, {"leakage.timeConstant": leakage})
