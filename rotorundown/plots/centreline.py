"""Shaft centreline: where each journal stands in its clearance over speed, as the model of the films has it."""

from typing import TYPE_CHECKING

import numpy as np

from estimator.errors import Invalid
from estimator.machine.bearings_on_films import bearings_on_films
from estimator.statics.journal_states import journal_states
from estimator.units import METRES, RAD_PER_S
from estimator.updated_model.model import UpdatedModel
from estimator.updated_model.placed_films import placed_films
from rotorundown.plots.canvas import FITTED, figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SPEEDS = 30


class NoFilms(Invalid):
    """Raised for a machine whose bearings are not described by their films."""


def centreline(model: UpdatedModel) -> "Figure":
    """Draw the journals' positions [µm] in their clearance circles over the speed range. Raises NoFilms."""
    limits = model.machine.speed_range
    speed = np.linspace(limits.minimum_rpm, limits.maximum_rpm, SPEEDS) * RAD_PER_S["rpm"]
    coordinates = model.coordinates_at(speed)
    found = placed_films(coordinates)
    if found is None:
        raise NoFilms(f"the bearings of '{model.machine.id}' say nothing of their films, so no journal's position is known")
    placed, films = found
    own = placed.own(coordinates.theta(model.values))
    states = journal_states(films, own, speed=speed)
    if states is None:
        raise NoFilms(f"the films of '{model.machine.id}' have no equilibrium at all speeds of the range")
    bearings = bearings_on_films(model.machine.bearings)
    drawn, axes = figure(1, len(bearings))
    circle = np.exp(1j * np.linspace(0.0, 2.0 * np.pi, 100))
    for number, bearing in enumerate(bearings):
        plot = axes[0, number]
        clearance = states.clearance[bearing.number] / METRES["um"]
        place = states.position[:, bearing.number] / METRES["um"]
        plot.plot(clearance * circle.real, clearance * circle.imag, color="0.6")
        plot.plot(place[:, 0], place[:, 1], color=FITTED)
        for at in (0, -1):
            plot.annotate(f"{speed[at] / RAD_PER_S['rpm']:.0f}", place[at], fontsize="x-small")
        plot.set_aspect("equal")
        plot.set_title(bearing.id)
        plot.set_xlabel("x [µm]")
    axes[0, 0].set_ylabel("y [µm]")
    return drawn
