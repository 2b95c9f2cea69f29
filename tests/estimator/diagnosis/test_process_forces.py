"""A static force that changes is named as one, with its size, and not as an alignment; where the document leaves it open."""

from functools import cache

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.alignment.healthy_films import coordinate_scales
from estimator.diagnosis.film_findings import process_force_size, process_forces
from estimator.diagnosis.film_reference import film_observation
from estimator.diagnosis.finding_kind import BaselineValues, Cause
from estimator.diagnosis.observation import Observation
from estimator.diagnosis.run_windows import RunWindows
from estimator.machine.alignment_rules import HealthyVariation
from estimator.machine.document import Machine, parse_machine
from estimator.machine.under_conditions import under_conditions
from estimator.updated_model.model import expected_model
from service.wording.described_finding import DescribedFinding
from service.wording.finding_words import process_force_words
from tests.estimator.diagnosis.test_film_findings import TWO_SHAFTS, columns_of
from tests.estimator.diagnosis.test_film_reference import BASELINE, observed
from tests.estimator.statics.films import motor_compressor_document
from tests.estimator.statics.test_process_forces import FORCE_Y, with_force

SPREAD = 800.0
"""Largest error of the force [N]."""


@cache
def train() -> Machine:
    said = with_force(motor_compressor_document("flexible"), force_y=-500.0, force_y_spread=SPREAD)
    for bearing in said["bearings"]:
        bearing["speed_dependence"] = {"form": "journal", "elevation_spread": 150e-6}
    return parse_machine(said)


def run(rng: np.random.Generator, force: float = 0.0) -> Observation:
    """A run that measures numbers of random directions of the document's machine, its force larger by so much [N]."""
    model = expected_model(train())
    coordinates = model.coordinates_at(np.ones(1))
    size = np.where(coordinates.spread > 1.0, 1e-5, coordinates.spread)
    seen = 40.0 * rng.standard_normal((400, coordinates.size)) / size / np.sqrt(coordinates.size)
    away = np.zeros(coordinates.size)
    place = coordinates.names.index(FORCE_Y)
    away[place] = force / coordinates.unit[place]
    covariance = np.linalg.inv(seen.T @ seen + coordinates.prior.precision)
    found = covariance @ seen.T @ (seen @ away + rng.standard_normal(400))
    unit = coordinates.unit
    values = coordinates.point(coordinates.centre + found)
    fitted = replace(model, values=values, covariance=covariance * np.outer(unit, unit))
    return film_observation(observed(fitted), train(), {})


def test_a_force_that_has_changed_is_named_with_its_size() -> None:
    rng = np.random.default_rng(6)
    watch = RunWindows.from_baseline(train(), [run(rng) for _ in range(BASELINE)], variation=HealthyVariation())
    still = watch.found([run(rng), run(rng)], on_delay=lambda _kind, _element: 2)
    assert still.causes == ()
    (cause,) = watch.found([run(rng, -600.0), run(rng, -600.0)], on_delay=lambda _kind, _element: 2).causes
    assert (cause.kind, cause.element, cause.names) == ("process_force", "static_load.gear", (FORCE_Y,))
    size = process_force_size(cause, BaselineValues({FORCE_Y: -500.0}, {}))
    assert size.quantities["force_y_n"] == pytest.approx(-600.0, abs=150.0)
    assert size.per_cent == pytest.approx(120.0, abs=30.0)


def test_a_force_varies_from_run_to_run_by_a_part_of_what_is_stated_of_it() -> None:
    coordinates = expected_model(train()).coordinates_at(np.ones(1))
    scales = coordinate_scales(coordinates, coordinates.point(coordinates.centre))
    place = coordinates.names.index(FORCE_Y)
    for variation in (HealthyVariation(), HealthyVariation(process_force=0.2)):
        spread = scales.own(variation)[place] * coordinates.unit[place]
        assert spread == pytest.approx(variation.process_force * SPREAD)  # more than the force of 500 N itself


def test_each_component_varies_by_what_is_stated_of_itself() -> None:
    """A heavy load that is known does not make the small one across it vary as much."""
    said = motor_compressor_document("flexible")
    for bearing in said["bearings"]:
        bearing["speed_dependence"] = {"form": "journal"}
    known = {"force_x": 30.0, "force_x_spread": 50.0, "force_y": -4000.0, "force_y_spread": 100.0}
    coordinates = expected_model(parse_machine(with_force(said, **known))).coordinates_at(np.ones(1))
    spread = coordinate_scales(coordinates, coordinates.point(coordinates.centre)).own(HealthyVariation(process_force=0.1))
    for name, size in (("static_load.gear.force_x", 50.0), (FORCE_Y, 4000.0)):
        place = coordinates.names.index(name)
        assert spread[place] * coordinates.unit[place] == pytest.approx(0.1 * size)


def test_runs_whose_force_varies_as_stated_are_no_finding_and_more_stated_variation_hides_more() -> None:
    rng = np.random.default_rng(8)
    stated = HealthyVariation(process_force=0.15)
    baseline = [run(rng, 120.0 * rng.standard_normal()) for _ in range(BASELINE)]
    moved = [run(rng, -250.0), run(rng, -250.0)]
    told = [
        {
            cause.kind
            for cause in RunWindows.from_baseline(train(), baseline, variation=one).found(moved, on_delay=lambda *_: 2).causes
        }
        for one in (HealthyVariation(process_force=0.0), stated)
    ]
    assert told == [{"process_force"}, set()]


def test_its_words_tell_newtons_with_what_it_was() -> None:
    cause = Cause("process_force", "static_load.gear", 9.0, (FORCE_Y,), np.array([-600.0]), np.array([[900.0]]), 20.0, (9.0,))
    size = process_force_size(cause, BaselineValues({FORCE_Y: -500.0}, {}))
    (part,) = size.parts
    assert part.unit == "N"
    assert part.value == pytest.approx(-600.0)
    assert part.lower == pytest.approx(-658.8, abs=0.1)
    told = DescribedFinding("process_force", "static_load.gear", {"quantities": size.quantities})
    assert process_force_words(told)["size"] == "by -600 ± 59 N along y, from -500 N"


def test_a_force_that_was_hardly_there_is_not_large_in_per_cent() -> None:
    cause = Cause("process_force", "static_load.gear", 9.0, (FORCE_Y,), np.array([50.0]), np.array([[1.0]]), 50.0, (9.0,))
    assert process_force_size(cause, BaselineValues({FORCE_Y: 0.0}, {})).per_cent == pytest.approx(50.0)


def test_forces_that_are_known_exactly_do_not_change() -> None:
    assert list(process_forces(columns_of(TWO_SHAFTS))) == []


def scaled_run(power: float) -> Observation:
    """A run at some power that finds what the document states, the force within a tenth of what it may be off."""
    said = train().model_dump(mode="json", exclude_none=True)
    said["conditions"] = [{"name": "power", "unit": "MW"}]
    said["static_loads"][0] |= {"scaled_by": "power", "stated_at": 8.0}
    machine = parse_machine(said)
    conditions = {"power": power}
    model = expected_model(under_conditions(machine, conditions))
    coordinates = model.coordinates_at(np.ones(1))
    error = 0.1 * np.where(coordinates.spread > 1.0, 1e-5, coordinates.spread) * coordinates.unit
    return film_observation(observed(replace(model, covariance=np.diag(error**2))), machine, conditions)


@pytest.mark.parametrize("power", [4.0, -8.0, 0.8])
def test_a_force_that_follows_the_power_is_reported_at_the_power_that_the_document_states(power: float) -> None:
    stated, scaled = scaled_run(8.0), scaled_run(power)
    place = stated.names.index(FORCE_Y)
    assert scaled.reference[place] == pytest.approx(-500.0)
    assert scaled.information[place, place] == pytest.approx(stated.information[place, place], rel=1e-6)


def test_a_run_at_no_power_says_nothing_of_the_force_and_is_still_compared() -> None:
    stated, none = scaled_run(8.0), scaled_run(0.0)
    assert none.names == stated.names
    assert np.isfinite(none.information).all()
