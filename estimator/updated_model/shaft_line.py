"""Shaft centreline of an updated model over speed, and as the gaps of its runs have it: journals in their clearance circles.

A gap's zero is its probe's own: it is set where the model's centreline lies on the mean (least squares), so that the measured
line tells how the shaft has moved, not where it stands (Bently and Hatch, Fundamentals of Rotating Machinery Diagnostics,
2002, ch. 6).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimator.arrays import Floats
from estimator.machine.bearings_on_films import BearingOnFilm, bearings_on_films
from estimator.machine.document import Machine
from estimator.phasors.measurement import Measurement
from estimator.statics.journal_states import journal_states
from estimator.statics.shaft_centreline import ShaftCentreline, probe_views
from estimator.updated_model.model import UpdatedModel
from estimator.updated_model.placed_films import placed_films

ACROSS = 0.2
"""Least sine of the angle between the axes of two probes that tell x from y [-]."""


@dataclass(frozen=True)
class JournalLines:
    """Positions of n journals in their films, as a model has them at S speeds.

    Attributes:
        bearings: Ids of their bearings.
        clearance: Radial clearances (n,) [m].
        position: Positions (S, n, 2), x and y [m].
    """

    bearings: tuple[str, ...]
    clearance: Floats
    position: Floats


def modelled_lines(model: UpdatedModel, *, speed: Floats) -> JournalLines | None:
    """Compute where the journals stand over speed (equilibria of the films; Pennacchi et al. 2012).

    Args:
        model: The updated model.
        speed: Spin speeds (S,), without sign [rad/s].

    Returns:
        The journals' positions; None of a train whose coefficients do not follow from films, or where one is too thin.
    """
    coordinates = model.coordinates_at(speed)
    found = placed_films(coordinates)
    if found is None:
        return None
    placed, films = found
    states = journal_states(films, placed.own(coordinates.theta(model.values)), speed=speed)
    if states is None:
        return None
    on_films = bearings_on_films(model.machine.bearings)
    numbers = [one.number for one in on_films]
    return JournalLines(tuple(one.id for one in on_films), states.clearance[numbers], states.position[:, numbers])


def measured_lines(model: UpdatedModel, measurement: Measurement) -> Floats | None:
    """Return where gaps have the journals, each probe's zero set by the model (module's docstring).

    Source: Bently and Hatch, Fundamentals of Rotating Machinery Diagnostics, 2002, ch. 6.

    Args:
        model: The updated model.
        measurement: S samples of one run with gaps.

    Returns:
        Positions (S, n, 2) of the n journals on films [m]; NaN of bearings without two probes across each other at their
        journal, and of samples without gaps of both. None without gaps, or of a train whose coefficients do not follow from
        films.
    """
    coordinates = model.coordinates_at(measurement.speed)
    found = placed_films(coordinates)
    if found is None or measurement.gaps is None:
        return None
    placed, films = found
    machine, own = model.machine, placed.own(coordinates.theta(model.values))
    expected = ShaftCentreline(films.films, probe_views(machine), measurement.speed).values(own)
    states = journal_states(films, own, speed=measurement.speed)
    if states is None:
        return None
    gone = measurement.gaps.place - expected
    told = np.isfinite(gone)
    mean = np.sum(np.where(told, gone, 0.0), axis=0) / np.maximum(np.count_nonzero(told, axis=0), 1)
    beside = gone - mean
    on_films = bearings_on_films(machine.bearings)
    lines = np.full((len(measurement.speed), len(on_films), 2), np.nan)
    for place, bearing in enumerate(on_films):
        probes = _probes_at(machine, bearing)
        if probes:
            angle = np.deg2rad([machine.probes[one].angle_deg for one in probes])
            axes = np.stack([np.cos(angle), np.sin(angle)], axis=1)
            lines[:, place] = states.position[:, bearing.number] + beside[:, probes] @ np.linalg.pinv(axes).T
    return lines


def _probes_at(machine: Machine, bearing: BearingOnFilm) -> Sequence[int]:
    """Return the probes within a bearing's length of its journal that together tell x from y; none where they do not."""
    said = machine.bearings[bearing.number]
    found = [
        number
        for number, one in enumerate(machine.probes)
        if one.shaft == said.shaft and abs(one.station - said.station) <= bearing.film.length and one.gap_grows is not None
    ]
    angle = np.deg2rad([machine.probes[one].angle_deg for one in found])
    return found if np.abs(np.sin(angle[:, None] - angle)).max(initial=0.0) >= ACROSS else ()
