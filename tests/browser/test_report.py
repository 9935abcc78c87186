"""What a reader of a report sees, in a phone's and a desktop's window, in light and dark, and on paper."""

import json
import re

import pytest
from playwright.sync_api import TimeoutError

from pages import FULL, OVERFLOW, beyond, windows

# Phone, tablet and desktop.
WINDOWS = windows([375, 800, 1440])
BEYOND = beyond(".scroll, .plot, .chart, pre, .thumbnails svg, desc")
# So many charts of a report open at each width; in full, all.
FEW = 10
# Texts of a picture that reach over its edge.
CLIPPED = """picture => {
    const frame = picture.getBoundingClientRect();
    return [...picture.querySelectorAll('text')].filter(text => {
        const box = text.getBoundingClientRect();
        return box.width > 0 && (box.left < frame.left - 1 || box.right > frame.right + 1 || box.top < frame.top - 1 || box.bottom > frame.bottom + 1);
    }).map(text => text.textContent);
}"""
UNFOLD = "() => document.querySelectorAll('details').forEach(details => { details.open = true; })"
# Height of a page of the report on a desktop, in screens.
SCREENS = "() => document.documentElement.scrollHeight / 900"
PANELS = "box => box.querySelectorAll('.cartesianlayer > .subplot').length"
RANGES = """box => Object.fromEntries(
    Object.entries(box._fullLayout).filter(([name]) => /^xaxis/.test(name)).map(([name, axis]) => [name, axis.range])
)"""


# Keys of the legends that show as a whole within the chart.
KEYS = """box => {
    const frame = box.getBoundingClientRect();
    return [...box.querySelectorAll('text[class^=legend]')].map(text => text.getBoundingClientRect())
        .filter(key => key.width > 0 && key.left >= frame.left && key.right <= frame.right && key.top >= frame.top).length;
}"""


def keys_of(chart):
    traces = sum(trace.get("showlegend", False) for trace in chart["traces"])
    return traces + sum(line["label"] != "" for panel in chart["panels"] for line in panel["lines"])


def look_closer(figure):
    figure.get_by_role("button", name="Look closer").click()
    figure.locator(".chart .main-svg").first.wait_for(state="visible")


def double_click_until(page, place, condition, argument):
    """Double-clicks, again if the two clicks came too far apart: a busy machine may draw between them."""
    for _ in range(10):
        page.mouse.dblclick(*place)
        try:
            return page.wait_for_function(condition, arg=argument, timeout=3000)
        except TimeoutError:
            pass
    pytest.fail(f"ten double clicks did not bring about {condition}")


def chart_of(figure):
    return json.loads(figure.locator("script").text_content())


@pytest.mark.parametrize(("width", "scheme"), WINDOWS)
def test_the_page_fits_and_every_picture_is_drawn(visit, width, scheme):
    visited = visit(width, scheme)
    page = visited.page
    visited.shoot(f"{width}-{scheme}")
    assert page.evaluate(OVERFLOW) <= 0 and page.evaluate(BEYOND) == []
    page.evaluate(UNFOLD)
    assert page.evaluate(OVERFLOW) <= 0 and page.evaluate(BEYOND) == []
    pictures = page.locator("figure .plot > svg").all()
    assert len(pictures) == page.locator("figure").count() > 0
    for picture in pictures:
        box = picture.bounding_box()
        assert box["width"] > 200 and box["height"] > 50
        assert picture.evaluate(CLIPPED) == []
        assert picture.locator("path, polyline, polygon, circle").count() > 0


@pytest.mark.parametrize(("width", "scheme"), WINDOWS)
def test_every_chart_opens_with_all_its_panels_and_closes_again(visit, width, scheme):
    visited = visit(width, scheme)
    page = visited.page
    page.evaluate(UNFOLD)
    figures = list(enumerate(page.locator("figure.interactive").all(), 1))
    # All figures of the paper take minutes: one after the other takes its turn at a width.
    turn = WINDOWS.index((width, scheme))
    for number, figure in figures if FULL or len(figures) <= FEW else figures[turn::len(WINDOWS)]:
        look_closer(figure)
        box, panels = figure.locator(".chart"), chart_of(figure)["panels"]
        assert box.evaluate(PANELS) == len(panels)
        # Legends come last, some after the first frame.
        page.wait_for_function(f"([box, keys]) => ({KEYS})(box) === keys",
                               arg=[box.element_handle(), keys_of(chart_of(figure))], timeout=60_000)
        assert box.locator(".trace path, .heatmaplayer image, .point").count() > 0
        visited.shoot(f"{width}-{scheme}-chart{number}", figure)
        assert page.evaluate(OVERFLOW) <= 0
        figure.get_by_role("button", name="Back to the picture").click()
        assert box.is_hidden() and figure.locator(".plot").is_visible()


def test_dragging_zooms_linked_panels_together_and_a_double_click_resets(visit):
    page = visit().page
    for figure in page.locator("figure.interactive").all():
        panels = chart_of(figure)["panels"]
        linked = next((k for k, panel in enumerate(panels) if panel["linked"] is not None), None)
        if linked is None:
            continue
        above = panels[linked]["linked"]
        look_closer(figure)
        chart = figure.locator(".chart")
        before = chart.evaluate(RANGES)
        area = chart.locator(".nsewdrag").nth(above)
        area.scroll_into_view_if_needed()
        box = area.bounding_box()
        middle = box["y"] + box["height"] / 2
        page.mouse.move(box["x"] + 0.3 * box["width"], middle)
        page.mouse.down()
        page.mouse.move(box["x"] + 0.5 * box["width"], middle, steps=5)
        page.mouse.up()
        name = [f"xaxis{k + 1 if k else ''}" for k in (above, linked)]
        page.wait_for_function("([box, key, old]) => box._fullLayout[key].range[0] > old + 1e-9",
                               arg=[chart.element_handle(), name[1], before[name[1]][0]])
        after = chart.evaluate(RANGES)
        assert after[name[0]] == pytest.approx(after[name[1]])
        double_click_until(
            page, (box["x"] + 0.5 * box["width"], middle),
            "([box, key, old]) => Math.abs(box._fullLayout[key].range[0] - old) < 1e-6",
            [chart.element_handle(), name[0], before[name[0]][0]])


def test_a_chart_follows_the_window_and_the_scheme(visit):
    page = visit().page
    for figure in page.locator("figure.interactive").all()[:1]:
        look_closer(figure)
        paper = "box => box._fullLayout.paper_bgcolor"
        light = figure.locator(".chart").evaluate(paper)
        page.emulate_media(color_scheme="dark")
        page.set_viewport_size({"width": 375, "height": 800})
        width = "box => box._fullLayout.width <= box.clientWidth"
        page.wait_for_function(f"box => ({width})(box) && ({paper})(box) !== {json.dumps(light)}",
                               arg=figure.locator(".chart").element_handle())
        assert page.evaluate(OVERFLOW) <= 0


def test_without_scripts_the_pictures_stand_alone(visit):
    page = visit(java_script_enabled=False).page
    assert page.get_by_role("button").count() == 0
    assert all(picture.is_visible() for picture in page.locator("figure .plot > svg").all())


def test_paper_shows_pictures_even_of_open_charts(visit):
    visited = visit()
    page = visited.page
    for figure in page.locator("figure.interactive").all()[:1]:
        look_closer(figure)
    page.emulate_media(media="print")
    assert all(picture.is_visible() for picture in page.locator("figure .plot > svg").all())
    assert not any(button.is_visible() for button in page.locator("figure button").all())
    # They lead to sections of a page that paper shows whole.
    assert not any(links.is_visible() for links in page.locator("nav, .thumbnails").all())
    pdf = page.pdf(format="A4", print_background=False)
    assert pdf.startswith(b"%PDF") and len(re.findall(rb"/Type\s*/Page\b", pdf)) >= 1


def test_every_link_leads_somewhere_within_the_page(page):
    for target in page.locator("a[href]").evaluate_all("links => links.map(link => link.getAttribute('href'))"):
        assert target.startswith("#") and page.locator(f"[id='{target[1:]}']").count() == 1


def test_the_answer_comes_first(page):
    keys, figures = page.locator(".keys .value"), page.locator("figure")
    if keys.count() == 0:
        return
    assert keys.first.bounding_box()["y"] < 400
    assert figures.first.bounding_box()["y"] < 900 or page.locator(".thumbnails").count() == 1


def test_the_paper_takes_few_screens_and_thumbnails_show_their_figures(page):
    if page.locator(".thumbnails").count() == 0:
        return
    assert page.evaluate(SCREENS) < 15
    for thumbnail in page.locator(".thumbnails use").all():
        assert thumbnail.bounding_box()["width"] > 40


def test_the_flows_of_every_stage_close_but_for_the_residual_that_is_stated(page):
    for picture in page.locator("svg.sankey").all():
        bands = picture.evaluate("""picture => [...picture.querySelectorAll('path[data-flow]')].map(band => ({...band.dataset}))""")
        lines = [line for line in picture.locator("text").all_text_contents() if "residual" in line]
        assert bands and lines
        for stage, line in enumerate(lines):
            total = {end: sum(float(band["flow"]) for band in bands if band.get(end) == str(stage)) for end in ("from", "to")}
            residual = float(re.search(r"residual (\S+)", line)[1])
            assert all(float(band["flow"]) > 0 for band in bands)
            assert total["to"] - total["from"] == pytest.approx(residual, rel=0.06, abs=1e-7 * total["to"])
            # What the coupling in steps leaves.
            assert abs(residual) < 1e-2 * total["to"], line
