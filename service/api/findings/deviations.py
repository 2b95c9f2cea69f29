"""Serves deviations of machines from their baselines, and the tests of their trends."""

import cmath
import math
from dataclasses import asdict
from typing import Annotated, Any, cast

from fastapi import APIRouter, Query, Request
from pydantic import Field
from sqlalchemy.orm import Session

from estimator.machine.document import Machine
from estimator.machine.parameter_description import is_direct
from estimator.rotor.parameter_names import derived_unit
from estimator.trends.deviations import ElementDistance, ParameterDeviation, comparable, deviations, element_of, parameter_of
from estimator.trends.drift import Drift
from estimator.trends.parameter_vector import Point
from estimator.trends.trend_tests import RUN_LENGTH, Chart, TrendTest, distance_trends, time_to_change, trend_tests
from service.api.conventions.dependencies import MachineId, Reading
from service.api.conventions.problems import RESPONSES, Unsuitable
from service.api.conventions.values import time_or_none
from service.api.findings import deviation_schemas as schemas
from service.api.findings.evidence import MeanSizeOut
from service.monitoring.assessment.context import WEEK
from service.monitoring.comparison import Compared, compared
from service.monitoring.condition_adjustment import condition_adjustment, points, readings
from service.monitoring.limits_in_force import limits_in_force
from service.monitoring.rules.limit_rule import Level
from service.monitoring.rules.limits import Limits, deviation_rule, severity_of
from service.security.requirement import VIEWER
from service.wording.described_finding import DescribedFinding
from storage.clock import to_datetime
from storage.findings import diagnoses, identifications
from storage.findings.identifications import IdentificationUnknown
from storage.findings.jobs import RUN
from storage.machines import machines
from storage.tables.findings import IdentificationRow

router = APIRouter(tags=["deviations"], responses=RESPONSES, dependencies=[VIEWER])

CENTURY = 5218.0
"""Time [weeks] after which a limit counts as never reached."""

ChosenIdentification = Annotated[
    int | None, Query(alias="identification", ge=0, le=2**62, description="by default the newest accepted one")
]
CoordinateName = Annotated[str, Field(pattern=r"^\w+\.\S{1,200}$", description="what it is a part of, a dot, and which")]


def _names(words: str) -> Any:
    return Query(default_factory=list, max_length=100, description=f"{words}; default: all")


@router.get("/machines/{machine_id}/deviations", operation_id="read_deviations")
def read_deviations(
    request: Request, session: Reading, machine_id: MachineId, which: ChosenIdentification = None
) -> schemas.DeviationsOut:
    """Measure the deviation of each parameter and each element from the baseline, in per cent and standard deviations."""
    found = chosen_comparison(request, session, machine_id, which)
    if found.missing is not None:
        return schemas.DeviationsOut(**compared_fields(session, found, {}), parameters=[], elements=[])
    *baseline, now = points(session, found, [*found.baseline, found.identification])
    result = deviations(baseline, now)
    limits = limits_in_force(session, machine_id)
    together = _together(session, found.identification)
    return schemas.DeviationsOut(
        **compared_fields(session, found, _left_out(session, found, baseline, now)),
        parameters=[_parameter(one, limits) for one in result.parameters],
        elements=[_element(one, together.get(one.element, [])) for one in result.elements],
    )


@router.get("/machines/{machine_id}/trend-tests", operation_id="read_trend_tests")
def read_trend_tests(
    request: Request,
    session: Reading,
    machine_id: MachineId,
    parameter: Annotated[list[CoordinateName], _names("such as bearing.B1.kxx")],
    element: Annotated[list[CoordinateName], _names("such as coupling.C1")],
    which: ChosenIdentification = None,
) -> schemas.TrendTestsOut:
    """Read steps, creep and drift of parameters and of elements' distances, from the baseline up to an identification.

    A query for parameters only leaves the elements out, and the reverse. Quantities derived from parameters, such as
    critical_speed.1, have trends but no tests.
    """
    found = chosen_comparison(request, session, machine_id, which)
    if found.missing is not None:
        return schemas.TrendTestsOut(**compared_fields(session, found, {}), run_length=RUN_LENGTH, tests=[])
    baseline, after = points(session, found, found.baseline), readings(session, found)
    limits = limits_in_force(session, machine_id)
    everything = not parameter and not element
    tests: list[schemas.TrendTestOut] = []
    if everything or parameter:
        names = _coordinates(after[-1].point, parameter or None)
        tests += [_coordinate_test(one, limits) for one in trend_tests(baseline, after, names)]
    if everything or element:
        tests += [_distance_test(one) for one in distance_trends(baseline, after, element or None)]
    left_out = _left_out(session, found, baseline, after[-1].point)
    asked = left_out if everything else [*parameter, *element]
    tested = {name for one in tests for name in (one.name, parameter_of(one.name))}
    machine = machines.document(session, machine_id, found.identification.revision)
    reasons = {name: left_out.get(name) or _reason_not_tested(machine, name) for name in asked if name not in tested}
    return schemas.TrendTestsOut(**compared_fields(session, found, reasons), run_length=RUN_LENGTH, tests=tests)


def _reason_not_tested(machine: Machine, name: str) -> str:
    """Return the reason why a name has no trend test."""
    if derived_unit(machine, name) is not None:
        return "derived from the parameters: trend tests are of identified parameters and of elements"
    return f"machine '{machine.id}' has nothing of that name"


def _coordinates(point: Point, parameters: list[str] | None) -> list[str] | None:
    """Return the coordinates of some parameters; both components of an unbalance."""
    if parameters is None:
        return None
    return [name for name in point.names if name in parameters or parameter_of(name) in parameters]


def chosen_comparison(request: Request, session: Session, machine_id: str, which: int | None) -> Compared:
    """Return an identification, by default the newest accepted one of a single run, with what it is compared with.

    Raises MachineUnknown, IdentificationUnknown, Unsuitable.
    """
    machines.get(session, machine_id)
    return compared(session, _chosen(session, machine_id, which), baseline_runs=cast(int, request.app.state.baseline_runs))


def _chosen(session: Session, machine_id: str, which: int | None) -> IdentificationRow:
    if which is None:
        newest = identifications.newest_of_single_run(session, machine_id)
        if newest is None:
            raise IdentificationUnknown(f"of machine '{machine_id}' was accepted yet")
        return newest
    row = identifications.get(session, which)
    if row.machine_id != machine_id:
        raise IdentificationUnknown(f"{which} of machine '{machine_id}'")
    if row.scope != RUN:
        raise Unsuitable(f"identification {which} is {row.scope}: only those of single runs are compared with a baseline")
    return row


def _left_out(session: Session, found: Compared, baseline: list[Point], now: Point) -> dict[str, str]:
    """Return the parameters that are not compared, with the reason."""
    same = {parameter_of(name) for name in comparable(baseline, now)}
    reasons = {}
    for one in identifications.estimates(session, found.identification.id):
        if one.parameter in same:
            continue
        if one.value is None:
            reasons[one.parameter] = one.reason or "not determined"
            continue
        lacking = [
            str(row.id)
            for row, point in zip(found.baseline, baseline, strict=True)
            if one.parameter not in {parameter_of(name) for name in point.names}
        ]
        reasons[one.parameter] = f"not determined in the baseline, by identification {', '.join(lacking)}"
    return reasons


def compared_fields(session: Session, found: Compared, left_out: dict[str, str]) -> dict[str, object]:
    """Return the fields of `ComparedOut`. left_out: what is not compared, with the reason."""
    row, began = found.identification, found.began
    return {
        "machine": row.machine_id,
        "identification": row.id,
        "measured_at": to_datetime(row.measured_at),
        "run_kind": row.run_kind,
        "conditions": row.conditions,
        "adjusted_for": [] if found.missing else list(condition_adjustment(session, found).conditions),
        "baseline": schemas.BaselineUsed(
            identifications=[one.id for one in found.baseline],
            wanted=found.wanted,
            since=time_or_none(None if began is None else began.since),
            reason=None if began is None else began.reason,
            by=None if began is None else began.by,
        ),
        "missing": found.missing,
        "left_out": left_out,
    }


def _parameter(one: ParameterDeviation, limits: Limits) -> schemas.ParameterDeviationOut:
    rule = deviation_rule(one.element)
    reached = None
    if rule is not None:
        reached = severity_of(limits, rule, sigma=one.sigma, per_cent=100 * one.change, element=one.element)
    return schemas.ParameterDeviationOut(
        parameter=one.name,
        element=one.element,
        per_cent=100 * one.change,
        lower_per_cent=100 * one.lower,
        upper_per_cent=100 * one.upper,
        sigma=one.sigma,
        degrees_of_freedom=one.degrees_of_freedom,
        probability=one.probability,
        added=None if one.vector is None else abs(one.vector),
        added_angle_deg=None if one.vector is None else math.degrees(cmath.phase(one.vector)) % 360.0,
        reaches=None if reached is None else reached.label,
    )


def _together(session: Session, row: IdentificationRow) -> dict[str, list[MeanSizeOut]]:
    """Return the figures of each element that the diagnosis of an identification names."""
    diagnosis = diagnoses.of_identification(session, row.id)
    found: dict[str, list[MeanSizeOut]] = {}
    for cause in [] if diagnosis is None else diagnosis.causes:
        finding = DescribedFinding(cause["kind"], cause["element"], cause)
        for part in finding.stored_parts():
            size = MeanSizeOut(**asdict(part) | {"members": list(part.members), "runs": finding.runs_of(part)})
            found.setdefault(element_of(part.name), []).append(size)
    return found


def _element(one: ElementDistance, together: list[MeanSizeOut]) -> schemas.ElementDistanceOut:
    return schemas.ElementDistanceOut(
        element=one.element,
        coordinates=list(one.names),
        distance=one.distance,
        degrees_of_freedom=one.degrees_of_freedom,
        probability=one.probability,
        together=together,
    )


def _coordinate_test(one: TrendTest, limits: Limits) -> schemas.TrendTestOut:
    direct = is_direct(one.name)

    def per_cent(change: float) -> float:
        return 100 * (math.expm1(change) if direct else change)

    rule = deviation_rule(one.element)
    chosen = None if rule is None else limits.rule(rule, one.element)
    # A component does not tell when the length of its vector reaches a limit.
    reaches = chosen is not None and parameter_of(one.name) == one.name
    drift = None
    if one.drift is not None:
        drift = schemas.DriftOut(
            per_week=per_cent(one.drift.slope),
            lower=per_cent(one.drift.slope_lower),
            upper=per_cent(one.drift.slope_upper),
            probability=one.drift.probability,
            correction=one.drift.correction,
            alert=_ahead(one.drift, chosen.alert, direct) if chosen is not None and reaches else None,
            danger=_ahead(one.drift, chosen.danger, direct) if chosen is not None and reaches else None,
        )
    return _test(one, per_cent(one.newest), drift)


def _distance_test(one: TrendTest) -> schemas.TrendTestOut:
    drift = None
    if one.drift is not None:
        drift = schemas.DriftOut(
            per_week=one.drift.slope,
            lower=one.drift.slope_lower,
            upper=one.drift.slope_upper,
            probability=one.drift.probability,
            correction=one.drift.correction,
            alert=None,
            danger=None,
        )
    return _test(one, one.newest, drift)


def _test(one: TrendTest, newest: float, drift: schemas.DriftOut | None) -> schemas.TrendTestOut:
    return schemas.TrendTestOut(
        name=one.name,
        runs=one.runs,
        newest=newest,
        step_up=_chart(one.step_up),
        step_down=None if one.step_down is None else _chart(one.step_down),
        creep=_chart(one.creep),
        drift=drift,
    )


def _chart(one: Chart) -> schemas.ChartOut:
    began = None if one.began is None else to_datetime(round(one.began * WEEK))
    return schemas.ChartOut(value=one.value, limit=one.limit, passed=one.passed, began=began, runs=one.runs)


def _ahead(drift: Drift, level: Level | None, direct: bool) -> schemas.AheadOut | None:
    if level is None or level.per_cent is None:
        return None
    found = time_to_change(drift, level.per_cent / 100, logarithmic=direct)
    weeks = [None if one is None or one > CENTURY else one for one in (found.expected, found.earliest, found.latest)]
    return schemas.AheadOut(per_cent=level.per_cent, expected=weeks[0], earliest=weeks[1], latest=weeks[2])
