"""Place where a misalignment shows: at its coupling, and at the bearings on either side of it (thesis §5.7-5.8)."""

from collections.abc import Iterator

from estimator.machine.document import Machine
from estimator.machine.parts import Bearing, Coupling, Probe


def neighbouring_bearings(machine: Machine, coupling: Coupling) -> tuple[str, ...]:
    """Find the last bearing before a coupling and the first one behind it, past shafts that have none (thesis §5.7-5.8).

    Args:
        machine: The machine.
        coupling: One of its couplings.

    Returns:
        Ids of up to two bearings, the driver's side first.
    """
    towards_driver = {one.driven: one.driver for one in machine.couplings}
    towards_driven = {one.driver: one.driven for one in machine.couplings}
    before = _first_with_bearings(machine, coupling.driver, towards_driver)
    behind = _first_with_bearings(machine, coupling.driven, towards_driven)
    last = [max(before, key=lambda b: b.station).id] if before else []
    first = [min(behind, key=lambda b: b.station).id] if behind else []
    return tuple(last + first)


def _first_with_bearings(machine: Machine, shaft: str | None, onward: dict[str, str]) -> list[Bearing]:
    """Find the bearings of a shaft, or of the next one onward that has any.

    A train's couplings make no ring, so this ends.
    """
    while shaft is not None:
        found = [bearing for bearing in machine.bearings if bearing.shaft == shaft]
        if found:
            return found
        shaft = onward.get(shaft)
    return []


def shafts_behind(machine: Machine, coupling: Coupling) -> tuple[str, ...]:
    """List the shafts from a coupling on, away from the driver.

    Args:
        machine: The machine.
        coupling: The coupling.

    Returns:
        Ids of the shafts, from driver to driven.
    """
    onward = {one.driver: one.driven for one in machine.couplings}
    found = [coupling.driven]
    while found[-1] in onward:
        found.append(onward[found[-1]])
    return tuple(found)


def probes_beside(machine: Machine, coupling: Coupling) -> Iterator[str]:
    """Yield the channels at the bearings on either side of a coupling.

    Args:
        machine: The machine.
        coupling: Its coupling.

    Yields:
        Channels in the document's order.
    """
    bearings = neighbouring_bearings(machine, coupling)
    yield from (probe.id for probe in machine.probes if _nearest_bearing(machine, probe) in bearings)


def _nearest_bearing(machine: Machine, probe: Probe) -> str | None:
    """Return the bearing on which a probe is mounted, or the nearest bearing of its shaft."""
    own = [one for one in machine.bearings if one.shaft == probe.shaft]
    if probe.mounted_on is not None or not own:
        return probe.mounted_on
    return min(own, key=lambda one: abs(one.station - probe.station)).id
