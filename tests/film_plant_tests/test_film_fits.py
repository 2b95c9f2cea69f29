"""Identification by films on plants of other make: it is accepted, its intervals hold, a wrong bore is refused."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from estimator.fit.identification import Identification, Options
from estimator.fit.identify import identify
from estimator.identification.pooling import combine
from estimator.identification.sweep_correction import predicted_transient
from estimator.machine.document import parse_machine
from estimator.machine.film_speeds import reported_rpm
from estimator.rotor.parameter_names import derived_unit, parameter_units
from estimator.updated_model.derived_quantities import derived_quantities
from estimator.updated_model.model import updated_model
from tests.film_plant.discrepancy import DiscrepancySize
from tests.film_plant.documents import film_document, measured
from tests.film_plant.plant import Plant
from tests.film_plant.plants import random_plant
from tests.film_plant.proportions import OTHER_SLENDERNESS, Design
from tests.film_plant.scores import film_result_truths, film_truths, score, score_derived
from tests.film_plant.train import Train
from tests.film_plant.wrong_documents import warming_oil

OPTIONS = Options(starts=2)


@cache
def fitted(seed: int) -> tuple[Plant, Identification]:
    """A plant and what its right document finds of it."""
    plant = random_plant(seed, discrepancy=DiscrepancySize())
    return plant, identify(parse_machine(film_document(plant)), measured(plant, seed=seed), OPTIONS)


def test_right_documents_are_accepted_and_most_intervals_hold() -> None:
    inside: list[bool] = []
    of_films: list[bool] = []
    for seed in range(3):
        plant, found = fitted(seed)
        machine = parse_machine(film_document(plant))
        assert found.accepted, found.verdict
        told = score(found, film_truths(plant))
        assert len(told.inside) >= 16
        inside += told.inside
        derived = score_derived(derived_quantities(machine, found), film_result_truths(plant, reported_rpm(machine)))
        assert len(derived.inside) >= 4 * 26
        of_films += derived.inside
    assert np.mean(inside) > 0.85
    assert np.mean(of_films) > 0.88


def test_what_is_reported_has_names_elements_and_units() -> None:
    plant, found = fitted(2)
    clearance = found.estimate("bearing.B2.clearance")
    assert (clearance.element, clearance.unit, clearance.quantity) == ("bearing.B2", "m", "clearance")
    assert clearance.value == pytest.approx(plant.train.clearances[1], rel=0.3)
    assert found.estimate("bearing.B4.viscosity").unit == "Pa s"
    assert not any("deviation" in one.name for one in found.estimates)


def test_by_the_document_alone_names_and_units_are_those_that_are_reported() -> None:
    plant, found = fitted(0)
    machine = parse_machine(film_document(plant))
    assert parameter_units(machine) == {one.name: one.unit for one in found.estimates}
    derived = {one.name: one for one in derived_quantities(machine, found)}
    assert {name: derived_unit(machine, name) for name in derived} == {name: one.unit for name, one in derived.items()}
    low, middle, running = reported_rpm(machine)
    assert derived[f"bearing.B1.kxx@{middle:g}rpm"].unit == "N/m"
    assert derived[f"bearing.B4.cyx@{low:g}rpm"].unit == "N s/m"
    assert derived["bearing.B2.load_vertical"].unit == "N"
    assert running == pytest.approx(machine.speed_range.maximum_rpm, abs=0.5)


@pytest.mark.long
def test_films_that_are_said_to_be_exact_and_are_not_are_refused() -> None:
    plant = random_plant(1, discrepancy=DiscrepancySize(spread=0.08))
    found = identify(parse_machine(film_document(plant, discrepancy=0.002)), measured(plant, seed=1), Options(starts=1))
    assert not found.accepted


def test_an_elliptical_bore_said_to_be_plain_is_refused_and_its_bearing_named() -> None:
    def bored(train: Train, _: np.random.Generator, __: float) -> Train:
        chosen = replace(train.bearings[1], profile="elliptical", clearance=1.5 * train.bearings[1].clearance)
        return replace(train, bearings=(train.bearings[0], chosen, *train.bearings[2:]))

    plant = random_plant(5002, design=Design(slenderness=OTHER_SLENDERNESS), alter=bored, discrepancy=DiscrepancySize())
    found = identify(parse_machine(film_document(plant)), measured(plant, seed=5002), OPTIONS)
    assert not found.accepted
    assert found.verdict.startswith("the oil film of B2 deviates from its model by ")


@pytest.mark.long
def test_oil_that_warms_and_is_said_to_have_one_viscosity_is_refused() -> None:
    plant = random_plant(5001, alter=warming_oil, discrepancy=DiscrepancySize())
    found = identify(parse_machine(film_document(plant)), measured(plant, seed=5001), OPTIONS)
    assert not found.accepted
    assert found.verdict.startswith("the oil films' viscosity falls with speed")


def test_a_start_in_which_a_film_is_too_thin_leads_nowhere_and_says_so() -> None:
    plant, good = fitted(0)
    machine, data = parse_machine(film_document(plant)), measured(plant, seed=0)
    thin = good.point.copy()
    thin[good.coordinates.index("bearing.B1.viscosity")] -= 9.0
    again = identify(machine, data, OPTIONS, beginning=thin)
    assert again.accepted
    assert again.starts > 1


def test_what_a_job_does_behind_an_identification_works_with_films() -> None:
    plant, found = fitted(0)
    machine = parse_machine(film_document(plant))
    derived = {one.name: one for one in derived_quantities(machine, found, (), direction=1)}
    assert derived["critical_speed.1"].value is not None
    model = updated_model(machine, found)
    speed = measured(plant, seed=0).speed
    swept = predicted_transient(model, time=np.linspace(0.0, 120.0, speed.size), speed=speed)
    assert np.isfinite(swept.averaged).all()
    again = identify(machine, measured(plant, seed=1), OPTIONS, beginning=found.point)
    assert again.accepted
    assert again.iterations < found.iterations
    assert combine([found, again]).accepted
