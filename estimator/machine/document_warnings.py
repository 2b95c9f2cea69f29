"""Warnings of a machine document: what is possible and taken, but probably a mistake."""

from dataclasses import dataclass

from estimator.machine.document import Machine
from estimator.machine.part_coefficients import ELEMENTS


@dataclass(frozen=True)
class DocumentWarning:
    """Something in a document that is probably a mistake.

    Attributes:
        field: Path of the field, such as `bearings[0].speed_dependence.speed_rpm`.
        words: What stands there, with its unit, and what is usual.
    """

    field: str
    words: str

    def __str__(self) -> str:
        """Return both in one line."""
        return f"{self.field}: {self.words}"


def document_warnings(machine: Machine) -> tuple[DocumentWarning, ...]:
    """List what is probably a mistake in a document that is taken.

    Args:
        machine: The machine.

    Returns:
        The warnings, in the document's order.
    """
    speeds = machine.speed_range
    return tuple(
        DocumentWarning(f"{place}[{number}].speed_dependence.{field}", words)
        for place in ELEMENTS
        for number, part in enumerate(getattr(machine, place))
        if part.speed_dependence is not None
        for field, words in part.speed_dependence.warnings(speeds.minimum_rpm, speeds.maximum_rpm)
    )
