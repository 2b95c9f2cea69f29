"""Trial weights that are most likely stated in another unit than they were meant in."""

import numpy as np

from estimator.arrays import Complexes
from estimator.errors import Invalid
from estimator.machine.document import Machine
from estimator.machine.parts import Disc

LARGEST_ECCENTRICITY = 0.01
"""Shift of a disc's centre of mass [m] beyond which a trial weight is most likely in another unit."""
LIKELY_ECCENTRICITY = 1e-3
"""Shift of a disc's centre of mass [m] up to which a trial weight is likely."""
FACTORS = {"kg m": 1e-6, "kg mm": 1e-3, "oz in": 1e-6 / 7.2008e-4, "g in": 1e-6 / 2.54e-5}
"""Factor by which a number that was meant in g mm is too large when given in another unit [-]."""
LEAST_ECCENTRICITY = 1e-6
"""Shift of a disc's centre of mass [m] from which on a trial weight shows anything."""


class UnlikelyWeight(Invalid):
    """Raised where a trial weight would move a disc's centre of mass by centimetres; says what is likely meant."""


def require_likely_weights(machine: Machine, added: Complexes, *, name: str) -> None:
    """Check that no trial weight would move the centre of mass of its disc by more than a centimetre.

    Source: own derivation: of the units that a number may be meant in, those are named in which a weight is usual.

    Args:
        machine: The machine, P discs.
        added: Trial weights (S, P) of a run [kg m].
        name: Name of the run, for the message.

    Raises:
        UnlikelyWeight: One would.
    """
    for disc, size in zip(machine.discs, np.max(np.abs(added), axis=0, initial=0.0), strict=True):
        eccentricity = float(size) / disc.mass
        if not np.isfinite(eccentricity) or eccentricity > LARGEST_ECCENTRICITY:
            raise UnlikelyWeight(
                f"{name}: {size:g} kg m on disc {disc.id} ({disc.mass:g} kg) would move its centre of mass by "
                f"{eccentricity:.3g} m{_likely_weight_text(disc, float(size))}"
            )


def _likely_weight_text(disc: Disc, size: float) -> str:
    """Name what the weight would be if its number was meant in g mm."""
    likely = [
        (unit, 1e6 * factor * size)
        for unit, factor in FACTORS.items()
        if LEAST_ECCENTRICITY <= size * factor / disc.mass <= LIKELY_ECCENTRICITY
    ]
    if not likely:
        return ": is the unit right?"
    if len(likely) == 1:
        return f": {likely[0][1]:.3g} g mm is likely, so `unit: g mm`"
    return f": is `unit: g mm` meant ({', '.join(f'{number:.3g} g mm where {unit} was said' for unit, number in likely)})?"
