"""Critical speeds followed through models, against the complete search and closed forms of a rigid rotor."""

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.machine.document import Machine
from estimator.modes.critical_speed import critical_speed_table
from estimator.modes.crossing_correction import corrected_crossing
from estimator.modes.eigenmodes import Modes
from estimator.units import rpm_to_rad_per_s
from estimator.updated_model.critical_speed_tracking import HIGHEST_ABOVE_TRIP, followed_crossings
from estimator.updated_model.modal_uncertainty import crossing_slopes, modes_at
from estimator.updated_model.model import UpdatedModel, expected_model
from tests.estimator.models import rich_model
from tests.estimator.rigid_rotor import MASS, STIFFNESS, rigid_rotor
from tests.estimator.trains import chapter_3


def drawn(machine: Machine, *, spread: float, seed: int) -> UpdatedModel:
    """The machine with every coefficient off: direct terms and scale factors by that part, the others in proportion."""
    model = expected_model(machine)
    coordinates = model.coordinates_at(np.ones(1))
    theta = coordinates.theta(model.values) + spread * np.random.default_rng(seed).standard_normal(coordinates.size)
    return replace(model, values=coordinates.point(theta))


def searched(model: UpdatedModel, count: int) -> list[float]:
    """The lowest critical speeds by a complete search."""
    highest = 1.5 * HIGHEST_ABOVE_TRIP * rpm_to_rad_per_s(model.machine.speed_range.maximum_rpm)
    table = critical_speed_table(model.scaled_machine, highest=highest, coefficients=model.coefficients)
    return [one.speed for one in table][:count]


@pytest.mark.parametrize("spread", [0.0, 0.05, 0.1])
def test_followed_ones_are_those_that_a_complete_search_finds(spread: float) -> None:
    model = drawn(chapter_3(), spread=spread, seed=round(100 * spread))
    found = followed_crossings(model)
    assert list(found.number) == list(range(found.count))
    assert found.modes.eigenvalue.imag == pytest.approx(searched(model, found.count), rel=1e-6)


def test_followed_where_coefficients_follow_the_speed() -> None:
    model = rich_model()
    found = followed_crossings(model)
    assert found.number.size == found.count > 5
    assert found.modes.eigenvalue.imag == pytest.approx(searched(model, found.count), rel=1e-6)


def test_modes_that_cross_are_those_of_the_whole_eigenvalue_problem() -> None:
    model = drawn(chapter_3(), spread=0.1, seed=5)
    found = followed_crossings(model).modes
    for i, root in enumerate(found.eigenvalue):
        whole = modes_at(model, speed=float(root.imag))
        nearest = int(np.argmin(np.abs(whole.eigenvalue - root)))
        assert root == pytest.approx(whole.eigenvalue[nearest], rel=1e-7)
        for one, other in ((found.shape, whole.shape), (found.left, whole.left)):
            cosine = abs(np.vdot(one[:, i], other[:, nearest]))
            assert cosine == pytest.approx(np.linalg.norm(one[:, i]) * np.linalg.norm(other[:, nearest]), rel=1e-6)


def test_slopes_along_the_synchronous_line_are_those_of_small_changes() -> None:
    model = rich_model()
    found = crossing_slopes(model, followed_crossings(model).modes)
    for name in ("bearing.B1.kxx@1500rpm", "bearing.B3.cxy@500rpm", "seal.G.mxx", "material.steel.young_modulus"):
        place = model.coordinates.index(name)
        step = np.zeros(model.values.size)
        step[place] = 1e-2 * np.sqrt(model.covariance[place, place])
        ahead, behind = (followed_crossings(replace(model, values=model.values + sign * step)) for sign in (1, -1))
        expected = (ahead.modes.eigenvalue - behind.modes.eigenvalue) / (2 * step[place])
        assert found[:, place] == pytest.approx(expected, abs=1e-3 * np.abs(expected).max()), name


def stiffer(machine: Machine, name: str, factor: float) -> UpdatedModel:
    """The machine with one kind of coefficient of both bearings changed."""
    model = expected_model(machine)
    values = model.values + np.where([one.endswith(name) for one in model.coordinates], np.log(factor), 0.0)
    return replace(model, values=values)


def test_two_that_pass_each_other_stay_in_order_and_are_a_pair() -> None:
    """x and y bounce of a rigid rotor, y a little stiffer in the document, x a lot stiffer afterwards."""
    machine = rigid_rotor(diametral=2e-3, polar=1e-4)
    first = machine.bearings[0].model_copy(update={"kyy": 1.1 * STIFFNESS})
    machine = machine.model_copy(update={"bearings": (first, machine.bearings[1].model_copy(update={"kyy": 1.1 * STIFFNESS}))})
    found = followed_crossings(stiffer(machine, "kxx", 1.44))
    expected = np.sqrt(2 * STIFFNESS * np.array([1.1, 1.44]) / MASS)
    assert found.modes.eigenvalue.imag == pytest.approx(expected, rel=1e-4)
    assert (list(found.number), found.pairs) == ([0, 1], ((0, 1),))


@pytest.mark.parametrize("factor", [1.0, 1.001, 1.44])
def test_equal_planes_are_told_apart_as_soon_as_they_differ(factor: float) -> None:
    found = followed_crossings(stiffer(rigid_rotor(diametral=2e-3, polar=1e-4), "kyy", factor))
    expected = np.sqrt(2 * STIFFNESS * np.array([1.0, factor]) / MASS)
    assert found.modes.eigenvalue.imag == pytest.approx(expected, rel=1e-4)
    assert (list(found.number), found.pairs) == ([0, 1], ((0, 1),))


def test_what_is_damped_beyond_oscillation_is_lost_and_says_so() -> None:
    machine = rigid_rotor(diametral=2e-3, polar=1e-4, damping=10.0)
    assert list(followed_crossings(stiffer(machine, "cxx", 10.0)).number) == [0, 1]
    found = followed_crossings(stiffer(machine, "cxx", 200.0))  # 2c / (2 sqrt(2k m)) = 2
    assert (found.count, found.number.size) == (2, 1)
    assert found.modes.eigenvalue.imag == pytest.approx([np.sqrt(2 * STIFFNESS / MASS)], rel=1e-4)


def test_a_guess_without_a_crossing_is_not_corrected() -> None:
    machine = rigid_rotor(diametral=2e-3, polar=1e-4, damping=3000.0)
    model = expected_model(machine)
    rng = np.random.default_rng(3)
    size = model.matrices(1.0).mass.shape[0]
    right, left = rng.standard_normal((2, size, 1)).astype(complex)
    guess = Modes(np.array([1j]), right, left)
    found = corrected_crossing(model.matrices, guess, direction=1)
    assert found is None or found.eigenvalue[0].imag > 1000.0
