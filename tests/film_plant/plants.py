"""Random plants: two shafts on four journal bearings with a coupling, of the proportions of industrial trains.

What is believed of a train is drawn first; the truth differs from it in clearances, viscosities and elevations by the stated
priors. Trains that whirl, or whose journals come close to the wall, within their speed range are drawn anew, both together.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from tests.film_plant.around_references import MOTOR_COMPRESSOR, SPEED, TURBINE_GENERATOR, train_around
from tests.film_plant.arrays import Floats
from tests.film_plant.discrepancy import Discrepancy, DiscrepancySize
from tests.film_plant.motor_compressor import CouplingKind, motor_compressor
from tests.film_plant.oil import HeatedOil
from tests.film_plant.other_trains import other_train
from tests.film_plant.plant import RPM, Plant
from tests.film_plant.proportions import PRESSURES, Design, believed_train, placed, standing
from tests.film_plant.statics import Equilibrium, NoEquilibrium
from tests.film_plant.supports import rolling, tabulated
from tests.film_plant.train import ConstantOil, Oil, Train

SMALLEST_RATIO = 0.005
"""Smallest damping ratio of a train that is taken [-]."""
LARGEST_WAY = 0.93
"""Largest way of a journal to the wall of a train that is taken [-]."""
LARGEST_ORBIT = 0.25
"""Largest 1× amplitude in clearances; unbalances are made smaller for it [-]."""
LEAST_WAY = 0.15
"""Least way of a journal to the wall at the highest speed of a train that is taken: bearings are not made for less [-]."""
MOST_DRAWS = 200
"""Most trains that are drawn for one plant."""
HOTTEST_FILM = 95.0
"""Highest effective temperature of a film of a train that is taken [°C]."""
SUPPORT_SPREAD = 0.15
"""Standard deviation of the logarithm by which coefficients of bearings that are no films differ from what is believed [-]."""
ROUND_BORES = ("plain", "grooved", "elliptical")
"""Bores of the films of mixed trains of other proportions."""
CHECKED_SPEEDS = 9
"""Speeds at which a train's stability is checked."""


@dataclass(frozen=True)
class Priors:
    """Standard deviations by which the truth differs from what is believed.

    Attributes:
        clearance: Of the logarithm [-].
        viscosity: Of the logarithm [-].
        elevation: Of a bearing's elevation, vertical and horizontal, with a flexible coupling [m].
        rigid_elevation: The same with a rigid coupling [m].
        common_oil: Whether all bearings have one oil supply, and so one viscosity.
        viscosity_difference: Of the logarithm of each viscosity from that [-].
    """

    clearance: float = 0.15
    viscosity: float = 0.15
    elevation: float = 30e-6
    rigid_elevation: float = 5e-6
    common_oil: bool = False
    viscosity_difference: float = 0.0


PRIORS = Priors()
"""Priors where none are given."""
PLAIN_DESIGN = Design()
"""Kind of train where none is given."""

Alteration = Callable[[Train, np.random.Generator, float], Train]
"""Function of a true train, a random generator and the highest speed [rad/s] that returns the train with something altered."""


def unaltered(train: Train, _: np.random.Generator, __: float) -> Train:
    """The train as it is."""
    return train


def random_plant(
    seed: int,
    *,
    design: Design | None = PLAIN_DESIGN,
    priors: Priors = PRIORS,
    discrepancy: DiscrepancySize | None = None,
    alter: Alteration = unaltered,
) -> Plant:
    """Draw a plant.

    Args:
        seed: Seed of the random generator: the same gives the same plant.
        design: Kind of the train; None for any of other proportions.
        priors: How far the truth is from what is believed.
        discrepancy: Size of the films' discrepancies; None for none.
        alter: What else is done to the truth, and not believed.

    Returns:
        The plant.

    Raises:
        RuntimeError: No train among many was stable.
    """
    rng = np.random.default_rng(seed)

    def draw() -> Plant | None:
        believed, kind, fastest = other_train(rng) if design is None else believed_train(rng, design)
        truth = alter(_truth(believed, rng, priors, kind), rng, fastest)
        return _checked(Plant(f"plant {seed}", truth, believed, float(rng.uniform(0.15, 0.2) * fastest), fastest))

    return _with_discrepancy(_first(draw, f"train of seed {seed}"), discrepancy, rng)


def drawn_supports(rng: np.random.Generator, bearings: int) -> Floats:
    """Draw the factors by which the true kxx, kyy, cxx and cyy of bearings that are no films are off (n, 4) [-]."""
    return np.exp(SUPPORT_SPREAD * rng.standard_normal((bearings, 4)))


def mixed_plant(
    seed: int,
    *,
    priors: Priors = PRIORS,
    discrepancy: DiscrepancySize | None = None,
    supports: Callable[[np.random.Generator, int], Floats] = drawn_supports,
    design: Design = PLAIN_DESIGN,
) -> Plant:
    """Draw a train of which one shaft runs on films, the other on rolling elements (even seeds) or by a maker's table.

    Of each four plants the third and fourth have the driver on films.

    Args:
        seed: Seed of the random generator.
        priors: How far the truth is from what is believed.
        discrepancy: Size of the films' discrepancies; None for none.
        supports: Function of a random generator and the number of bearings that are no films that returns the factors on their
            true kxx, kyy, cxx and cyy (n, 4) [-].
        design: Kind of the train and of its films.

    Returns:
        The plant.
    """
    rng = np.random.default_rng([seed, 23])
    supported = 0 if seed % 4 < 2 else 1

    def draw() -> Plant | None:
        believed, kind, fastest = believed_train(rng, design)
        slowest = float(rng.uniform(0.15, 0.2) * fastest)
        bearings = []
        for one in believed.bearings:
            if one.shaft == supported:
                load = 0.5 * sum(PRESSURES) * one.diameter * one.length
                own = tabulated(load, slowest, fastest, rng) if seed % 2 else rolling(load, fastest, rng)
                one = replace(one, own=own)
            bearings.append(one)
        believed = replace(believed, bearings=tuple(bearings))
        truth = _supports_changed(_truth(believed, rng, priors, kind), rng, supports)
        return _checked(Plant(f"mixed {seed}", truth, believed, slowest, fastest))

    return _with_discrepancy(_first(draw, f"mixed train of seed {seed}"), discrepancy, rng)


def other_mixed_plant(seed: int, *, discrepancy: DiscrepancySize | None = None) -> Plant:
    """Draw a train of two or three shafts of other proportions, one of which runs on rolling elements.

    Args:
        seed: Seed of the random generator.
        discrepancy: Size of the films' discrepancies; None for none.

    Returns:
        The plant.
    """
    rng = np.random.default_rng([seed, 77])

    def believed_one() -> tuple[Train, CouplingKind, float]:
        while True:
            found = other_train(rng)
            if len(found[0].shafts) > 1 and found[0].bearings[0].profile in ROUND_BORES:
                return found

    def draw() -> Plant | None:
        believed, kind, fastest = believed_one()
        rolls = int(rng.integers(len(believed.shafts)))
        slowest = float(rng.uniform(0.15, 0.3) * fastest)
        load = 0.5 * believed.gravity * _mass(believed, rolls)
        bearings = tuple(
            replace(one, pedestal=None, own=rolling(load, fastest, rng) if one.shaft == rolls else None)
            for one in believed.bearings
        )
        believed = replace(believed, bearings=bearings)
        truth = _supports_changed(_truth(believed, rng, PRIORS, kind), rng, drawn_supports)
        return _checked(Plant(f"other mixed {seed}", truth, believed, slowest, fastest))

    return _with_discrepancy(_first(draw, f"other mixed train of seed {seed}"), discrepancy, rng)


def _mass(train: Train, shaft: int) -> float:
    """Mass of a shaft with its discs [kg]."""
    steel = sum(train.material.density * np.pi / 4 * length * diameter**2 for length, diameter in train.shafts[shaft].pieces)
    return float(steel + sum(one.mass for one in train.discs if one.shaft == shaft))


def _supports_changed(train: Train, rng: np.random.Generator, supports: Callable[[np.random.Generator, int], Floats]) -> Train:
    """The train with factors on the coefficients of its bearings that are no films."""
    factors = iter(supports(rng, sum(one.own is not None for one in train.bearings)))
    return replace(
        train,
        bearings=tuple(one if one.own is None else replace(one, own=one.own.scaled(next(factors))) for one in train.bearings),
    )


def motor_compressor_plant(
    seed: int,
    kind: CouplingKind = "flexible",
    *,
    priors: Priors = PRIORS,
    discrepancy: DiscrepancySize | None = None,
    alter: Alteration = unaltered,
) -> Plant:
    """Draw the truth of a motor and compressor from the priors; otherwise as `random_plant`."""
    rng = np.random.default_rng(seed)
    believed = replace(motor_compressor(kind), refinement=2)
    slowest, fastest = 700.0 * RPM, 4600.0 * RPM

    def draw() -> Plant | None:
        truth = alter(_truth(believed, rng, priors, kind), rng, fastest)
        return _checked(Plant(f"motor-compressor {seed}", truth, believed, slowest, fastest))

    return _with_discrepancy(_first(draw, f"truth of seed {seed}"), discrepancy, rng)


def reference_plant(
    seed: int,
    kind: CouplingKind = "flexible",
    *,
    priors: Priors = PRIORS,
    discrepancy: DiscrepancySize | None = None,
    alter: Alteration = unaltered,
    pedestals: bool = False,
) -> Plant:
    """Draw a train around a reference, of even seeds a motor and compressor, of odd ones a turbine and its generator.

    Otherwise as `random_plant`; believed and true train are drawn anew together.

    pedestals: Whether bearings stand on pedestals with resonances inside the speed range.
    """
    rng = np.random.default_rng([seed, 24])
    reference = TURBINE_GENERATOR if seed % 2 else MOTOR_COMPRESSOR

    def draw() -> Plant | None:
        believed = train_around(reference, kind, rng)
        fastest = reference.fastest * RPM * float(rng.uniform(1.0 - SPEED, 1.0 + SPEED))
        if pedestals:
            stood = tuple(standing(one, fastest, rng) for one in believed.bearings)
            believed = placed(replace(believed, bearings=stood))
        truth = alter(_truth(believed, rng, priors, kind), rng, fastest)
        return _checked(Plant(f"{reference.name} {seed}", truth, believed, reference.slowest * RPM, fastest))

    return _with_discrepancy(_first(draw, f"train of seed {seed}"), discrepancy, rng)


def _first(draw: Callable[[], Plant | None], what: str) -> Plant:
    """The first plant of many draws that is taken."""
    for _ in range(MOST_DRAWS):
        found = draw()
        if found is not None:
            return found
    raise RuntimeError(f"no {what} among {MOST_DRAWS} was stable")


def _with_discrepancy(plant: Plant, size: DiscrepancySize | None, rng: np.random.Generator) -> Plant:
    """Draw discrepancies until the plant is stable with them."""
    if size is None:
        return plant
    for _ in range(MOST_DRAWS):
        drawn = Discrepancy(size, len(plant.train.bearings), slowest=plant.slowest, fastest=plant.fastest, rng=rng)
        found = plant.with_discrepancy(drawn)
        if found.is_damped(found.speeds(CHECKED_SPEEDS), ratio=SMALLEST_RATIO):
            return found
    raise RuntimeError(f"{plant.name} is stable with none of {MOST_DRAWS} discrepancies")


def _checked(plant: Plant) -> Plant | None:
    """The plant with unbalances of a sensible size; None where it whirls or a journal is too close to the wall."""
    try:
        films = plant.films(plant.speeds(CHECKED_SPEEDS))
    except NoEquilibrium:
        return None
    way = films.way[:, plant.train.on_films]
    if (
        _hottest(plant, films) > HOTTEST_FILM
        or way.max() > LARGEST_WAY
        or way[0].min() < LEAST_WAY
        or films.load[..., 1].min() <= 0.0
    ):
        return None
    if not plant.is_damped(plant.speeds(CHECKED_SPEEDS), ratio=SMALLEST_RATIO):
        return None
    orbit = np.abs(plant.phasors(plant.films(plant.speeds(60)))).reshape(60, -1, 2) / plant.train.clearances[:, None]
    factor = min(1.0, LARGEST_ORBIT / orbit.max())
    discs = tuple(replace(one, unbalance=factor * one.unbalance) for one in plant.train.discs)
    return replace(plant, train=replace(plant.train, discs=discs))


def _hottest(plant: Plant, films: Equilibrium) -> float:
    """Highest temperature of the oil at the highest speed, which comes first [°C]; -∞ where it has none."""
    return max(
        one.oil.temperature(one, speed=float(films.speed[0]), eccentricity=float(way))
        if isinstance(one.oil, HeatedOil)
        else -np.inf
        for one, way in zip(plant.train.bearings, films.way[0], strict=True)
    )


def _truth(believed: Train, rng: np.random.Generator, priors: Priors, kind: CouplingKind) -> Train:
    """Draw the true train."""
    count = len(believed.bearings)
    clearance = np.exp(priors.clearance * rng.standard_normal(count))
    drawn = np.exp(priors.viscosity * rng.standard_normal(count))
    if priors.common_oil:
        drawn = drawn[0] * np.exp(priors.viscosity_difference * rng.standard_normal(count))
    move = (priors.elevation if kind == "flexible" else priors.rigid_elevation) * rng.standard_normal((count, 2))
    bearings = tuple(
        replace(
            one,
            clearance=float(one.clearance * clearance[k]),
            oil=_thickened(one.oil, float(drawn[k])),
            elevation=(one.elevation[0] + float(move[k, 0]), one.elevation[1] + float(move[k, 1])),
        )
        for k, one in enumerate(believed.bearings)
    )
    discs = tuple(
        replace(one, unbalance=complex(one.mass * rng.uniform(6e-6, 20e-6) * np.exp(2j * np.pi * rng.random())))
        for one in believed.discs
    )
    return replace(believed, bearings=bearings, discs=discs)


def _thickened(oil: Oil, factor: float) -> Oil:
    """The oil with its viscosity times a factor."""
    if isinstance(oil, ConstantOil):
        return ConstantOil(oil.value * factor)
    assert isinstance(oil, HeatedOil)
    return replace(oil, factor=oil.factor * factor)
