"""The page of `videg explore` as the tests handle it."""

import subprocess
import time

import harness
from pages import Visit


def wait(page, condition, argument=None, seconds=180):
    """Until a condition holds: the page lets nobody evaluate texts, so Playwright cannot wait within it."""
    end = time.monotonic() + seconds
    while not page.evaluate(condition, argument):
        assert time.monotonic() < end, condition
        page.wait_for_timeout(10)


def videg(*arguments):
    command = ["cargo", "run", "--quiet", "--release", "--", *arguments]
    return subprocess.run(command, cwd=harness.ROOT, check=True, capture_output=True, text=True).stdout


class ExplorerVisit(Visit):
    """The open page, once it shows its first numbers or says why there are none."""

    def __init__(self, browser, path, fragment, **options):
        super().__init__(browser, path, 60_000, accept_downloads=True, **options)
        self.open(fragment)
        wait(self.page, "window.videg")
        # On a busy machine a run takes longer than the page has patience for.
        self.page.evaluate("() => { window.limit = videg.engine.limit; videg.engine.limit = 60_000; }")
        wait(self.page, "videg.shown || document.body.classList.contains('stale')")

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


def drop(page, target, name, text):
    page.evaluate(
        """([target, name, text]) => {
            const data = new DataTransfer();
            data.items.add(new File([text], name, { type: 'text/csv' }));
            const event = new DragEvent('drop', { dataTransfer: data, bubbles: true, cancelable: true });
            document.querySelector(target).dispatchEvent(event);
        }""", [target, name, text])
