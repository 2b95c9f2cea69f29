"""Arrangements of parts that are possible, but probably a slip: a train in two pieces, a probe that is described twice."""

from collections.abc import Iterator

from estimator.machine.document import Machine
from estimator.machine.parts import STATION_TOLERANCE

SAME_ANGLE = 0.1
"""Largest difference of two angles that are the same direction [°]."""


def odd_arrangements(machine: Machine) -> Iterator[tuple[str, str]]:
    """Find shafts that nothing couples to the others, and probes that stand in the same place.

    Args:
        machine: The machine.

    Yields:
        The field, and a sentence about it.
    """
    coupled = _coupled_to(machine, machine.shafts[0].id)
    for number, shaft in enumerate(machine.shafts):
        if shaft.id not in coupled:
            words = f"no coupling joins shaft '{shaft.id}' to shaft '{machine.shafts[0].id}': is one missing?"
            yield f"shafts[{number}]", words
    for number, probe in enumerate(machine.probes):
        for other in machine.probes[:number]:
            apart = abs((probe.angle_deg - other.angle_deg + 180.0) % 360.0 - 180.0)
            beside = probe.shaft == other.shaft and abs(probe.station - other.station) <= STATION_TOLERANCE
            if beside and apart <= SAME_ANGLE and (probe.mounted_on, probe.absolute) == (other.mounted_on, other.absolute):
                words = f"{probe.angle_deg:g} ° at station {probe.station:g} m is where probe '{other.id}' stands: is one of "
                yield f"probes[{number}].angle_deg", f"{words}them meant to be elsewhere?"
                break


def _coupled_to(machine: Machine, first: str) -> set[str]:
    """Return the shafts that couplings join to one, itself included."""
    joined, last = {first}, set[str]()
    while joined != last:
        last = set(joined)
        for coupling in machine.couplings:
            ends = {coupling.driver, coupling.driven}
            if ends & joined:
                joined |= ends
    return joined
