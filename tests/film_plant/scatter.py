"""Runs of one plant: its films' coefficients scatter from run to run, and its oil is warmer or colder."""

from dataclasses import dataclass, replace

import numpy as np

from tests.film_plant.arrays import Floats
from tests.film_plant.discrepancy import FilmChange
from tests.film_plant.plant import Plant
from tests.film_plant.plants import MOST_DRAWS, SMALLEST_RATIO
from tests.film_plant.statics import Equilibrium
from tests.film_plant.train import ConstantOil

STIFFNESS, DAMPING = 0.01, 0.05
"""Standard deviation of each term of a film from run to run, level over speed [-]."""
OIL = 0.05
"""Standard deviation of the logarithm of all viscosities together [-]: some 2 K."""

CHECKED = 3
"""Speeds at which a run's stability is checked."""


@dataclass(frozen=True)
class ScatteredDiscrepancy:
    """A film's discrepancies with the scatter of one run on top: relative ones (n, 2, 2) of stiffness and of damping."""

    usual: FilmChange | None
    stiffness: Floats
    damping: Floats

    def applied(self, films: Equilibrium) -> Equilibrium:
        """Change the coefficients of films."""
        usual = films if self.usual is None else self.usual.applied(films)
        return replace(usual, stiffness=usual.stiffness * (1.0 + self.stiffness), damping=usual.damping * (1.0 + self.damping))


def run_of(plant: Plant, rng: np.random.Generator) -> Plant:
    """The plant as it is in one run, in which it does not whirl: what would is drawn anew.

    Raises:
        RuntimeError: Each of many draws whirls.
    """
    for _ in range(MOST_DRAWS):
        found = _drawn(plant, rng)
        if found.is_damped(found.speeds(CHECKED), ratio=SMALLEST_RATIO):
            return found
    raise RuntimeError(f"{plant.name} whirls in each of {MOST_DRAWS} runs")


def _drawn(plant: Plant, rng: np.random.Generator) -> Plant:
    """The plant with films and oil of one run."""
    count = len(plant.train.bearings)
    stiffness = STIFFNESS * rng.standard_normal((count, 2, 2))
    damping = DAMPING * rng.standard_normal((count, 2, 2))
    damping[:, 1, 0] = damping[:, 0, 1]
    thicker = float(np.exp(OIL * rng.standard_normal()))
    bearings = []
    for one in plant.train.bearings:
        assert isinstance(one.oil, ConstantOil)
        bearings.append(replace(one, oil=ConstantOil(one.oil.value * thicker)))
    train = replace(plant.train, bearings=tuple(bearings))
    discrepancy = ScatteredDiscrepancy(plant.discrepancy, stiffness, damping)
    return replace(plant, train=train, discrepancy=discrepancy)
