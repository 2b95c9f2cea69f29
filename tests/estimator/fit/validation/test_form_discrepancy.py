"""Forms of coefficients over speed, judged on films that follow none of them and on trains that follow them exactly."""

from typing import Literal

import numpy as np
import pytest

from estimator.bearings.deviation_shapes import DeviationShapes
from estimator.fit.identification import Options
from estimator.fit.identify import identify
from estimator.machine.document import Machine
from tests.film_plant.documents import Form, linear_machine, measured
from tests.film_plant.plant import RPM, Plant
from tests.film_plant.plants import random_plant
from tests.film_plant.scores import own_form_data, score, true_values

FORMS: list[tuple[Form, int]] = [("polynomial", 2), ("polynomial", 3), ("piecewise", 4)]
FEW = Options(starts=2)


@pytest.fixture(scope="module")
def plant() -> Plant:
    return random_plant(2)


def machine_of(plant: Plant, form: Form, knots: int, terms: Literal["direct", "all"] = "direct") -> Machine:
    at = np.linspace(plant.slowest / RPM, plant.fastest / RPM, knots).round()
    return linear_machine(plant, form=form, knots_rpm=at.tolist(), terms=terms, seed=1)


@pytest.mark.parametrize(("form", "knots"), FORMS)
def test_films_that_follow_no_form_are_refused(plant: Plant, form: Form, knots: int) -> None:
    """χ² alone accepts most of these, with intervals of which a fifth holds the truth."""
    found = identify(machine_of(plant, form, knots), measured(plant, seed=1), FEW)
    assert not found.accepted
    if found.chi_square < 1.1 * found.degrees_of_freedom:
        assert found.verdict.startswith("coefficients do not follow the speed as the document's forms say: they deviate by ")
        assert "accepted" not in found.verdict


@pytest.mark.parametrize(("form", "knots"), FORMS)
def test_a_train_that_follows_its_forms_is_accepted_with_intervals_that_hold(plant: Plant, form: Form, knots: int) -> None:
    machine = machine_of(plant, form, knots)
    data = own_form_data(plant, machine, seed=1)
    assert data is not None
    found = identify(machine, data[0], FEW)
    assert found.accepted, found.verdict
    assert score(found, data[1]).coverage >= 0.9


def test_where_the_form_alone_tells_coefficients_apart_intervals_widen_until_they_hold(plant: Plant) -> None:
    machine = machine_of(plant, "polynomial", 2, "all")
    found = identify(machine, measured(plant, seed=1), FEW)
    judged = score(found, true_values(plant, machine))
    assert not found.accepted or judged.coverage >= 0.85
    reasons = [one.reason for one in found.estimates if one.reason is not None]
    assert any(reason.endswith("and no data show whether that is true") for reason in reasons)


def test_shapes_have_the_variance_and_correlation_of_the_process() -> None:
    speeds = np.linspace(50.0, 500.0, 31)
    shapes = DeviationShapes(50.0, 500.0).at(speeds)
    covariance = shapes @ shapes.T
    assert np.diag(covariance) == pytest.approx(1.0, abs=0.1)
    place = (speeds - 50.0) / 450.0
    expected = np.exp(-0.5 * ((place[:, None] - place) / 0.4) ** 2)
    assert np.abs(covariance - expected).max() < 0.1
