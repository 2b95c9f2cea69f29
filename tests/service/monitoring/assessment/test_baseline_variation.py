"""Tests that the variation of a machine on oil films is learnt once of a baseline that is read again, and anew of any
other."""

from dataclasses import replace

import numpy as np

from service.monitoring.assessment import run_models
from service.monitoring.assessment.context import WEEK, AssessedRun
from service.monitoring.assessment.run_models import baseline_variation
from tests.estimator.alignment.drawn_runs import MODEL, drawn_machine, drawn_run, fitted
from tests.estimator.diagnosis.test_film_reference import VARIATION, observed


def baseline(seed: int, *, times: float = 1.0) -> list[AssessedRun]:
    """Runs of one machine, read anew at each call; times: size of their scatter."""
    rng = np.random.default_rng(seed)
    machine = drawn_machine(rng)
    variation = VARIATION.model_copy(update={"damping": times * VARIATION.damping})
    runs = [fitted(drawn_run(machine, variation, rng), rng) for _ in range(5)]
    return [AssessedRun(number, number * WEEK, {}, observed(one)) for number, one in enumerate(runs)]


def test_a_baseline_that_is_read_again_is_not_learnt_from_again() -> None:
    first, before = baseline_variation(MODEL.machine, baseline(1)), run_models._baseline_variation.cache_info()
    assert baseline_variation(MODEL.machine, baseline(1)) == first
    after = run_models._baseline_variation.cache_info()
    assert (after.hits, after.misses) == (before.hits + 1, before.misses)


def test_one_that_differs_in_a_number_or_in_its_document_is() -> None:
    runs = baseline(1)
    usual = baseline_variation(MODEL.machine, runs)
    assert baseline_variation(MODEL.machine, baseline(1, times=3.0)).damping > usual.damping
    moved = replace(runs[0].fit, point=runs[0].fit.point + 1e-9)
    assert baseline_variation(MODEL.machine, [replace(runs[0], fit=moved), *runs[1:]]) != usual
    said = MODEL.machine.operation.model_copy(update={"healthy_variation": VARIATION.model_copy(update={"damping": 0.1})})
    assert baseline_variation(MODEL.machine.model_copy(update={"operation": said}), runs).damping > usual.damping
