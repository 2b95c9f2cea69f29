"""Alignment of a machine's couplings, and by how much it has changed against the baseline."""

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from typing import Literal

from fastapi import APIRouter, Request
from pydantic import BaseModel, Field

from estimator.alignment.alignment_change import changed_alignment
from estimator.alignment.load_change import LoadChange, changed_loads
from estimator.alignment.run_change import run_change
from estimator.alignment.targets import TargetedAlignment, targeted_alignment
from estimator.alignment.tolerance import ToleratedChange, tolerated_changes
from estimator.diagnosis.moving_causes import moving_causes
from estimator.fit.estimates import CONFIDENCE_95
from estimator.machine.film_speeds import follows_films
from estimator.machine.parameter_description import describe
from estimator.quantities import UNITS
from estimator.updated_model.derived_quantities import Derived, alignment_quantities
from service.api.conventions.dependencies import MachineId, database
from service.api.conventions.problems import RESPONSES
from service.api.findings.deviation_schemas import ComparedOut
from service.api.findings.deviations import ChosenIdentification, chosen_comparison, compared_fields
from service.api.findings.model import cached_result, read_identified
from service.identification.stored_model import Identified, identified
from service.security.requirement import VIEWER
from storage.findings import diagnoses
from storage.machines import machines

router = APIRouter(tags=["models"], responses=RESPONSES, dependencies=[VIEWER])

Quantities = tuple[Derived, ...]


class Determined(BaseModel):
    """A number with its 95 % interval, in SI units, or the reason why it is not determined."""

    value: float | None
    lower: float | None
    upper: float | None
    reason: str | None


class AlignmentNumber(BaseModel):
    """Offset [m] or angle [rad] at a coupling, in one plane."""

    name: str = Field(description="such as coupling.C1.offset_vertical, as in trends")
    coupling: str
    quantity: str = Field(description="offset or angle, vertical or horizontal: signs and zero in docs/method-alignment.md")
    unit: str
    absolute: Determined = Field(description="of this identification by itself")
    change: Determined | None = Field(description="against the baseline, with which it is known better; null: none")
    allowed: float | None = Field(description="how large the change may be, by the document or what is usual; null: no change")
    beyond: float | None = Field(description="probability that the change is larger; null where it is not determined")
    target: "AlignmentTargetOut | None" = Field(
        default=None, description="by the document, for a machine as warm as runs of this kind show it; null: none stated"
    )


class AlignmentTargetOut(BaseModel):
    """Alignment that the document aims at, and by how much the identified one differs from it."""

    state: Literal["cold", "hot"] = Field(description="cold: of a run-up; hot: of a run-down, with the growth expected")
    target: float
    off: Determined = Field(description="by how much the identified alignment is larger")
    allowed: float = Field(description="how large the difference may be")
    beyond: float | None = Field(description="probability that the difference is larger; null where it is not determined")


class LoadNumber(BaseModel):
    """Load on a bearing's oil film at running speed, in one direction, against the baseline [N]."""

    name: str = Field(description="such as bearing.B2.load_vertical, as in trends")
    bearing: str
    quantity: str = Field(description="vertical or horizontal load")
    unit: str
    before: float = Field(description="in the baseline, of all runs together")
    change: Determined
    change_per_cent: float | None = Field(
        description="of the load before in that direction; null where it carries less than a tenth of the whole load"
    )


class AlignmentOut(ComparedOut):
    """Alignment of all couplings of a train on oil films; no numbers where bearings are not described by their films."""

    numbers: list[AlignmentNumber]
    loads: list[LoadNumber] = Field(description="changes of the bearings' loads that belong to those; none without a baseline")


@router.get("/machines/{machine_id}/alignment", operation_id="read_alignment")
def read_alignment(request: Request, machine_id: MachineId, which: ChosenIdentification = None) -> AlignmentOut:
    """Read offset and angle of each coupling, and by how much they have changed against the baseline.

    A change is known better than either alignment: what is uncertain of the films is the same in all runs. What other causes
    of the diagnosis have moved, such as a worn bearing's clearance, is left open.
    """
    with database(
        request
    ).reading() as session:  # not while the computation waits for its turn: it would hold back checkpoints
        compared = chosen_comparison(request, session, machine_id, which)
        fields = compared_fields(session, compared, {})
        number, kind = compared.identification.id, compared.identification.run_kind
        baseline = () if compared.missing is not None else tuple(row.id for row in compared.baseline)
        diagnosis = diagnoses.newest(session, machine_id) if which is None else diagnoses.of_identification(session, number)
        causes = diagnoses.named_causes(diagnosis)
        # Targets are those of today's document: an alignment may be left anew without another train.
        today = machines.document(session, machine_id)
    if not follows_films(read_identified(request, number).machine):
        return AlignmentOut(**fields, numbers=[], loads=[])

    def read_baseline(_: Identified) -> list[Identified]:
        with database(request).reading() as reading:
            return [identified(reading, one) for one in baseline]

    compute = partial(_alignment, causes=causes)
    _, (absolute, changes, loads) = cached_result(
        request, number, ("alignment", baseline, causes), compute, given=read_baseline
    )
    if baseline and not changes:
        fields["missing"] = "the baseline was identified with other unknowns: identify its runs again"
    targets = targeted_alignment(today, absolute, kind) if follows_films(today) else ()
    numbers = list(_numbers(absolute, changes, {one.name: one for one in targets}))
    return AlignmentOut(**fields, numbers=numbers, loads=[_load(one) for one in loads])


def _alignment(
    one: Identified, baseline: list[Identified], causes: Sequence[tuple[str, str]]
) -> tuple[Quantities, tuple[ToleratedChange, ...], tuple[LoadChange, ...]]:
    """Return alignment, its changes and those of loads, as the alert tells them; no changes without a baseline of the same
    unknowns.

    causes: kind and element of those that the machine's diagnosis has named.
    """
    models, now = [each.model_beside(()) for each in baseline], one.model_beside(causes)
    comparable = bool(models) and all(each.coordinates == now.coordinates for each in models)
    change = run_change(models, now, causes=moving_causes(causes)) if comparable else None
    if change is None:
        return alignment_quantities(now), (), ()
    return alignment_quantities(now), tolerated_changes(one.machine, changed_alignment(change)), changed_loads(change)


def _numbers(
    absolute: Quantities, changes: tuple[ToleratedChange, ...], targets: Mapping[str, TargetedAlignment]
) -> Iterator[AlignmentNumber]:
    by_name = {one.name: one for one in changes}
    for one in absolute:
        said = describe(one.name)
        change = by_name.get(one.name)
        yield AlignmentNumber(
            name=one.name,
            coupling=said.element_id,
            quantity=said.quantity,
            unit=one.unit,
            absolute=_determined(one),
            change=None if change is None else _changed(change),
            allowed=None if change is None else change.allowed,
            beyond=None if change is None or change.value is None else change.beyond,
            target=None if one.name not in targets else _targeted(targets[one.name]),
        )


def _load(one: LoadChange) -> LoadNumber:
    said, half = describe(one.name), CONFIDENCE_95 * one.error
    change = Determined(value=one.value, lower=one.value - half, upper=one.value + half, reason=None)
    return LoadNumber(
        name=one.name,
        bearing=said.element_id,
        quantity=said.quantity,
        unit=UNITS["force"],
        before=one.before,
        change=change,
        change_per_cent=None if one.part is None else 100.0 * one.part,
    )


def _targeted(one: TargetedAlignment) -> AlignmentTargetOut:
    off, half = one.off, one.half
    ends = (None, None) if off is None or half is None else (off - half, off + half)
    told = Determined(value=off, lower=ends[0], upper=ends[1], reason=one.reason)
    return AlignmentTargetOut(state=one.state, target=one.target, off=told, allowed=one.allowed, beyond=one.beyond)


def _determined(one: Derived) -> Determined:
    return Determined(value=one.value, lower=one.lower, upper=one.upper, reason=one.reason)


def _changed(one: ToleratedChange) -> Determined:
    if one.value is None:
        return Determined(value=None, lower=None, upper=None, reason=one.reason)
    return Determined(value=one.value, lower=one.value - one.half, upper=one.value + one.half, reason=None)
