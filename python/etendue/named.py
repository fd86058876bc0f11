"""Mappings from the names of parts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TypeVar

Part = TypeVar("Part")


class Named(Mapping[str, Part]):
    """A mapping from names; the fault of an unknown name lists those that exist."""

    _KIND = "plane"

    def __init__(self, parts: Mapping[str, Part]) -> None:
        self._parts = dict(parts)

    def __getitem__(self, name: str) -> Part:
        if name not in self._parts:
            raise KeyError(f"no {self._KIND} {name!r}; there are {', '.join(self._parts)}")
        return self._parts[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._parts)

    def __len__(self) -> int:
        return len(self._parts)
