"""Checks whole numbers that a caller gives against their ranges."""

from __future__ import annotations

import operator


def whole(name: str, value: int, least: int, most: int) -> int:
    """A whole number within a range."""
    try:
        number = operator.index(value)
    except TypeError:
        number = None
    if number is None or not least <= number <= most:
        raise ValueError(f"{name} is {value!r}; allowed: a whole number from {least} to {most}")
    return number


def thread_count(threads: int | None) -> int | None:
    """A number of threads, or None for all cores."""
    return None if threads is None else whole("threads", threads, 1, 1024)
