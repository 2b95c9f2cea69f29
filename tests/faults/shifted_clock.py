"""Rundown's commands under a wall clock that is off: `python -m tests.faults.shifted_clock FILE serve …`.

FILE says by how many seconds; what is written there holds at once. The monotonic clock goes on as it does.
"""

import sys
import time
from contextlib import AbstractContextManager
from pathlib import Path
from subprocess import Popen
from typing import Any

from tests.end_to_end.processes import Service, python


class ShiftedService(Service):
    """A service whose clock is off by `offset_s`."""

    def __init__(self, folder: Path, **environment: str) -> None:
        super().__init__(folder, **environment)
        self._offset_file = folder / "offset"
        self.offset_s = 0.0

    @property
    def offset_s(self) -> float:
        """Return how far its clock is off [s]."""
        return float(self._offset_file.read_text())

    @offset_s.setter
    def offset_s(self, seconds: float) -> None:
        # Replaced at once: half a number would be another time.
        new = self._offset_file.with_suffix(".new")
        new.write_text(str(seconds))
        new.replace(self._offset_file)

    def started(self) -> AbstractContextManager[Popen[bytes]]:
        """Start the service with its shifted clock."""
        flags = ["--database", self.database, "--port", str(self.port), "--zenoh-listen", self.endpoint]
        arguments = ["-m", "tests.faults.shifted_clock", str(self._offset_file), "serve", *flags]
        return python(self.log, *arguments, **self._environment)

    def figure(self, name: str) -> float:
        """One of its metrics."""
        text = self.client.get(f"http://127.0.0.1:{self.port}/metrics").text
        return next(float(words[1]) for words in map(str.split, text.splitlines()) if words[0] == name)


def _shift(file: Path) -> None:
    wall_ns, wall = time.time_ns, time.time

    def offset() -> float:
        return float(file.read_text())

    shifted: Any = {"time_ns": lambda: wall_ns() + round(1e9 * offset()), "time": lambda: wall() + offset()}
    for name, clock in shifted.items():
        setattr(time, name, clock)


if __name__ == "__main__":
    _shift(Path(sys.argv.pop(1)))
    from service.commands.app import app

    app()
