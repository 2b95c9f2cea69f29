"""Offset and angle at each coupling from an identification by oil films, with what was believed of them before it.

Both follow linearly from the elevations of all bearings, so that their errors come exactly from the covariance of these
(JCGM 100:2008, 5.2). An offset may be known well although the data say nothing of a single elevation.
"""

from dataclasses import dataclass

import numpy as np

from estimator.arrays import Floats
from estimator.rotor.parameter_names import ALIGNMENT_UNITS
from estimator.statics.alignment import coupling_alignments
from estimator.statics.film_parameters import NUMBERS, FilmParameters
from estimator.updated_model.model import UpdatedModel
from estimator.updated_model.placed_films import placed_films
from estimator.updated_model.uncertainty import standard_errors

PLANES = (("vertical", "elevation_y"), ("horizontal", "elevation_x"))
"""Planes in which alignment is reported, with the number of a film that it follows from."""


@dataclass(frozen=True)
class AlignmentResult:
    """Offset or angle of a coupling in one plane.

    Attributes:
        name: Name, such as `coupling.C1.offset_vertical`.
        unit: SI unit.
        slope: Derivatives (n,) by the coordinates of the model [unit per unit of the coordinate].
        value: Value [unit].
        error: Its standard error [unit].
        believed: Its standard deviation before the identification, from the spreads of the elevations [unit].
        undefined: Reason why there is none; None where there is one.
    """

    name: str
    unit: str
    slope: Floats
    value: float
    error: float
    believed: float
    undefined: str | None = None


def alignment_results(model: UpdatedModel) -> tuple[AlignmentResult, ...]:
    """Compute offset and angle of each coupling in both planes (first order: JCGM 100:2008, 5.2).

    Args:
        model: The updated model.

    Returns:
        The numbers, coupling by coupling; none of a train whose coefficients do not follow from films.
    """
    coordinates = model.coordinates_at(np.ones(1))
    found = placed_films(coordinates)
    if found is None:
        return ()
    placed, films = found
    fitted = placed.own(coordinates.theta(model.values))[: films.own.count]
    own = placed.numbers[: films.own.count]
    spread = coordinates.spread[own]
    results = []
    for one in coupling_alignments(model.machine):
        for what, by_elevation in (("offset", one.offset), ("angle", one.angle)):
            for plane, number in PLANES:
                row = by_elevation @ _mixing(films.own, number)
                slope = np.zeros(model.values.size)
                slope[own] = row / coordinates.unit[own]
                results.append(
                    AlignmentResult(
                        name=f"coupling.{one.coupling}.{what}_{plane}",
                        unit=ALIGNMENT_UNITS[f"{what}_{plane}"],
                        slope=slope,
                        value=float(row @ fitted),
                        error=float(standard_errors(slope, model.covariance)),
                        believed=float(np.linalg.norm(row * spread)),
                        undefined=one.undefined,
                    )
                )
    return tuple(results)


def _mixing(own: FilmParameters, number: str) -> Floats:
    """Return one number of all n films (n, P) per unit of each fitted number [m]."""
    return own.mixing[NUMBERS.index(number) : len(NUMBERS) * len(own.forms) : len(NUMBERS)]
