"""Reports the static state of a train on its oil films on a terminal: loads, positions, stability, as said and identified."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from estimator.alignment.stability_margin import LEAST_DECREMENT, stability_margin
from estimator.fit.estimates import CONFIDENCE_95
from estimator.machine.document import Machine
from estimator.machine.film_speeds import follows_films, reported_rpm
from estimator.statics.equilibrium import FilmEquilibrium, FilmTrain, film_train
from estimator.statics.film_stability import LeastDampedWhirl, least_damped_whirl, whirl_onset
from estimator.statics.first_touch import first_touch_words
from estimator.statics.journal_bearing import JournalBearing
from estimator.units import rad_per_s_to_rpm, rpm_to_rad_per_s
from estimator.updated_model.film_results import film_results
from estimator.updated_model.model import UpdatedModel

LARGEST_ONSET = 2.0
"""Highest speed at which whirl is looked for, as a multiple of the speed range's end [-]."""
MEGAPASCAL = 1e6


def has_films(machine: Machine) -> bool:
    """Return whether every bearing of a document says what its film is, or coefficients of one at least follow from its."""
    return follows_films(machine) or all(bearing.film is not None for bearing in machine.bearings)


@dataclass(frozen=True)
class JournalState:
    """State of one journal in its bearing, in SI units; the fields of films are None in a bearing without a film.

    Attributes:
        bearing: Id of its bearing.
        load_x: Force of the film along x [N].
        load_y: Force along y [N].
        journal_x: Place along x, of no film from where it stands aligned [m].
        journal_y: Place along y, likewise [m].
        specific_pressure: Load over diameter times length [Pa].
        eccentricity: Distance from the bearing's centre over the clearance [-].
        thinnest_film: Least thickness of the film [m].
        sommerfeld: Sommerfeld number [-].
        lifted: Whether something else lifts it at this speed, so that the film's model does not hold.
    """

    bearing: str
    load_x: float
    load_y: float
    journal_x: float
    journal_y: float
    specific_pressure: float | None = None
    eccentricity: float | None = None
    thinnest_film: float | None = None
    sommerfeld: float | None = None
    lifted: bool = False


def film_content(machine: Machine, *, service_rpm: float) -> dict[str, Any]:
    """Return the states and the stability for JSON, in SI units. Raises Invalid as `film_text`."""
    train = film_train(machine)
    mode, onset = _whirl(machine, train, service_rpm)
    return {
        "machine": machine.id,
        "states": [
            {"speed_rpm": rpm, "equilibria": [list(journal_states(machine, train, one)) for one in found]}
            for rpm, found in _equilibria(machine, train, service_rpm)
        ],
        "service_rpm": service_rpm,
        "log_decrement": None if mode is None else mode.log_decrement,
        "whirl_from_rpm": None if onset is None else rad_per_s_to_rpm(onset),
    }


def film_text(machine: Machine, *, service_rpm: float) -> str:
    """Return the report at the lowest speed of the range and at the service speed [r/min].

    Raises Invalid for films and shafts that have no equilibrium.
    """
    train = film_train(machine)
    return "\n".join([*_states(machine, train, service_rpm), "", *_stability(machine, train, service_rpm)])


def identified_films(model: UpdatedModel) -> Iterator[str]:
    """Yield what was identified of each film at running speed, with 95 % intervals; nothing of a train without films."""
    found = {one.name: one for one in film_results(model)}
    if not found:
        return
    yield (
        f"Oil films as identified, at {reported_rpm(model.machine)[-1]:g} r/min, with ± half a 95 % interval: bearing, load x "
        "and y [N], eccentricity, position x and y [µm]"
    )
    for bearing in model.machine.bearings:
        columns = (
            ("load_horizontal", 1.0, "z9.0f", ".0f"),
            ("load_vertical", 1.0, "z9.0f", ".0f"),
            ("eccentricity_ratio", 1.0, "7.3f", ".3f"),
            ("journal_x", 1e6, "z8.1f", ".1f"),
            ("journal_y", 1e6, "z8.1f", ".1f"),
        )
        said = []
        for name, scale, wide, narrow in columns:
            one = found.get(f"bearing.{bearing.id}.{name}")
            if one is not None:
                said.append(f"{scale * one.value:{wide}} ± {scale * CONFIDENCE_95 * one.error:{narrow}}".ljust(18))
        yield f"  {bearing.id:<10} {''.join(said)}".rstrip()


def identified_stability(model: UpdatedModel) -> Iterator[str]:
    """Yield how well the least damped whirl of the identified train decays; nothing of a train without films."""
    found = stability_margin(model)
    if found is None:
        return
    yield (
        f"Stability as identified, at {rad_per_s_to_rpm(found.speed):.0f} r/min: least damped mode below it "
        f"{rad_per_s_to_rpm(found.frequency):.0f} cycles per minute, log decrement {found.log_decrement:.3f} ± "
        f"{CONFIDENCE_95 * found.error:.3f}; API 617 asks for {LEAST_DECREMENT:g}"
    )


def _states(machine: Machine, train: FilmTrain, service_rpm: float) -> Iterator[str]:
    yield (
        "Static state on oil films as the document describes them: bearing, load x and y [N], specific pressure [MPa], "
        "eccentricity, position x and y [µm], thinnest film [µm], Sommerfeld number"
    )
    for rpm, found in _equilibria(machine, train, service_rpm):
        if not found:
            yield (
                f"  at {rpm:g} r/min: no equilibrium with films of at least a twentieth of the clearance; the journals touch: "
                f"{first_touch_words(train, rpm_to_rad_per_s(rpm))}"
            )
            continue
        if len(found) > 1:
            yield f"  at {rpm:g} r/min there are {len(found)} equilibria; which one holds depends on how the train came there"
        for one in found:
            yield f"  at {rpm:g} r/min"
            yield from _bearings(machine, train, one)


def _equilibria(machine: Machine, train: FilmTrain, service_rpm: float) -> Iterator[tuple[float, tuple[FilmEquilibrium, ...]]]:
    for rpm in dict.fromkeys((machine.speed_range.minimum_rpm, service_rpm)):
        yield rpm, tuple(train.equilibria(rpm_to_rad_per_s(rpm)))


def journal_states(machine: Machine, train: FilmTrain, found: FilmEquilibrium) -> Iterator[JournalState]:
    """Yield the state of each journal in one equilibrium."""
    for bearing, journal, place, force in zip(machine.bearings, train.bearings, found.position, found.force, strict=True):
        state = JournalState(bearing.id, float(force[0]), float(force[1]), float(place[0]), float(place[1]))
        if not isinstance(journal, JournalBearing):
            yield state
            continue
        below = rad_per_s_to_rpm(found.speed) < journal.described.valid_above_rpm
        load = float(np.hypot(*force))
        pressure = load / (journal.described.diameter * journal.described.length)
        turns = found.speed / (2 * math.pi)
        viscous = float(journal.oil.at(found.speed)) * turns * (journal.radius / journal.clearance) ** 2
        number = viscous / pressure if pressure > 0.0 else math.inf
        yield replace(
            state,
            specific_pressure=pressure,
            eccentricity=float(np.hypot(*place)) / journal.clearance,
            thinnest_film=float(journal.thinnest(place)),
            sommerfeld=number,
            lifted=below,
        )


def _bearings(machine: Machine, train: FilmTrain, found: FilmEquilibrium) -> Iterator[str]:
    valid_from = {one.id: 0.0 if one.film is None else one.film.valid_above_rpm for one in machine.bearings}
    for one in journal_states(machine, train, found):
        pressure, thinnest = _scaled(one.specific_pressure, 1.0 / MEGAPASCAL), _scaled(one.thinnest_film, 1e6)
        yield (
            f"    {one.bearing:<10} {one.load_x:z9.0f} {one.load_y:z9.0f} {_column(pressure, 7, 3)} "
            f"{_column(one.eccentricity, 6, 3)} {1e6 * one.journal_x:z8.1f} {1e6 * one.journal_y:z8.1f} "
            f"{_column(thinnest, 7, 1)} {_column(one.sommerfeld, 8, 3)}{_remark(one, valid_from[one.bearing])}"
        )


def _scaled(value: float | None, factor: float) -> float | None:
    return None if value is None else value * factor


def _column(value: float | None, width: int, decimals: int) -> str:
    """Return a number in its column; a dash of what the bearing does not have."""
    return f"{'-':>{width}}" if value is None else f"{value:{width}.{decimals}f}"


def _remark(one: JournalState, valid_from_rpm: float) -> str:
    """Return what is unusual about a journal's state, behind its numbers; the speed from which its film holds [r/min]."""
    if one.eccentricity is None:
        return "  coefficients of its own; position from where it stands aligned"
    if one.lifted:
        return f"  not valid below {valid_from_rpm:g} r/min: lifted by other means here"
    return "  pressed upwards" if one.load_y < 0.0 and abs(one.load_y) > abs(one.load_x) else ""


def _whirl(machine: Machine, train: FilmTrain, service_rpm: float) -> tuple[LeastDampedWhirl | None, float | None]:
    """Return the least damped mode at the service speed, and the speed from which on the train would whirl [rad/s]."""
    equilibrium = train.equilibrium(rpm_to_rad_per_s(service_rpm))
    mode = None if equilibrium is None else least_damped_whirl(machine, equilibrium)
    lowest = rpm_to_rad_per_s(machine.speed_range.minimum_rpm)
    return mode, whirl_onset(machine, train, first=lowest, last=rpm_to_rad_per_s(_highest_rpm(machine)))


def _highest_rpm(machine: Machine) -> float:
    return LARGEST_ONSET * machine.speed_range.maximum_rpm


def _stability(machine: Machine, train: FilmTrain, service_rpm: float) -> Iterator[str]:
    if train.equilibrium(rpm_to_rad_per_s(service_rpm)) is None:
        yield f"Stability is not judged: without an equilibrium at {service_rpm:g} r/min there are no coefficients"
        return
    mode, onset = _whirl(machine, train, service_rpm)
    invalid = [one.id for one in machine.bearings if one.film is not None and service_rpm < one.film.valid_above_rpm]
    if invalid:
        yield f"Stability as if the films of {', '.join(invalid)} carried, which are not valid at {service_rpm:g} r/min:"
    if mode is None:
        yield f"Stability at {service_rpm:g} r/min: no mode to judge"
    else:
        yield (
            f"Stability at {service_rpm:g} r/min: least damped mode {rad_per_s_to_rpm(mode.frequency):.0f} cycles per minute, "
            f"log decrement {mode.log_decrement:.3f}"
        )
    if onset is None:
        yield f"The train would not whirl up to {_highest_rpm(machine):.0f} r/min"
    else:
        yield f"The train would whirl from {rad_per_s_to_rpm(onset):.0f} r/min"
