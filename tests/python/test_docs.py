"""The blocks of docs/howto/python.md run in order in one interpreter, and print what the page shows."""

import contextlib
import io
import os
import re
from pathlib import Path

PAGE = Path(__file__).resolve().parent.parent.parent / "docs/howto/python.md"
BLOCK = re.compile(r"```python\n(.*?)```\n\n```text\n(.*?)```", re.DOTALL)


def test_the_page_prints_what_it_shows(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    text, names = PAGE.read_text(), {}
    blocks = list(BLOCK.finditer(text))
    assert len(blocks) == text.count("```python")
    for block in blocks:
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile(block[1], str(PAGE), "exec"), names)  # noqa: S102 - our own page
        if os.environ.get("UPDATE_BOOK"):
            PAGE.write_text(PAGE.read_text().replace(block[0], block[0].replace(block[2], printed.getvalue())))
        else:
            assert printed.getvalue() == block[2]
