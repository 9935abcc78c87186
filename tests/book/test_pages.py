"""What a reader of the built book sees, in a phone's and a desktop's window, in light and dark, without a network."""

import re

import pytest

import chromium
from harness import ROOT

BOOK = ROOT / "target" / "book" / "html"
# A page of its own, which tests/browser looks at.
EXPLORER = BOOK / "explorer.html"
PAGES = sorted(path for path in BOOK.rglob("*.html") if path.name not in ("print.html", "toc.html", "404.html", EXPLORER.name))

OVERFLOW = "document.documentElement.scrollWidth - document.documentElement.clientWidth"
FLAT = "[...document.querySelectorAll('main math')].filter(math => math.getBoundingClientRect().height < 4).length"
# Brackets that are less than half as high as what they hold.
SHORT = """[...document.querySelectorAll('main math[display=block] mrow')].filter(row => {
    const [first] = row.children
    const fences = first?.tagName === 'mo' && '([{'.includes(first.textContent) && first.textContent
    const tall = [...row.querySelectorAll('mtable')].map(it => it.getBoundingClientRect().height)
    return fences && first.getBoundingClientRect().height < 0.5 * Math.max(0, ...tall)
}).length"""
CUT = "[...document.querySelectorAll('main table, main pre > code')].filter(it => it.scrollWidth > it.clientWidth + 1).length"
BROKEN = "[...document.images].filter(image => image.naturalWidth === 0).map(image => image.src)"
LATEX = re.compile(r"\$\$|\\(?:t?frac|sqrt|text|left|quad|begin|Delta|omega)\b")


@pytest.fixture(scope="module")
def browser():
    with chromium.headless() as browser:
        yield browser


def test_every_chapter_became_a_page():
    summary = (ROOT / "docs" / "SUMMARY.md").read_text()
    chapters = [BOOK / name.replace(".md", ".html") for name in re.findall(r"\]\((.+?\.md)\)", summary)]
    assert chapters and [page for page in chapters if not page.is_file()] == []


def test_the_first_page_leads_to_the_explorer(browser):
    page = browser.new_page()
    page.goto((BOOK / "index.html").as_uri())
    page.get_by_role("link", name="Open the explorer").click()
    page.locator("#net-value").wait_for()
    assert page.url == EXPLORER.as_uri()
    page.close()


def test_no_page_shows_the_markup_of_an_equation():
    shown = [path.name for path in PAGES if "&lt;math xmlns" in path.read_text()]
    assert shown == [], "docs/equations.py took code for an equation"


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [375, 1280])
def test_every_page_fits_has_its_equations_and_asks_for_nothing(browser, width, scheme):
    faults = []
    context = browser.new_context(viewport={"width": width, "height": 900}, color_scheme=scheme)
    page = context.new_page()
    page.on("pageerror", lambda error: faults.append(f"{page.url}: {error}"))
    page.on("request", lambda request: request.url.startswith(("file:", "data:")) or faults.append(request.url))
    for path in PAGES:
        page.goto(path.as_uri())
        name = path.relative_to(BOOK).with_suffix("")
        words = page.locator("main").evaluate(
            "main => { const copy = main.cloneNode(true); copy.querySelectorAll('code').forEach(code => code.remove()); "
            "return copy.textContent }"
        )
        if found := LATEX.search(words):
            faults.append(f"{name}: {found[0]} is left of an equation")
        wrongs = [("wide", OVERFLOW), ("flat equations", FLAT), ("short brackets", SHORT)]
        if width > 1000:
            wrongs.append(("cut tables or code", CUT))
        for what, wrong in ((what, page.evaluate(script)) for what, script in wrongs):
            if wrong > 0:
                faults.append(f"{name} at {width}: {what}: {wrong}")
        faults += [f"{name}: {image} is not drawn" for image in page.evaluate(BROKEN)]
        page.screenshot(path=chromium.SCREENSHOTS / f"book-{str(name).replace('/', '-')}-{width}-{scheme}.png")
    context.close()
    assert faults == []
