"""Figures of the evidence of films: a film's coefficients over speed against the truth, and which intervals hold."""

from collections.abc import Mapping
from html import escape

import numpy as np

from benchmarks.fluid_film.film_trials import KINDS, OPTIONS
from benchmarks.thesis.plots import COLOURS, PlottedCurve, chart, save
from estimator.arrays import Floats
from estimator.bearings.terms import LATERAL
from estimator.fit.estimates import CONFIDENCE_95
from estimator.fit.identify import identify
from estimator.machine.document import parse_machine
from estimator.statics.film_model import FilmModel
from estimator.updated_model.model import UpdatedModel, updated_model
from estimator.updated_model.uncertainty import standard_errors
from tests.film_plant.discrepancy import DiscrepancySize
from tests.film_plant.documents import DAMPING, STIFFNESS, film_document, measured
from tests.film_plant.plant import RPM
from tests.film_plant.plants import random_plant

SPEEDS = 40
BEARING = 0
"""Place of the bearing whose film is drawn."""
LEFT, RIGHT, TOP, ROW, WIDTH = 110, 400, 60, 30, 980
"""Margins, the height of a row, and the width of the figure of coverage [px]."""
LOWEST = 0.7
"""Coverage at the left edge; what is lower is drawn there [-]."""
ASKED, LEAST = 0.95, 0.86
"""Coverage that is meant, and the least of a kind [-]."""


def coefficients_over_speed(seed: int) -> list[tuple[str, str]]:
    """Draw the first film of a random plant, identified and true; return each figure's name and place."""
    plant = random_plant(seed, discrepancy=DiscrepancySize())
    machine = parse_machine(film_document(plant))
    model = updated_model(machine, identify(machine, measured(plant, seed=seed), OPTIONS))
    speed = np.linspace(plant.slowest, plant.fastest, SPEEDS)
    films = plant.films(speed[::-1])  # from the highest speed on
    value, error = _with_errors(model, speed)
    found = []
    for what, terms, matrices, unit, scale in (
        ("stiffness", STIFFNESS, films.stiffness, "MN/m", 1e-6),
        ("damping", DAMPING, films.damping, "kN s/m", 1e-3),
    ):
        true = matrices[::-1, BEARING].reshape(SPEEDS, 4)
        series = []
        for place, term in enumerate(terms):
            middle, half = scale * value[term], scale * CONFIDENCE_95 * error[term]
            band = ((middle - half).tolist(), (middle + half).tolist())
            rpm = (speed / RPM).tolist()
            series.append(PlottedCurve(f"{term}, found", rpm, middle.tolist(), band=band, colour=place))
            series.append(PlottedCurve(f"{term}, true", rpm, (scale * true[:, place]).tolist(), dashed=True, colour=place))
        title = f"{what} of a film over speed, plant of seed {seed}"
        svg = chart(title=title, x_label="speed [r/min]", y_label=f"{what} [{unit}]", series=series)
        found.append((what, save(f"films-{what}", svg)))
    return found


def _with_errors(model: UpdatedModel, speed: Floats) -> tuple[dict[str, Floats], dict[str, Floats]]:
    """Return the drawn film's coefficients (S,) [SI] by term, and their standard errors."""
    coordinates = model.coordinates_at(speed)
    placed = next(one for one in coordinates.models if isinstance(one.model, FilmModel))
    theta, unit = coordinates.theta(model.values), coordinates.unit[placed.numbers]
    block = np.ix_(placed.numbers, placed.numbers)
    errors = standard_errors(placed.derivatives(theta, slice(None)), model.covariance[block] / np.outer(unit, unit))
    values, names = placed.values(theta), list(placed.model.coefficients)
    column = {one.name: names.index(f"bearing.{model.machine.bearings[BEARING].id}.{one.name}") for one in LATERAL}
    return ({term: values[:, c] for term, c in column.items()}, {term: errors[:, c] for term, c in column.items()})


def coverage_by_kind(rows: Mapping[str, Mapping[str, float]]) -> str:
    """Draw by kind the part of the intervals that hold the truth, a colour for each row; return the figure's place."""
    kinds = [one for one in KINDS if any(one in row for row in rows.values())]
    height = TOP + ROW * len(kinds) + 50
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" font-family="sans-serif" font-size="12">',
        f'<rect width="{WIDTH}" height="{height}" fill="white"/>',
        f'<text x="{LEFT}" y="22" font-size="14" font-weight="bold">95 % intervals that hold the truth, by kind</text>',
    ]
    for part in np.arange(LOWEST, 1.01, 0.05):
        parts.append(f'<path d="M{_x(part):.1f} {TOP - 15}V{height - 45}" stroke="#dddddd"/>')
        parts.append(f'<text x="{_x(part):.1f}" y="{height - 25}" text-anchor="middle">{part:.0%}</text>')
    for part, dashes in ((ASKED, ""), (LEAST, ' stroke-dasharray="5 4"')):
        parts.append(f'<path d="M{_x(part):.1f} {TOP - 15}V{height - 45}" stroke="#444444"{dashes}/>')
    for line, kind in enumerate(kinds):
        y = TOP + ROW * line
        parts.append(f'<text x="{LEFT - 8}" y="{y + 4}" text-anchor="end">{escape(kind)}</text>')
        for number, row in enumerate(rows.values()):
            if kind in row:
                place = y + 5 * (number - (len(rows) - 1) / 2)
                parts.append(
                    f'<circle cx="{_x(row[kind]):.1f}" cy="{place:.1f}" r="4" fill="{COLOURS[number % len(COLOURS)]}"/>'
                )
    for number, name in enumerate(rows):
        y = TOP + 18 * number
        parts.append(f'<circle cx="{WIDTH - RIGHT + 20}" cy="{y - 4}" r="4" fill="{COLOURS[number % len(COLOURS)]}"/>')
        parts.append(f'<text x="{WIDTH - RIGHT + 30}" y="{y}">{escape(name)}</text>')
    return save("films-coverage", "\n".join([*parts, "</svg>\n"]))


def _x(part: float) -> float:
    return LEFT + (max(part, LOWEST) - LOWEST) / (1.0 - LOWEST) * (WIDTH - LEFT - RIGHT)
