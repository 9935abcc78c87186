"""A headless Chromium that asks nobody for anything, and where its pictures go."""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager

from playwright.sync_api import Browser, sync_playwright

import harness

SCREENSHOTS = harness.TARGET / "screenshots"
QUIET = [
    "--no-sandbox",
    "--disable-gpu",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]


@contextmanager
def headless() -> Iterator[Browser]:
    """The system's Chromium, until the end of the block; a folder for pictures is there.

    That without windows takes a quarter less of the processor: the other one makes a frame with its buttons for each page.
    """
    program = shutil.which("chromium-headless-shell") or shutil.which("chromium")
    assert program, "neither chromium-headless-shell nor chromium is on the PATH; run ./test.sh setup first"
    SCREENSHOTS.mkdir(parents=True, exist_ok=True)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=QUIET)
        yield browser
        browser.close()
