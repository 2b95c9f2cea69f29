"""Criteria by which a correction is the best: a module of its own, as commands name them before they compute anything."""

from typing import Literal

Criterion = Literal["least-squares", "min-max"]
"""Quantity that a correction minimises: the squares of the vibration, or its largest amplitude."""
