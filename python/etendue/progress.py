"""Progress of long work."""

from __future__ import annotations

import sys
from collections.abc import Callable, Generator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, Union

if TYPE_CHECKING:
    from etendue._etendue import Tell

Progress = Union[bool, Callable[[int], object], None]
"""Whether a bar is shown, or a function that receives the progress of the current work: photons, pixels, or points of a sweep.
`None` shows a bar in a terminal or a notebook if tqdm is installed."""


@contextmanager
def told(progress: Progress) -> Generator[Tell | None, None, None]:
    """A function that receives progress: which work, what is done to what, how many there are, and how many are done."""
    if callable(progress):
        yield lambda number, verb, things, total, done: progress(done)
        return
    if progress is None:
        progress = sys.stderr.isatty() or _is_notebook()
    tqdm = _tqdm() if progress else None
    if tqdm is None:
        yield None
        return
    bars = _Bars(tqdm)
    try:
        yield bars.tell
    finally:
        bars.close()


class _Bars:
    """A bar for the current work; one bar after the other."""

    def __init__(self, tqdm: Any) -> None:
        self._tqdm = tqdm
        self._bar: Any = None
        self._number = -1

    def tell(self, number: int, verb: str, things: str, total: int, done: int) -> None:
        if number != self._number:
            self.close()
            self._bar = self._tqdm(total=total, unit=things, unit_scale=True, desc=verb)
            self._number = number
        self._bar.update(done - self._bar.n)

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()
            self._bar = None


def _is_notebook() -> bool:
    ipython = sys.modules.get("IPython")
    shell: Any = ipython.get_ipython() if ipython else None
    return getattr(shell, "kernel", None) is not None


def _tqdm() -> Any:
    try:
        from tqdm.auto import tqdm
    except ImportError:
        return None
    return tqdm
