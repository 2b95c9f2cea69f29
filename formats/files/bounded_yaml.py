"""Loads YAML whose values are counted while they are read: a loader in Python takes 20 to 50 µs for each."""

from typing import Any

import yaml

MOST_WRITTEN = 200_000
"""Most values that are written in a file, names of fields among them: a calibration of 400 parameters has 160,000."""


MERGED = "tag:yaml.org,2002:merge"
"""Tag of `<<`, which may be written more than once."""


class TooManyValues(Exception):
    """More values are written than may be. line: where the first one too many stands."""

    def __init__(self, line: int) -> None:
        super().__init__(f"line {line}")
        self.line = line


class WrittenTwice(Exception):
    """A field is written twice in the same place, of which the library would take the last one. line, first: where."""

    def __init__(self, name: str, *, line: int, first: int) -> None:
        super().__init__(f"line {line}: '{name}' is written a second time, after line {first}")


class _CountingLoader(yaml.SafeLoader):
    """Stops at the first value too many, and at a field that is written twice."""

    def __init__(self, text: str) -> None:
        super().__init__(text)
        self._written = 0

    def compose_node(self, parent: yaml.Node | None, index: Any) -> yaml.Node | None:
        """Count a node before it is made, as of SafeLoader. Raises TooManyValues."""
        self._written += 1
        if self._written > MOST_WRITTEN:
            raise TooManyValues(self.line + 1)
        return super().compose_node(parent, index)

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        """Make a mapping, as of SafeLoader. Raises WrittenTwice."""
        lines: dict[str, int] = {}
        for key, _ in node.value if isinstance(node, yaml.MappingNode) else ():
            if isinstance(key, yaml.ScalarNode) and key.tag != MERGED:
                line = key.start_mark.line + 1
                if key.value in lines:
                    raise WrittenTwice(key.value, line=line, first=lines[key.value])
                lines[key.value] = line
        return super().construct_mapping(node, deep)


def load(text: str) -> Any:
    """Return the content of a text of YAML or JSON. Raises TooManyValues, WrittenTwice, and what the library raises."""
    return yaml.load(text, Loader=_CountingLoader)
