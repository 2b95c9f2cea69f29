"""Loads YAML whose values are counted while they are read: a loader in Python takes 20 to 50 µs for each."""

from typing import Any

import yaml

MOST_WRITTEN = 200_000
"""Most values that are written in a file, names of fields among them: a calibration of 400 parameters has 160,000."""


class TooManyValues(Exception):
    """More values are written than may be. line: where the first one too many stands."""

    def __init__(self, line: int) -> None:
        super().__init__(f"line {line}")
        self.line = line


class _CountingLoader(yaml.SafeLoader):
    """Stops at the first value too many."""

    def __init__(self, text: str) -> None:
        super().__init__(text)
        self._written = 0

    def compose_node(self, parent: yaml.Node | None, index: Any) -> yaml.Node | None:
        """Count a node before it is made, as of SafeLoader. Raises TooManyValues."""
        self._written += 1
        if self._written > MOST_WRITTEN:
            raise TooManyValues(self.line + 1)
        return super().compose_node(parent, index)


def load(text: str) -> Any:
    """Return the content of a text of YAML or JSON. Raises TooManyValues, and what the library raises."""
    return yaml.load(text, Loader=_CountingLoader)
