"""A dictionary of limited size, for knowledge that can be looked up again."""

from typing import TypeVar

K = TypeVar("K")
V = TypeVar("V")

CAPACITY = 100_000
"""Largest number of entries: ten starts of the sources of ten thousand machines."""


class BoundedDict(dict[K, V]):
    """A dictionary that drops its oldest entries beyond `CAPACITY`."""

    def __setitem__(self, key: K, value: V) -> None:
        super().__setitem__(key, value)
        while len(self) > CAPACITY:
            del self[next(iter(self))]

    def setdefault(self, key: K, value: V) -> V:
        """Return the value of a key, setting it first when there is none."""
        if key not in self:
            self[key] = value
        return self[key]
