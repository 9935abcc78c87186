"""The page of `videg explore`: it computes what the command line does, in every window, and stays alive whatever it is given."""

import contextlib
import io
import json
import math
import random
import re
import subprocess
import sys
import time
import types
from pathlib import Path

import pytest

import chromium
import harness

WIDTHS = [375, 800, 1440, 2560]
# The last bits of these differ between the machine and WebAssembly, see docs/explore.md.
CLOSE = 1e-12
# A compliant contact is integrated, and contacts multiply the last bits of the powers in it: so many times what the last bit of one
# parameter does.
BITS = 10
OVERFLOW = "document.documentElement.scrollWidth - document.documentElement.clientWidth"
# What sticks out of the page and is in no box that scrolls.
BEYOND = """() => [...document.querySelectorAll('body *')].filter(it => {
    if (it.closest('svg, .plot, #controls, select') || !it.checkVisibility()) return false;
    const box = it.getBoundingClientRect();
    return box.width > 0 && (box.right > document.documentElement.clientWidth + 1 || box.left < -1);
}).map(it => it.outerHTML.slice(0, 100))"""
# Controls without a name for a screen reader.
NAMELESS = """() => [...document.querySelectorAll('input, select, button, summary, [role=img]')].filter(it => {
    const said = it.getAttribute('aria-label') || it.textContent.trim() || it.labels?.[0]?.textContent.trim() || it.title;
    return !said;
}).map(it => it.outerHTML.slice(0, 100))"""


def wait(page, condition, argument=None, seconds=60):
    """Until a condition holds: the page lets nobody evaluate texts, so Playwright cannot wait within it."""
    end = time.monotonic() + seconds
    while not page.evaluate(condition, argument):
        assert time.monotonic() < end, condition
        page.wait_for_timeout(10)


def videg(*arguments):
    command = ["cargo", "run", "--quiet", "--release", "--", *arguments]
    return subprocess.run(command, cwd=harness.ROOT, check=True, capture_output=True, text=True).stdout


@pytest.fixture(scope="session")
def explorer(tmp_path_factory):
    """The page."""
    path = tmp_path_factory.mktemp("explorer") / "explorer.html"
    videg("explore", "--output", str(path), "--no-open")
    return path


class Visit:
    """The open page with all that it did wrong."""

    def __init__(self, browser, path, fragment, **options):
        self.faults = []
        self.context = browser.new_context(accept_downloads=True, **options)
        self.context.set_default_timeout(60_000)
        self.page = self.context.new_page()
        self.page.on("console", self.heard)
        self.page.on("pageerror", lambda error: self.faults.append(f"error: {error}"))
        self.page.on("request", self.requested)
        self.path = path
        self.page.goto(path.as_uri() + fragment)
        wait(self.page, "window.videg?.shown || document.body.classList.contains('stale')")

    def heard(self, message):
        if message.type in ("error", "warning"):
            self.faults.append(message.text)

    def requested(self, request):
        if request.url.split("#")[0] != self.path.as_uri() and not request.url.startswith(("data:", "blob:")):
            self.faults.append(f"request: {request.url}")

    def numbers(self):
        return self.page.evaluate("videg.shown.numbers")

    def message(self):
        message = self.page.locator("#message")
        return message.inner_text() if message.is_visible() else ""

    def settle(self, act):
        """Acts, and waits for the answer to it: the numbers then."""
        self.page.evaluate("() => { window.before = videg.answers; }")
        act()
        wait(self.page, "() => videg.answers > window.before && videg.settled")
        return self.numbers()

    def go(self, fragment):
        return self.settle(lambda: self.page.evaluate("text => { location.hash = text; }", fragment))

    def field(self, name):
        return self.page.locator(f"[data-name='{name}'] input[type=text]")

    def type(self, name, text):
        self.page.evaluate("name => { document.querySelector(`[data-name='${name}']`).closest('details').open = true; }", name)
        field = self.field(name)
        field.fill(text)
        field.press("Enter")


@pytest.fixture
def visit(browser, explorer):
    """Opens the page; after the test, nothing may have gone wrong."""
    visits = []

    def open_page(fragment="", width=1440, height=900, scheme="light", **options):
        visits.append(Visit(browser, explorer, fragment, viewport={"width": width, "height": height}, color_scheme=scheme, **options))
        return visits[-1]

    yield open_page
    faults = [fault for visit in visits for fault in visit.faults]
    for visit in visits:
        visit.context.close()
    assert faults == []


def test_the_page_is_one_small_file_and_runs_its_own_scripts_only(explorer):
    text = explorer.read_text()
    assert len(text) < 1_500_000
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', text)[1]
    assert "default-src 'none'" in policy and "unsafe-eval'" not in policy.replace("'wasm-unsafe-eval'", "")
    assert not re.search(r"(src|href)=\"(?!data:)", text.split("<script")[0])


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
    command = ["cargo", "run", "--quiet", "--release", "--package", "videg-explorer", "--example", "native"]
    output = subprocess.run(command, cwd=harness.ROOT, check=True, capture_output=True, text=True, input=lines).stdout.splitlines()
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
    # The same machines with the next number as their stiffness.
    others = [{**it, "set": it["set"] | {"membrane.stiffness": math.nextafter(it["set"]["membrane.stiffness"], math.inf)}} for it in machines]
    of_a_bit = apart(machines, native(others), expected)
    for law in (1, 2):
        largest, bit = max(differences[law]), max(of_a_bit[law])
        equal = sum(it == 0 for it in differences[law])
        print(f"contact law {law}: energies differ by {largest:.1e} of what went through at most, {equal} of {len(differences[law])} by nothing; "
              f"by {bit:.1e} if a bit of the stiffness differs")
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


def test_a_link_carries_the_machine_and_undo_brings_it_back(visit):
    visited = visit("#case=fig15&topology=isolated&release=switch&zener.voltage=2700&load.resistance=Infinity&until=12&from=6&diagram=ball.mass,Phase,,")
    numbers = visited.numbers()
    state = visited.page.evaluate("videg.state")
    assert state["case"] == "fig15" and state["set"]["zener.voltage"] == 2700 and state["diagram"]["shown"] == "Phase"
    visited.type("load.resistance", "1e10")
    wait(visited.page, "location.hash.includes('load.resistance=10000000000')")
    link = visited.page.evaluate("location.hash")
    wait(visited.page, "videg.settled")
    changed = visited.numbers()
    assert changed["net_power"] != numbers["net_power"]
    assert visit(link).numbers() == changed
    assert visited.settle(lambda: visited.page.locator("#undo").click()) == numbers
    assert visited.settle(lambda: visited.page.locator("#redo").click()) == changed
    assert visited.settle(lambda: visited.page.keyboard.press("Control+z")) == numbers
    back = visited.page.locator("[data-name='zener.voltage'] .back")
    visited.settle(back.click)
    assert "zener.voltage" not in visited.page.evaluate("videg.state.set")


def test_a_link_with_mistakes_says_what_it_leaves_out(visit):
    visited = visit("#case=fig99&ball.wait=1&topology=star&ball.mass=much&until=-1&excitation.file=a.csv,!!!&until=8&from=4")
    for part in ["case fig99", "ball.wait: no such parameter", "topology = star", "ball.mass = much", "until = -1", "excitation.file = a.csv"]:
        assert part in visited.message(), part
    assert visited.numbers()["impacts"] > 0
    for wrong, said in [("diagram=ball.mass,Foo", "Speed, Phase"), ("diagram=membrane.law,Speed", "no such number"), ("map=topology,ball.mass", "no such number"),
                        ("map=ball.mass,ball.mass", "two different"), ("span=0", "1, 2, 4"), ("membrane.file=long.csv,", "drop the file here")]:
        assert said in visit(f"#until=2&from=1&{wrong}").message(), wrong


def test_a_browser_that_starts_the_model_late_has_the_numbers_too(browser, explorer, tmp_path):
    """In Firefox the model is there only after the first question."""
    late = "const instantiate = WebAssembly.instantiate; WebAssembly.instantiate = async (...parts) => { await new Promise(done => setTimeout(done, 200)); return instantiate(...parts); };\n"
    begin = '<script type="text/plain" id="worker">'
    text = explorer.read_text()
    assert text.count(begin) == 1
    path = tmp_path / "late.html"
    path.write_text(text.replace(begin, begin + late))
    visited = Visit(browser, path, "#until=8&from=4")
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


def test_search_finds_parameters_in_closed_groups_and_leaves_them_as_they_were(visit):
    page = visit("#until=4&from=2").page
    opened = "[...document.querySelectorAll('.group')].map(it => it.open)"
    before = page.evaluate(opened)
    page.locator("#filter").fill("friction")
    assert page.locator("[data-name='ball.friction'] input[type=text]").is_visible()
    assert not page.locator("[data-name='membrane.stiffness']").is_visible()
    page.locator("#filter").fill("shearModulus")
    assert page.locator("[data-name='membrane.shearModulus'] .condition").inner_text() == "counts only with membrane.law = gent"
    page.locator("#filter").fill("")
    assert page.evaluate(opened) == before


def test_whoever_types_is_not_disturbed_and_faults_go_with_the_field(visit):
    visited = visit("#until=4&from=2")
    page = visited.page
    page.evaluate("document.querySelectorAll('details.group').forEach(it => { it.open = true; })")
    page.evaluate("videg.set('membrane.restitution', 0.55)")
    field = visited.field("ball.mass")
    field.fill("0.00")
    page.wait_for_timeout(700)
    assert field.input_value() == "0.00"
    visited.type("membrane.restitution", "1.7")
    field.click()
    visited.settle(lambda: page.evaluate("videg.set('ball.mass', 0.004)"))
    assert visited.field("membrane.restitution").get_attribute("aria-invalid") is None
    assert visited.field("membrane.restitution").input_value() == "0.55"


def test_undo_and_redo_lose_nothing(visit):
    visited = visit("")
    page = visited.page
    visited.settle(lambda: page.evaluate("videg.set('membrane.restitution', 0.55)"))
    visited.go("#case=fig15&until=8&from=4")
    page.locator("#undo").click()
    assert page.evaluate("videg.state.case + JSON.stringify(videg.state.set)") == 'fig14{"membrane.restitution":0.55}'
    page.locator("#undo").click()
    assert page.evaluate("JSON.stringify(videg.state.set)") == "{}"
    # An edit that is not kept yet ends what could be done again.
    page.evaluate("videg.set('ball.mass', 0.004)")
    assert page.locator("#redo").is_disabled()
    page.keyboard.press("Control+Shift+z")
    assert page.evaluate("videg.state.set['ball.mass']") == 0.004
    # A drag is one step.
    box = page.locator("#plot-diagram").bounding_box()
    page.locator("#plot-diagram").scroll_into_view_if_needed()
    wait(page, "() => videg.diagram.took")
    box = page.locator("#plot-diagram").bounding_box()
    page.mouse.move(box["x"] + box["width"] / 3, box["y"] + 50)
    page.mouse.down()
    for k in range(20):
        page.mouse.move(box["x"] + box["width"] * (1 / 3 + k / 100), box["y"] + 50)
    page.wait_for_timeout(600)
    page.mouse.up()
    assert page.evaluate("'membrane.restitution' in videg.state.set")
    page.locator("#undo").click()
    assert page.evaluate("'membrane.restitution' in videg.state.set") is False
    # Beside the axes there is nothing to pick.
    page.mouse.click(box["x"] + 10, box["y"] + 50)
    assert page.evaluate("'membrane.restitution' in videg.state.set") is False


def test_a_map_reads_out_the_cell_below_the_pointer(visit):
    visited = visit("#until=4&from=2&map=ball.mass,cylinder.inclination")
    page = visited.page
    page.locator("#plot-map").scroll_into_view_if_needed()
    wait(page, "() => videg.map.took")
    box = page.locator("#plot-map").bounding_box()
    page.mouse.move(box["x"] + 62 + (box["width"] - 70) * 0.5, box["y"] + 8 + (box["height"] - 30) * 0.23)
    said = page.locator("#map-text").inner_text()
    ys = page.evaluate("videg.map.asked.ys")
    assert re.search(r"(\S+) rad$", said)[1] == f"{ys[int(0.77 * len(ys))]:.3g}", said


def test_machines_that_are_not_wanted_any_more_do_not_keep_others_waiting(visit):
    visited = visit("#until=4&from=2")
    slow = "#case=fig14&excitation.frequency=20000&excitation.amplitude=1000&until=1000&from=500"
    visited.page.evaluate("text => { location.hash = text; }", slow)
    visited.page.evaluate("() => { videg.engine.limit = 600_000; }")
    visited.page.wait_for_timeout(100)
    visited.page.evaluate("text => { location.hash = text; }", "#case=fig15&until=8&from=4")
    wait(visited.page, "videg.settled && videg.state.case === 'fig15' && !document.body.classList.contains('stale')")


def test_cases_are_presets(visit):
    visited = visit()
    cases = visited.page.evaluate("[...document.querySelectorAll('#case option')].map(it => it.value)")
    assert {"fig14", "table3-5hz", "capsule-2-1"} <= set(cases)
    for case in ("table3-5hz", "capsule-2-1", "fig10"):
        numbers = visited.settle(lambda case=case: visited.page.locator("#case").select_option(case))
        expected = json.loads(videg("simulate", "--case", case, "--json"))
        # Fig. 10 is a saddle: the last bits grow.
        assert numbers["average_voltage_gain"] == pytest.approx(expected["average_voltage_gain"], rel=1e-4 if case == "fig10" else 1e-9)


def drop(page, target, name, text):
    page.evaluate(
        """([target, name, text]) => {
            const data = new DataTransfer();
            data.items.add(new File([text], name, { type: 'text/csv' }));
            const event = new DragEvent('drop', { dataTransfer: data, bubbles: true, cancelable: true });
            document.querySelector(target).dispatchEvent(event);
        }""", [target, name, text])


def test_files_of_the_user_are_taken_and_go_into_a_link(visit):
    visited = visit("#until=8&from=4")
    before = visited.numbers()
    rows = "".join(f"{0.01 * k:.2f},{5 * math.sin(0.1 * k):.4f}\n" for k in range(900))
    after = visited.settle(lambda: drop(visited.page, "main", "shaker.csv", f"time,acceleration\n{rows}"))
    assert after["average_voltage_gain"] != before["average_voltage_gain"]
    assert visited.page.evaluate("videg.state.set['excitation.kind']") == "motion"
    wait(visited.page, "location.hash.includes('excitation.file=shaker.csv')")
    assert visit(visited.page.evaluate("location.hash")).numbers() == after
    film = "deflection,force\n0,0\n1e-3,0.01\n3e-3,0.2\n9e-3,4\n"
    with_film = visited.settle(lambda: drop(visited.page, "main", "film.csv", film))
    assert with_film["largest_deflection"] != after["largest_deflection"]


@pytest.mark.parametrize(("text", "said"), [
    ("time,acceleration\n0,1\n0,2\n", "line 3"), ("time,acceleration\n0,one\n1,2\n", "one"), ("a,b\n1,2\n", "its heading"), ("", "its heading"),
    ("deflection,force\n0,0\n1,-1\n2,0\n", "line 3"), ("time,force\n0,1\n1,1e400\n", "line 3"), ("\x00\x01\x02", "its heading"),
])
def test_a_bad_file_is_named_and_the_page_goes_on(visit, text, said):
    visited = visit("#until=4&from=2")
    drop(visited.page, "main", "bad.csv", text)
    wait(visited.page, "said => document.getElementById('message').textContent.includes(said)", said)
    visited.go("#case=fig14&until=8&from=4")
    assert visited.message() == ""
    assert visited.numbers()["impacts"] > 0


def test_a_value_out_of_bounds_is_named_with_its_bound(visit):
    visited = visit("#until=4&from=2")
    for name, text, said in [("membrane.restitution", "1.7", "allowed: 0 to 1"), ("membrane.restitution", "", "allowed: 0 to 1"), ("membrane.restitution", "0,5", "allowed"),
                             ("ball.mass", "NaN", "allowed: 1e-9"), ("ball.mass", "-1", "allowed"), ("excitation.seed", "1.5", "whole numbers")]:
        visited.type(name, text)
        assert said in visited.message(), name
        assert visited.field(name).get_attribute("aria-invalid") == "true"
    assert visited.page.evaluate("Object.keys(videg.state.set)") == []


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
    visited.page.evaluate("text => { location.hash = text; }", "#case=fig14&excitation.frequency=100000&excitation.amplitude=1000000&until=1000&from=500")
    wait(visited.page, "() => document.body.classList.contains('stale')")
    assert "too many" in visited.message() or "more than" in visited.message()
    frames = visited.page.evaluate("new Promise(done => { let n = 0; const go = () => (++n === 20 ? done(n) : requestAnimationFrame(go)); go(); })")
    assert frames == 20
    visited.go("#case=fig14&until=8&from=4")
    assert visited.message() == "" and visited.numbers()["impacts"] > 0


def test_the_motion_can_be_stopped_and_stepped(visit):
    visited = visit()
    page = visited.page
    page.locator("#play").click()
    clock = page.evaluate("videg.clock")
    page.wait_for_timeout(200)
    assert page.evaluate("videg.clock") == clock
    page.locator("#next").click()
    impacts = page.evaluate("[...videg.shown.impacts].filter((_, k) => k % 3 === 0)")
    assert page.evaluate("videg.clock") == min(it for it in impacts if it > clock)
    page.locator("h1").click()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowLeft")
    assert page.evaluate("videg.clock") == min(it for it in impacts if it > clock)
    page.keyboard.press(" ")
    wait(page, "clock => videg.clock !== clock", page.evaluate("videg.clock"))
    # The ball and the film are where the motion says.
    page.keyboard.press(" ")
    at = page.evaluate("""() => { const { k, part } = videg.locate(videg.clock); const { rows, width, column } = videg.shown;
        const c = column('ball.position'); return rows[k * width + c] + part * (rows[(k + 1) * width + c] - rows[k * width + c]); }""")
    drawn = page.evaluate("Number(document.querySelector('#device .ball').getAttribute('cx')) / videg.device.unit")
    assert drawn == pytest.approx(at, abs=1e-4)


def test_with_reduced_motion_nothing_moves_at_first(visit):
    page = visit(reduced_motion="reduce").page
    clock = page.evaluate("videg.clock")
    page.wait_for_timeout(300)
    assert page.evaluate("videg.clock") == clock
    assert page.locator("#play").inner_text() == "Play"


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


@pytest.fixture
def exported(visit):
    """The files that the page exports, by their endings."""
    visited = visit("#case=fig14&topology=isolated&release=switch&zener.voltage=2700&until=8&from=4&membrane.restitution=0.55")
    files = {}
    for name in visited.page.evaluate("[...document.querySelectorAll('#export button')].map(it => it.textContent)"):
        with visited.page.expect_download() as download:
            visited.page.evaluate("name => [...document.querySelectorAll('#export button')].find(it => it.textContent === name).click()", name)
        files[download.value.suggested_filename.removeprefix("fig14-changed")] = Path(download.value.path()).read_text()
    return visited, files


def assert_python_runs(text, numbers, folder):
    """The script for Python, with a package that asks the command line: the package itself is installed in the stage `python` only."""
    class Run(dict):
        __getattr__ = dict.__getitem__

    def cosim(case, set, until, window):  # noqa: A002
        settings = [part for name, value in set.items() for part in ("--set", f"{name}={value}")]
        run = videg("cosim", "--case", case, *settings, "--until", str(until), "--window", f"{window[0]},{window[1]}", "--json", "--output", str(folder / "python"))
        return Run(json.loads(run))

    module = types.ModuleType("videg")
    module.cosim = cosim
    printed = io.StringIO()
    with pytest.MonkeyPatch.context() as patch, contextlib.redirect_stdout(printed):
        patch.setitem(sys.modules, "videg", module)
        exec(compile(text, "exported.py", "exec"), {})  # noqa: S102 - what our own page wrote
    net = float(re.match(r"net power (\S+) uW", printed.getvalue())[1])
    assert net == pytest.approx(numbers["net_power"] * 1e6, rel=5e-3)


def test_what_is_exported_runs_in_the_tools(exported, tmp_path):
    visited, files = exported
    numbers = visited.numbers()
    (tmp_path / "case.toml").write_text(files[".toml"])
    result = json.loads(videg("cosim", "--case-file", str(tmp_path / "case.toml"), "--json", "--output", str(tmp_path / "cosim")))
    assert result["net_power"] == pytest.approx(numbers["net_power"], rel=5e-3)
    assert result["average_voltage_gain"] == pytest.approx(numbers["average_voltage_gain"], rel=1e-9)

    videg("fmu", "build")
    script = tmp_path / "with_fmpy.py"
    script.write_text(files["-fmpy.py"].replace("target/fmu", str(harness.ROOT / "target/fmu")))
    printed = subprocess.run([harness.ROOT / ".venv/bin/python", script], check=True, capture_output=True, text=True).stdout
    impacts = visited.page.evaluate("""async () => {
        const { values, files } = videg.machine();
        const answer = await videg.engine.ask({ job: 'live', machine: { values, files }, from: 0, until: 8, begin: 0, end: 8, spacing: 0.1 });
        return answer.numbers.impacts;
    }""")
    assert f"{impacts:.0f} impacts" in printed

    assert_python_runs(files[".py"], numbers, tmp_path)
    for ending in (".svg", "-C.csv", "-C.lib", "-C-ltspice.lib", "-C-qspice.lib"):
        assert files[ending], ending
    assert files[".svg"].startswith("<svg") and "NaN" not in files[".svg"]


def test_ngspice_takes_the_exported_subcircuits(exported, tmp_path):
    """A source at 1 kV on a membrane: the charge that flows is the voltage times the change of C."""
    _, files = exported
    (tmp_path / "c.lib").write_text(files["-C.lib"])
    rows = [line.split(",") for line in files["-C.csv"].splitlines()[2:]]
    times, left = ([float(row[k]) for row in rows] for k in (0, 1))
    top = max(range(len(left)), key=lambda k: left[k])
    deck = f"""title
.include c.lib
V1 a 0 1000
Xl a 0 deg_left
Xr a2 0 deg_right
V2 a2 0 1000
.tran 1e-4 {times[top]} 0 1e-4 uic
.measure tran q integ i(V1)
.end
"""
    (tmp_path / "deck.cir").write_text(deck)
    printed = subprocess.run(["ngspice", "-b", "deck.cir"], cwd=tmp_path, check=True, capture_output=True, text=True).stdout
    charge = -float(re.search(r"^q\s*=\s*(\S+)", printed, re.MULTILINE)[1])
    # What the linear part takes at 0 s is not in the integral of a start with uic.
    assert charge == pytest.approx(1000 * (left[top] - left[0]), rel=0.02, abs=1e-11)


@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_the_page_fits_every_window(visit, width, scheme):
    visited = visit("#case=fig14&topology=isolated&release=switch&zener.voltage=2700", width=width, scheme=scheme)
    page = visited.page
    page.evaluate("document.getElementById('maps').scrollIntoView()")
    wait(page, "() => videg.map.took && videg.diagram.took")
    page.evaluate("scrollTo(0, 0)")
    assert page.evaluate(OVERFLOW) <= 0
    assert page.evaluate(BEYOND) == []
    assert page.evaluate(NAMELESS) == []
    page.screenshot(path=chromium.SCREENSHOTS / f"explorer-{width}-{scheme}.png", full_page=True)
    if width == 375:
        page.locator("#open-controls").click()
        page.locator("#groups summary").first.wait_for(state="visible")
        assert page.evaluate(OVERFLOW) <= 0
    page.locator("#export summary").click()
    assert page.evaluate(BEYOND) == []
    page.keyboard.press("Escape")
    assert not page.locator("#export button").first.is_visible()
