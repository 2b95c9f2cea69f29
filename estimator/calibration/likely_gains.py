"""Gains that no measuring chain has: a sign that trial weights, or amplitudes, were given in another unit.

A factor on all known unbalances is the inverse factor on all gains: no run contradicts it. Derived here.
"""

import itertools
import math
from collections.abc import Collection

import numpy as np

from estimator.arrays import Complexes
from estimator.units import KILOGRAM_METRES

LARGEST = 10.0
"""Factor from one within which gains are usual on average [-]."""
NEAR = 5.0
"""Factor within which a wrong unit explains the gains [-]: those of a real chain differ from one, too."""
ALIKE = 1.3
"""Factor from their mean within which all gains are one common factor [-]."""
MOST = 3
"""Most units that are named."""


def unlikely_gains(gains: Complexes, units: Collection[str] = ()) -> tuple[str, ...]:
    """Describe that gains are far from one on average, and name the unit of the trial weights that would explain it.

    Args:
        gains: Gains of the channels (m,) [-].
        units: Units in which the weights were given, as far as that is known; without, any may be meant otherwise.

    Returns:
        A sentence; none where the gains are usual.
    """
    size = np.abs(gains)
    middle = float(np.exp(np.mean(np.log(size)))) if size.size and np.all(size > 0.0) else 1.0
    if 1.0 / LARGEST <= middle <= LARGEST:
        return ()
    away = {
        (meant, given): abs(math.log(middle * KILOGRAM_METRES[given] / KILOGRAM_METRES[meant]))
        for given, meant in itertools.permutations(KILOGRAM_METRES, 2)
        if not units or given in units
    }
    near = [pair for pair in sorted(away, key=lambda pair: away[pair]) if away[pair] <= math.log(NEAR)][:MOST]
    units = ", ".join(f"{meant} given as {given}" for meant, given in near)
    why = f": are the trial weights' units right (such as {units}), and the amplitudes'?"
    if not near:
        why = ": are the units of the trial weights and of the amplitudes right?"
    alike = float(np.max(np.abs(np.log(size / middle)))) <= math.log(ALIKE)
    together = ", all nearly alike" if alike and size.size > 1 else ""
    return (f"the channels read {middle:.2g} times what they should on average{together}, which no usual chain does{why}",)
