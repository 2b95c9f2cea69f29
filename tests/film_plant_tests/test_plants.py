"""Random plants: reproducible, stable, of the stated priors; oil, pedestals and discrepancies in them."""

from dataclasses import replace

import numpy as np
import pytest

from tests.film_plant.discrepancy import Discrepancy, DiscrepancySize
from tests.film_plant.oil import HeatedOil, walther
from tests.film_plant.plant import RPM, Plant, noisy
from tests.film_plant.plants import LARGEST_WAY, LEAST_WAY, motor_compressor_plant, random_plant
from tests.film_plant.proportions import OTHER_SLENDERNESS, Design
from tests.film_plant.statics import Statics
from tests.film_plant.train import Bearing, ConstantOil, Pedestal
from tests.film_plant.wrong_documents import elliptical, far_clearance, soft_pedestal, warming_oil


def test_a_seed_gives_the_same_plant_and_another_another() -> None:
    one, same, other = random_plant(3), random_plant(3), random_plant(4)
    assert (one.train.bearings, one.train.discs) == (same.train.bearings, same.train.discs)
    assert one.train.bearings != other.train.bearings


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_plants_are_stable_and_their_journals_float(seed: int) -> None:
    plant = random_plant(seed)
    speed = plant.speeds(7)
    films = plant.films(speed)
    assert plant.damping_ratios(speed).min() > 0.0
    assert films.way.max() < LARGEST_WAY
    assert films.way[0].min() > LEAST_WAY
    pressure = films.load[..., 1] / np.array([one.diameter * one.length for one in plant.train.bearings])
    assert 0.1e6 < pressure.min() < pressure.max() < 2.5e6
    assert 1e-6 < np.abs(plant.phasors(films)).max() < 0.5 * plant.train.clearances.max()
    assert 1500 * RPM < plant.fastest < 20000 * RPM


@pytest.mark.long
def test_truths_are_spread_as_the_priors_say() -> None:
    """Less what whirls or touches: plants of thin films are drawn anew."""
    truths = [motor_compressor_plant(seed) for seed in range(40)]
    off = np.log([one.train.clearances / one.believed.clearances for one in truths])
    thick = np.log([one.truth(one.speeds(2)).viscosity for one in truths])
    for drawn in (off, thick):
        assert drawn.std() == pytest.approx(0.15, rel=0.2)
        assert abs(drawn.mean()) < 0.05
    moved = np.array([one.train.elevations - one.believed.elevations for one in truths])
    assert moved.std() == pytest.approx(30e-6, rel=0.2)


def test_truth_says_what_made_the_data() -> None:
    plant = motor_compressor_plant(0, discrepancy=DiscrepancySize())
    truth = plant.truth(plant.speeds(5))
    assert np.allclose(truth.clearance, plant.train.clearances)
    assert np.array_equal(truth.unbalances, [one.unbalance for one in plant.train.discs])
    assert plant.phasors(truth.films).shape == (5, 8)
    model = Statics(plant.train).follow(truth.films.speed)
    assert np.array_equal(truth.films.load, model.load)
    assert np.abs(truth.films.stiffness / model.stiffness - 1.0).max() > 0.01


def test_a_discrepancy_has_its_size_its_mean_and_is_smooth() -> None:
    size, rng = DiscrepancySize(), np.random.default_rng(0)
    speed = np.linspace(100.0, 400.0, 61)
    drawn = [Discrepancy(size, 4, slowest=100.0, fastest=400.0, rng=rng).at(speed) for _ in range(60)]
    stiffness, damping = (np.array([pair[k] for pair in drawn]) for k in (0, 1))
    for found, mean in ((stiffness, size.stiffness_mean), (damping, size.damping_mean)):
        direct = found[..., [0, 1], [0, 1]]
        assert direct.mean() == pytest.approx(mean, abs=0.004)
        assert direct.std() == pytest.approx(size.spread, rel=0.1)
        cross = found[..., 0, 1]
        assert abs(cross.mean()) < 0.006
    assert np.array_equal(damping[..., 0, 1], damping[..., 1, 0])
    far = np.corrcoef(stiffness[:, 0, :, 0, 0].ravel(), stiffness[:, -1, :, 0, 0].ravel())[0, 1]
    near = np.corrcoef(stiffness[:, 0, :, 0, 0].ravel(), stiffness[:, 6, :, 0, 0].ravel())[0, 1]
    assert near > 0.9
    assert abs(far) < 0.3


def test_oil_of_a_grade_has_its_viscosity() -> None:
    assert walther(32, 40.0) == pytest.approx(32e-6 * 860)
    assert walther(46, 100.0) == pytest.approx(6.8e-6 * 860)
    assert walther(32, 40.0) > walther(32, 60.0) > walther(32, 80.0)


def test_oil_warms_with_speed_and_cools_by_its_flow() -> None:
    oil = HeatedOil(32, 45.0)
    bearing = Bearing(0, 0.1, 0.1, 0.06, 8e-5, oil)
    slow, fast = (oil.temperature(bearing, speed=w, eccentricity=0.6) for w in (100.0, 400.0))
    assert 45.0 < slow < fast < 100.0
    assert oil.temperature(bearing, speed=400.0, eccentricity=0.2) > fast
    # The balance itself: power lost, times the part carried off, is the heat of the flow.
    viscosity = oil.viscosity(bearing, speed=400.0, eccentricity=0.6)
    power = 2 * np.pi * viscosity * 400.0**2 * 0.05**3 * 0.06 / 8e-5 / np.sqrt(1 - 0.6**2)
    flow = (0.6 + oil.feed) * 400.0 * 0.05 * 8e-5 * 0.06
    assert oil.carried * power == pytest.approx(860 * 2000 * flow * (fast - 45.0), rel=1e-6)


def test_viscosity_falls_along_speed_in_a_heated_plant() -> None:
    plant = random_plant(5, design=Design(heated=True))
    films = plant.films(plant.speeds(6))
    assert np.all(np.diff(films.viscosity, axis=0) > 0.0)
    for row, speed, ways in zip(films.viscosity, films.speed, films.way, strict=True):
        due = [
            one.oil.viscosity(one, speed=speed, eccentricity=way) for one, way in zip(plant.train.bearings, ways, strict=True)
        ]
        assert row == pytest.approx(due, rel=1e-5)


def test_pedestals_give_way_and_are_seen_by_absolute_probes_only() -> None:
    plant = random_plant(6, design=Design(pedestals=True))
    films = plant.films(plant.speeds(30))
    relative, absolute = plant.phasors(films), replace(plant, absolute=True).phasors(films)
    assert np.abs(relative - absolute).max() > 0.05 * np.abs(absolute).max()
    hard = Pedestal((1.0, 1.0), (1e14, 1e14), (0.0, 0.0))
    stiff = _on(plant, hard)
    assert np.abs(stiff.phasors(films) - _on(plant, None).phasors(films)).max() < 1e-4 * np.abs(relative).max()
    soft = plant.films(plant.speeds(2)).load
    assert np.allclose(soft.sum(axis=1)[:, 1], stiff.films(plant.speeds(2)).load.sum(axis=1)[:, 1])


def _on(plant: Plant, pedestal: Pedestal | None) -> Plant:
    bearings = tuple(replace(one, pedestal=pedestal) for one in plant.train.bearings)
    return replace(plant, train=replace(plant.train, bearings=bearings))


def test_thicker_oil_lifts_the_journals() -> None:
    plant = motor_compressor_plant(1)
    thick = tuple(
        replace(one, oil=ConstantOil(2 * one.oil.viscosity(one, speed=1.0, eccentricity=0.5))) for one in plant.train.bearings
    )
    lifted = replace(plant, train=replace(plant.train, bearings=thick))
    speed = plant.speeds(3)
    assert np.all(lifted.films(speed).way < plant.films(speed).way)


@pytest.mark.parametrize("profile", ["grooved", "elliptical"])
def test_plants_on_other_bores(profile: str) -> None:
    plant = random_plant(1, design=Design(coupling="flexible", profile=profile, slenderness=OTHER_SLENDERNESS))
    assert plant.damping_ratios(plant.speeds(4)).min() > 0.0


def test_a_sweep_of_a_plant_deviates_from_the_steady_state() -> None:
    plant = motor_compressor_plant(0)
    short = replace(plant, slowest=0.9 * plant.fastest)
    found = short.swept(rate_rpm_per_s=80.0, samples=12)
    assert found.instant.shape == (12, 8)
    assert np.abs(found.steady - short.phasors(short.films(found.speed))).max() < 1e-3 * np.abs(found.steady).max()
    assert 1e-4 < np.abs(found.instant - found.steady).max() / np.abs(found.steady).max() < 0.5


def test_noise_has_its_size() -> None:
    clean = np.full((20000, 1), 3e-6 + 4e-6j)
    error = noisy(clean, np.random.default_rng(0)) - clean
    assert np.sqrt(np.mean(np.abs(error) ** 2)) == pytest.approx(np.hypot(0.01 * 5e-6, 1e-7), rel=0.03)
    assert abs(np.mean(error**2)) < 0.05 * np.mean(np.abs(error) ** 2)


@pytest.mark.long
def test_each_wrong_document_differs_in_its_one_thing() -> None:
    right = motor_compressor_plant(2)
    bore, soft, wide, warm = (
        motor_compressor_plant(2, alter=alter) for alter in (elliptical, soft_pedestal, far_clearance(0.15), warming_oil)
    )
    assert sorted(one.profile for one in bore.train.bearings) == ["elliptical"] + 3 * ["plain"]
    assert sum(one.pedestal is not None for one in soft.train.bearings) == 1
    assert np.abs(np.log(wide.train.clearances / wide.believed.clearances)).max() > 0.2
    middle = 0.6 * warm.fastest
    for one, believed in zip(warm.train.bearings, warm.believed.bearings, strict=True):
        slow, due, fast = (one.oil.viscosity(one, speed=w, eccentricity=0.6) for w in (0.2 * middle, middle, 1.6 * middle))
        assert slow > 1.2 * fast
        assert abs(np.log(due / believed.oil.viscosity(believed, speed=middle, eccentricity=0.6))) < 0.7
    for plant in (bore, soft, wide, warm):
        assert {(one.profile, one.pedestal) for one in plant.believed.bearings} == {("plain", None)}
        assert plant.damping_ratios(plant.speeds(5)).min() > 0.0
        assert [one.clearance for one in plant.believed.bearings] == [one.clearance for one in right.believed.bearings]
