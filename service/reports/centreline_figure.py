"""Shaft centreline: where each journal stands in its clearance over speed, by the model of the films, before and after."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from estimator.arrays import Floats
from estimator.machine.bearings_on_films import bearings_on_films
from estimator.statics.journal_states import journal_states
from estimator.units import METRES
from estimator.updated_model.placed_films import placed_films
from service.identification.stored_model import Identified
from service.reports.plot_frame import BEFORE, FITTED, GRID, INK, curve, dots, label, segment, svg
from service.wording.language import ENGLISH, Language
from service.wording.shown_units import USUAL_UNITS, ShownUnits

SIZE, RADIUS = 164.0, 62.0
SPEEDS = 15


@dataclass(frozen=True)
class JournalPath:
    """A journal's positions (S, 2) [µm] over speed, and the radial clearance [µm] of its bearing."""

    bearing: str
    position: Floats
    clearance: float


def journal_paths(one: Identified) -> list[JournalPath]:
    """Return the path of each journal from the lowest to the highest speed of the fit; none without films or equilibrium."""
    model = one.model
    speed = np.linspace(one.speed_minimum, one.speed_maximum, SPEEDS)
    coordinates = model.coordinates_at(speed)
    found = placed_films(coordinates)
    if found is None:
        return []
    placed, films = found
    states = journal_states(films, placed.own(coordinates.theta(model.values)), speed=speed)
    if states is None:
        return []
    return [
        JournalPath(
            bearing.id,
            states.position[:, bearing.number] / METRES["um"],
            float(states.clearance[bearing.number]) / METRES["um"],
        )
        for bearing in bearings_on_films(one.machine.bearings)
    ]


def centreline_figure(
    now: JournalPath,
    before: JournalPath | None,
    speed_rpm: tuple[float, float],
    language: Language = ENGLISH,
    units: ShownUnits = USUAL_UNITS,
) -> str:
    """Return one bearing's picture. speed_rpm: at the ends of the paths [r/min]."""
    scale = RADIUS / max(now.clearance, 0.0 if before is None else before.clearance)
    parts = [segment(-RADIUS, 0, RADIUS, 0, GRID), segment(0, -RADIUS, 0, RADIUS, GRID)]
    for colour, one in ((BEFORE, before), (FITTED, now)):
        if one is not None:
            parts += _drawn(one, scale, colour)
    end = now.position * scale
    for at, rpm in ((0, speed_rpm[0]), (-1, speed_rpm[1])):
        words = units.speed_number(rpm, language)
        parts.append(label(end[at, 0] + 4, -end[at, 1] - 3, words, anchor="start", size=7))
    parts.append(label(0, RADIUS + 13, language.translate("plot.clearance", clearance=language.length(now.clearance))))
    return svg("".join(parts), SIZE, SIZE, left=-SIZE / 2, top=-SIZE / 2)


def _drawn(one: JournalPath, scale: float, colour: str) -> Iterator[str]:
    ring = INK if colour == FITTED else colour
    yield f'<circle cx="0" cy="0" r="{one.clearance * scale:.1f}" fill="none" stroke="{ring}" stroke-width="0.8"/>'
    x, y = one.position[:, 0] * scale, -one.position[:, 1] * scale
    yield curve(x, y, colour, dashed=colour == BEFORE)
    yield dots(x[-1:], y[-1:], colour, radius=2.6)
