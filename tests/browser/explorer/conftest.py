"""The page of `videg explore`, opened."""

import pytest

from explorer_page import ExplorerVisit, videg
from pages import closing


@pytest.fixture(scope="session")
def explorer(tmp_path_factory):
    """The page."""
    path = tmp_path_factory.mktemp("explorer") / "explorer.html"
    videg("explore", "--output", str(path), "--no-open")
    return path


@pytest.fixture
def visit(browser, explorer):
    """Opens the page; after the test, nothing may have gone wrong."""
    with closing() as visits:
        def open_page(fragment="", width=1440, height=900, scheme="light", **options):
            visits.append(ExplorerVisit(browser, explorer, fragment, viewport={"width": width, "height": height}, color_scheme=scheme, **options))
            return visits[-1]

        yield open_page
