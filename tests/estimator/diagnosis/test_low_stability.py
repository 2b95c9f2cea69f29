"""A stability margin below its limit as a finding of its own: where an alignment takes it away, not for oil or by design."""

import math
from dataclasses import replace

import numpy as np
from msgspec import structs

from estimator.alignment.stability_margin import LEAST_DECREMENT, stability_margin
from estimator.diagnosis.low_stability import low_stability
from estimator.diagnosis.observation import Observation
from estimator.machine.parameter_description import describe
from estimator.updated_model.model import UpdatedModel
from tests.estimator.alignment.drawn_runs import MODEL, fitted
from tests.estimator.diagnosis.test_film_reference import after, found, machine, says

SURE, UNSURE = 1e-2, 1.0
"""Parts of what is believed of deviations that a fit leaves open, as standard deviations."""


def moved(by: float = 0.0, oil: float = 1.0, open_part: float = SURE) -> UpdatedModel:
    """The machine with its driven shaft higher [m], in oil of another viscosity, known as well as that."""
    values = MODEL.values.copy()
    for place, name in enumerate(MODEL.coordinates):
        said = describe(name)
        if name in ("bearing.B3.elevation_y", "bearing.B4.elevation_y"):
            values[place] += by
        if said.quantity in ("viscosity", "viscosity_factor"):
            values[place] += math.log(oil)
    deviates = np.array(["_deviation" in name for name in MODEL.coordinates])
    return structs.replace(MODEL, values=values, covariance=np.diag(np.where(deviates, open_part**2, 1e-24)))


def run(model: UpdatedModel, *, accepted: bool = True) -> Observation:
    return replace(after({}, runs=1)[0], accepted=accepted, model=lambda: model)


BASELINE = [run(moved())] * 3
RISEN = run(moved(400e-6))


def decrement(one: Observation) -> float:
    assert one.model is not None
    margin = stability_margin(one.model())
    assert margin is not None
    return margin.log_decrement


def test_a_margin_that_an_alignment_has_taken_away_is_named() -> None:
    assert decrement(RISEN) < 0.5 * decrement(BASELINE[0])
    (fault,) = low_stability(BASELINE, [RISEN, RISEN])
    assert fault.element == "machine"
    assert min(fault.agreement) > 1.0


def test_one_run_by_itself_is_not_enough() -> None:
    assert list(low_stability(BASELINE, [BASELINE[0], RISEN])) == []
    assert list(low_stability(BASELINE, [RISEN, BASELINE[0]])) == []


def test_what_its_error_allows_to_be_above_the_limit_is_not_named() -> None:
    unsure = run(moved(400e-6, open_part=UNSURE))
    assert list(low_stability(BASELINE, [unsure, unsure])) == []


def test_one_that_was_as_low_in_the_baseline_is_the_machines_design() -> None:
    assert decrement(BASELINE[0]) < LEAST_DECREMENT
    assert list(low_stability(BASELINE, BASELINE[:2])) == []
    assert list(low_stability([RISEN], [RISEN, RISEN])) == []


def test_colder_oil_is_the_years_and_not_a_fault() -> None:
    cold = run(moved(oil=1.6))
    assert decrement(cold) < 0.5 * decrement(BASELINE[0])
    assert list(low_stability(BASELINE, [cold, cold])) == []
    assert list(low_stability(BASELINE, [run(moved(400e-6, oil=1.6))] * 2)) != []


def test_refused_runs_and_trains_without_films_say_nothing() -> None:
    assert list(low_stability(BASELINE, [RISEN, run(moved(400e-6), accepted=False)])) == []
    without = replace(RISEN, model=None)
    assert list(low_stability([without], [without])) == []


def test_a_diagnosis_names_it_beside_the_causes_only_where_it_is_low() -> None:
    healthy = after({})
    assert ("low_stability", "machine") not in {(one.kind, one.element) for one in found(healthy).causes}
    low = [replace(one, model=lambda: moved(400e-6)) for one in healthy]
    watched = {(one.kind, one.element) for one in found(low).causes}
    assert watched == {("low_stability", "machine")}


def test_an_observation_has_the_model_of_its_own_fit() -> None:
    drawn = fitted(machine(), np.random.default_rng(8))
    one = says(drawn)
    assert one.model is not None
    assert np.array_equal(one.model().values, drawn.values)
