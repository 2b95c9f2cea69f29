"""Warnings of a machine document: what is possible and taken, but probably a mistake."""

from collections.abc import Iterator
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
    of_laws = (
        DocumentWarning(f"{place}[{number}].speed_dependence.{field}", words)
        for place in ELEMENTS
        for number, part in enumerate(getattr(machine, place))
        if part.speed_dependence is not None
        for field, words in part.speed_dependence.warnings(speeds.minimum_rpm, speeds.maximum_rpm)
    )
    return (*of_laws, *_far_elevations(machine))


def _far_elevations(machine: Machine) -> Iterator[DocumentWarning]:
    """Yield elevations beyond the clearance of their own bearing, whose journal would touch if the others stayed."""
    for number, bearing in enumerate(machine.bearings):
        film = bearing.film
        if film is None:
            continue
        clearance = film.radial_clearance
        for name, elevation in (("elevation_x", film.elevation_x), ("elevation_y", film.elevation_y)):
            if abs(elevation) > clearance:
                yield DocumentWarning(
                    f"bearings[{number}].film.{name}",
                    f"{1e6 * elevation:.4g} µm is more than the radial clearance, {1e6 * clearance:.4g} µm: usual are some 10 "
                    "µm; elevations are in m, over the place at which couplings carry nothing",
                )
