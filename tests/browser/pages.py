"""What is asked of each page, be it a report or the explorer."""

import itertools
import os
from contextlib import contextmanager

# Whether all of what takes long is run, as in the stage soak.
FULL = os.environ.get("VIDEG_SOAK") == "full"

# Both sides of the page, which text and figures must not leave unless a box of their own scrolls.
OVERFLOW = "document.documentElement.scrollWidth - document.documentElement.clientWidth"


def windows(widths):
    """Each width with light or dark by turns, since the scheme changes colours only; in full, with both."""
    schemes = ["light", "dark"]
    return list(itertools.product(widths, schemes) if FULL else zip(widths, itertools.cycle(schemes)))


def beyond(boxes):
    """What sticks out of the page and is in none of these boxes, which scroll."""
    return """() => [...document.querySelectorAll('body *')].filter(it => {
    if (it.closest('BOXES') || !it.checkVisibility()) return false;
    const box = it.getBoundingClientRect();
    return box.width > 0 && (box.right > document.documentElement.clientWidth + 1 || box.left < -1);
}).map(it => it.outerHTML.slice(0, 100))""".replace("BOXES", boxes)


class Visit:
    """An open page with all that it did wrong. It waits for an element at most `patience`, ms."""

    def __init__(self, browser, path, patience, **options):
        self.path = path
        self.faults = []
        self.context = browser.new_context(**options)
        self.context.set_default_timeout(patience)
        self.page = self.context.new_page()
        self.page.on("console", self.heard)
        self.page.on("pageerror", lambda error: self.faults.append(f"error: {error}"))
        self.page.on("request", self.requested)

    def open(self, fragment=""):
        self.page.goto(self.path.as_uri() + fragment)

    def heard(self, message):
        if message.type in ("error", "warning"):
            self.faults.append(f"{message.type}: {message.text}")

    def requested(self, request):
        if request.url.split("#")[0] != self.path.as_uri() and not request.url.startswith(("data:", "blob:")):
            self.faults.append(f"request: {request.url}")


@contextmanager
def closing():
    """A list for visits, which are closed in the end; nothing may have gone wrong then."""
    visits = []
    yield visits
    faults = [fault for visit in visits for fault in visit.faults]
    for visit in visits:
        visit.context.close()
    assert faults == []
