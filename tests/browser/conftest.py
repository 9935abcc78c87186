"""Reports to look at, and the browser to look with."""

import os
import subprocess
from pathlib import Path

import pytest

import chromium
import harness
from pages import Visit, closing


def run(*command):
    cargo = ["cargo", "run", "--quiet", "--release", *command]
    subprocess.run(cargo, cwd=harness.ROOT, check=True, stdout=subprocess.DEVNULL)


# Verbs with their options: one report each. The inclined capsule has all that a drawing of the device can show.
VERBS = {
    "cosim": ["cosim", "--until", "10"],
    "capsule": ["cosim", "--until", "10", "--set", "contact.law=compliant", "--set", "cylinder.inclination=0.3", "--set", "contact.electrostaticFeedback=true", "--set",
                "contact.reaction=true", "--set", "cylinder.suspensionStiffness=20", "--set", "topology=isolated", "--set", "release=storage",
                "--set", "leakage.timeConstant=50"],
    "simulate": ["simulate", "--until", "10"],
    "crosscheck": ["crosscheck", "--until", "2"],
    "dynamics": ["dynamics", "--orbits"],
    "reproduce": ["reproduce", "--quick", "all"],
    "map": ["map", "zener.voltage=2000:4300:6", "load.resistance=log:1e8:1e12:5", "--set", "topology=isolated", "--set", "release=switch",
            "--window", "5,10", "--until", "10"],
}
# Names of pages that are not called report.html.
PAGES = {"map": "map.html"}


def make_report(kind, folder):
    if kind == "figures":
        subprocess.run([harness.example("figures"), folder / "report.html"], cwd=harness.ROOT, check=True, stdout=subprocess.DEVNULL)
    else:
        run("--", *VERBS[kind], "--output", str(folder))
    return folder / PAGES.get(kind, "report.html")


def kinds():
    """Of the reports to test: those of VIDEG_REPORTS, paths with colons between, or those that the tests make."""
    given = os.environ.get("VIDEG_REPORTS")
    return given.split(":") if given else ["figures", *VERBS]


@pytest.fixture(scope="session", params=kinds())
def report(request, tmp_path_factory):
    """Path of a report, and a name for it."""
    if request.param == "figures" or request.param in VERBS:
        return make_report(request.param, tmp_path_factory.mktemp(request.param)), request.param
    path = Path(request.param).resolve()
    assert path.is_file(), f"{path} is no file"
    return path, path.parent.name


@pytest.fixture(scope="session")
def browser():
    with chromium.headless() as browser:
        yield browser


class ReportVisit(Visit):
    """An open report."""

    def __init__(self, browser, report, **options):
        path, self.name = report
        # A chart of all events takes long to draw where other programs run, too.
        super().__init__(browser, path, 180_000, **options)
        self.open()

    def shoot(self, name, target=None):
        path = chromium.SCREENSHOTS / f"{self.name}-{name}.png"
        if target:
            target.screenshot(path=path)
        else:
            self.page.screenshot(path=path, full_page=True)


@pytest.fixture(scope="session")
def page(browser, report):
    """The report on a desktop, open once for tests that only read it."""
    with closing() as visits:
        visits.append(ReportVisit(browser, report, viewport={"width": 1440, "height": 900}))
        yield visits[0].page


@pytest.fixture
def visit(browser, report):
    """Opens the report; after the test, nothing may have gone wrong."""
    with closing() as visits:
        def open_report(width=1440, scheme="light", **options):
            visits.append(ReportVisit(browser, report, viewport={"width": width, "height": 900}, color_scheme=scheme, **options))
            return visits[-1]

        yield open_report
