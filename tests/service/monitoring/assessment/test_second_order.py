"""The 2× beside other evidence: it decides between two explanations that are about as good, and raises nothing by itself."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from sqlalchemy import event

from estimator.diagnosis.bayes_factors import Diagnosis
from estimator.diagnosis.finding_kind import Cause
from estimator.diagnosis.observation import observed_fit
from estimator.updated_model.derived_quantities import Derived
from service.monitoring.assessment.assess import assess
from service.monitoring.assessment.context import WEEK, AssessedRun, AssessmentBasis, AssessmentContext, ComparedValue
from service.monitoring.assessment.second_order import Explanation, explained
from service.monitoring.context_loading import load_context
from service.monitoring.rules.limits import Limits
from service.wording.described_finding import DescribedFinding
from service.wording.finding_words import second_order_words
from storage.database.engine import Database
from storage.findings import derived
from storage.machines import machines
from tests.estimator.diagnosis import watched_machine
from tests.plant import KEY, START, identification, store_identification

BEARING, MISALIGNMENT = ("bearing", "bearing.B2"), ("misalignment", "coupling.C1")
USUAL, GROWN = 2e-6, 5e-6
"""Amplitudes of the 2× [m]."""
BASELINE = 6


def second_orders(now: dict[str, float]) -> tuple[ComparedValue, ...]:
    """Amplitudes of the 2× at all probes: of those that are named as they are now, else as usual."""
    before = [(USUAL * (1.0 + 0.02 * (number % 3 - 1)), 0.05e-6) for number in range(BASELINE)]
    return tuple(
        ComparedValue(f"probe.{one}.second_amplitude", f"probe.{one}", "m", now.get(one, USUAL), before)
        for one in watched_machine.motor_pump().channels
    )


def context(now: dict[str, float], *, open_causes: Sequence[tuple[str, str]] = ()) -> AssessmentContext:
    return AssessmentContext(
        machine=watched_machine.motor_pump(),
        limits=Limits(),
        basis=AssessmentBasis(None, None),
        baseline=(),
        after=(),
        open_causes=tuple(open_causes),
        history=None,
        open_rates={},
        second_orders=second_orders(now),
    )


def cause(named: tuple[str, str], evidence: float, agreement: tuple[float, ...] = (3.0, 3.0)) -> Cause:
    names = (f"{named[1]}.kxx",)
    return Cause(named[0], named[1], evidence, names, np.array([0.2]), np.array([[1e-4]]), 20.0, agreement)


def between(first: Cause, second: Cause, *beside: Cause) -> Diagnosis:
    return Diagnosis((first, *beside), ((second,), *(() for _ in beside)))


def chosen(found: Explanation) -> tuple[tuple[str, str], bool | None]:
    decided = None if found.second_order is None else found.second_order.decided
    return (found.cause.kind, found.cause.element), decided


CLOSE = between(cause(BEARING, 20.0), cause(MISALIGNMENT, 19.5))
BESIDE = {"B2L": GROWN}


def test_a_2x_that_has_grown_beside_the_coupling_decides_between_explanations_that_are_as_good() -> None:
    found = explained(context(BESIDE), CLOSE, 0)
    assert chosen(found) == (MISALIGNMENT, True)
    assert [(one.kind, one.element) for one in found.runners_up] == [BEARING]
    assert found.second_order is not None
    assert (found.second_order.probe, found.second_order.now) == ("B2L", GROWN)


def test_it_does_not_where_another_explanation_is_better_or_already_told() -> None:
    assert chosen(explained(context(BESIDE), between(cause(BEARING, 20.0), cause(MISALIGNMENT, 18.5)), 0)) == (BEARING, None)
    assert chosen(explained(context(BESIDE, open_causes=[BEARING]), CLOSE, 0)) == (BEARING, None)
    doubtful = cause(MISALIGNMENT, 19.5, agreement=(3.0, -1.0))
    assert chosen(explained(context(BESIDE), between(cause(BEARING, 20.0), doubtful), 0)) == (BEARING, None)
    beside = between(cause(BEARING, 20.0), cause(MISALIGNMENT, 19.5), cause(("unbalance", "disc.core-1"), 9.0))
    assert chosen(explained(context(BESIDE), beside, 0)) == (BEARING, None)


def test_it_does_not_where_the_2x_has_not_grown_or_has_elsewhere_too() -> None:
    assert chosen(explained(context({}), CLOSE, 0)) == (BEARING, None)
    assert chosen(explained(context({"B2L": 1.15 * USUAL}), CLOSE, 0)) == (BEARING, None)
    assert chosen(explained(context({"B2L": 0.2 * USUAL}), CLOSE, 0)) == (BEARING, None)
    assert chosen(explained(context({"B2L": GROWN, "B4L": GROWN}), CLOSE, 0)) == (BEARING, None)
    assert chosen(explained(context({"B4L": GROWN}), CLOSE, 0)) == (BEARING, None)


def test_it_speaks_for_a_misalignment_that_another_explanation_comes_close_to() -> None:
    close = between(cause(MISALIGNMENT, 20.0), cause(BEARING, 18.0))
    assert chosen(explained(context(BESIDE), close, 0)) == (MISALIGNMENT, False)
    far = between(cause(MISALIGNMENT, 40.0), cause(BEARING, 18.0))
    assert chosen(explained(context(BESIDE), far, 0)) == (MISALIGNMENT, None)


def test_words_say_what_it_rests_on() -> None:
    said = {"probe": "B2L", "before_um": 2.0, "now_um": 5.0, "decided": True}
    told = DescribedFinding(*MISALIGNMENT, {"second_order": said})
    words = second_order_words(told, "bearing B2 itself")
    assert "by 1× alone bearing B2 itself explains it about as well" in words
    assert "the 2× at probe B2L has grown from 2.0 to 5.0 µm" in words
    assert second_order_words(DescribedFinding(*MISALIGNMENT, {}), "") == ""


def test_a_2x_that_grows_at_a_healthy_machine_raises_nothing() -> None:
    identified = [watched_machine.run(watched_machine.true_machine(), seed) for seed in range(300, 300 + BASELINE + 2)]
    runs = [AssessedRun(number, number * WEEK, {}, observed_fit(one)) for number, one in enumerate(identified)]
    whole = replace(context(BESIDE), baseline=tuple(runs[:BASELINE]), after=tuple(runs[BASELINE:]))
    diagnosis = assess(whole).diagnosis
    assert diagnosis is not None
    assert diagnosis.causes == ()


def test_the_stored_2x_of_the_newest_run_and_of_its_baseline_are_compared(plant: Database) -> None:
    with plant.transaction() as session:
        channel = machines.document(session, KEY.machine).channels[0]
        for number in range(BASELINE):
            row = store_identification(session, identification(), run_id=number, measured_at=START + number)
            size = 1e-6 * (number + 1)
            told = [
                Derived(f"probe.{channel}.{name}", "m", size, 0.9 * size, 1.1 * size) for name in ("second_amplitude", "other")
            ]
            derived.add(session, row, told)
        asked: list[str] = []
        event.listen(plant.engine, "before_cursor_execute", lambda *told: asked.append(told[2]))
        loaded = load_context(session, row, baseline_runs=BASELINE - 1)
        assert loaded is not None
        (one,) = loaded.second_orders
    assert (one.name, one.newest) == (f"probe.{channel}.second_amplitude", 6e-6)
    assert [value for value, _ in one.baseline] == pytest.approx([1e-6, 2e-6, 3e-6, 4e-6, 5e-6])
    assert one.baseline[0][1] == pytest.approx(1e-7)
    of_derived = [one for one in asked if "FROM derived_quantities" in one]
    assert len(of_derived) == 3, "loads, 2× and forces in a query each, however many runs and channels there are"
