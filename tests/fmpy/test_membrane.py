"""FMPy sets a measured membrane by its file, a String parameter; its force and depth are those of scipy's interpolation."""

import numpy as np
import pytest
from fmpy import simulate_fmu
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq

# Items of the enumerations; FMPy takes their numbers.
TABLE = 2
IMPULSIVE, COMPLIANT = 1, 2

MASS = 0.0035


def measured(random, path):
    """A random membrane of 20 points, as a file and as scipy has it."""
    deflection = np.concatenate([[0.0], np.cumsum(random.uniform(1e-4, 6e-4, 20))])
    force = np.concatenate([[0.0], np.cumsum(random.uniform(0.01, 0.2, 20))])
    rows = "".join(f"{x!r},{f!r}\n" for x, f in zip(deflection.tolist(), force.tolist()))
    path.write_text(f"deflection,force\n{rows}")
    return str(path), PchipInterpolator(deflection, force)


def contact(fmu, file, law, speed, interval):
    """A ball that flies to the right against a cylinder at rest: deflection and acceleration over time."""
    settings = {"membrane.law": TABLE, "membrane.file": file, "contact.law": law, "membrane.restitution": 1.0}
    settings |= {"excitation.amplitude": 0.0, "initial.ballPosition": 0.0, "initial.ballVelocity": speed}
    output = ["right.deflection", "der(ball.velocity)"]
    return simulate_fmu(str(fmu), start_values=settings, output=output, stop_time=0.1, output_interval=interval)


@pytest.mark.parametrize("seed", range(4))
def test_the_force_of_a_contact_is_that_of_scipy(fmus, tmp_path, seed):
    random = np.random.default_rng(seed)
    file, force = measured(random, tmp_path / "film.csv")
    result = contact(fmus["VibroImpactHarvester"], file, COMPLIANT, random.uniform(0.3, 0.8), 1e-4)
    pressed = result[result["right.deflection"] > 0.0]
    assert len(pressed) > 50
    assert -MASS * pressed["der(ball.velocity)"] == pytest.approx(force(pressed["right.deflection"]), rel=1e-10, abs=1e-13)


@pytest.mark.parametrize("seed", range(4))
def test_an_impact_goes_as_deep_as_its_energy_takes_it(fmus, tmp_path, seed):
    random = np.random.default_rng(seed)
    file, force = measured(random, tmp_path / "film.csv")
    energy, end = force.antiderivative(), force.x[-1]
    speed = np.sqrt(2 * energy(random.uniform(0.3, 0.9) * end) / MASS)
    result = contact(fmus["VibroImpactHarvester"], file, IMPULSIVE, speed, 2e-5)
    depth = brentq(lambda x: energy(x) - 0.5 * MASS * speed**2, 0.0, end, xtol=1e-15)
    assert result["right.deflection"].max() == pytest.approx(depth, rel=1e-5)
    assert result["right.deflection"].max() <= depth * (1 + 1e-12)
