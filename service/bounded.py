"""What is known of many, and can be found out again: of so many at most."""

from typing import TypeVar

Key = TypeVar("Key")
Value = TypeVar("Value")

MOST = 100_000
"""Ten starts of the sources of ten thousand machines."""


class Bounded(dict[Key, Value]):
    """A dictionary that forgets what was put in first when it holds too much."""

    def __setitem__(self, key: Key, value: Value) -> None:
        super().__setitem__(key, value)
        while len(self) > MOST:
            del self[next(iter(self))]

    def setdefault(self, key: Key, value: Value) -> Value:
        """As of dict."""
        if key not in self:
            self[key] = value
        return self[key]
