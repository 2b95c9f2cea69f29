"""Stories that simulated machines can tell: what becomes of them from run to run."""

from typing import Literal

Story = Literal["healthy", "misalignment", "unbalance"]
"""Name of a story."""
