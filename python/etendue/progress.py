"""Progress of long work."""

from __future__ import annotations

import sys
from collections.abc import Callable, Generator
from contextlib import contextmanager
from typing import Any, Union

Progress = Union[bool, Callable[[int], object], None]
"""Whether a bar is shown, or a function that is told the photons done so far. `None`: a bar where somebody looks, on a terminal or in a
notebook, and tqdm is installed."""


@contextmanager
def told(progress: Progress, total: int, unit: str) -> Generator[Callable[[int], object] | None, None, None]:
    """A function to tell photons to, while they are traced."""
    if callable(progress):
        yield progress
        return
    bar = _bar(progress, total, unit)
    if bar is None:
        yield None
        return
    with bar:
        yield lambda done: bar.update(done - bar.n)


def _is_notebook() -> bool:
    ipython = sys.modules.get("IPython")
    shell: Any = ipython.get_ipython() if ipython else None
    return getattr(shell, "kernel", None) is not None


def _bar(progress: bool | None, total: int, unit: str) -> Any:
    if progress is None:
        progress = sys.stderr.isatty() or _is_notebook()
    if not progress:
        return None
    try:
        from tqdm.auto import tqdm
    except ImportError:
        return None
    return tqdm(total=total, unit=unit, unit_scale=True, desc="tracing")
