"""A step of the alignment that the growth of pedestals hides from the baseline: found, kept while it stands, gone when it is.

Runs of a plant of other make than the estimator, through the gate.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from service.monitoring.assessment.alignment_steps import has_step
from service.monitoring.assessment.assess import assess
from service.monitoring.assessment.baseline_comparison import compare
from service.monitoring.assessment.context import WEEK, AssessedRun, AssessmentBasis, AssessmentContext, MachineDiagnosis
from service.monitoring.rules.limits import Limits
from tests.film_plant.scatter import run_of
from tests.film_plant_tests.test_film_diagnosis import BASELINE, assessed, baseline, gated, machine, plant, sunk, worn

MISALIGNED = ("misalignment", "coupling.C1")
GROWN, STEPPED = 9e-6, -10e-6
"""Offset after the growth of pedestals, and after the step of 19 µm against it [m], counted from the baseline."""
STEEPEST = 1.5e-6
"""Growth in a week [m]: that of pedestals by ±10 µm over a year is at most 1.2 µm."""


@cache
def run_at(offset: float, number: int, clearance: float = 1.0) -> AssessedRun:
    """Identify a run of the plant with the driven shaft so much higher, and bearing B3 so much wider [-].

    number: the run's, in the order of their times.
    """
    rng = np.random.default_rng([7, number])
    later = worn(2, clearance)(sunk(-offset)(plant()))
    return assessed(BASELINE + number, gated(run_of(later, rng), 200 + number, baseline()[0]))


def context(offsets: Sequence[float], *, step_open_since: int | None = None, clearance: float = 1.0) -> AssessmentContext:
    """The context after runs with such offsets.

    step_open_since: place of the run since which an alert tells a step. clearance: of bearing B3, over that of the baseline.
    """
    is_open = step_open_since is not None
    return AssessmentContext(
        machine=machine(),
        limits=Limits(),
        basis=AssessmentBasis(None, None),
        baseline=tuple(assessed(number, one) for number, one in enumerate(baseline())),
        after=tuple(run_at(offset, number, clearance) for number, offset in enumerate(offsets)),
        open_causes=(MISALIGNED,) if is_open else (),
        history=None,
        open_rates={},
        open_steps={"coupling.C1": (BASELINE + step_open_since) * WEEK} if step_open_since is not None else {},
    )


def diagnosed(of: AssessmentContext) -> MachineDiagnosis:
    found = assess(of).diagnosis
    assert found is not None
    return found


def test_a_step_against_the_growth_of_pedestals_is_told_with_both_sizes() -> None:
    of = context([GROWN] * 4 + [STEPPED] * 2)
    compared = compare(of)
    assert compared is not None
    assert compared.watch.found(compared.observations, on_delay=lambda *_: 2).causes == (), "the baseline alone hides it"
    (one,) = diagnosed(of).causes
    assert (one.cause.kind, one.cause.element) == MISALIGNED
    assert one.began == BASELINE + 4
    q = one.size.quantities
    assert q["offset_vertical_um"] == pytest.approx(1e6 * STEPPED, abs=q["offset_vertical_half_width_um"])
    assert q["step_offset_vertical_um"] == pytest.approx(-19.0, abs=4.0)
    assert one.size.tolerance_per_cent == pytest.approx(
        100.0 * abs(q["step_offset_vertical_um"]) / q["offset_vertical_allowed_um"], rel=0.01
    )
    assert has_step({"quantities": q})
    told = {(part.name, part.against): part.value for part in one.size.parts}
    assert told["coupling.C1.offset_vertical", "runs_before"] == q["step_offset_vertical_um"]
    assert told["coupling.C1.offset_vertical", "baseline"] == q["offset_vertical_um"]


def test_one_run_is_not_enough_and_growth_by_itself_is_no_step() -> None:
    assert diagnosed(context([GROWN] * 4 + [STEPPED])).causes == ()
    growing = [STEEPEST * number for number in range(1, 7)]
    assert diagnosed(context(growing)).causes == ()


def test_it_stays_open_while_it_stands_and_goes_when_it_is_taken_back() -> None:
    standing = diagnosed(context([GROWN] * 4 + [STEPPED] * 6, step_open_since=4))
    assert [(one.cause.kind, one.cause.element) for one in standing.causes] == [MISALIGNED]
    back = diagnosed(context([GROWN] * 4 + [STEPPED] * 2 + [GROWN] * 3, step_open_since=4))
    assert back.causes == ()
    assert back.gone == {MISALIGNED}


def test_a_step_back_to_the_baseline_is_a_repair() -> None:
    assert diagnosed(context([-40e-6] * 4 + [0.0] * 2)).causes == ()


def test_a_refused_run_neither_shows_a_step_nor_hides_one() -> None:
    runs = [GROWN] * 4 + [STEPPED] * 2
    of = context(runs)
    refused = replace(of.after[3], fit=replace(of.after[3].fit, accepted=False))
    (one,) = diagnosed(replace(of, after=(*of.after[:3], refused, *of.after[4:]))).causes
    assert (one.cause.kind, one.cause.element) == MISALIGNED
    last = replace(of.after[-1], fit=replace(of.after[-1].fit, accepted=False))
    assert all(
        "step_offset_vertical_um" not in found.size.quantities
        for found in diagnosed(replace(of, after=(*of.after[:-1], last))).causes
    )


@pytest.mark.long
def test_wear_beside_an_offset_is_no_part_of_its_size_nor_of_its_step() -> None:
    """Wear of 30 % held at the baseline's would be told as some 30 µm of offset more, and 20 µm sideways."""
    found = diagnosed(context([STEPPED * 2] * 3, clearance=1.3)).causes
    assert ("wear", "bearing.B3") in {(one.cause.kind, one.cause.element) for one in found}
    sizes = [one.size.quantities for one in found if (one.cause.kind, one.cause.element) == MISALIGNED]
    assert sizes
    for told in sizes:
        for step in ("", "step_"):
            for quantity, true in (("offset_vertical", 2e6 * STEPPED), ("offset_horizontal", 0.0)):
                half = told[f"{step}{quantity}_half_width_um"]
                assert told[f"{step}{quantity}_um"] == pytest.approx(true, abs=1.5 * half), f"{step}{quantity}"


@pytest.mark.long
def test_no_step_is_told_against_runs_among_which_a_bearing_has_worn() -> None:
    """Three healthy runs and three with the wear have no alignment in common that a step could be told against."""
    of = context([0.0] * 3 + [STEPPED * 4] * 2, clearance=1.3)
    found = {(one.cause.kind, one.cause.element): one.size.quantities for one in diagnosed(of).causes}
    assert set(found) == {MISALIGNED, ("wear", "bearing.B3")}
    told = found[MISALIGNED]
    assert told["offset_vertical_um"] == pytest.approx(4e6 * STEPPED, abs=1.5 * told["offset_vertical_half_width_um"])
    assert not has_step({"quantities": told})
