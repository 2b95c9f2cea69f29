"""Random plants: two shafts on four journal bearings with a coupling, of the proportions of industrial trains.

What is believed of a train is drawn first; the truth differs from it in clearances, viscosities and elevations by the stated
priors. Trains that whirl, or whose journals come close to the wall, within their speed range are drawn anew, both together.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from tests.film_plant.arrays import Floats
from tests.film_plant.discrepancy import Discrepancy, DiscrepancySize
from tests.film_plant.motor_compressor import CouplingKind, motor_compressor
from tests.film_plant.oil import HeatedOil, walther
from tests.film_plant.plant import RPM, Plant
from tests.film_plant.statics import Equilibrium, NoEquilibrium, aligned_elevations
from tests.film_plant.train import Bearing, ConstantOil, Coupling, Disc, Oil, Pedestal, Shaft, Train

SMALLEST_RATIO = 0.005
"""Smallest damping ratio of a train that is taken [-]."""
LARGEST_WAY = 0.93
"""Largest way of a journal to the wall of a train that is taken [-]."""
LARGEST_ORBIT = 0.25
"""Largest 1× amplitude in clearances; unbalances are made smaller for it [-]."""
PRESSURES = (0.4e6, 1.1e6)
"""Specific pressures that bearings are drawn for [Pa]."""
LEAST_WAY = 0.15
"""Least way of a journal to the wall at the highest speed of a train that is taken: bearings are not made for less [-]."""
MOST_DRAWS = 200
"""Most trains that are drawn for one plant."""
HOTTEST_FILM = 95.0
"""Highest effective temperature of a film of a train that is taken [°C]."""
FASTEST_SURFACE = 50.0
"""Highest speed of a journal's surface [m/s]."""
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
    """

    clearance: float = 0.15
    viscosity: float = 0.15
    elevation: float = 30e-6
    rigid_elevation: float = 5e-6
    common_oil: bool = False


PRIORS = Priors()
"""Priors where none are given."""


def random_plant(
    seed: int,
    *,
    coupling: CouplingKind | None = None,
    profile: str = "plain",
    priors: Priors = PRIORS,
    discrepancy: DiscrepancySize | None = None,
    pedestals: bool = False,
    heated: bool = False,
) -> Plant:
    """Draw a plant.

    Args:
        seed: Seed of the random generator: the same gives the same plant.
        coupling: Kind of the coupling; None draws it.
        profile: Bore of all bearings; other ones than plain have L/D 0.5 or 0.8.
        priors: How far the truth is from what is believed.
        discrepancy: Size of the films' discrepancies; None for none.
        pedestals: Whether the bearings stand on pedestals with resonances inside the speed range.
        heated: Whether a heat balance gives the viscosity.

    Returns:
        The plant.

    Raises:
        RuntimeError: No train among many was stable.
    """
    rng = np.random.default_rng(seed)
    for _ in range(MOST_DRAWS):
        kind: CouplingKind = coupling or ("flexible" if rng.random() < 0.7 else "rigid")
        believed, fastest = _believed(rng, kind, profile, heated=heated, pedestals=pedestals)
        truth = _truth(believed, rng, priors, kind)
        found = _checked(Plant(f"plant {seed}", truth, believed, rng.uniform(0.15, 0.2) * fastest, fastest))
        if found is not None:
            return _with_discrepancy(found, discrepancy, rng)
    raise RuntimeError(f"none of {MOST_DRAWS} trains of seed {seed} was stable")


def motor_compressor_plant(
    seed: int,
    kind: CouplingKind = "flexible",
    *,
    priors: Priors = PRIORS,
    discrepancy: DiscrepancySize | None = None,
) -> Plant:
    """Draw the truth of a motor and compressor from the priors; redrawn as `random_plant` does."""
    rng = np.random.default_rng(seed)
    believed = replace(motor_compressor(kind), refinement=2)
    for _ in range(MOST_DRAWS):
        truth = _truth(believed, rng, priors, kind)
        found = _checked(Plant(f"motor-compressor {seed}", truth, believed, 700.0 * RPM, 4600.0 * RPM))
        if found is not None:
            return _with_discrepancy(found, discrepancy, rng)
    raise RuntimeError(f"none of {MOST_DRAWS} truths of seed {seed} was stable")


def _with_discrepancy(plant: Plant, size: DiscrepancySize | None, rng: np.random.Generator) -> Plant:
    """Draw discrepancies until the plant is stable with them."""
    if size is None:
        return plant
    for _ in range(MOST_DRAWS):
        drawn = Discrepancy(size, len(plant.train.bearings), slowest=plant.slowest, fastest=plant.fastest, rng=rng)
        found = plant.with_discrepancy(drawn)
        if found.damping_ratios(found.speeds(CHECKED_SPEEDS)).min() > SMALLEST_RATIO:
            return found
    raise RuntimeError(f"{plant.name} is stable with none of {MOST_DRAWS} discrepancies")


def _checked(plant: Plant) -> Plant | None:
    """The plant with unbalances of a sensible size; None where it whirls or a journal is too close to the wall."""
    try:
        films = plant.films(plant.speeds(CHECKED_SPEEDS))
    except NoEquilibrium:
        return None
    if (
        _hottest(plant, films) > HOTTEST_FILM
        or films.way.max() > LARGEST_WAY
        or films.way[0].min() < LEAST_WAY
        or films.load[..., 1].min() <= 0.0
    ):
        return None
    if plant.damping_ratios(plant.speeds(CHECKED_SPEEDS)).min() < SMALLEST_RATIO:
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
    viscosity = np.full(count, drawn[0]) if priors.common_oil else drawn
    move = (priors.elevation if kind == "flexible" else priors.rigid_elevation) * rng.standard_normal((count, 2))
    bearings = tuple(
        replace(
            one,
            clearance=float(one.clearance * clearance[k]),
            oil=_thickened(one.oil, float(viscosity[k])),
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


@dataclass(frozen=True)
class _ShaftDraw:
    """A shaft alone: its pieces, discs, bearings and what it can run at [rad/s]."""

    shaft: Shaft
    discs: tuple[Disc, ...]
    bearings: tuple[Bearing, ...]
    critical: float


def _believed(
    rng: np.random.Generator, kind: CouplingKind, profile: str, *, heated: bool, pedestals: bool
) -> tuple[Train, float]:
    """Draw a train as its document describes it, and its highest speed [rad/s]."""
    diameter = float(np.exp(rng.uniform(np.log(0.06), np.log(0.15))))
    grade = int(rng.choice([32, 46]))
    inlet = rng.uniform(40.0, 48.0)
    oil: Oil = HeatedOil(grade, inlet) if heated else ConstantOil(walther(grade, inlet + rng.uniform(12.0, 25.0)))
    draws = [
        _shaft(rng, number, diameter * (1.0 if number == 0 else rng.uniform(0.85, 1.1)), oil, profile) for number in (0, 1)
    ]
    fastest = min(rng.uniform(1.15, 1.75) * min(one.critical for one in draws), 2 * FASTEST_SURFACE / diameter)
    bearings = tuple(one for draw in draws for one in draw.bearings)
    if pedestals:
        bearings = tuple(_on_pedestal(one, fastest, rng) for one in bearings)
    train = Train(
        tuple(one.shaft for one in draws),
        tuple(one for draw in draws for one in draw.discs),
        bearings,
        (_coupling(rng, kind, diameter / 0.08),),
        refinement=2,
    )
    level = aligned_elevations(train)
    placed = tuple(replace(one, elevation=(0.0, float(y))) for one, (_, y) in zip(train.bearings, level, strict=True))
    return replace(train, bearings=placed), float(fastest)


def _shaft(rng: np.random.Generator, number: int, diameter: float, oil: Oil, profile: str) -> _ShaftDraw:
    """Draw a shaft on two bearings with two discs between them."""
    slenderness = float(rng.choice([0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0] if profile == "plain" else [0.5, 0.8]))
    body, span = diameter * rng.uniform(1.4, 1.8), diameter * rng.uniform(10.0, 14.0)
    outer, inner = diameter * rng.uniform(0.8, 1.4), diameter * rng.uniform(1.3, 2.0)
    if number == 1:
        outer, inner = inner, outer
    # The free end lies outwards, the coupling inwards; necks of a tenth of the span at each bearing.
    neck = 0.1 * span
    cuts = np.sort([rng.uniform(0.3, 0.45), rng.uniform(0.55, 0.7)]) * span
    pieces = (
        (outer, diameter),
        (neck, diameter),
        (cuts[0] - neck, body),
        (cuts[1] - cuts[0], body),
        (span - neck - cuts[1], body),
        (neck, diameter),
        (inner, diameter),
    )
    shaft_mass = 7850.0 * np.pi / 4 * sum(length * d**2 for length, d in pieces)
    total = max(2 * rng.uniform(*PRESSURES) * slenderness * diameter**2 / 9.81, 1.4 * shaft_mass)
    shares = rng.uniform(0.42, 0.58)
    discs = tuple(
        _disc(number, float(outer + cut), float(share * (total - shaft_mass)), body, span)
        for cut, share in zip(cuts, (shares, 1.0 - shares), strict=True)
    )
    bearings = tuple(
        Bearing(
            number,
            float(station),
            diameter,
            slenderness * diameter,
            float(diameter / 2 * rng.uniform(1e-3, 2e-3)),
            oil,
            profile,
        )
        for station in (outer, outer + span)
    )
    sag = 9.81 * total * 0.75 * span**3 / (48 * 2.06e11 * np.pi / 64 * body**4)
    shaft = Shaft(tuple((float(length), float(d)) for length, d in pieces))
    return _ShaftDraw(shaft, discs, bearings, float(np.sqrt(9.81 / sag)))


def _disc(shaft: int, station: float, mass: float, body: float, span: float) -> Disc:
    """A disc of a mass as a solid steel cylinder of a sixth of the span in length."""
    length = span / 6
    radius = np.sqrt(mass / (7850.0 * np.pi * length) + body**2 / 4)
    polar = mass * (radius**2 + body**2 / 4) / 2
    return Disc(shaft, station, mass, float(polar / 2 + mass * length**2 / 12), float(polar))


def _coupling(rng: np.random.Generator, kind: CouplingKind, size: float) -> Coupling:
    """A coupling for a shaft of `size` times 80 mm."""
    half = (5.5 * size**3, 0.012 * size**5, 0.02 * size**5)
    if kind == "rigid":
        lateral, slowed, angular = 3e9 * size, 1e4 * size, 3e7 * size**3
        return Coupling(lateral * np.eye(2), slowed * np.eye(2), angular, angular, half)
    lateral, slowed, angular = (
        one * float(np.exp(0.3 * rng.standard_normal())) for one in (1.2e6 * size, 300.0 * size, 2e4 * size**3)
    )
    return Coupling(lateral * np.eye(2), slowed * np.eye(2), angular, angular, half)


def _on_pedestal(bearing: Bearing, fastest: float, rng: np.random.Generator) -> Bearing:
    """The bearing on a pedestal whose own frequencies with its mass lie between 0.5 and 1.3 of the highest speed."""
    mass = 7850.0 * (2.2 * bearing.diameter) ** 3 * rng.uniform(0.8, 1.5)
    frequency = np.array([rng.uniform(0.5, 0.8), rng.uniform(0.8, 1.3)]) * fastest
    stiffness = mass * frequency**2
    damping = 2 * rng.uniform(0.03, 0.08) * mass * frequency
    pair: Callable[[Floats], tuple[float, float]] = lambda two: (float(two[0]), float(two[1]))  # noqa: E731
    return replace(bearing, pedestal=Pedestal((float(mass), float(mass)), pair(stiffness), pair(damping)))
