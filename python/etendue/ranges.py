"""Checks numbers that a caller gives against their ranges."""

from __future__ import annotations

import operator

import numpy as np
from numpy.typing import ArrayLike, NDArray


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


def finite(name: str, values: ArrayLike, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """Finite real numbers of a shape, as a new array that is read-only."""
    array = np.array(values)
    if array.shape != shape or array.dtype.kind not in "buif" or not np.isfinite(array).all():
        what = f"{array.dtype} of shape {array.shape}" if array.ndim else repr(values)
        raise ValueError(f"{name} is {what}; allowed: finite real numbers of shape {shape}")
    array = array.astype(np.float64)
    array.setflags(write=False)
    return array


def real(name: str, value: float, nonzero: bool = False) -> float:
    """A finite real number."""
    number = float(finite(name, value, ()))
    if nonzero and number == 0:
        raise ValueError(f"{name} is 0; allowed: other numbers")
    return number
