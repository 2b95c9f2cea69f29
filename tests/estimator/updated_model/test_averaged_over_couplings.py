"""Averages over couplings that are open: first order where they are well known, and drawn samples where they are not."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace

from benchmarks.fluid_film.film_fits import as_drawn
from benchmarks.fluid_film.film_trials import OPTIONS
from estimator.arrays import Floats
from estimator.fit.identify import identify
from estimator.machine.document import parse_machine
from estimator.machine.film_speeds import reported_rpm
from estimator.statics.journal_states import journal_states
from estimator.updated_model.averaged_over_couplings import OPEN, Averaged, over_couplings
from estimator.updated_model.bearing_loads import WEIGHT_ERROR
from estimator.updated_model.expected_at_stiffness import FittedNumbers, Prediction
from estimator.updated_model.film_results import film_results
from estimator.updated_model.films_over_couplings import films_over_couplings
from estimator.updated_model.model import UpdatedModel, expected_model, updated_model
from estimator.updated_model.placed_films import placed_films
from estimator.updated_model.uncertainty import standard_errors
from tests.estimator.updated_model.test_alignment_results import before, machine_of
from tests.film_plant.discrepancy import DiscrepancySize
from tests.film_plant.documents import measured
from tests.film_plant.plants import motor_compressor_plant, other_mixed_plant
from tests.film_plant.scores import film_result_truths

NAMES = ("coupling.C1.kxx", "coupling.C1.kyy", "bearing.B1.elevation_y")
STIFFNESS = 1.2e6


def pushed(fitted: Floats) -> Prediction:
    """The force of a spring of the first stiffness, whose end is raised by so many tenths of a mm, and 1 kN besides."""
    force = STIFFNESS * np.exp(fitted[0]) * 1e-4 * fitted[2]
    return Prediction(np.array([1000.0 + force]), np.array([[force, 0.0, STIFFNESS * np.exp(fitted[0]) * 1e-4]]))


def averaged(covariance: Floats, *, at: Floats, predict: Callable[[Floats], Prediction | None] = pushed) -> Averaged:
    """The average of a prediction where the covariance is the prior's alone."""
    return averaged_of(
        FittedNumbers(NAMES, at, covariance, np.asarray(np.linalg.pinv(covariance), dtype=float), np.zeros(3)), predict
    )


def averaged_of(fitted: FittedNumbers, predict: Callable[[Floats], Prediction | None]) -> Averaged:
    """The average of a prediction, which is also what the data see."""
    central = predict(fitted.values)
    assert central is not None
    found = over_couplings(fitted, central, reach=predict, seen=lambda one: one)
    return found.averaged(lambda _, state: state)


def covariance_of(spreads: Floats, correlation: Floats) -> Floats:
    """A covariance with given standard deviations."""
    root = np.eye(len(spreads)) + 0.3 * correlation
    whole = root @ root.T
    size = np.sqrt(np.diag(whole))
    return np.asarray(whole / np.outer(size, size) * np.outer(spreads, spreads))


@given(st.integers(0, 2**31), st.floats(0.01, OPEN / 2))
def test_where_stiffness_is_well_known_it_is_first_order(seed: int, spread: float) -> None:
    rng = np.random.default_rng(seed)
    covariance = covariance_of(np.array([spread, spread, 1.0]), rng.standard_normal((3, 3)))
    at = rng.standard_normal(3)
    found, central = averaged(covariance, at=at), pushed(at)
    assert found.value == pytest.approx(central.value, rel=1e-12)
    assert found.error == pytest.approx(standard_errors(central.slope, covariance), rel=1e-12)


@given(st.integers(0, 2**31), st.floats(OPEN, 1.5))
def test_a_prediction_that_is_linear_is_first_order_however_open_stiffness_is(seed: int, spread: float) -> None:
    rng = np.random.default_rng(seed)
    covariance = covariance_of(np.array([spread, 0.8 * spread, 1.0]), rng.standard_normal((3, 3)))
    slope, at = rng.standard_normal((4, 3)), rng.standard_normal(3)

    def linear(fitted: Floats) -> Prediction:
        return Prediction(slope @ fitted, slope)

    found = averaged(covariance, at=at, predict=linear)
    np.testing.assert_allclose(found.value, slope @ at, atol=1e-9)
    np.testing.assert_allclose(found.error, standard_errors(slope, covariance), rtol=1e-6)


@pytest.mark.parametrize("spread", [0.3, 0.5, 0.7])
@pytest.mark.parametrize("raised", [0.0, 1.0])
def test_where_it_is_open_mean_and_spread_are_those_of_drawn_samples(spread: float, raised: float) -> None:
    covariance = covariance_of(np.array([spread, 0.05, 1.0]), np.zeros((3, 3)))
    covariance[0, 2] = covariance[2, 0] = -0.4 * spread
    at = np.array([0.0, 0.0, raised])
    drawn = np.random.default_rng(1).multivariate_normal(at, covariance, 400_000)
    force = 1000.0 + STIFFNESS * np.exp(drawn[:, 0]) * 1e-4 * drawn[:, 2]
    found, first_order = averaged(covariance, at=at), standard_errors(pushed(at).slope, covariance)
    assert found.value[0] == pytest.approx(force.mean(), abs=0.05 * force.std())
    assert found.error[0] == pytest.approx(force.std(), rel=0.12)
    assert abs(found.error[0] - force.std()) < abs(first_order[0] - force.std())


def test_stiffnesses_that_are_open_together_are_counted_once() -> None:
    """Of two that are perfectly correlated the sum of two averages would widen twice."""
    at, spread = np.array([0.0, 0.0, 0.0]), 0.5

    def twice(fitted: Floats) -> Prediction:
        one, other = (1e-4 * STIFFNESS * np.exp(fitted[place]) for place in (0, 1))
        force = 0.5 * (one + other) * fitted[2]
        return Prediction(np.array([force]), np.array([[one * fitted[2] / 2, other * fitted[2] / 2, (one + other) / 2]]))

    together = np.array([[spread**2, spread**2, 0.0], [spread**2, spread**2, 0.0], [0.0, 0.0, 1.0]])
    alone = np.diag([spread**2, 1e-8, 1.0])
    found = averaged(together, at=at, predict=twice)
    assert found.error == pytest.approx(averaged(alone, at=at).error, rel=1e-4)


def test_without_equilibrium_at_the_far_points_nearer_ones_count_and_without_any_first_order() -> None:
    covariance, at = np.diag([0.25, 1e-6, 1.0]), np.array([0.0, 0.0, 0.5])

    def within(limit: float) -> Callable[[Floats], Prediction | None]:
        return lambda fitted: pushed(fitted) if abs(fitted[0]) <= limit else None

    first_order = standard_errors(pushed(at).slope, covariance)
    near = averaged(covariance, at=at, predict=within(0.6))
    assert first_order[0] < near.error[0] < averaged(covariance, at=at).error[0]
    none = averaged(covariance, at=at, predict=within(0.1))
    assert none.error == pytest.approx(first_order)
    assert none.value == pytest.approx(pushed(at).value)


MEASURED = 300.0
"""Force that the films tell [N], beside the 1 kN."""


def fit_of_force(error: float, spread: float) -> tuple[FittedNumbers, float, float]:
    """A fit to a measured force of a spring of unknown stiffness, whose end is raised by about its prior's deviation.

    Returns what the fit leaves known, and mean and deviation of the force by summing the posterior over a grid.
    """
    prior = np.diag([spread**-2, 1e6, 1.0])
    at = np.array([0.0, 0.0, MEASURED / (STIFFNESS * 1e-4)])
    for _ in range(50):
        central = pushed(at)
        row = central.slope / error
        curvature = row.T @ row + prior
        misfit = (central.value - 1000.0 - MEASURED) / error
        at = at - np.linalg.solve(curvature, row.T @ misfit + prior @ at)
    stiffness, raised = np.meshgrid(np.linspace(-5 * spread, 5 * spread, 1201), np.linspace(-6.0, 6.0, 4801), indexing="ij")
    force = STIFFNESS * 1e-4 * np.exp(stiffness) * raised
    weight = np.exp(-0.5 * (((force - MEASURED) / error) ** 2 + (stiffness / spread) ** 2 + raised**2))
    mean = float(np.sum(weight * force) / np.sum(weight))
    deviation = float(np.sqrt(np.sum(weight * (force - mean) ** 2) / np.sum(weight)))
    return (
        FittedNumbers(NAMES, at, np.asarray(np.linalg.inv(curvature), dtype=float), prior, prior @ at),
        1000.0 + mean,
        deviation,
    )


@pytest.mark.parametrize("spread", [0.3, 0.5, 0.7])
@pytest.mark.parametrize("error", [3.0, 30.0, 100.0, 300.0])
def test_a_force_that_the_films_tell_is_as_sure_however_open_the_coupling_is(spread: float, error: float) -> None:
    """Carried along in a straight line, elevations would spread a well measured force by the doubt about the stiffness."""
    fitted, mean, deviation = fit_of_force(error, spread)
    found = averaged_of(fitted, pushed)
    assert found.error[0] == pytest.approx(deviation, rel=0.12)
    assert found.value[0] == pytest.approx(mean, abs=0.25 * deviation)


def with_open_coupling(spread: float) -> UpdatedModel:
    """A motor-compressor whose coupling is open, and the height of one bearing as its document says, 150 µm."""
    model = before(expected_model(machine_of()))
    sizes = np.sqrt(np.diag(model.covariance))
    for place, name in enumerate(model.coordinates):
        if name.startswith("coupling."):
            sizes[place] = spread if ".k" in name else 0.0
        elif ".elevation_" in name:
            sizes[place] = 150e-6 if name.startswith("bearing.B3.elevation_y") else 0.0
        else:
            sizes[place] = 0.0
    return replace(model, covariance=np.diag(sizes**2))


def test_loads_of_a_train_whose_coupling_is_open_are_those_of_drawn_trains() -> None:
    model = with_open_coupling(0.6)
    speed = np.array([reported_rpm(model.machine)[-1] * np.pi / 30])
    coordinates = model.coordinates_at(speed)
    placed_at = placed_films(coordinates)
    assert placed_at is not None
    placed, films = placed_at
    rng, size = np.random.default_rng(3), np.sqrt(np.diag(model.covariance))
    drawn = []
    for _ in range(300):
        found = journal_states(
            films, placed.own(coordinates.theta(model.values + size * rng.standard_normal(size.size))), speed=speed
        )
        assert found is not None
        drawn.append(found.force[-1, :, 1])
    told = {one.name: one for one in film_results(model)}
    loads = [told[f"bearing.B{number}.load_vertical"] for number in range(1, 5)]
    error = np.std(drawn, axis=0)
    assert [one.error for one in loads] == pytest.approx(error, rel=0.15)
    assert np.abs(np.array([one.value for one in loads]) - np.mean(drawn, axis=0)).max() < 0.15 * error.max()
    assert sum(one.value for one in loads) == pytest.approx(np.sum(np.mean(drawn, axis=0)), rel=1e-6)


@pytest.mark.parametrize("seed", [26, pytest.param(34, marks=pytest.mark.long)])
def test_loads_of_trains_whose_couplings_the_data_leave_open_hold(seed: int) -> None:
    """To first order loads of these were off by 5 and 6.5 standard errors."""
    plant = other_mixed_plant(seed, discrepancy=DiscrepancySize())
    machine = parse_machine(as_drawn(plant, seed))
    found = identify(machine, measured(plant, seed=seed), OPTIONS)
    assert found.accepted
    truth = film_result_truths(plant, reported_rpm(machine))
    loads = [one for one in film_results(updated_model(machine, found)) if ".load_" in one.name]
    assert len(loads) == 2 * len(plant.train.bearings)
    assert max(abs(one.value - truth[one.name].real) / one.error for one in loads) < 3.0


def test_loads_that_the_films_tell_are_as_sure_with_an_open_coupling() -> None:
    """Of this train on films alone a load was told 2.1 times too wide: elevations were carried along in a straight line."""
    plant = motor_compressor_plant(3, "rigid", discrepancy=DiscrepancySize())
    machine = parse_machine(as_drawn(plant, 3))
    found = identify(machine, measured(plant, seed=3), OPTIONS)
    assert found.accepted
    model = updated_model(machine, found)
    films = films_over_couplings(model)
    assert films is not None
    assert films.states.lines
    central = films.states.central
    first_order = standard_errors(central.force_slope[-1], films.covariance)
    of_masses = WEIGHT_ERROR * np.hypot(*central.force[-1].T)[:, None]
    error = [one.error for one in film_results(model) if one.name.endswith("load_vertical")]
    assert error == pytest.approx(np.hypot(first_order, of_masses)[:, 1], rel=0.05)


def test_states_over_open_couplings_are_sought_once_for_a_model() -> None:
    model = with_open_coupling(0.6)
    assert films_over_couplings(model) is films_over_couplings(model)
    assert films_over_couplings(with_open_coupling(0.6)) is not films_over_couplings(model)
