"""The type of a machine document as it is read from JSON or YAML, which benchmarks change before they parse it."""

from typing import Any

Document = dict[str, Any]
"""A machine document, not yet parsed."""
