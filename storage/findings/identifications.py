"""Repository of identifications and of the parameter histories that they form."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from sqlalchemy import Select, Text, cast, func, insert, select
from sqlalchemy.orm import Session, undefer

from estimator.diagnosis.observation import ObservedFit
from estimator.errors import Missing
from estimator.fit.identification import Identification
from estimator.fit.validation.channel_sensitivity import ChannelEffects
from estimator.machine.parameter_description import is_direct
from estimator.trends.parameter_vector import Point
from storage.clock import TOLERANCE, now
from storage.encoding import channel_effects
from storage.findings.jobs import GATHERED, RUN
from storage.measurements.runs import DISCARDED
from storage.paging import Keys, between, ordered
from storage.tables.findings import EstimateRow, IdentificationRow
from storage.tables.measurements import RunRow


class IdentificationUnknown(Missing):
    """Raised when no identification has this id."""

    subject = "identification"


@dataclass(frozen=True)
class Origin:
    """The inputs of an identification: machine revision, job, runs and options.

    load_balance: version of the balance of loads on oil films by which it was computed, see the table.
    """

    machine_id: str
    revision: int
    job_id: int
    scope: str
    run_kind: str
    run_ids: list[int]
    measured_at: int
    options: dict[str, Any]
    code_version: str
    slow_roll_version: int | None = None
    conditions: dict[str, float | None] | None = None
    load_balance: int | None = None


@dataclass(frozen=True)
class ComparisonGroup:
    """Conditions under which identifications are comparable: one of these machine revisions, kind of run, slow-roll vectors.

    since: measured at that time or later [ns]. load_balance: version of the balance of loads on oil films, see the table.
    """

    revisions: tuple[int, ...]
    run_kind: str
    slow_roll_version: int | None = None
    since: int = 0
    load_balance: int | None = None


def add(session: Session, origin: Origin, result: Identification) -> IdentificationRow:
    """Store an identification with all its estimates."""
    row = IdentificationRow(
        machine_id=origin.machine_id,
        revision=origin.revision,
        job_id=origin.job_id,
        scope=origin.scope,
        run_kind=origin.run_kind,
        run_ids=origin.run_ids,
        measured_at=origin.measured_at,
        computed_at=now(),
        accepted=result.accepted,
        verdict=result.verdict,
        chi_square=result.chi_square,
        degrees_of_freedom=result.degrees_of_freedom,
        condition_number=result.condition_number,
        samples=result.samples,
        speed_minimum=result.speed_minimum,
        speed_maximum=result.speed_maximum,
        starts=result.starts,
        iterations=result.iterations,
        options=origin.options,
        code_version=origin.code_version,
        slow_roll_version=origin.slow_roll_version,
        load_balance=origin.load_balance,
        conditions=origin.conditions,
        channel_effects=None if result.channel_effects is None else channel_effects.encode(result.channel_effects),
        coordinates=list(result.coordinates),
        covariance=result.covariance.astype("<f8").tobytes(),
        noise_relative=result.noise.relative,
        noise_floor=result.noise.floor,
        outliers=result.outliers,
        point=result.point.astype("<f8").tobytes(),
    )
    session.add(row)
    session.flush()
    estimates_of = [
        {
            "identification_id": row.id,
            "parameter": estimate.name,
            "machine_id": origin.machine_id,
            "measured_at": origin.measured_at,
            "quantity": estimate.quantity,
            "element": estimate.element,
            "unit": estimate.unit,
            "value": estimate.value,
            "standard_error": estimate.standard_error,
            "lower": estimate.lower,
            "upper": estimate.upper,
            "imaginary": estimate.imaginary,
            "imaginary_standard_error": estimate.imaginary_standard_error,
            "reason": estimate.reason,
        }
        for estimate in result.estimates
    ]
    if estimates_of:  # many at once: as objects of the session they would cost several times as much within the writer's turn
        session.execute(insert(EstimateRow), estimates_of)
    return row


def of_job(session: Session, job_id: int) -> int | None:
    """Return the id of the identification that a job has produced; None while there is none."""
    return session.scalar(select(IdentificationRow.id).where(IdentificationRow.job_id == job_id))


def get(session: Session, identification_id: int) -> IdentificationRow:
    """Return an identification with its covariance. Raises IdentificationUnknown."""
    row = session.get(IdentificationRow, identification_id, options=[undefer(IdentificationRow.covariance)])
    if row is None:
        raise IdentificationUnknown(identification_id)
    return row


def estimates(session: Session, identification_id: int) -> Sequence[EstimateRow]:
    """Return all estimates of one identification, in the order of the machine's document."""
    query = select(EstimateRow).where(EstimateRow.identification_id == identification_id)
    order = {name.removesuffix(".real"): i for i, name in enumerate(get(session, identification_id).coordinates)}
    return sorted(session.scalars(query).all(), key=lambda row: order.get(row.parameter, len(order)))


def covariance(row: IdentificationRow) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """Return the covariance matrix over `row.coordinates`; direct terms as logarithms, else SI."""
    size = len(row.coordinates)
    return np.frombuffer(row.covariance, "<f8").reshape(size, size)


def point(session: Session, identification_id: int) -> np.ndarray[tuple[int], np.dtype[np.float64]] | None:
    """Return the values over the row's coordinates, as `Identification.point`; None for an identification by an older release.

    Raises IdentificationUnknown.
    """
    row = session.get(IdentificationRow, identification_id, options=[undefer(IdentificationRow.point)])
    if row is None:
        raise IdentificationUnknown(identification_id)
    return None if row.point is None else np.frombuffer(row.point, "<f8")


def effects(session: Session, identification_id: int) -> ChannelEffects | None:
    """Return the effects of channels' errors on an identification; None for one by an older release.

    Raises IdentificationUnknown.
    """
    row = session.get(IdentificationRow, identification_id, options=[undefer(IdentificationRow.channel_effects)])
    if row is None:
        raise IdentificationUnknown(identification_id)
    return None if row.channel_effects is None else channel_effects.decode(row.channel_effects)


def of_machine(
    session: Session,
    machine_id: str,
    *,
    first: int | None = None,
    last: int | None = None,
    limit: int | None = None,
    after: Keys | None = None,
) -> Sequence[IdentificationRow]:
    """Return the identifications of a machine measured between two times [ns], newest first.

    after: (time, id) of the last one of the page before.
    """
    query = select(IdentificationRow).where(IdentificationRow.machine_id == machine_id)
    query = ordered(query, (IdentificationRow.measured_at, IdentificationRow.id), after)
    query = between(query, IdentificationRow.measured_at, first, last)
    return session.scalars(query.limit(limit)).all()


def first_accepted(session: Session, machine_id: str, like: ComparisonGroup, *, limit: int) -> Sequence[IdentificationRow]:
    """Return the first accepted identifications of single runs that meet `like`, oldest first."""
    query = _accepted_runs(machine_id, like)
    return session.scalars(query.order_by(IdentificationRow.measured_at, IdentificationRow.id).limit(limit)).all()


def first_of(session: Session, machine_id: str, *, revision: int, slow_roll_version: int | None) -> IdentificationRow | None:
    """Return the first accepted identification of a single run of any kind, under a revision and slow-roll version."""
    query = select(IdentificationRow).where(
        IdentificationRow.machine_id == machine_id,
        IdentificationRow.revision == revision,
        IdentificationRow.slow_roll_version == slow_roll_version,
        IdentificationRow.scope == RUN,
        IdentificationRow.accepted,
        IdentificationRow.point.is_not(None),
    )
    query = query.order_by(IdentificationRow.measured_at, IdentificationRow.id).limit(1)
    return session.scalars(query.options(undefer(IdentificationRow.point))).one_or_none()


def newest(
    session: Session, machine_id: str, like: ComparisonGroup, *, limit: int, last: int | None = None, accepted: bool = True
) -> Sequence[IdentificationRow]:
    """Return the newest identifications of single runs that meet `like`, measured up to a time [ns], newest first.

    accepted: only accepted ones; otherwise the refused ones as well.
    """
    query = _accepted_runs(machine_id, like) if accepted else _runs(machine_id, like)
    if last is not None:
        query = query.where(IdentificationRow.measured_at <= last)
    order = (IdentificationRow.measured_at.desc(), IdentificationRow.id.desc())
    return session.scalars(query.order_by(*order).limit(limit)).all()


def newest_of_single_run(
    session: Session, machine_id: str, *, accepted: bool = True, last: int | None = None
) -> IdentificationRow | None:
    """Return the newest identification of a single run of any kind, see `counting`.

    accepted: only accepted ones. last: measured up to this time [ns].
    """
    query = select(IdentificationRow).where(IdentificationRow.machine_id == machine_id, IdentificationRow.scope == RUN)
    latest = now() + TOLERANCE if last is None else min(last, now() + TOLERANCE)
    query = query.where(IdentificationRow.id.in_(counted_ids(machine_id)), IdentificationRow.measured_at <= latest)
    if accepted:
        query = query.where(IdentificationRow.accepted)
    order = (IdentificationRow.measured_at.desc(), IdentificationRow.id.desc())
    return session.scalars(query.order_by(*order).limit(1)).one_or_none()


def accepted_flags(session: Session, machine_id: str, *, first: int, last: int) -> Sequence[bool]:
    """Return for each identification of a machine measured between two times [ns] whether it was accepted."""
    query = select(IdentificationRow.accepted).where(IdentificationRow.machine_id == machine_id)
    return session.scalars(between(query, IdentificationRow.measured_at, first, last)).all()


def is_newest(session: Session, row: IdentificationRow) -> bool:
    """Return whether no single run of the same kind was measured later, and this one not in the future."""
    latest = now() + TOLERANCE
    query = select(IdentificationRow.id).where(IdentificationRow.machine_id == row.machine_id, IdentificationRow.scope == RUN)
    query = query.where(IdentificationRow.run_kind == row.run_kind, IdentificationRow.id.in_(counted_ids(row.machine_id)))
    query = query.where(IdentificationRow.measured_at > row.measured_at, IdentificationRow.measured_at <= latest)
    return row.measured_at <= latest and session.scalars(query.limit(1)).first() is None


def accepted_among(
    session: Session, machine_id: str, like: ComparisonGroup, ids: Sequence[int]
) -> Sequence[IdentificationRow]:
    """Return the accepted ones of some identifications that meet `like`, whenever they were measured, oldest first.

    Where a run was identified again, the identification that counts now is returned.
    """
    query = _of_same_runs(_accepted_runs(machine_id, replace(like, since=0)), ids)
    return session.scalars(query.order_by(IdentificationRow.measured_at, IdentificationRow.id)).all()


def counted_ids(machine_id: str) -> Select[int]:
    """Return a query for the ids of the identifications that trends, baselines and alerts use.

    A run may be identified again: after late samples, or with other slow-roll vectors in force. Among a run's identifications
    with the usual options (scope RUN, not VARIANT) the newest accepted one counts or, without any accepted one, the newest.
    The others stay readable. Identifications of a run that was discarded since, because late samples joined it to another run,
    do not count.
    """
    gone = select(RunRow.id).where(RunRow.machine_id == machine_id, RunRow.state == DISCARDED)
    newest = func.row_number().over(
        partition_by=(IdentificationRow.scope, cast(IdentificationRow.run_ids, Text)),
        order_by=(IdentificationRow.accepted.desc(), IdentificationRow.id.desc()),
    )
    of_machine = select(IdentificationRow.id, newest.label("place")).where(IdentificationRow.machine_id == machine_id)
    of_one_gone = (IdentificationRow.scope != GATHERED) & IdentificationRow.run_ids[0].as_integer().in_(gone)
    ranked = of_machine.where(~of_one_gone).subquery()
    return select(ranked.c.id).where(ranked.c.place == 1)


def _accepted_runs(machine_id: str, like: ComparisonGroup) -> Select[IdentificationRow]:
    return _runs(machine_id, like).where(IdentificationRow.accepted)


def _of_same_runs(query: Select[IdentificationRow], ids: Sequence[int]) -> Select[IdentificationRow]:
    """Return a query for those identifications that are of the same runs as some."""
    same_runs = select(cast(IdentificationRow.run_ids, Text)).where(IdentificationRow.id.in_(ids))
    return query.where(cast(IdentificationRow.run_ids, Text).in_(same_runs))


def balanced_otherwise(session: Session, machine_id: str, like: ComparisonGroup, *, among: Sequence[int] | None = None) -> int:
    """Return how many accepted identifications would meet `like` but for the balance of loads on oil films.

    among: ids of the only ones that count, whenever they were measured, see `accepted_among`; None: all.
    """
    query = _runs_of_any_balance(machine_id, like if among is None else replace(like, since=0))
    query = query if among is None else _of_same_runs(query, among)
    other = query.where(IdentificationRow.accepted, IdentificationRow.load_balance.is_distinct_from(like.load_balance))
    return session.scalar(select(func.count()).select_from(other.with_only_columns(IdentificationRow.id).subquery())) or 0


def _runs(machine_id: str, like: ComparisonGroup) -> Select[IdentificationRow]:
    """Return a query for single runs that meet `like`."""
    return _runs_of_any_balance(machine_id, like).where(IdentificationRow.load_balance == like.load_balance)


def _runs_of_any_balance(machine_id: str, like: ComparisonGroup) -> Select[IdentificationRow]:
    """Return a query for single runs that meet `like` but for their balance of loads on oil films.

    Runs that a wrong clock dated in the future are left out: one of these would remain the newest until that time comes.
    """
    return (
        select(IdentificationRow)
        .where(IdentificationRow.machine_id == machine_id, IdentificationRow.revision.in_(like.revisions))
        .where(IdentificationRow.measured_at >= like.since, IdentificationRow.measured_at <= now() + TOLERANCE)
        .where(IdentificationRow.scope == RUN, IdentificationRow.run_kind == like.run_kind)
        .where(IdentificationRow.slow_roll_version == like.slow_roll_version)
        .where(IdentificationRow.id.in_(counted_ids(machine_id)))
        .options(undefer(IdentificationRow.covariance), undefer(IdentificationRow.point))
        .options(undefer(IdentificationRow.channel_effects))
    )


def fit(row: IdentificationRow) -> ObservedFit | None:
    """Return the fit of an identification for comparison; None for an identification by an older release."""
    if row.point is None or row.channel_effects is None:
        return None
    effects = channel_effects.decode(row.channel_effects)
    point, covariances = effects.estimate(np.frombuffer(row.point, "<f8"), covariance(row))
    return ObservedFit(
        coordinates=tuple(row.coordinates),
        point=point,
        covariance=covariances,
        effects=effects,
        accepted=row.accepted,
        chi_square=row.chi_square,
        degrees_of_freedom=row.degrees_of_freedom,
        samples=row.samples,
        outliers=row.outliers or {},
    )


def points(session: Session, rows: Sequence[IdentificationRow]) -> dict[int, Point]:
    """Return per identification all coordinates that the data determined, with covariance; direct terms as logarithms, else
    SI."""
    whole = [row for row in rows if row.point is not None]
    found = _estimated(session, [row for row in rows if row.point is None])
    unknown: dict[int, set[str]] = {row.id: set() for row in whole}
    left_open = select(EstimateRow.identification_id, EstimateRow.parameter).where(EstimateRow.value.is_(None))
    for number, parameter in session.execute(left_open.where(EstimateRow.identification_id.in_(unknown))):
        unknown[number] |= {parameter, f"{parameter}.real", f"{parameter}.imaginary"}
    for row in whole:
        values = zip(row.coordinates, np.frombuffer(row.point or b"", "<f8").tolist(), strict=True)
        found[row.id] = {name: value for name, value in values if name not in unknown[row.id]}
    return {row.id: _point(row, found[row.id]) for row in rows}


def _estimated(session: Session, rows: Sequence[IdentificationRow]) -> dict[int, dict[str, float]]:
    """Return the coordinates from the estimates, for identifications by older releases, which did not store their points."""
    found: dict[int, dict[str, float]] = {row.id: {} for row in rows}
    wanted = (EstimateRow.identification_id, EstimateRow.parameter, EstimateRow.value, EstimateRow.imaginary)
    query = select(*wanted).where(EstimateRow.identification_id.in_(found), EstimateRow.value.is_not(None))
    for number, parameter, value, imaginary in session.execute(query) if found else ():
        if value is None:
            continue
        if imaginary is not None:
            found[number] |= {f"{parameter}.real": value, f"{parameter}.imaginary": imaginary}
        else:
            found[number][parameter] = math.log(value) if is_direct(parameter) else value
    return found


def _point(row: IdentificationRow, values: dict[str, float]) -> Point:
    names = [name for name in row.coordinates if name in values]
    index = [row.coordinates.index(name) for name in names]
    return Point(tuple(names), np.array([values[name] for name in names]), covariance(row)[np.ix_(index, index)].copy())
