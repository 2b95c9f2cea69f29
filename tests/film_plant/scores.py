"""Truths of a document's parameters, data that follow a document's own forms, and the score of an identification."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimator.fit.estimates import CONFIDENCE_95
from estimator.fit.identification import Identification
from estimator.fit.problem.coordinates import Coordinates
from estimator.fit.validation.physical_limits import PhysicalLimits
from estimator.machine.document import Machine
from estimator.phasors.measurement import Measurement
from estimator.rotor.condensation import CondensedTrain, condense
from estimator.rotor.response import response
from estimator.updated_model.derived_quantities import Derived
from tests.film_plant.arrays import Floats
from tests.film_plant.documents import DAMPING, DIRECT, SPEED_MARGIN, STIFFNESS, measured, pedestal_terms
from tests.film_plant.plant import RPM, Plant
from tests.film_plant.supports import OwnCoefficients

Truths = dict[str, complex]
"""True value by the name of an estimate [SI]."""
WEAKER_STIFFNESS, WEAKER_DAMPING = 0.25, 0.5
"""Part of a film's cross-coupled terms that own forms keep, so that the train is stable [-]."""
LARGEST_TREND = 0.5
"""Largest change of a coefficient's logarithm from the middle speed to standstill, in own forms [-]."""
CURVATURE = 0.15
"""Change of its logarithm with the square of that distance [-]."""


@dataclass(frozen=True)
class Score:
    """Comparison of an identification with the truth.

    Attributes:
        accepted: Whether it was accepted.
        inside: Which of the real numbers told have the truth in their 95 % interval.
        withheld: Number of parameters that are not estimable.
    """

    accepted: bool
    inside: tuple[bool, ...]
    withheld: int

    @property
    def coverage(self) -> float:
        """Part of the intervals that hold the truth; 1 where none is told."""
        return float(np.mean(self.inside)) if self.inside else 1.0

    @property
    def withheld_part(self) -> float:
        """Part of the parameters that are not estimable."""
        return self.withheld / max(1, self.withheld + len(self.inside))


def score(found: Identification, truth: Truths) -> Score:
    """Compare an identification with the truth, of the parameters whose truth is given."""
    inside: list[bool] = []
    withheld = 0
    for one in found.estimates:
        true = truth.get(one.name)
        if true is None:
            continue
        if one.value is None or one.standard_error is None or one.lower is None or one.upper is None:
            withheld += 1
        elif one.imaginary is not None and one.imaginary_standard_error is not None:
            inside.append(abs(one.value - true.real) <= CONFIDENCE_95 * one.standard_error)
            inside.append(abs(one.imaginary - true.imag) <= CONFIDENCE_95 * one.imaginary_standard_error)
        else:
            inside.append(one.lower <= true.real <= one.upper)
    return Score(found.accepted, tuple(inside), withheld)


def score_derived(found: Sequence[Derived], truth: Truths) -> Score:
    """Compare the derived quantities of an accepted identification with the truth, of those whose truth is given."""
    told = [one for one in found if one.name in truth]
    inside = tuple(
        one.lower <= truth[one.name].real <= one.upper for one in told if one.lower is not None and one.upper is not None
    )
    return Score(True, inside, len(told) - len(inside))


def true_values(plant: Plant, machine: Machine) -> Truths:
    """The plant's unbalances and coefficients: at each knot those at its speed, of constant ones the mean over the speeds."""
    speed = np.sort(plant.speeds(40))
    films = plant.films(speed)
    found = _unbalances(plant)
    for one in _coordinates(machine, speed)[1].parameters:
        if one.coefficient is None or not one.coefficient.startswith("bearing."):
            continue
        _, bearing, term = one.coefficient.split(".")
        values = _term(films.stiffness, films.damping, term)[:, int(bearing[1:]) - 1]
        found[one.name] = complex(np.mean(values) if one.speed is None else np.interp(one.speed, speed, values))
    return found


def film_truths(plant: Plant) -> Truths:
    """The plant's unbalances, clearances, viscosities, and elevations over those of the aligned train."""
    found = _unbalances(plant)
    # Viscosity is told at the end of the document's range.
    fastest = plant.films(np.array([plant.fastest * (1.0 + SPEED_MARGIN)]))
    for number, (true, believed) in enumerate(zip(plant.train.bearings, plant.believed.bearings, strict=True), start=1):
        name = f"bearing.B{number}"
        found[f"{name}.clearance"] = complex(true.clearance)
        found[f"{name}.viscosity"] = complex(fastest.viscosity[0, number - 1])
        for axis, place in (("x", 0), ("y", 1)):
            found[f"{name}.elevation_{axis}"] = complex(true.elevation[place] - believed.elevation[place])
        if true.own is not None and believed.own is not None:
            found |= _own_truths(name, true.own, believed.own)
        if true.pedestal is not None:
            found |= {f"pedestal.P{number}.{term}": complex(value) for term, value in pedestal_terms(true.pedestal)}
    return found


def _own_truths(name: str, true: OwnCoefficients, believed: OwnCoefficients) -> Truths:
    """Coefficients of a bearing that is no film; of one that follows a table, the factors on its direct terms."""
    values, expected = (np.concatenate([one.stiffness[0].ravel(), one.damping[0].ravel()]) for one in (true, believed))
    found: Truths = {}
    for term, value, said in zip((*STIFFNESS, *DAMPING), values, expected, strict=True):
        if true.constant:
            found[f"{name}.{term}"] = complex(value)
        elif term in DIRECT:
            found[f"{name}.{term}_scale"] = complex(value / said)
    return found


def film_result_truths(plant: Plant, reported_rpm: Sequence[float]) -> Truths:
    """Return what follows from the plant's films: coefficients at some speeds [r/min], loads and journals' positions at the
    last."""
    films = plant.films(np.array(reported_rpm) * RPM)
    found: Truths = {}
    for number, bearing in enumerate(plant.train.bearings):
        name, place, load = f"bearing.B{number + 1}", films.position[-1, number], films.load[-1, number]
        for term in (*STIFFNESS, *DAMPING):
            values = _term(films.stiffness, films.damping, term)[:, number]
            found |= {f"{name}.{term}@{rpm:g}rpm": complex(value) for rpm, value in zip(reported_rpm, values, strict=True)}
        found |= {f"{name}.load_vertical": complex(load[1]), f"{name}.load_horizontal": complex(load[0])}
        found |= {f"{name}.journal_x": complex(place[0]), f"{name}.journal_y": complex(place[1])}
        found[f"{name}.eccentricity_ratio"] = complex(np.hypot(*place) / bearing.clearance)
    return found


def own_form_data(plant: Plant, machine: Machine, *, seed: int) -> tuple[Measurement, Truths] | None:
    """Data of a train whose coefficients follow exactly the forms of its document, and its truth; None where it is unstable.

    At the middle speed the direct terms are the plant's; cross-coupled ones are weaker, so that the train is stable.
    """
    clean = measured(plant, seed=seed)
    train, coordinates = _coordinates(machine, clean.speed)
    rng = np.random.default_rng(7000 + seed)
    middle = (plant.slowest + plant.fastest) / 2
    films = plant.films(np.array([middle]))
    trend = {one.coefficient: rng.uniform(-LARGEST_TREND, LARGEST_TREND) for one in coordinates.parameters}
    theta, truth = coordinates.centre.copy(), _unbalances(plant)
    for place, one in enumerate(coordinates.parameters):
        if one.coefficient is not None and one.coefficient.startswith("bearing."):
            _, bearing, term = one.coefficient.split(".")
            away = 0.0 if one.speed is None else (one.speed - middle) / middle
            value = float(_term(films.stiffness, films.damping, term)[0, int(bearing[1:]) - 1]) * _weaker(term)
            value *= float(np.exp(trend[one.coefficient] * away + CURVATURE * away**2))
            theta[place] = one.fitted(value)
        truth[one.name] = complex(float(one.value(theta[place : place + 1])[0]))
    excitations = np.zeros(len(train.unknowns.excitations), dtype=complex)
    excitations[: len(plant.train.discs)] = [disc.unbalance for disc in plant.train.discs]
    phasor = response(train, coefficients=coordinates.coefficients(theta), excitations=excitations)
    found = measured(plant, seed=seed, clean=(clean.speed, phasor))
    limits = PhysicalLimits(machine, clean.speed, coordinates, tuple(train.scale_names))
    return None if limits.growing_mode(theta) is not None else (found, truth)


def _coordinates(machine: Machine, speed: Floats) -> tuple[CondensedTrain, Coordinates]:
    train = condense(machine, speed=speed, direction=np.ones(speed.size))
    return train, Coordinates.of(train, unbalance_scale=1.0)


def _unbalances(plant: Plant) -> Truths:
    return {f"disc.D{number}.unbalance": complex(disc.unbalance) for number, disc in enumerate(plant.train.discs, start=1)}


def _term(stiffness: Floats, damping: Floats, term: str) -> Floats:
    """One term of all bearings over speed (S, n)."""
    place = (STIFFNESS if term in STIFFNESS else DAMPING).index(term)
    return np.asarray((stiffness if term in STIFFNESS else damping)[:, :, place // 2, place % 2])


def _weaker(term: str) -> float:
    if term in ("kxy", "kyx"):
        return WEAKER_STIFFNESS
    return WEAKER_DAMPING if term in ("cxy", "cyx") else 1.0
