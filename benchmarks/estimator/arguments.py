"""The one argument of benchmarks that average over random runs."""

import argparse
from collections.abc import Sequence


def runs_asked(arguments: Sequence[str] | None, *, name: str, description: str | None, default: int, what: str) -> int:
    """Return the value of `--runs`; ends the program where it is below 1.

    name: name of the benchmark's module. description: its docstring, of which the first line is shown. what: what a run is.
    """
    parser = argparse.ArgumentParser(prog=f"python -m {name}", description=(description or "").split("\n")[0])
    parser.add_argument("--runs", type=int, default=default, help=f"{what}, default {default}")
    runs: int = parser.parse_args(arguments).runs
    if runs < 1:
        parser.error("--runs must be at least 1")
    return runs
