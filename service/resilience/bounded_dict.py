"""A dictionary of limited size, for knowledge that can be looked up again."""

from typing import TypeVar

Key = TypeVar("Key")
Value = TypeVar("Value")

CAPACITY = 100_000
"""Largest number of entries: ten starts of the sources of ten thousand machines."""


class BoundedDict(dict[Key, Value]):
    """A dictionary that drops its oldest entries beyond `CAPACITY`."""

    def __setitem__(self, key: Key, value: Value) -> None:
        super().__setitem__(key, value)
        while len(self) > CAPACITY:
            del self[next(iter(self))]

    def setdefault(self, key: Key, value: Value) -> Value:
        """Return the value of a key, setting it first when there is none."""
        if key not in self:
            self[key] = value
        return self[key]
