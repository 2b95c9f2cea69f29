"""Shaft centreline of an updated model over speed, and as the gaps of its runs have it: journals in their clearance circles.

A gap's zero is its probe's own: it is set where the model's centreline lies on the mean (least squares), so that the measured
line tells how the shaft has moved, not where it stands (Bently and Hatch, Fundamentals of Rotating Machinery Diagnostics,
2002, ch. 6).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimator.arrays import Floats
from estimator.machine.document import Machine
from estimator.machine.parts import Bearing
from estimator.phasors.measurement import Measurement
from estimator.statics.journal_states import journal_states
from estimator.statics.shaft_centreline import ShaftCentreline, probe_views
from estimator.updated_model.film_results import placed_films
from estimator.updated_model.model import UpdatedModel

ACROSS = 0.2
"""Least sine of the angle between the axes of two probes that tell x from y [-]."""


@dataclass(frozen=True)
class JournalLines:
    """Journals' positions in their bearings, as a model has them at S speeds.

    Attributes:
        clearance: Radial clearances (n,) [m].
        position: Positions (S, n, 2), x and y [m].
    """

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
    return None if states is None else JournalLines(states.clearance, states.position)


def measured_lines(model: UpdatedModel, measurement: Measurement) -> Floats | None:
    """Return where gaps have the journals, each probe's zero set by the model (module's docstring).

    Source: Bently and Hatch, Fundamentals of Rotating Machinery Diagnostics, 2002, ch. 6.

    Args:
        model: The updated model.
        measurement: S samples of one run with gaps.

    Returns:
        Positions (S, n, 2) [m]; NaN of bearings without two probes across each other at their journal, and of samples without
        gaps of both. None without gaps, or of a train whose coefficients do not follow from films.
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
    lines = np.full(states.position.shape, np.nan)
    for number, bearing in enumerate(machine.bearings):
        probes = _probes_at(machine, bearing)
        if probes:
            angle = np.deg2rad([machine.probes[one].angle_deg for one in probes])
            axes = np.stack([np.cos(angle), np.sin(angle)], axis=1)
            lines[:, number] = states.position[:, number] + beside[:, probes] @ np.linalg.pinv(axes).T
    return lines


def _probes_at(machine: Machine, bearing: Bearing) -> Sequence[int]:
    """Return the probes within a bearing's length of its journal that together tell x from y; none where they do not."""
    reach = bearing.film.length if bearing.film is not None else 0.0
    found = [
        number
        for number, one in enumerate(machine.probes)
        if one.shaft == bearing.shaft and abs(one.station - bearing.station) <= reach and one.gap_grows is not None
    ]
    angle = np.deg2rad([machine.probes[one].angle_deg for one in found])
    return found if np.abs(np.sin(angle[:, None] - angle)).max(initial=0.0) >= ACROSS else ()
