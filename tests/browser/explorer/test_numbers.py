"""The page of `videg explore` computes what the command line does."""

import json
import math
import random
import re
import subprocess

import pytest

import harness
from explorer_page import ExplorerVisit, drop, videg, wait

# The last bits of these differ between the machine and WebAssembly, see docs/explore.md.
CLOSE = 1e-12
# A compliant contact is integrated, and contacts multiply the last bits of the powers in it: so many times what the last bit of one
# parameter does.
BITS = 10


def test_fig_14_has_the_digits_of_the_command_line(visit):
    numbers = visit().numbers()
    alone = json.loads(videg("simulate", "--json"))
    assert numbers["average_voltage_gain"] == pytest.approx(alone["average_voltage_gain"], rel=CLOSE)
    assert numbers["average_power_eq13"] == pytest.approx(alone["average_power_eq13"], rel=CLOSE)
    # A co-simulation has communication steps, of which the page is the limit.
    steps = json.loads(videg("cosim", "--json", "--fresh"))
    for name in ("net_power", "load_power", "supply_power"):
        assert numbers[name] == pytest.approx(steps[name], rel=1e-3)


def native(machines):
    """The same runs outside of a browser: a list of numbers by name, or of a text that says why there are none."""
    lines = "".join(f"{m['from']!r} {m['until']!r} {' '.join(f'{name}={value!r}' for name, value in m['set'].items())}\n" for m in machines)
    output = subprocess.run([harness.example("native")], check=True, capture_output=True, text=True, input=lines).stdout.splitlines()
    names = output[0].split()
    return [line[6:] if line.startswith("error ") else dict(zip(names, map(float, line.split()), strict=True)) for line in output[1:]]


def random_machine(draw):
    """A machine that does not fail at once: each parameter within a wide range, with a topology and a release."""
    log = lambda low, high: math.exp(draw.uniform(math.log(low), math.log(high)))  # noqa: E731
    return {
        "from": 2.0, "until": 4.0,
        "set": {
            "membrane.restitution": draw.uniform(0.2, 0.8), "excitation.amplitude": log(0.05, 0.4), "excitation.frequency": log(1, 4),
            "membrane.stiffness": log(1e5, 1e6), "membrane.stiffnessExponent": draw.uniform(2, 3), "ball.mass": log(1e-3, 1e-2),
            "membrane.prestretch": draw.uniform(1.5, 3), "topology": draw.choice([1, 2]), "release": draw.choice([1, 2, 3]),
            "zener.voltage": log(2000, 4000), "storage.voltage": log(2000, 4000), "load.resistance": log(1e8, 1e11),
            "contact.law": draw.choice([1, 1, 1, 2]), "leakage.timeConstant": draw.choice([0, 50.0]),
        },
    }


ENERGIES = ("load.energy", "supply.energy", "zener.energy", "stored.energy", "mechanical.energy")


def apart(machines, ours, theirs):
    """For each contact law, by how much energies differ, over what went through."""
    found = {1: [], 2: []}
    for machine, one, other in zip(machines, ours, theirs, strict=True):
        if isinstance(other, str):
            assert one == other
            continue
        assert one["impacts"] == other["impacts"], machine
        scale = abs(other["load.energy"]) + abs(other["supply.energy"])
        found[machine["set"]["contact.law"]] += [abs(one[name] - other[name]) / scale if scale else 0 for name in ENERGIES]
    return found


def test_webassembly_has_the_numbers_of_the_machine(visit):
    draw = random.Random(25)
    machines = [random_machine(draw) for _ in range(40)]
    page = visit().page
    ask = """async machines => {
        const answers = [];
        for (const { from, until, set } of machines) {
            const machine = { values: Object.entries(set), files: {} };
            const question = { job: "live", machine, from, until, begin: from, end: until, spacing: 0.01 };
            answers.push(await videg.engine.ask(question).then(answer => answer.numbers, error => error.message));
        }
        return answers;
    }"""
    expected = native(machines)
    differences = apart(machines, page.evaluate(ask, machines), expected)
    # The same machines with the next number as one of their parameters.
    moved = ("membrane.stiffness", "membrane.stiffnessExponent", "ball.mass", "excitation.amplitude", "excitation.frequency")
    others = [[{**it, "set": it["set"] | {name: math.nextafter(it["set"][name], math.inf)}} for it in machines] for name in moved]
    of_a_bit = [apart(machines, native(it), expected) for it in others]
    for law in (1, 2):
        largest, bit = max(differences[law]), max(max(it[law]) for it in of_a_bit)
        equal = sum(it == 0 for it in differences[law])
        print(f"contact law {law}: energies differ by {largest:.1e} of what went through at most, {equal} of {len(differences[law])} by nothing; "
              f"by {bit:.1e} if a bit of a parameter differs")
        assert largest < (CLOSE if law == 1 else max(CLOSE, BITS * bit))


# What each slider must change, for a machine in which it counts.
MECHANICAL = "average_voltage_gain"
VISCOUS = "membrane.law=gent&contact.law=compliant&until=4&from=2"
EXPONENTIAL = "diode.model=exponential&until=2&from=1"
SLIDERS = {
    "cylinder.mass": ("", MECHANICAL), "cylinder.length": ("", MECHANICAL), "frame.width": ("", MECHANICAL), "ball.mass": ("", "largest_deflection"),
    "ball.radius": ("", MECHANICAL), "membrane.initialRadius": ("", MECHANICAL), "membrane.initialThickness": ("", "net_power"),
    "membrane.prestretch": ("", MECHANICAL), "membrane.relativePermittivity": ("", "net_power"), "membrane.stiffness": ("", "largest_deflection"),
    "membrane.stiffnessExponent": ("", "largest_deflection"), "membrane.restitution": ("", MECHANICAL), "excitation.amplitude": ("", MECHANICAL),
    "excitation.frequency": ("", MECHANICAL), "excitation.phase": ("until=4&from=2", MECHANICAL), "excitation.phaseNoise": ("until=4&from=2", MECHANICAL),
    "excitation.noiseHold": ("excitation.phaseNoise=0.5&until=4&from=2", MECHANICAL), "initial.cylinderPosition": ("until=4&from=0", MECHANICAL),
    "initial.cylinderVelocity": ("until=4&from=0", MECHANICAL), "initial.ballPosition": ("case=fig13&until=4&from=0", MECHANICAL),
    "initial.ballVelocity": ("until=4&from=0", MECHANICAL), "biasVoltage": ("", "net_power"), "cylinder.inclination": ("", MECHANICAL),
    "gravity": ("cylinder.inclination=0.2", MECHANICAL), "ball.friction": ("", MECHANICAL),
    "cylinder.suspensionStiffness": ("until=4&from=2", MECHANICAL), "cylinder.suspensionDamping": ("until=4&from=2", MECHANICAL),
    "excitation.acceleration": ("excitation.kind=motion&until=4&from=2", MECHANICAL),
    "membrane.shearModulus": ("membrane.law=gent", "largest_deflection"), "membrane.stretchLimit": ("membrane.law=gent", "largest_deflection"),
    "membrane.ogdenModulus1": ("membrane.law=ogden", "largest_deflection"), "membrane.ogdenExponent1": ("membrane.law=ogden", "largest_deflection"),
    "membrane.ogdenModulus2": ("membrane.law=ogden", "largest_deflection"), "membrane.ogdenModulus3": ("membrane.law=ogden", "largest_deflection"),
    "membrane.ogdenExponent2": ("membrane.law=ogden&membrane.ogdenModulus2=1e4", "largest_deflection"),
    "membrane.ogdenExponent3": ("membrane.law=ogden&membrane.ogdenModulus3=1e4", "largest_deflection"),
    "membrane.viscousModulus": (f"{VISCOUS}&membrane.relaxationTime=0.01", MECHANICAL),
    "membrane.relaxationTime": (f"{VISCOUS}&membrane.viscousModulus=2e4", MECHANICAL),
    **{name: (EXPONENTIAL, "net_power") for name in ("diode.saturationCurrent", "diode.emissionCoefficient", "diode.temperature",
                                                    "zener.emissionCoefficient", "solver.relativeTolerance")},
    # As in ngspice it counts only above the current that the saturation current gives.
    "zener.breakdownCurrent": (f"{EXPONENTIAL}&zener.breakdownCurrent=1e-3", "net_power"),
    "switch.band": (f"{EXPONENTIAL}&release=switch", "net_power"),
    "excitation.fileScale": ("FILE&until=4&from=2", MECHANICAL), "excitation.fileOffset": ("FILE&until=4&from=2", MECHANICAL),
    "supply.voltage": ("", "net_power"), "zener.voltage": ("", "net_power"), "load.resistance": ("", "net_power"),
    "storage.voltage": ("release=storage&topology=isolated", "net_power"), "leakage.timeConstant": ("", "leakage_power"),
}


def test_each_slider_changes_what_it_should(visit):
    visited = visit("#until=4&from=2")
    variables = visited.page.evaluate("JSON.parse(document.getElementById('description').textContent).variables")
    assert {it["name"] for it in variables if it["kind"] == "real"} == set(SLIDERS)
    # A recording as a link carries it.
    rows = "".join(f"{0.01 * k:.2f},{0.2 * math.sin(0.1 * k):.4f}\n" for k in range(900))
    visited.settle(lambda: drop(visited.page, "main", "push.csv", f"time,force\n{rows}"))
    wait(visited.page, "location.hash.includes('excitation.file')")
    recording = re.search(r"excitation\.file=[^&]*", visited.page.evaluate("location.hash"))[0]
    for name, (fragment, changed) in SLIDERS.items():
        fragment = fragment.replace("FILE", recording)
        before = visited.go(f"#{'' if 'case=' in fragment else 'case=fig14&'}{fragment or 'until=8&from=4'}")
        slide = """name => {
            const slider = document.querySelector(`[data-name='${name}'] input[type=range]`);
            slider.value = Math.min(1000, Number(slider.value) + 15);
            slider.dispatchEvent(new Event('input', { bubbles: true }));
            slider.dispatchEvent(new Event('change', { bubbles: true }));
        }"""
        after = visited.settle(lambda name=name, slide=slide: visited.page.evaluate(slide, name))
        assert visited.message() == "", name
        assert after[changed] != before[changed], name
        assert name in visited.page.evaluate("Object.keys(videg.state.set)")
        assert visited.field(name).input_value() != ""


def test_choices_and_switches_change_the_machine(visit):
    visited = visit("#until=2&from=1&begin=1")
    before = visited.numbers()
    for name, item, changed in [("topology", "isolated", "net_power"), ("release", "switch", "zener_power"), ("contact.law", "compliant", "largest_deflection"),
                                ("membrane.law", "gent", "largest_deflection"), ("diode.model", "exponential", "diode_power")]:
        select = visited.page.locator(f"[data-name='{name}'] select")
        visited.page.evaluate("name => { document.querySelector(`[data-name='${name}']`).closest('details').open = true; }", name)
        after = visited.settle(lambda select=select, item=item: select.select_option(item))
        assert after[changed] != before[changed], name
        before = after
    assert visited.page.locator("[data-name='membrane.shearModulus']").is_visible()
    assert not visited.page.locator("[data-name='membrane.stiffness']").is_visible()
    visited.page.evaluate("document.querySelectorAll('details.group').forEach(it => { it.open = true; })")
    after = visited.settle(lambda: visited.page.locator("[data-name='contact.reaction'] input").check())
    assert after["average_voltage_gain"] != before["average_voltage_gain"]


def test_a_browser_that_starts_the_model_late_has_the_numbers_too(browser, explorer, tmp_path):
    """In Firefox the model is there only after the first question."""
    late = "const instantiate = WebAssembly.instantiate; WebAssembly.instantiate = async (...parts) => { await new Promise(done => setTimeout(done, 200)); return instantiate(...parts); };\n"
    begin = '<script type="text/plain" id="worker">'
    text = explorer.read_text()
    assert text.count(begin) == 1
    path = tmp_path / "late.html"
    path.write_text(text.replace(begin, begin + late))
    visited = ExplorerVisit(browser, path, "#until=8&from=4")
    assert visited.message() == "" and visited.numbers()["impacts"] > 0
    visited.context.close()


def test_voltages_that_follow_from_the_harvester_are_shown_as_they_are_used(visit):
    for fragment, release in [("biasVoltage=3000", "zener.voltage"), ("release=storage&topology=isolated", "storage.voltage")]:
        visited = visit(f"#until=8&from=4&{fragment}")
        supply, zener, storage = visited.page.evaluate("videg.shown.voltages")
        assert float(visited.field("supply.voltage").input_value()) == pytest.approx(supply, rel=1e-5)
        assert float(visited.field(release).input_value()) == pytest.approx(zener if release == "zener.voltage" else storage, rel=1e-5)
    # The start value is a value like any other.
    visited = visit("#until=8&from=4&biasVoltage=3000&supply.voltage=2500&zener.voltage=3500")
    visited.type("supply.voltage", "2000")
    wait(visited.page, "videg.settled && videg.shown.voltages[0] === 2000")


def test_cases_are_presets(visit):
    visited = visit()
    cases = visited.page.evaluate("[...document.querySelectorAll('#case option')].map(it => it.value)")
    assert {"fig14", "table3-5hz", "capsule-2-1"} <= set(cases)
    for case in ("table3-5hz", "capsule-2-1", "fig10"):
        numbers = visited.settle(lambda case=case: visited.page.locator("#case").select_option(case))
        expected = json.loads(videg("simulate", "--case", case, "--json"))
        # Fig. 10 is a saddle: the last bits grow.
        assert numbers["average_voltage_gain"] == pytest.approx(expected["average_voltage_gain"], rel=1e-4 if case == "fig10" else 1e-9)


def test_absurd_machines_leave_the_page_alive(visit):
    """Every parameter at both ends of its bounds, then at random within them: numbers or a message."""
    visited = visit("#until=1&from=0.5&begin=0")
    visited.page.evaluate("() => { videg.engine.limit = 1000; }")
    variables = visited.page.evaluate("JSON.parse(document.getElementById('description').textContent).variables")
    draw = random.Random(7)
    reals = [it for it in variables if it["kind"] == "real"]
    fragments = []
    for it in reals:
        fragments += [f"{it['name']}={it[bound]}" for bound in ("min", "max") if it[bound] is not None]
    fragments = draw.sample(fragments, 30)
    for _ in range(20):
        chosen = draw.sample(reals, 4)
        ends = [(it["name"], it["min"] or 0.0, it["max"] or 1e6) for it in chosen]
        value = lambda low, high: math.exp(draw.uniform(math.log(max(low, 1e-9)), math.log(high))) if low >= 0 else draw.uniform(low, high)  # noqa: E731
        fragments.append("&".join(f"{name}={value(low, high)!r}" for name, low, high in ends))
    refused = 0
    for fragment in fragments:
        visited.page.evaluate("() => { window.before = videg.answers; }")
        visited.page.evaluate("text => { location.hash = text; }", f"#case=fig14&until=1&from=0.5&begin=0&{fragment}")
        wait(visited.page, "() => videg.answers > window.before && videg.settled")
        refused += visited.message() != ""
    assert 0 < refused < len(fragments)
    visited.go("#case=fig14&until=8&from=4")
    assert visited.message() == "" and visited.numbers()["impacts"] > 0


def test_a_million_impacts_a_second_are_a_message(visit):
    visited = visit("#until=4&from=2")
    visited.page.evaluate("() => { videg.engine.limit = window.limit; }")
    visited.page.evaluate("text => { location.hash = text; }", "#case=fig14&excitation.frequency=100000&excitation.amplitude=1000000&until=1000&from=500")
    wait(visited.page, "() => document.body.classList.contains('stale')")
    assert "too many" in visited.message() or "more than" in visited.message()
    frames = visited.page.evaluate("new Promise(done => { let n = 0; const go = () => (++n === 20 ? done(n) : requestAnimationFrame(go)); go(); })")
    assert frames == 20
    visited.go("#case=fig14&until=8&from=4")
    assert visited.message() == "" and visited.numbers()["impacts"] > 0


def test_maps_show_what_runs_give_and_a_click_goes_there(visit):
    visited = visit("#case=fig14&topology=isolated&release=switch&until=8&from=4")
    page = visited.page
    page.locator("#plot-map").scroll_into_view_if_needed()
    wait(page, "() => videg.map.took && videg.diagram.took")
    cells = page.evaluate("({ xs: videg.map.asked.xs, ys: videg.map.asked.ys, cells: videg.map.cells.map(it => [...it]) })")
    draw = random.Random(3)
    for _ in range(3):
        column, row = draw.randrange(len(cells["xs"])), draw.randrange(len(cells["ys"]))
        machine = {"from": 4.0, "until": 8.0, "set": {"membrane.restitution": 0.6, "topology": 2, "release": 2}}
        case = page.evaluate("JSON.parse(document.getElementById('description').textContent).cases.find(it => it.name === 'fig14').settings")
        machine["set"] |= case | {"zener.voltage": cells["xs"][column], "load.resistance": cells["ys"][row]}
        [expected] = native([machine])
        assert cells["cells"][row][2 * column] == pytest.approx(expected["net_power"], rel=1e-9, abs=1e-15)
    box = page.locator("#plot-map").bounding_box()
    before = visited.numbers()
    after = visited.settle(lambda: page.mouse.click(box["x"] + box["width"] * 0.4, box["y"] + box["height"] * 0.5))
    assert after["net_power"] != before["net_power"]
    assert {"zener.voltage", "load.resistance"} <= set(page.evaluate("Object.keys(videg.state.set)"))
    points = page.evaluate("videg.diagram.columns.map(it => it.length)")
    assert len(points) == 600 and max(points) == 200
