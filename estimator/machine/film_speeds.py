"""Speeds at which the films of a machine's journal bearings carry and are reported, by its document alone."""

from estimator.machine.bearings_on_films import bearings_on_films
from estimator.machine.document import Machine


def follows_films(machine: Machine) -> bool:
    """Return whether coefficients of bearings follow from their oil films.

    Args:
        machine: The machine.

    Returns:
        Whether those of one do at least: then the static model of the train gives the loads of all.
    """
    return bool(bearings_on_films(machine.bearings))


def slowest_rpm(machine: Machine) -> float:
    """Return the lowest speed of the machine at which its films carry.

    Args:
        machine: The machine.

    Returns:
        Speed [r/min].
    """
    lifted = max((one.film.valid_above_rpm for one in machine.bearings if one.film is not None), default=0.0)
    return max(machine.speed_range.minimum_rpm, lifted)


def reported_rpm(machine: Machine) -> tuple[float, ...]:
    """Return the speeds at which an identification reports the films' coefficients: lowest, middle and running speed.

    They follow from the document alone, so that trends are of the same quantities whatever a run covered.

    Args:
        machine: The machine.

    Returns:
        Whole speeds, ascending; the last is `operation.running_rpm`, else the highest of the range [r/min].
    """
    low, high = slowest_rpm(machine), machine.speed_range.maximum_rpm
    given = machine.operation.running_rpm
    running = high if given is None else min(max(given, low), high)
    return tuple(sorted({float(round(one)) for one in (low, (low + running) / 2, running)}))
