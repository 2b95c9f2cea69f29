"""Limits of machines: the sizes at which a finding becomes an alert or a danger."""

import re

from fastapi import APIRouter, Request, Response

from service.api.conventions.dependencies import MachineId, Reading, database
from service.api.conventions.paging import ById
from service.api.conventions.preconditions import ANYTHING, IfMatch, PreconditionMissing
from service.api.conventions.problems import RESPONSES
from service.api.machines.limit_schemas import LimitsIn, LimitsOut
from service.monitoring.limits_in_force import LimitsChanged, set_limits
from service.monitoring.rules.limits import Limits
from service.security.requirement import OPERATOR, VIEWER
from storage.clock import to_datetime
from storage.machines import limits, machines
from storage.tables.machines import LimitsRow

router = APIRouter(tags=["limits"], responses=RESPONSES, dependencies=[VIEWER])


@router.get("/machines/{machine_id}/limits", operation_id="read_limits")
def read_limits(session: Reading, response: Response, machine_id: MachineId) -> LimitsOut:
    """Read the limits in force: the defaults, version 0, until a person sets some."""
    machines.get(session, machine_id)
    found = _rendered(machine_id, limits.in_force(session, machine_id))
    response.headers["ETag"] = f'"{found.version}"'
    return found


@router.put("/machines/{machine_id}/limits", operation_id="set_limits", dependencies=[OPERATOR])
def replace_limits(
    request: Request, response: Response, machine_id: MachineId, body: LimitsIn, if_match: IfMatch = None
) -> LimitsOut:
    """Put new limits in force; earlier versions stay readable. The next identification is assessed by them."""
    expected = _expected(if_match)
    with database(request).transaction() as session:
        row = set_limits(session, machine_id, body.limits, by=body.by, comment=body.comment, expected=expected)
        found = _rendered(machine_id, row)
    response.headers["ETag"] = f'"{found.version}"'
    return found


@router.get("/machines/{machine_id}/limits/versions", operation_id="list_limits")
def list_limits(session: Reading, machine_id: MachineId, paging: ById) -> list[LimitsOut]:
    """List all versions that people have set, newest first."""
    machines.get(session, machine_id)
    rows = limits.versions(session, machine_id, limit=paging.wanted, after=paging.after)
    return [_rendered(machine_id, row) for row in paging.page(rows, lambda row: (row.version,))]


def _expected(if_match: str | None) -> int | None:
    """Return the version that the client has read; None for any."""
    if if_match is None:
        raise PreconditionMissing("say with If-Match which limits are to be replaced: the ETag of those that were read, or *")
    if if_match.strip() == ANYTHING:
        return None
    number = re.fullmatch(r'"([0-9]{1,18})"', if_match.strip())
    if number is None:
        raise LimitsChanged(f"If-Match is {if_match[:40]}: it must be the ETag that the limits were read with")
    return int(number[1])


def _rendered(machine_id: str, row: LimitsRow | None) -> LimitsOut:
    if row is None:
        return LimitsOut(machine=machine_id, version=0, limits=Limits(), set_at=None, by=None, comment=None)
    return LimitsOut(
        machine=machine_id,
        version=row.version,
        limits=Limits.model_validate(row.document),
        set_at=to_datetime(row.at),
        by=row.by,
        comment=row.comment,
    )
