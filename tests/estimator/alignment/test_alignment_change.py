"""Changes of alignment: runs drawn as the linear model says, so that errors must be those that are told."""

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.alignment.alignment_change import alignment_changes
from estimator.arrays import Floats
from estimator.diagnosis.moving_causes import moving_causes
from estimator.fit.problem.coordinates import Coordinates
from estimator.machine.alignment_rules import HealthyVariation
from estimator.machine.film_parameter_names import with_open_forces
from estimator.machine.films import StaticLoad
from estimator.machine.parameter_description import describe
from estimator.updated_model.alignment_results import alignment_results
from estimator.updated_model.model import UpdatedModel, expected_model, model_at
from tests.estimator.models import rich_model
from tests.estimator.updated_model.test_alignment_results import NAMES, machine_of

MODEL = expected_model(machine_of())
COORDINATES = MODEL.coordinates_at(np.ones(1))
VARIATION = HealthyVariation(elevation=5e-6, slow_oil=0.0, slow_viscosity=0.0, slow_clearance=0.0)
ROWS = 120
"""Numbers that each run measures: fewer than there are coordinates."""
TRIALS = 60
BASELINE = 3
OWN_PART = 0.05 * np.sqrt(0.6)
"""Unit of a film's own deviations: the document's discrepancy but for what all films share [-]."""


def drawn_variation(rng: np.random.Generator, coordinates: Coordinates) -> Floats:
    """Draw the deviations of one run's coordinates from the machine's, by name."""
    warmer = VARIATION.oil * rng.standard_normal()
    found = np.zeros(coordinates.size)
    for place, name in enumerate(coordinates.names):
        quantity, number = describe(name).quantity, rng.standard_normal()
        if quantity == "viscosity":
            found[place] = warmer + VARIATION.viscosity * number
        elif quantity.startswith("elevation"):
            found[place] = VARIATION.elevation * number / coordinates.unit[place]
        elif quantity[0] in "kc" and "_deviation" in quantity:
            found[place] = {"k": 0.01, "c": 0.05}[quantity[0]] * number / OWN_PART
        elif name.startswith("coupling."):
            found[place] = {"k": 0.01, "c": 0.05}[quantity[0]] * number
    return found


def fitted(theta: Floats, seen: Floats, rng: np.random.Generator) -> UpdatedModel:
    """The model that a run leads to which measures `seen` @ theta with errors of one."""
    prior, away = np.diag(COORDINATES.spread**-2), theta - COORDINATES.centre
    covariance = np.linalg.inv(seen.T @ seen + prior)
    found = covariance @ seen.T @ (seen @ away + rng.standard_normal(len(seen)))
    unit = COORDINATES.unit
    return replace(MODEL, values=COORDINATES.point(COORDINATES.centre + found), covariance=covariance * np.outer(unit, unit))


WORN = "bearing.B2"
"""Bearing that wears in some trials."""


SEASONS = HealthyVariation(elevation=5e-6, slow_viscosity=0.1, slow_clearance=0.05)
"""Variation with seasons, whose oil is some 30 % thicker or thinner; bearings differ more than is usual."""


SEASONAL = np.array([describe(one).quantity.startswith(("elevation", "viscosity", "clearance")) for one in COORDINATES.names])
FEW = 14
"""Numbers that a run of another season measures, of elevations, viscosities and clearances alone: fewer than there are of
these, so that what the season brings counts."""


def drawn_season(rng: np.random.Generator, thicker: float) -> Floats:
    """Draw the deviations of coordinates in a season whose oil has a viscosity with another logarithm."""
    part = abs(thicker) / SEASONS.slow_oil
    own = {"viscosity": SEASONS.slow_viscosity, "clearance": SEASONS.slow_clearance}
    quantities = [describe(name).quantity for name in COORDINATES.names]
    common = thicker * np.array([one == "viscosity" for one in quantities])
    return common + part * np.array([own.get(one, 0.0) for one in quantities]) * rng.standard_normal(COORDINATES.size)


def trial(seed: int, *, worn: float = 0.0, named: bool = False, thicker: float | None = None) -> tuple[Floats, Floats, Floats]:
    """True changes (4,), told ones with their errors (4, 2), and errors of the alignment of the later run alone (4,).

    worn: growth of a clearance's logarithm. named: whether it is told that the bearing is worn. thicker: change of the
    logarithm of all viscosities with the season; None without seasons.
    """
    rng = np.random.default_rng(seed)
    unbalances = np.array([describe(name).quantity == "unbalance" for name in COORDINATES.names])
    scale = np.where(unbalances, 1e-5, COORDINATES.spread)
    # All is linear here: so runs know couplings well, as what follows from one that a fit finds far softer is not.
    scale = np.where([name.startswith("coupling.") for name in COORDINATES.names], 0.1 * scale, scale)
    machine = COORDINATES.centre + np.where(unbalances, 0.0, scale * rng.standard_normal(scale.size))
    moved = np.array([float("elevation" in name) for name in COORDINATES.names]) * rng.standard_normal(scale.size)
    grown = np.array([worn * float(name == f"{WORN}.clearance") for name in COORDINATES.names])
    if thicker is not None:
        grown = grown + drawn_season(rng, thicker)
    variation = VARIATION if thicker is None else SEASONS
    fits = []
    for run in range(BASELINE + 1):
        own = drawn_variation(rng, COORDINATES)
        theta = machine + own + (moved + grown if run == BASELINE else 0.0)
        seen = 2.0 * rng.standard_normal((ROWS, scale.size)) / scale
        if run == BASELINE and thicker is not None:
            seen = seen[:FEW] * SEASONAL
        fits.append(fitted(theta, seen, rng))
    alone = alignment_results(fits[-1])
    told = alignment_changes(fits[:-1], fits[-1], variation=variation, causes=moving_causes([("wear", WORN)] if named else ()))
    true = [one.slope @ (COORDINATES.unit * (moved + own)) for one in alone]  # slopes of elevations only
    return np.array(true), np.array([[one.value, one.error] for one in told]), np.array([one.error for one in alone])


def test_changes_err_by_what_is_reported() -> None:
    trials = [trial(seed) for seed in range(TRIALS)]
    z = np.array([(told[:, 0] - true) / told[:, 1] for true, told, _ in trials])
    assert 0.85 < np.sqrt(np.mean(z**2)) < 1.15
    assert 0.9 < np.mean(np.abs(z) < 1.96) < 0.99


@pytest.mark.parametrize("thicker", [*(pytest.param(one, marks=pytest.mark.long) for one in (0.0, 0.3)), -0.9])
def test_in_any_season_changes_err_by_what_is_reported(thicker: float) -> None:
    """In the baseline's, in another, and with an oil of less than half the viscosity that nobody has named."""
    trials = [trial(seed, thicker=thicker) for seed in range(TRIALS)]
    z = np.array([(told[:, 0] - true) / told[:, 1] for true, told, _ in trials])
    assert 0.85 < np.sqrt(np.mean(z**2)) < 1.15


def test_a_run_of_the_baselines_oil_is_known_better_than_one_of_another_season() -> None:
    """Bearings differ by what the oil has changed: not at all, and by as much as the season's."""
    seasons = SEASONS.model_copy(update={"slow_viscosity": 0.5, "slow_clearance": 0.5, "viscosity": 0.0})
    rng = np.random.default_rng(5)
    seen = 0.2 * rng.standard_normal((ROWS, COORDINATES.size)) / COORDINATES.spread
    thicker = np.array([float(describe(name).quantity == "viscosity") for name in COORDINATES.names])
    before, same, other = (
        fitted(COORDINATES.centre + by * thicker, seen, np.random.default_rng(6)) for by in (0.0, 0.0, seasons.slow_oil)
    )
    near, far = (alignment_changes([before] * 6, one, variation=seasons) for one in (same, other))
    assert all(one.error > 1.005 * less.error for one, less in zip(far, near, strict=True))


def test_beside_a_worn_bearing_that_is_named_changes_err_by_what_is_reported() -> None:
    def rms(*, named: bool) -> float:
        trials = [trial(seed, worn=0.3, named=named) for seed in range(TRIALS)]
        return float(np.sqrt(np.mean([((told[:, 0] - true) / told[:, 1]) ** 2 for true, told, _ in trials])))

    assert 0.85 < rms(named=True) < 1.15
    assert rms(named=False) > 1.5, "the wear would not have been mistaken for a change of alignment"


def test_what_the_runs_have_in_common_cancels() -> None:
    """The same fit twice has not changed, and its change is known better than its alignment where runs vary by little."""
    rng = np.random.default_rng(1)
    one = fitted(COORDINATES.centre, 2.0 * rng.standard_normal((ROWS, COORDINATES.size)) / COORDINATES.spread, rng)
    still = HealthyVariation.model_validate(dict.fromkeys(HealthyVariation.model_fields, 0.0))
    found = alignment_changes([one] * 6, one, variation=still)
    assert [change.name for change in found] == list(NAMES)
    for change, alone in zip(found, alignment_results(one), strict=True):
        assert abs(change.value) < change.error
        assert change.error < 1.1 * alone.error
        assert change.unit == alone.unit
    wide = alignment_changes([one] * 6, one, variation=VARIATION.model_copy(update={"elevation": 50e-6}))
    assert all(more.error > less.error for more, less in zip(wide, found, strict=True))


def test_a_baseline_is_needed_and_of_the_same_machine() -> None:
    with pytest.raises(ValueError, match="baseline of at least one run"):
        alignment_changes([], MODEL)
    with pytest.raises(ValueError, match="of the same machine"):
        alignment_changes([rich_model()], MODEL)


def test_runs_of_which_some_doubt_a_force_are_compared() -> None:
    """As `updated_model` builds them: a doubted force is a coordinate of that run's model only."""
    rng = np.random.default_rng(2)
    load = StaticLoad.model_validate({"id": "gear", "shaft": "S1", "station": 0.5, "force_y": 100.0})
    machine = MODEL.machine.model_copy(update={"static_loads": (load,)})
    name, size = "static_load.gear.force_y", 30.0
    plain = replace(expected_model(machine), covariance=np.diag((0.1 * COORDINATES.unit * COORDINATES.spread) ** 2))
    answer = 1e-3 * rng.standard_normal(COORDINATES.size) * COORDINATES.unit * COORDINATES.spread
    opened, stated = with_open_forces(machine, {name: size})
    along = size**2 * answer[:, None]
    covariance = np.block([[plain.covariance + along @ answer[None], along], [along.T, np.array([[size**2]])]])
    doubting = model_at(opened, (*plain.coordinates, name), np.concatenate([plain.values, stated]), covariance)
    assert name in doubting.coordinates
    found = alignment_changes([plain, doubting, plain], plain, variation=VARIATION)
    assert [change.name for change in found] == list(NAMES)
    assert all(change.value == pytest.approx(0.0, abs=1e-12) for change in found)
    assert len(alignment_changes([plain, plain], doubting, variation=VARIATION)) == len(NAMES)


def test_runs_that_all_doubt_a_force_by_sizes_of_their_own_are_compared_as_those_that_doubt_none() -> None:
    """Its coordinate would have another unit in each of them."""
    load = StaticLoad.model_validate({"id": "gear", "shaft": "S1", "station": 0.5, "force_y": 100.0})
    machine = MODEL.machine.model_copy(update={"static_loads": (load,)})
    plain = replace(expected_model(machine), covariance=np.diag((0.1 * COORDINATES.unit * COORDINATES.spread) ** 2))

    def doubting(size: float) -> UpdatedModel:
        opened, stated = with_open_forces(machine, {"static_load.gear.force_y": size})
        covariance = np.diag([*np.diag(plain.covariance), size**2])
        return model_at(opened, (*plain.coordinates, "static_load.gear.force_y"), np.append(plain.values, stated), covariance)

    expected = alignment_changes([plain] * 3, plain, variation=VARIATION)
    for sizes in ((3.0, 30.0, 90.0, 20.0), (30.0, 30.0, 30.0, 30.0)):
        *before, later = map(doubting, sizes)
        found = alignment_changes(before, later, variation=VARIATION)
        for one, other in zip(found, expected, strict=True):
            assert one.error == pytest.approx(other.error, rel=1e-6)


def test_trains_without_films_have_none() -> None:
    assert alignment_changes([rich_model()], rich_model()) == ()
