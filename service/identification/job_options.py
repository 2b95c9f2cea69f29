"""Options of an identification job, and their meaning when it is computed.

A job without options is the usual one. It subtracts the slow-roll vectors in force when it is taken; their version is then
stored with the job, so that a repetition after a crash subtracts the same.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Literal

from msgspec.structs import asdict, replace
from sqlalchemy.orm import Session

from estimator.errors import Conflict
from estimator.fit.identification import Options
from estimator.machine.rules import QualityRules
from service.identification.job_quota import LONGEST_IDENTITY, JobQuota
from storage.findings import jobs
from storage.findings.job_order import ASKED
from storage.machines import machines, slow_roll
from storage.measurements import runs
from storage.tables.findings import JobRow

SlowRollChoice = Literal["none", "in_force"] | int
"""Choice of slow-roll vectors: none, those in force, or a version."""

RULES = tuple(QualityRules.model_fields)
"""Names of the options that determine which samples of a run are left out."""
_VERSION, _AGAIN = "slow_roll_version", "again"
OPEN_ERRORS = "open_errors"
"""Option that names the errors which estimates leave open, see `Options`."""


class NotIdentifiable(Conflict):
    """The run cannot be identified; the message states the reason."""


@dataclass(frozen=True)
class Request:
    """A person's request for an identification of one run. Options that are None stay as usual."""

    slow_roll: SlowRollChoice = "in_force"
    starts: int | None = None
    seed: int | None = None
    robust: bool | None = None
    sweep_rate: bool | None = None
    half_power: bool | None = None
    accepted_rpm: tuple[float, float] | None = None


@dataclass(frozen=True)
class Requester:
    """The person who requests. identity: unambiguous; quota: quota of waiting jobs; priority: priority of one identification,
    or of many at once."""

    identity: str
    quota: JobQuota = field(default_factory=JobQuota)
    priority: int = ASKED


def request_identification(session: Session, run_id: int, request: Request, requester: Requester) -> JobRow:
    """Queue an identification of a closed run, or of dwells; return the job that is already waiting for the same, if any.

    With the usual options the result replaces the earlier one in trends and baselines, otherwise it stands beside them; that
    of dwells always does. Raises RunUnknown, NotIdentifiable, SlowRollUnknown, QuotaExceeded.
    """
    run = runs.get(session, run_id)
    if run.state != runs.CLOSED and not runs.is_dwells(run):
        raise NotIdentifiable(f"run {run_id} is {run.state}; only closed runs are identified")
    if run.released_at is not None:
        raise NotIdentifiable(f"run {run_id} no longer has its samples, as the retention of runs says")
    version = chosen_version(session, run.machine_id, request.slow_roll)
    usual = asdict(Options())
    fit = {name: value for name in usual if (value := getattr(request, name, None)) is not None and value != usual[name]}
    rules = machines.document(session, run.machine_id, run.revision).quality
    fit |= {name: value for name in RULES if (value := getattr(request, name)) is not None and value != getattr(rules, name)}
    in_force = machines.get(session, run.machine_id).slow_roll_version
    scope = jobs.VARIANT if fit or version != in_force or runs.is_dwells(run) else jobs.RUN
    options: dict[str, Any] = {**fit, _VERSION: version}

    def repeated(again: int) -> dict[str, Any]:
        return options | ({_AGAIN: again} if again else {})

    def find_repetition(again: int) -> JobRow | None:
        return jobs.find_request(session, scope=scope, run_ids=[run_id], options=repeated(again))

    again = _first_missing(lambda number: find_repetition(number) is not None)
    newest = find_repetition(again - 1) if again else None
    if newest is not None and newest.state in (jobs.QUEUED, jobs.RUNNING):
        return newest
    by = requester.identity[:LONGEST_IDENTITY]
    requester.quota.require(session, by=by, machine_id=run.machine_id)
    queued = jobs.enqueue(
        session,
        run.machine_id,
        scope=scope,
        run_ids=[run_id],
        options=repeated(again),
        asked_by=by,
        priority=requester.priority,
    )
    assert queued is not None
    return queued


def _first_missing(there: Callable[[int], bool]) -> int:
    """Return the first free number behind contiguous ones from 0 on, in O(log n) look-ups."""
    beyond = 1
    if not there(0):
        return 0
    while there(beyond):
        beyond *= 2
    first, last = beyond // 2, beyond  # the one is there, the other not
    while last - first > 1:
        middle = (first + last) // 2
        first, last = (middle, last) if there(middle) else (first, middle)
    return last


def chosen_version(session: Session, machine_id: str, choice: SlowRollChoice) -> int | None:
    """Return the version that a choice means now; None for no vectors. Raises MachineUnknown, SlowRollUnknown."""
    if choice == "none":
        return None
    if choice == "in_force":
        return machines.get(session, machine_id).slow_roll_version
    return slow_roll.get(session, machine_id, choice).version


def slow_roll_version(session: Session, row: JobRow) -> int | None:
    """Return the version that a job subtracts, stored with it the first time."""
    options = row.options or {}
    if _VERSION not in options:
        options = {**options, _VERSION: machines.get(session, row.machine_id).slow_roll_version}
        row.options = options
    version: int | None = options[_VERSION]
    return version


def quality_rules(row: JobRow, usual: QualityRules) -> QualityRules:
    """Return the rules by which a job leaves out samples. usual: the document's rules."""
    asked = row.options or {}
    return QualityRules.model_validate(usual.model_dump() | {name: asked[name] for name in RULES if name in asked})


def fit_options(row: JobRow, usual: Options) -> Options:
    """Return the options of a job's fit."""
    asked = row.options or {}
    chosen = {name: asked[name] for name in asdict(usual) if name in asked}
    return replace(usual, **chosen | {OPEN_ERRORS: tuple(asked.get(OPEN_ERRORS, ()))})


def described_options(row: JobRow, usual: Options) -> dict[str, Any]:
    """Return the options of a job's fit as they are stored with its identification."""
    said = asdict(fit_options(row, usual))
    del said["explain"]
    return said if said[OPEN_ERRORS] else {name: value for name, value in said.items() if name != OPEN_ERRORS}
