"""How fast the page of `videg explore` is, on a quiet machine: `.venv/bin/python tests/browser/explorer_speed.py`."""

import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "support"))

import chromium  # noqa: E402
import harness  # noqa: E402

# Moves a slider as a hand does: at each frame of the browser, to and fro.
DRAG = """async () => {
    const slider = document.querySelector("[data-name='membrane.restitution'] input[type=range]");
    const answers = videg.answers;
    videg.forget();
    for (let k = 0; k < 300; k++) {
        slider.value = 500 + Math.round(300 * Math.sin(k / 30));
        slider.dispatchEvent(new Event('input', { bubbles: true }));
        await new Promise(requestAnimationFrame);
    }
    return { frames: videg.frames(), answers: videg.answers - answers };
}"""
RUNS = """async () => {
    const { values, files } = videg.machine();
    const took = [];
    for (let k = 0; k < 30; k++) {
        const answer = await videg.engine.ask({ job: 'live', machine: { values, files }, from: 50, until: 100, begin: 50, end: 52, spacing: 0.005 });
        took.push(answer.took);
    }
    return took.slice(10);
}"""


def wait(page, condition):
    while not page.evaluate(condition):
        page.wait_for_timeout(10)


def native(page):
    """Milliseconds of the same run outside of a browser."""
    command = ["cargo", "run", "--quiet", "--release", "--package", "videg-explorer", "--example", "native"]
    machine = " ".join(f"{name}={value!r}" for name, value in page.evaluate("videg.machine().values"))
    took = {}
    for count in (1, 1, 201):
        began = time.monotonic()
        subprocess.run(command, cwd=harness.ROOT, check=True, capture_output=True, text=True, input=f"50 100 {machine}\n" * count)
        took[count] = time.monotonic() - began
    return 1000 * (took[201] - took[1]) / 200


def main():
    with tempfile.TemporaryDirectory() as folder, chromium.headless() as browser:
        path = Path(folder) / "explorer.html"
        subprocess.run(["cargo", "run", "--quiet", "--release", "--", "explore", "--no-open", "--output", path], cwd=harness.ROOT, check=True)
        print(f"file: {path.stat().st_size / 1e6:.2f} MB")
        page = browser.new_context(viewport={"width": 1440, "height": 900}).new_page()
        began = time.monotonic()
        page.goto(path.as_uri())
        wait(page, "window.videg?.shown")
        print(f"from opening it to the first picture: {time.monotonic() - began:.2f} s")
        dragged = page.evaluate(DRAG)
        frames = dragged["frames"]
        late = sum(frame > 20 for frame in frames)
        print(f"dragging a slider of Fig. 14: median of {len(frames)} frames {statistics.median(frames):.1f} ms, {late} above 20 ms; {dragged['answers']} machines computed")
        page.evaluate("videg.set('membrane.restitution', undefined)")
        here, there = statistics.median(page.evaluate(RUNS)), native(page)
        print(f"a run of 100 s with its limits: {here:.1f} ms, natively compiled {there:.1f} ms: {here / there:.2f} times")
        page.evaluate("document.getElementById('maps').scrollIntoView()")
        wait(page, "videg.settled && videg.diagram.took && videg.map.took")
        for name, text in (("diagram", "bifurcation diagram"), ("map", "map of net power")):
            page.evaluate(f"videg.{name}.key = ''; videg.{name}.took = 0; videg.{name}.later(0)")
            wait(page, f"videg.{name}.took")
            print(f"{text}: {page.locator(f'#{name}-text').inner_text()}")


if __name__ == "__main__":
    main()
