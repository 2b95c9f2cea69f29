"""Outcomes of trials that are kept in a file, so that a benchmark of hours goes on where it was stopped."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any


class KeptOutcomes:
    """Outcomes by name, a line of JSON each; without a file they are forgotten at the end."""

    def __init__(self, file: Path | None = None) -> None:
        """Read the outcomes of earlier runs; a line that was cut short is left out and computed again."""
        self._file = file
        self._found: dict[str, Any] = {}
        for line in file.read_text(encoding="utf-8").splitlines() if file is not None and file.exists() else []:
            try:
                name, outcome = json.loads(line)
            except ValueError:
                continue
            self._found[name] = outcome

    def of(self, name: str, compute: Callable[[], Any]) -> Any:
        """Return an outcome, computed and kept where it is not known yet."""
        if name not in self._found:
            self._found[name] = compute()
            if self._file is not None:
                with self._file.open("a", encoding="utf-8") as file:
                    file.write(f"\n{json.dumps([name, self._found[name]])}")
        return self._found[name]
