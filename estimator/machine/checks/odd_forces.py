"""Static forces, and loads of tables, that are possible, but probably in another unit than N."""

import math
from collections.abc import Iterator

from estimator.machine.checks.rotor_masses import train_weight
from estimator.machine.document import Machine
from estimator.machine.films import StaticLoad
from estimator.usual_values import question

STRONGEST_FORCE = 50.0
"""Static force over the weight of all rotors above which a warning asks whether its unit is right [-]: gears reach some 10."""
WEAKEST_FORCE = 0.005
"""Static force over the weight of all rotors below which a warning asks whether its unit is right [-]."""
WIDEST_FORCE = 5.0
"""Spread of a static force over the weight of all rotors above which a warning asks whether its unit is right [-]."""
USUAL_FORCE = (0.01, 10.0)
"""Usual size of a force over the weight of all rotors [-]."""
AXES = ("force_x", "force_y")


def odd_forces(machine: Machine) -> Iterator[tuple[str, str]]:
    """Find static forces and loads that do not fit the weight of the rotors.

    Args:
        machine: The machine.

    Yields:
        The field, and a sentence about it.
    """
    weight = train_weight(machine)
    for number, load in enumerate(machine.static_loads):
        if not any((load.force_x, load.force_y, load.force_x_spread, load.force_y_spread)):
            words = "neither a force nor a spread: it does nothing; usual are force_x, force_y [N], up to the rotors' weight"
            yield f"static_loads[{number}]", words
        elif weight is not None:
            yield from ((f"static_loads[{number}].{field}", words) for field, words in _odd_force(load, weight))
    if weight is not None:
        yield from _odd_table_loads(machine, weight)


def _odd_force(load: StaticLoad, weight: float) -> Iterator[tuple[str, str]]:
    """Yield components of a static force that do not fit the weight of all rotors [N]."""
    usual = (USUAL_FORCE[0] * weight, USUAL_FORCE[1] * weight)
    strongest = max(AXES, key=lambda name: abs(getattr(load, name)))
    if 0.0 < abs(weak := getattr(load, strongest)) < WEAKEST_FORCE * weight:
        words = f"{weak:g} N is {abs(weak) / weight:.2g} times the weight of all rotors, {weight:.3g} N"
        yield strongest, f"{words}: usual is 0.01 to 10 times{_signed_question(weak, usual)}"
    for name in AXES:
        force, spread = getattr(load, name), getattr(load, f"{name}_spread")
        if abs(force) > STRONGEST_FORCE * weight:
            words = f"{force:g} N is {abs(force) / weight:.0f} times the weight of all rotors, {weight:.3g} N"
            yield name, f"{words}: usual is up to 10 times"
        if spread > WIDEST_FORCE * weight:
            words = f"{spread:g} N is {spread / weight:.0f} times the weight of all rotors, {weight:.3g} N"
            yield f"{name}_spread", f"{words}: usual is 0.05 to 0.2 times the force"


def _odd_table_loads(machine: Machine, weight: float) -> Iterator[tuple[str, str]]:
    """Yield loads of bearings' tables over the load that no bearing of rotors of this weight [N] carries."""
    share = weight / len(machine.bearings)
    for number, bearing in enumerate(machine.bearings):
        form = bearing.speed_dependence
        field = None if form is None else form.load_field
        load = None if field is None else getattr(form, field)
        if load is not None and not WEAKEST_FORCE * weight <= load <= STRONGEST_FORCE * weight:
            words = f"{load:g} N is {load / share:.2g} times a bearing's share of all rotors' weight, {share:.3g} N"
            meant = question(load, "N", (0.1 * share, USUAL_FORCE[1] * share))
            yield f"bearings[{number}].speed_dependence.{field}", f"{words}: usual is 0.2 to 5 times{meant}"


def _signed_question(force: float, usual: tuple[float, float]) -> str:
    """Return the question whether another unit was meant of a force of either sign [N]."""
    ends = sorted(math.copysign(one, force) for one in usual)
    return question(force, "N", (ends[0], ends[1]))
