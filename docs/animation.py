"""Makes docs/figures/explorer.webp: the page of `videg explore` in slow motion. `python docs/animation.py [FRAMES [FILE]]`.

Needs ./test.sh setup, and a Rust toolchain with the target wasm32-unknown-unknown.
"""

import io
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests/support"))

import chromium  # noqa: E402

# A circuit that gains, and what shows it: from the device to the voltages.
MACHINE = "#case=fig14&topology=isolated&release=switch&zener.voltage=2911&span=2"
WIDTH, HEIGHT = 1240, 950
SCALE = 0.68
# What a picture has room for.
STYLE = """
#layout { grid-template-columns: minmax(0, 1fr); }
#controls, header .tools, .transport, .aside, #charts figure:nth-child(1), #charts figure:nth-child(4), #side figure:nth-child(2) { display: none; }
"""
# One period of the excitation, in so many frames of so many milliseconds.
FRAMES, DELAY = 90, 70


def draw(frames: int, output: Path) -> None:
    with tempfile.TemporaryDirectory() as folder:
        page = Path(folder) / "explorer.html"
        subprocess.run(["cargo", "run", "--quiet", "--release", "--", "explore", "--no-open", "--output", page], cwd=ROOT, check=True)
        pictures = [picture.resize((int(WIDTH * SCALE), int(HEIGHT * SCALE)), Image.Resampling.LANCZOS) for picture in shots(page, frames)]
    pictures[0].save(output, save_all=True, append_images=pictures[1:], duration=DELAY, loop=0, quality=60, method=4, minimize_size=True)
    print(f"{output}: {output.stat().st_size // 1000} kB")


def shots(page: Path, frames: int):
    """Pictures of the page at times that are spread over a period."""
    with chromium.headless() as browser:
        context = browser.new_context(viewport={"width": WIDTH, "height": HEIGHT}, reduced_motion="reduce")
        visit = context.new_page()
        visit.goto(page.as_uri() + MACHINE)
        while not visit.evaluate("window.videg?.shown && videg.settled"):
            visit.wait_for_timeout(20)
        visit.add_style_tag(content=STYLE)
        visit.wait_for_timeout(500)
        for k in range(frames):
            visit.evaluate("part => { videg.clock = videg.shown.begin + 0.25 + 0.5 * part; }", k / frames)
            # Two frames of the browser, so that what was drawn is what is seen.
            visit.evaluate("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
            yield Image.open(io.BytesIO(visit.screenshot())).convert("RGB")


if __name__ == "__main__":
    draw(int(sys.argv[1]) if len(sys.argv) > 1 else FRAMES, Path(sys.argv[2]) if len(sys.argv) > 2 else ROOT / "docs/figures/explorer.webp")
