"""FMPy runs inclined, rubbing, suspended and shaken capsules, in co-simulation and model exchange."""

import numpy as np
import pytest
from fmpy import simulate_fmu

# Item of the enumeration; FMPy takes its number.
MOTION = 2

CAPSULE = {
    "cylinder.mass": 0.1245,
    "ball.mass": 0.01245,
    "excitation.amplitude": 5.0,
    "excitation.frequency": 2.5,
    "membrane.restitution": 0.5,
    "cylinder.length": 0.55 - 2 * 0.006 + 2 * 0.005,
    "initial.ballPosition": -0.275,
}


def run(fmu, settings, **options):
    output = ["impact.lastVelocity", "cylinder.position", "ball.position", "mount.force", "energy.friction"]
    return simulate_fmu(str(fmu), start_values=settings, output=output, **options)


@pytest.mark.parametrize(
    ("settings", "speeds"),
    [
        ({"cylinder.inclination": np.pi / 4}, [4.582409, 6.431569]),
        ({"cylinder.inclination": 0.2, "ball.friction": 0.15}, [5.152122, 5.702423]),
    ],
)
def test_the_capsule_of_the_literature_hits_once_a_period_at_each_end(fmus, settings, speeds):
    result = run(fmus["VibroImpactHarvester"], CAPSULE | settings, stop_time=62.0, output_interval=0.01)
    seen = np.unique(np.round(result["impact.lastVelocity"][result["time"] > 61.0], 6))
    assert seen == pytest.approx(speeds, abs=2e-6)


@pytest.mark.parametrize(
    "settings",
    [
        {"cylinder.inclination": 0.02, "contact.reaction": True, "ball.friction": 0.05},
        {"cylinder.suspensionStiffness": 20.0, "cylinder.suspensionDamping": 0.3},
        {"excitation.kind": MOTION, "excitation.acceleration": 4.0},
    ],
)
def test_model_exchange_agrees_with_co_simulation(fmus, settings):
    settings = {"initial.ballPosition": 0.005, "initial.ballVelocity": 0.1} | settings
    options = {"stop_time": 0.5, "output_interval": 0.01}
    exact = run(fmus["VibroImpactHarvester"], settings, **options)
    integrated = run(fmus["VibroImpactHarvester"], settings, fmi_type="ModelExchange", relative_tolerance=1e-9, **options)
    for name in ["cylinder.position", "ball.position"]:
        at = np.interp(exact["time"], integrated["time"], integrated[name])
        assert at == pytest.approx(exact[name], abs=2e-5)
    assert exact["impact.lastVelocity"][-1] > 0


@pytest.mark.parametrize("seed", range(4))
def test_under_cvode_the_damper_takes_what_it_takes_in_co_simulation(fmus, seed):
    random = np.random.default_rng(seed)
    settings = {
        "cylinder.suspensionStiffness": random.uniform(5.0, 60.0),
        "cylinder.suspensionDamping": random.uniform(0.05, 1.0),
        "cylinder.inclination": random.uniform(-0.05, 0.05),
        "contact.reaction": bool(seed % 2),
        "excitation.amplitude": random.uniform(0.2, 1.0),
        "initial.cylinderVelocity": random.uniform(-0.3, 0.3),
        "initial.ballVelocity": random.uniform(-0.3, 0.3),
    }
    names = ["energy.damping", "energy.excitation"]
    options = {"start_values": settings, "stop_time": 1.0, "output_interval": 1e-3}
    options["output"] = [*names, "cylinder.velocity", "impact.count"]
    exact, integrated = (
        simulate_fmu(str(fmus["VibroImpactHarvester"]), fmi_type=kind, **options, **solver)
        for kind, solver in (("CoSimulation", {}), ("ModelExchange", {"relative_tolerance": 1e-9}))
    )
    assert exact["impact.count"][-1] == integrated["impact.count"][-1] > 0
    moved = float(np.abs(exact["energy.excitation"]).max() + exact["energy.damping"][-1])
    for name in names:
        at = np.interp(exact["time"], integrated["time"], integrated[name])
        assert at == pytest.approx(exact[name], abs=1e-5 * moved)
    # The work of the excitation, by the trapezoidal rule; an impact between two points is at a time of its own.
    force = settings["excitation.amplitude"] * np.cos(2 * np.pi * 2.0 * integrated["time"])
    work = np.trapezoid(force * integrated["cylinder.velocity"], integrated["time"])
    assert integrated["energy.excitation"][-1] == pytest.approx(work, abs=1e-4 * moved)


def test_a_shaker_bears_the_force_that_its_motion_takes(fmus):
    settings = {"excitation.kind": MOTION, "excitation.acceleration": 4.0, "excitation.frequency": 2.0}
    result = run(fmus["VibroImpactHarvester"], settings, stop_time=1.0, output_interval=0.01)
    expected = 0.1245 * 4.0 * np.cos(2 * np.pi * 2.0 * result["time"])
    assert result["mount.force"] == pytest.approx(expected, abs=1e-12)


def test_a_suspension_beside_a_prescribed_motion_is_refused_by_name(fmus):
    messages = []
    with pytest.raises(Exception):
        run(
            fmus["VibroImpactHarvester"],
            {"excitation.kind": MOTION, "cylinder.suspensionStiffness": 1.0},
            stop_time=0.1,
            logger=lambda *arguments: messages.append(arguments[-1]),
        )
    assert any(b"cylinder.suspensionStiffness = 1 N/m needs excitation.kind = force" in message for message in messages)
