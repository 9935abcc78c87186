"""The page of `videg explore` in the hands of a user: it fits every window, loses nothing and says what it does not take."""

import math
import re

import pytest

import chromium
from explorer_page import drop, wait
from pages import OVERFLOW, beyond, windows

WIDTHS = [375, 800, 1440, 2560]
BEYOND = beyond("svg, .plot, #controls, select")
# Controls without a name for a screen reader.
NAMELESS = """() => [...document.querySelectorAll('input, select, button, summary, [role=img]')].filter(it => {
    const said = it.getAttribute('aria-label') || it.textContent.trim() || it.labels?.[0]?.textContent.trim() || it.title;
    return !said;
}).map(it => it.outerHTML.slice(0, 100))"""


def test_the_page_is_one_small_file_and_runs_its_own_scripts_only(explorer):
    text = explorer.read_text()
    assert len(text) < 1_500_000
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', text)[1]
    assert "default-src 'none'" in policy and "unsafe-eval'" not in policy.replace("'wasm-unsafe-eval'", "")
    assert not re.search(r"(src|href)=\"(?!data:)", text.split("<script")[0])


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


@pytest.mark.parametrize(("width", "scheme"), windows(WIDTHS))
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
