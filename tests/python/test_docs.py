"""The blocks of docs/howto/python.md and of the README run in order in one interpreter, and print what is shown there."""

import contextlib
import io
import os
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent.parent
BLOCK = re.compile(r"```python\n(.*?)```\n\n```text\n(.*?)```", re.DOTALL)


@pytest.mark.parametrize("name", ["README.md", "docs/howto/python.md"])
def test_a_page_prints_what_it_shows(name: str, tmp_path: Path, monkeypatch) -> None:
    page = ROOT / name
    monkeypatch.chdir(tmp_path)
    text, names = page.read_text(), {}
    blocks = list(BLOCK.finditer(text))
    assert len(blocks) == text.count("```python")
    for block in blocks:
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile(block[1], name, "exec"), names)  # noqa: S102 - our own page
        if os.environ.get("UPDATE_BOOK"):
            page.write_text(page.read_text().replace(block[0], block[0].replace(block[2], printed.getvalue())))
        else:
            assert printed.getvalue() == block[2]
