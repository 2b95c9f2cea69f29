"""Steps of a coupling's alignment on oil films, seen against the runs just before them.

Over a year pedestals grow by as much as a step that should be told, so that compared with the baseline alone it may hide in
that growth. Within some weeks they hardly grow.
"""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from statistics import fmean
from typing import Any

from estimator.diagnosis.bayes_factors import Diagnosis
from estimator.diagnosis.data_faults import is_trusted
from estimator.diagnosis.film_reference import film_observation, is_of_films
from estimator.diagnosis.finding_kind import Cause, ChangeSize, SizePart, is_step_beside
from estimator.diagnosis.observation import Observation
from estimator.diagnosis.run_windows import RunWindows
from estimator.diagnosis.season_part import variation_within
from estimator.machine.alignment_rules import HealthyVariation
from estimator.machine.document import Machine
from estimator.machine.parameter_description import describe
from service.monitoring.assessment.baseline_comparison import BaselineComparison, RunsBefore
from service.monitoring.assessment.context import WEEK, AssessedRun, AssessmentContext
from service.monitoring.rules.coupling_and_bearing_findings import MISALIGNMENT
from service.monitoring.rules.diagnosis_rules import delays

MOST_BEFORE = 6
"""Most runs before a step that it is compared with: their scatter averages out, and they hardly cover a season."""
FEWEST_BEFORE = 4
"""Fewest runs before a step with which it can be compared."""
LEAST_OFF = 0.125
"""Part of what is allowed by which an alignment has to differ from the baseline's for a step to be told [-]."""
STEP = "step_"
"""Beginning of the names of quantities that tell a step by itself, not the change since the baseline."""
_COORDINATES = (
    ("offset_vertical", "um"),
    ("offset_horizontal", "um"),
    ("angle_vertical", "urad"),
    ("angle_horizontal", "urad"),
)
"""Names of a coupling's offsets and angles in a size, and the units at their ends."""


@dataclass(frozen=True)
class AlignmentStep:
    """A misalignment that the newest runs show against those before it.

    comparison: comparison of these runs. diagnosis: the misalignment alone. others: other causes of what these runs show.
    """

    comparison: BaselineComparison
    diagnosis: Diagnosis
    others: tuple[Cause, ...]

    @property
    def keys(self) -> frozenset[tuple[str, str]]:
        """Return kind and element of the misalignment."""
        return frozenset((one.kind, one.element) for one in self.diagnosis.causes)


def alignment_steps(
    context: AssessmentContext, compared: BaselineComparison, channels: frozenset[str]
) -> Iterator[AlignmentStep]:
    """Yield the steps of couplings' alignments that the newest runs show, those of open alerts first.

    compared: comparison with the baseline; of trains without oil films nothing is yielded. channels: ids of the channels
    whose errors fits may rest on.
    """
    if compared.variation is None:
        return
    runs = _film_runs(context, compared, channels)
    if not runs or runs[-1][0].id != context.after[-1].id:
        return
    found: set[str] = set()
    for comparison, of in _comparisons(context, runs, compared.variation):
        diagnosis = comparison.watch.found(
            comparison.observations, on_delay=lambda kind, element: delays(context.limits, kind, element)[0]
        )
        for cause, runners_up in zip(diagnosis.causes, diagnosis.runners_up, strict=True):
            if cause.kind == MISALIGNMENT.name and cause.element in of - found:
                found.add(cause.element)
                others = tuple(one for one in diagnosis.causes if one is not cause)
                yield AlignmentStep(comparison, Diagnosis((cause,), (runners_up,)), others)


def step_begins_amid(step: AlignmentStep, began: Iterable[int]) -> bool:
    """Return whether the runs before a step are unlike each other, as another cause began among them.

    Their mean is that of no machine, so that nothing can be told against it. began: when other causes began [ns].
    """
    before = step.comparison.before
    times = [] if before is None else [run.measured_at for run in before.runs]
    return any(min(times, default=at) < at <= max(times, default=at - 1) for at in began)


def step_has_gone(
    context: AssessmentContext, compared: BaselineComparison, element: str, channels: frozenset[str]
) -> bool | None:
    """Return whether the newest runs no longer show the step of an open alert; None where none is known of.

    channels: ids of the channels whose errors fits may rest on.
    """
    began = context.open_steps.get(element)
    if began is None or compared.variation is None:
        return None
    comparison = _compared_since(context.machine, _film_runs(context, compared, channels), began, compared.variation)
    if comparison is None:
        return None
    off_delay = delays(context.limits, MISALIGNMENT.name, element)[1]
    return comparison.watch.has_gone(comparison.observations, MISALIGNMENT.name, element, off_delay=off_delay)


def with_step(size: ChangeSize, step: ChangeSize) -> ChangeSize:
    """Return the size of a change since the baseline, with that of the step beside it.

    A limit is reached by either; what is certain to be beyond what is allowed is the change since the baseline.
    """
    named = [f"{coordinate}{kind}_{unit}" for coordinate, unit in _COORDINATES for kind in ("", "_half_width")]
    told = {f"{STEP}{name}": step.quantities[name] for name in named if name in step.quantities}
    parts = [one for one in (size.tolerance_per_cent, step.tolerance_per_cent) if one is not None]
    steps = [replace(one, against="runs_before") for one in step.parts if _differs_from_change(one, size)]
    return replace(
        size,
        quantities={**size.quantities, **told},
        tolerance_per_cent=max(parts, default=None),
        parts=(*size.parts, *steps),
    )


def _differs_from_change(part: SizePart, size: ChangeSize) -> bool:
    """Return whether a figure of a step is one of alignment, and reads otherwise than the change since the baseline."""
    coordinate = describe(part.name).quantity, part.unit
    whole = size.quantities.get("_".join(coordinate), 0.0)
    return coordinate in _COORDINATES and is_step_beside(part.value, (part.upper - part.lower) / 2.0, whole=whole)


def has_step(evidence: Mapping[str, Any]) -> bool:
    """Return whether the evidence of an alert has a step of an alignment."""
    return any(name.startswith(STEP) for name in evidence.get("quantities") or ())


def is_off_baseline(size: ChangeSize, step: ChangeSize) -> bool:
    """Return whether an alignment differs from the baseline's where the step has moved it most: a step back is a repair.

    size: size of the change since the baseline. step: size of the step by itself.
    """
    now, moved = size.quantities, step.quantities
    known = [(name, unit) for name, unit in _COORDINATES if f"{name}_{unit}" in now and f"{name}_{unit}" in moved]
    if not known:
        return False
    name, unit = max(known, key=lambda one: abs(moved["{}_{}".format(*one)]) / moved["{}_allowed_{}".format(*one)])
    least = max(now[f"{name}_half_width_{unit}"], LEAST_OFF * now[f"{name}_allowed_{unit}"])
    return abs(now[f"{name}_{unit}"]) > least


_FilmRuns = Sequence[tuple[AssessedRun, Observation]]
"""Runs whose fits hold, with their observations, oldest first, those of the baseline first."""


def _film_runs(context: AssessmentContext, compared: BaselineComparison, channels: frozenset[str]) -> _FilmRuns:
    """Return the newest runs that a step is looked for in; with open steps all, since these may have begun with any."""
    machine, names = context.machine, compared.watch.reference.names
    enough = math.inf if context.open_steps else MOST_BEFORE + max(_windows(context), default=0)
    found: list[tuple[AssessedRun, Observation]] = []
    for run in reversed([*context.baseline, *context.after]):
        if len(found) < enough and is_of_films(run.fit, machine):
            said = film_observation(run.fit, machine, run.conditions)
            if said.names == names and is_trusted(said, channels):
                found.insert(0, (run, said))
    return found


def _windows(context: AssessmentContext) -> list[int]:
    """Return the numbers of newest runs in which a step is looked for."""
    agree = {delays(context.limits, MISALIGNMENT.name, f"coupling.{one.id}")[0] for one in context.machine.couplings}
    return sorted({count for needed in agree for count in (needed, needed + 1)})


def _comparisons(
    context: AssessmentContext, runs: _FilmRuns, variation: HealthyVariation
) -> Iterator[tuple[BaselineComparison, frozenset[str]]]:
    """Yield comparisons of the newest runs with those before, each with the couplings of which it says whether they moved.

    Where a step is open, the runs before it say whether it stands; what it does since, such as going back, is none of its own.
    """
    unmoved = {f"coupling.{one.id}" for one in context.machine.couplings}
    for element, began in context.open_steps.items():
        if (since := _compared_since(context.machine, runs, began, variation)) is not None:
            unmoved -= {element}
            yield since, frozenset({element})
    for count in _windows(context):
        if (newest := _compared_from(context.machine, runs, len(runs) - count, variation)) is not None:
            yield newest, frozenset(unmoved)


def _compared_since(machine: Machine, runs: _FilmRuns, began: int, variation: HealthyVariation) -> BaselineComparison | None:
    """Compare the runs since a step began [ns] with those before it; return None where these are not known any more.

    It may have begun with a run of another kind.
    """
    place = next((place for place, (run, _) in enumerate(runs) if run.measured_at >= began), None)
    return None if place is None else _compared_from(machine, runs, place, variation)


def _compared_from(machine: Machine, runs: _FilmRuns, place: int, variation: HealthyVariation) -> BaselineComparison | None:
    """Compare the runs from a place on with those before it; return None where these are too few."""
    before, after = runs[max(0, place - MOST_BEFORE) : max(0, place)], runs[max(0, place) :]
    if len(before) < FEWEST_BEFORE:
        return None
    weeks = (after[-1][0].measured_at - fmean(run.measured_at for run, _ in before)) / WEEK
    within = variation_within(variation, weeks=weeks)
    watch = RunWindows.from_baseline(machine, [said for _, said in before], variation=within)
    return BaselineComparison(
        watch,
        tuple(run for run, _ in after),
        tuple(said for _, said in after),
        variation,
        before=RunsBefore(tuple(run for run, _ in before), within),
    )
