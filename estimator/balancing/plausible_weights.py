"""Sizes of weights that somebody would put on a rotor, and those that are more likely in another unit than was meant.

Derived here: a weight is judged by how far it moves the centre of mass of the rotor that bears it, a shaft with its discs.
Trial weights are some tenths of a rotor's weight in centrifugal force, and move it by micrometres to a tenth of a millimetre.
"""

import math
from collections.abc import Sequence

import numpy as np

from estimator.arrays import Complexes, Floats
from estimator.balancing.balance_quality import GRAM_MILLIMETRE, mass_and_centre
from estimator.balancing.trial_runs import TrialRuns, TrialsUnusable
from estimator.machine.document import Machine
from estimator.rotor.assembly import assemble_rotor
from estimator.units import KILOGRAM_METRES

LARGEST_SHIFT = 2.5e-3
"""Largest shift of the rotor's centre of mass by a weight that is taken for meant [m]."""
USUAL_SHIFT = 3e-5
"""Usual shift of the rotor's centre of mass by a trial weight [m]."""
USUAL_FACTOR = 100.0
"""Factor by which usual trial weights may differ from that [-]."""
LARGEST_GRADE = 250.0
"""Balance quality grade G [mm/s] beyond which a correction is doubted: rotors that run are far below."""
LARGEST_MAGNIFICATION = 1000.0
"""Vibration over the shift of the centre of mass that caused it [-] beyond which a weight was larger than stated."""


def rotor_masses(machine: Machine) -> Floats:
    """Compute the masses of the rotors that weights on discs are compared with.

    Args:
        machine: The machine.

    Returns:
        Mass (P,) of the shaft that bears each disc, with all discs on it [kg].
    """
    rotor = assemble_rotor(machine)
    mass = {shaft.id: mass_and_centre(rotor, shaft.id)[0] for shaft in machine.shafts}
    return np.array([mass[disc.shaft] for disc in machine.discs])


def require_plausible_weights(machine: Machine, added: Complexes, *, name: str) -> None:
    """Check that the weights of a run are of a size that somebody would put on.

    Args:
        machine: The machine, with P discs.
        added: The weights (P,) [kg m].
        name: Name of the run.

    Raises:
        TrialsUnusable: A weight would move the centre of mass of its rotor by millimetres; says which unit was probably meant.
    """
    sizes = np.abs(added).tolist()
    for disc, size, mass in zip(machine.discs, sizes, rotor_masses(machine).tolist(), strict=True):
        if not size <= LARGEST_SHIFT * mass:
            raise TrialsUnusable(
                f"{name}: {size:.3g} kg m on {disc.id} would move the centre of mass of its rotor, {mass:.3g} kg, by "
                f"{1e3 * size / mass:.3g} mm; {_meant(size, mass)}"
            )


def _meant(size: float, mass: float) -> str:
    """Return which unit a number [kg m] was probably meant in, in words."""
    away = {
        unit: abs(math.log(size * factor / mass / USUAL_SHIFT))
        for unit, factor in KILOGRAM_METRES.items()
        if unit != "kg m" and 0.0 < size < math.inf
    }
    unit = min(away, key=lambda one: away[one], default="")
    if not unit or away[unit] > math.log(USUAL_FACTOR):
        return "is the unit right?"
    amount = size * KILOGRAM_METRES[unit]
    same = "" if unit == "g mm" else f" ({_g_mm(amount)} g mm)"
    return f"is it in another unit? {size:.4g} {unit}{same} are {amount:.3g} kg m"


def _g_mm(unbalance: float) -> str:
    """Return an unbalance in g mm with four digits, and without a power of ten."""
    return f"{float(f'{unbalance / GRAM_MILLIMETRE:.4g}'):.12g}"


def doubtful_corrections(machine: Machine, planes: Sequence[str], unbalance: Complexes, *, speed: float) -> tuple[str, ...]:
    """Name corrections that no rotor which runs would need: trial weights of a unit that is too large lead to them.

    Args:
        machine: The machine.
        planes: Ids of Q discs.
        unbalance: Corrections in them (Q,) [kg m].
        speed: Service speed [rad/s].

    Returns:
        A sentence for each.
    """
    masses = dict(zip((disc.id for disc in machine.discs), rotor_masses(machine).tolist(), strict=True))
    found = []
    for plane, size in zip(planes, np.abs(unbalance).tolist(), strict=True):
        grade = 1e3 * size / masses[plane] * speed
        if grade > LARGEST_GRADE:
            found.append(
                f"{_g_mm(size)} g mm on {plane} would be G {grade:.3g} of its rotor, {masses[plane]:.3g} kg, "
                "where rotors that run are far below: is the trial weights' unit right?"
            )
    return tuple(found)


def underrated_trials(machine: Machine, runs: TrialRuns) -> tuple[str, ...]:
    """Name trial runs that show more than the stated weights can do: their unit is too small.

    Args:
        machine: The machine.
        runs: The runs, the first one the initial state.

    Returns:
        A sentence for each.
    """
    masses = dict(zip((disc.id for disc in machine.discs), rotor_masses(machine).tolist(), strict=True))
    mass = np.array([masses[plane] for plane in runs.planes])
    found = []
    for number in range(1, len(runs.names)):
        shift = float(np.sum(np.abs(runs.added[number] - runs.added[0]) / mass))
        change = np.abs(runs.vector[number] - runs.vector[0])
        error = np.hypot(runs.error[number], runs.error[0])
        clear = np.isfinite(change) & (change > 3.0 * np.nan_to_num(error))
        if shift > 0.0 and clear.any() and np.median(change[clear]) > LARGEST_MAGNIFICATION * shift:
            seen = 1e6 * float(np.median(change[clear]))
            found.append(
                f"{runs.names[number]} differs from {runs.names[0]} by {seen:.3g} µm, where its "
                f"weights move the centre of mass by {1e6 * shift:.2g} µm: were they heavier, or in a larger unit?"
            )
    return tuple(found)
