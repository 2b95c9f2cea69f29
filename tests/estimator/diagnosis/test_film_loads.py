"""Loads on oil films as findings of their own: hardly any, or more than white metal takes."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import pytest

from estimator.alignment.film_loads import FilmLoad, FilmLoads, film_loads
from estimator.diagnosis.data_faults import heavy_loads, light_loads
from estimator.diagnosis.observation import Observation
from estimator.machine.film_speeds import reported_rpm
from estimator.updated_model.derived_quantities import model_quantities
from estimator.updated_model.model import expected_model
from tests.estimator.diagnosis.test_film_reference import after
from tests.estimator.models import rich_model
from tests.estimator.updated_model.test_alignment_results import before, machine_of

AREA = 0.005
"""Of each bearing [m²]."""


def loaded(vertical: Sequence[float], error: float = 10.0) -> Observation:
    """An observation with loads on the bearings [N]."""
    found = loads_of(vertical, error)
    return replace(after({}, runs=1)[0], loads=FilmLoads(found, found))


def loads_of(vertical: Sequence[float], error: float = 10.0) -> Callable[[], Sequence[FilmLoad]]:
    """A function that returns loads on the bearings [N]."""
    return lambda: [FilmLoad(f"B{number}", load, error, AREA) for number, load in enumerate(vertical, start=1)]


USUAL = loaded([1000.0, 800.0])


def test_a_bearing_that_carries_hardly_anything_is_named() -> None:
    (fault,) = light_loads([USUAL], [loaded([1000.0, 20.0]), loaded([990.0, -300.0])])
    assert fault.element == "bearing.B2"
    assert fault.agreement[0] == pytest.approx(0.5 * 6.0**2)


def test_one_that_may_carry_more_is_not() -> None:
    assert list(light_loads([USUAL], [loaded([1000.0, 70.0]), loaded([1000.0, 70.0])])) == []
    assert list(light_loads([USUAL], [loaded([1000.0, 20.0]), loaded([1000.0, 200.0])])) == []


def test_errors_are_not_computed_of_loads_that_are_far_from_any_limit() -> None:
    def known() -> Sequence[FilmLoad]:
        raise AssertionError("loads were averaged over couplings")

    cheap = replace(USUAL, loads=FilmLoads(loads_of([1000.0, 400.0]), known))
    assert list(light_loads([cheap], [cheap])) == []
    assert list(heavy_loads([cheap], [cheap])) == []


def test_a_bearing_beyond_five_megapascals_is_named() -> None:
    (fault,) = heavy_loads([USUAL], [loaded([26_000.0, 800.0]), loaded([25_500.0, 800.0])])
    assert fault.element == "bearing.B1"
    assert list(heavy_loads([USUAL], [loaded([25_010.0, 800.0])])) == []


def test_trains_without_films_have_no_loads() -> None:
    one = replace(USUAL, loads=None)
    assert list(light_loads([one], [one])) == []
    assert list(heavy_loads([one], [one])) == []
    assert film_loads(rich_model()) == ()


def test_loads_are_those_that_are_trended() -> None:
    model = before(expected_model(machine_of()))
    derived = {one.name: one for one in model_quantities(model, speed=reported_rpm(model.machine)[-1] * np.pi / 30)}
    for one in film_loads(model):
        trended = derived[f"bearing.{one.bearing}.load_vertical"]
        assert trended.lower is not None
        assert trended.value == pytest.approx(one.vertical, rel=1e-9)
        assert one.vertical - trended.lower == pytest.approx(1.959964 * one.error, rel=1e-5)
