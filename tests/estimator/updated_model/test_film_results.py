"""Results about films: values against equilibria solved by themselves, errors against differences, names, what is withheld."""

from itertools import pairwise

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.arrays import Floats
from estimator.machine.document import Machine, parse_machine
from estimator.machine.film_speeds import reported_rpm
from estimator.statics.equilibrium import FilmEquilibrium, FilmTrain
from estimator.statics.film_model import film_model
from estimator.units import rpm_to_rad_per_s
from estimator.updated_model.bearing_loads import WEIGHT_ERROR
from estimator.updated_model.derived_quantities import model_quantities
from estimator.updated_model.film_results import FilmResult, film_results
from estimator.updated_model.model import UpdatedModel, expected_model
from estimator.updated_model.placed_films import placed_films
from tests.estimator.models import rich_model
from tests.estimator.statics.test_film_model import document
from tests.estimator.updated_model.propagation import propagated


def machine_of(**form: float) -> Machine:
    said = document(**form)
    said["operation"] = {"running_rpm": 3000}
    return parse_machine(said)


def uncertain(machine: Machine, *, size: float = 0.1) -> UpdatedModel:
    """The document's model a little way off; its films' numbers are uncertain by a part of what is believed."""
    rng = np.random.default_rng(4)
    model = expected_model(machine)
    coordinates = model.coordinates_at(np.array([100.0]))
    films = np.arange(coordinates.size) < len(coordinates.parameters)
    spread = np.where(films, coordinates.spread * coordinates.unit, 0.0)
    root = size * spread[:, None] * (np.eye(spread.size) + 0.1 * rng.standard_normal((spread.size, spread.size)))
    return replace(model, values=model.values + 0.2 * spread * rng.standard_normal(spread.size), covariance=root @ root.T)


def by_name(model: UpdatedModel) -> dict[str, FilmResult]:
    return {one.name: one for one in film_results(model)}


def solved_train(model: UpdatedModel) -> FilmTrain:
    """The train on its films at the model's numbers."""
    coordinates = model.coordinates_at(np.array([1.0]))
    with_films = placed_films(coordinates)
    assert with_films is not None
    placed, films = with_films
    return films.own.changed(placed.own(coordinates.theta(model.values)))


def solved(model: UpdatedModel, rpm: float) -> FilmEquilibrium:
    """The equilibrium at the model's films."""
    found = solved_train(model).equilibrium(rpm_to_rad_per_s(rpm))
    assert found is not None
    return found


def test_speeds_are_the_lowest_a_middle_and_the_running_one() -> None:
    assert reported_rpm(machine_of()) == (700.0, 1850.0, 3000.0)
    said = document()
    said["bearings"][1]["film"]["valid_above_rpm"] = 1000
    assert reported_rpm(parse_machine(said)) == (1000.0, 2800.0, 4600.0)
    said["operation"] = {"running_rpm": 1000}
    assert reported_rpm(parse_machine(said)) == (1000.0,)


def test_coefficients_loads_and_positions_are_those_of_the_equilibrium() -> None:
    model = uncertain(machine_of(discrepancy=0.0), size=0.05)
    found = by_name(model)
    for rpm in reported_rpm(model.machine):
        exact = solved(model, rpm)
        for number, name in enumerate(("B1", "B2", "B3", "B4")):
            for matrix, letter in ((exact.stiffness[number], "k"), (exact.damping[number], "c")):
                told = np.array([[found[f"bearing.{name}.{letter}{i}{j}@{rpm:g}rpm"].value for j in "xy"] for i in "xy"])
                np.testing.assert_allclose(told, matrix, atol=5e-4 * np.abs(matrix).max())
    for number, bearing in enumerate(model.machine.bearings):
        assert bearing.film is not None
        element, place, load = f"bearing.{bearing.id}", exact.position[number], exact.force[number]
        size = float(np.hypot(*load))
        assert found[f"{element}.load_vertical"].value == pytest.approx(load[1], abs=1e-4 * size)
        assert found[f"{element}.load_horizontal"].value == pytest.approx(load[0], abs=1e-4 * size)
        told = np.array([found[f"{element}.journal_{axis}"].value for axis in "xy"])
        np.testing.assert_allclose(told, place, atol=1e-4 * bearing.film.radial_clearance)
        clearance = solved_clearance(model, number)
        assert found[f"{element}.eccentricity_ratio"].value == pytest.approx(np.hypot(*told) / clearance)


def solved_clearance(model: UpdatedModel, number: int) -> float:
    return solved_train(model).bearings[number].clearance


def test_loads_carry_the_weight_of_the_train() -> None:
    found = by_name(uncertain(machine_of()))
    loads = [found[f"bearing.B{number}.load_vertical"] for number in range(1, 5)]
    weight = film_model(machine_of()).nominal.train.statics.weight.reshape(-1, 2)[:, 1].sum()
    assert sum(one.value for one in loads) == pytest.approx(-weight, rel=1e-6)
    assert all(one.error > 0.0 for one in loads)


def test_errors_are_those_of_differences() -> None:
    model = uncertain(machine_of(discrepancy=0.05), size=0.05)

    def values(one: UpdatedModel) -> Floats:
        return np.array([result.value for result in film_results(one)])

    expected = np.sqrt(np.diag(propagated(values, model)))
    found = film_results(model)
    load = {
        one.name.rpartition(".")[0]: np.hypot(one.value, following.value)
        for one, following in pairwise(found)
        if one.name.endswith(".load_vertical")
    }
    beside = [WEIGHT_ERROR * load[one.name.rpartition(".")[0]] if ".load_" in one.name else 0.0 for one in found]
    np.testing.assert_allclose([one.error for one in found], np.hypot(expected, beside), rtol=1e-3)


def test_a_load_is_known_no_better_than_the_masses_that_it_carries() -> None:
    model = uncertain(machine_of(), size=1e-9)
    found = by_name(model)
    vertical, horizontal = found["bearing.B2.load_vertical"], found["bearing.B2.load_horizontal"]
    assert vertical.error == pytest.approx(0.002 * np.hypot(vertical.value, horizontal.value), rel=1e-3)
    assert horizontal.error == pytest.approx(vertical.error, rel=1e-3)


def test_deviations_widen_coefficients_and_not_loads() -> None:
    model = uncertain(machine_of(discrepancy=0.05))
    own = np.array(["deviation" not in name for name in model.coordinates])
    narrow, wide = by_name(replace(model, covariance=model.covariance * np.outer(own, own))), by_name(model)
    assert narrow["bearing.B1.kxx@1850rpm"].error < wide["bearing.B1.kxx@1850rpm"].error
    assert narrow["bearing.B1.load_vertical"].error == pytest.approx(wide["bearing.B1.load_vertical"].error)


def test_a_coefficient_that_is_open_is_not_told_and_a_direct_one_has_a_lopsided_interval() -> None:
    told = {one.name: one for one in model_quantities(uncertain(machine_of()), speed=300.0)}
    kxx = told["bearing.B1.kxx@3000rpm"]
    assert kxx.value is not None
    assert kxx.lower is not None
    assert kxx.upper is not None
    assert kxx.value**2 == pytest.approx(kxx.lower * kxx.upper)
    assert kxx.unit == "N/m"
    open_ones = {one.name: one for one in model_quantities(uncertain(machine_of(), size=20.0), speed=300.0)}
    assert open_ones["bearing.B1.kxx@3000rpm"].value is None
    assert "% of the direct terms" in (open_ones["bearing.B1.kxx@3000rpm"].reason or "")


def test_trains_without_films_have_none() -> None:
    assert film_results(rich_model()) == ()
