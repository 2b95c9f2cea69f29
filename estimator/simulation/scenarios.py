"""Scenarios of simulated machines: what happens to them from run to run."""

from typing import Literal

Scenario = Literal["healthy", "misalignment", "unbalance"]
"""Name of a scenario."""
