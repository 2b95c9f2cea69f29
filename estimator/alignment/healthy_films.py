"""Variation of a healthy train on oil films, in its own coordinates: from run to run, and over the seasons.

From run to run, films' stiffness and damping scatter by some per cent, the oil is warmer or colder for all films together,
each bearing moves by a micrometre, and the power is not quite the same, which process forces follow. How
much is learnt from a baseline: variance components of a linear mixed model (Laird and Ware, Biometrics 38 (1982) 963,
doi:10.2307/2529876), with what is stated as a prior that counts as much as ten runs.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimator.alignment.run_likelihood import run_likelihood
from estimator.arrays import Floats
from estimator.bearings.terms import TERMS
from estimator.fit.problem.coordinates import Coordinates
from estimator.machine.alignment_rules import HealthyVariation
from estimator.machine.document import Machine
from estimator.machine.films import StaticLoad
from estimator.machine.parameter_description import ParameterDescription, describe
from estimator.statics.film_deviations import own_size
from estimator.updated_model.model import UpdatedModel
from estimator.updated_model.placed_films import placed_films

DEVIATION = "_deviation"
"""Middle of the names of films' deviations, behind the term that deviates."""
LEVELS = {"stiffness": 0, "damping": 1}
"""Power of jω of the terms whose deviations all films share, by the word that their names begin with."""
VISCOSITIES = ("viscosity", "viscosity_factor")
"""Numbers of films that follow the oil's temperature."""
KNOWN_RUNS = 10
"""Weight of the stated values, as a number of runs."""
KNOWN_COMPONENTS = 1
"""Weight of the stated values of what is `ALIKE`, as a number of components of single runs: a baseline has dozens."""
ALIKE = ("unbalance",)
"""Numbers whose quantities vary alike and are seen in each run, so that each component of one run counts as a run: stiffness
and damping of films, couplings and pedestals are not, and what a baseline shows of all says little of each."""
STEPS = 6
"""Steps in which the numbers are found: each takes most of the way that is left."""
KNOWN_OIL = 2.0
"""Standard deviation of the season's viscosity where the oil's temperature is measured, over that from run to run [-]."""


@dataclass(frozen=True)
class CoordinateScales:
    """Scales by which a train's n coordinates vary.

    Attributes:
        numbers: Number of `HealthyVariation` that each follows from run to run, such as `stiffness`; None of what stays.
        scales: Each one's standard deviation per unit of that number (n,) [1/unit].
        oil: Change (n,) of each per unit of the logarithm of all viscosities together [-].
        slow_numbers: Number that each follows over the seasons; None of what stays.
        slow_scales: As `scales` (n,) [1/unit].
    """

    numbers: tuple[str | None, ...]
    scales: Floats
    oil: Floats
    slow_numbers: tuple[str | None, ...]
    slow_scales: Floats

    def own(self, variation: HealthyVariation) -> Floats:
        """Return the standard deviation of each coordinate by itself from run to run.

        Args:
            variation: Variation of the machine.

        Returns:
            Standard deviations (n,) [-].
        """
        return self.scales * _numbers(self.numbers, variation)

    def between_runs(self, variation: HealthyVariation) -> Floats:
        """Return the covariance of the coordinates from run to run.

        Args:
            variation: Variation of the machine.

        Returns:
            Covariance (n, n) [-].
        """
        return np.diag(self.own(variation) ** 2) + variation.oil**2 * np.outer(self.oil, self.oil)

    def over_seasons(self, variation: HealthyVariation) -> Floats:
        """Return the covariance of the coordinates between two times of the year, elevations included.

        Args:
            variation: Variation of the machine.

        Returns:
            Covariance (n, n) [-].
        """
        own = self.slow_scales * _numbers(self.slow_numbers, variation)
        return np.diag(own**2) + variation.slow_oil**2 * np.outer(self.oil, self.oil)


def stated_variation(machine: Machine) -> HealthyVariation:
    """Return what a machine's document says of its healthy variation.

    Where the oil's temperature is measured, its season is known.

    Args:
        machine: The machine.

    Returns:
        The variation.
    """
    said = machine.operation.healthy_variation
    if any(one.film is not None and one.film.oil.temperature_from is not None for one in machine.bearings):
        return said.model_copy(update={"slow_oil": min(said.slow_oil, KNOWN_OIL * said.oil)})
    return said


def coordinate_scales(coordinates: Coordinates, values: Floats) -> CoordinateScales:
    """Describe what the coordinates of a train on oil films vary with (derived here).

    Args:
        coordinates: The coordinates.
        values: Values (n,) of the machine, of whose unbalances a part varies [SI, logarithms of positive ones].

    Returns:
        The description.

    Raises:
        ValueError: The coefficients do not follow from films.
    """
    found = placed_films(coordinates)
    if found is None:
        raise ValueError("only coordinates of a train on oil films vary so")
    films = found[1].own
    size = {
        one.name: form.discrepancy for one, form in zip(films.train.bearings, films.forms, strict=True) if form is not None
    }
    size |= {f"static_load.{one.id}.{name}": force for one in films.loads for name, force in _stated_forces(one).items()}
    excited = dict(zip(coordinates.names, values, strict=True))
    described = [describe(name) for name in coordinates.names]
    ways = [_way(said, float(unit), size, excited) for said, unit in zip(described, coordinates.unit, strict=True)]
    slow = [_slow_way(said, float(unit)) for said, unit in zip(described, coordinates.unit, strict=True)]
    return CoordinateScales(
        numbers=tuple(number for number, _ in ways),
        scales=np.array([scale for _, scale in ways]),
        oil=np.array([float(said.quantity in VISCOSITIES) for said in described]),
        slow_numbers=tuple(number for number, _ in slow),
        slow_scales=np.array([scale for _, scale in slow]),
    )


def machine_spread(coordinates: Coordinates) -> Floats:
    """Return how far each coordinate of a machine may be off, common to its runs: without what varies from run to run.

    Args:
        coordinates: The coordinates of a train on oil films.

    Returns:
        Standard deviations (n,) [-].
    """
    return np.asarray(np.sqrt(coordinates.spread**2 - coordinates.between_runs))


def machine_precision(coordinates: Coordinates) -> Floats:
    """Return the precision of what is believed of a machine, common to its runs: without what varies from run to run.

    Args:
        coordinates: The coordinates of a train on oil films.

    Returns:
        Precision (n, n) [-].
    """
    part = machine_spread(coordinates) / coordinates.spread
    return np.asarray(coordinates.prior.precision / np.outer(part, part))


def learnt_variation(baseline: Sequence[UpdatedModel]) -> HealthyVariation:
    """Estimate how a machine varies from run to run from its baseline (variance components; Laird and Ware 1982).

    Source: mixed model of Laird and Ware, Biometrics 38 (1982) 963, doi:10.2307/2529876.

    Args:
        baseline: Models of the baseline's runs, at least one, of one machine.

    Returns:
        The variation; that over the seasons as stated, as a baseline is too short to show it.
    """
    coordinates = baseline[0].coordinates_at(np.ones(1))
    scales = coordinate_scales(coordinates, np.median([one.values for one in baseline], axis=0))
    runs = [run_likelihood(one) for one in baseline]
    stated = variation = stated_variation(baseline[0].machine)
    ways = np.column_stack([np.eye(coordinates.size), scales.oil])
    numbers = (*scales.numbers, "oil")
    sizes = np.append(scales.scales, 1.0)
    believed = machine_precision(coordinates)
    for _ in range(STEPS):
        spread = np.append(scales.own(variation), variation.oil)
        seen = [one.marginalised(ways * spread**2 @ ways.T) for one in runs]
        common = np.linalg.inv(sum((one.information for one in seen), believed))
        machine = common @ sum((one.vector for one in seen), np.zeros(coordinates.size))
        squares, told = np.zeros(spread.size), np.zeros(spread.size)
        for one in seen:
            along = ways * spread
            squares += (spread * (along.T @ (one.vector - one.information @ machine))) ** 2
            told += np.sum(along * ((one.information - one.information @ common @ one.information) @ along), axis=0)
        variation = _shrunk(stated, numbers, sizes, squares, told)
    return variation


def _shrunk(
    stated: HealthyVariation, numbers: Sequence[str | None], sizes: Floats, squares: Floats, told: Floats
) -> HealthyVariation:
    """Return the stated numbers moved towards what some runs show (MacKay, Neural Comput. 4 (1992) 415, eq. 2.16).

    squares: sums, over the runs, of the squares of what followed each. told: how many of these values the runs determine.
    """
    update = {}
    for number in dict.fromkeys(one for one in numbers if one is not None):
        own = np.array([one == number and size > 0.0 for one, size in zip(numbers, sizes, strict=True)])
        before = getattr(stated, number)
        if own.any() and before > 0.0:
            known = float(KNOWN_COMPONENTS if number in ALIKE else KNOWN_RUNS * np.count_nonzero(own))
            shown, count = float(np.sum(squares[own] / sizes[own] ** 2)), float(np.sum(told[own]))
            update[number] = float(np.sqrt((known * before**2 + shown) / (known + count)))
    return stated.model_copy(update=update)


def _numbers(names: Sequence[str | None], variation: HealthyVariation) -> Floats:
    return np.array([0.0 if name is None else getattr(variation, name) for name in names])


def _way(
    said: ParameterDescription, unit: float, size: dict[str, float], excited: dict[str, float]
) -> tuple[str | None, float]:
    """Return the number that a coordinate follows from run to run, and its standard deviation per unit of that."""
    if said.quantity in (*VISCOSITIES, "viscosity_ratio"):
        return "viscosity", 1.0
    if said.physical_quantity == "elevation":
        return "elevation", 1.0 / unit
    if said.element_kind == "static_load":
        return "process_force", size[said.whole] / unit
    if said.quantity == "unbalance":
        parts = [excited[f"{said.whole}.{part}"] for part in ("real", "imaginary")]
        return "unbalance", math.hypot(*parts) / unit
    of_scale = describe(said.coefficient).term  # a factor on a table's term varies as that
    if of_scale is not None:
        return _of_order(of_scale.order), 1.0
    if DEVIATION in said.quantity:
        term = said.quantity.partition(DEVIATION)[0]
        if term not in LEVELS:  # those that all films share stay
            return _of_order(TERMS[term].order), 1.0 / own_size(size[said.element_id])
    return None, 0.0


def _stated_forces(load: StaticLoad) -> dict[str, float]:
    """Return what the document states of each component of a static force: its size, or its spread where that is more [N]."""
    return {
        "force_x": max(abs(load.force_x), load.force_x_spread),
        "force_y": max(abs(load.force_y), load.force_y_spread),
    }


def _slow_way(said: ParameterDescription, unit: float) -> tuple[str | None, float]:
    """Return the number that a coordinate follows over the seasons, and its standard deviation per unit of that."""
    if said.quantity in (*VISCOSITIES, "viscosity_ratio"):
        return "slow_viscosity", 1.0
    if said.quantity == "clearance":
        return "slow_clearance", 1.0
    if said.physical_quantity == "elevation":
        return "slow_elevation", 1.0 / unit
    return None, 0.0


def _of_order(order: int) -> str | None:
    return ("stiffness", "damping")[order] if order < 2 else None
