"""The progress of a long run: a bar of tqdm if that is there."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

Told = Callable[[int, int], None]


@contextmanager
def bar(wanted: bool | None, what: str) -> Iterator[Told | None]:
    """What the run tells its progress to. None shows a bar where somebody looks at the terminal."""
    shown = sys.stderr is not None and sys.stderr.isatty() if wanted is None else wanted
    if not shown:
        yield None
        return
    try:
        from tqdm.auto import tqdm
    except ImportError:
        if wanted:
            raise
        yield None
        return
    with tqdm(desc=what, leave=False) as shown_bar:

        def tell(done: int, total: int) -> None:
            if total and shown_bar.total != total:
                shown_bar.total = total
            shown_bar.update(done - shown_bar.n)

        yield tell
