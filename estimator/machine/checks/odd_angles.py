"""Angles that are possible, but probably in radians."""

import math
from collections.abc import Iterator

from estimator.machine.document import Machine

MOUNTED = 15.0
"""Angles of probes are mostly multiples of this [°]."""
ROUNDED = 0.1
"""Largest difference of an angle in radians from such a multiple for which it is taken for that [°]."""
LEAST_GROOVE = 2.0
"""Width of a groove below which a warning asks whether radians were meant [°]."""


def odd_angles(machine: Machine) -> Iterator[tuple[str, str]]:
    """Find angles that are usual ones in radians: of probes, and widths of grooves.

    Args:
        machine: The machine.

    Yields:
        The field, and a sentence about it.
    """
    for number, probe in enumerate(machine.probes):
        angle, meant = probe.angle_deg, math.degrees(probe.angle_deg)
        multiple = MOUNTED * round(meant / MOUNTED)
        if 0.0 < abs(angle) <= 2.0 * math.pi + 0.01 and multiple != 0.0 and abs(meant - multiple) < ROUNDED:
            words = f"{angle:g} °: probes mostly stand at multiples of 15°"
            yield f"probes[{number}].angle_deg", f"{words}; was {angle:g} rad meant, {multiple:g} °?"
    for number, bearing in enumerate(machine.bearings):
        if bearing.film is not None and bearing.film.groove_deg < LEAST_GROOVE:
            width = bearing.film.groove_deg
            words = f"{width:g} ° wide grooves: usual is 5 to 45 °"
            yield f"bearings[{number}].film.groove_deg", f"{words}; was {width:g} rad meant, {math.degrees(width):.3g} °?"
