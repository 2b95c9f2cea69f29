"""Alerts."""

from typing import Annotated

from fastapi import APIRouter, Query

from service.api import rendering, schemas
from service.api.access import Limit, MachineId, Number, Reading
from service.api.problems import RESPONSES
from storage import alerts, machines

router = APIRouter(tags=["alerts"], responses=RESPONSES)

OnlyOpen = Annotated[bool, Query(alias="open", description="only alerts that are still open")]


@router.get("/alerts", operation_id="list_alerts")
def list_alerts(session: Reading, only_open: OnlyOpen = False, limit: Limit = 100) -> list[schemas.AlertOut]:
    """Alerts of all machines, newest first."""
    rows = alerts.find(session, machine_id=None, only_open=only_open, limit=limit)
    return [rendering.alert(row) for row in rows]


@router.get("/alerts/{alert_id}", operation_id="read_alert")
def read_alert(session: Reading, alert_id: Number) -> schemas.AlertOut:
    """One alert with its evidence."""
    return rendering.alert(alerts.get(session, alert_id))


@router.get("/machines/{machine_id}/alerts", operation_id="list_machine_alerts")
def list_machine_alerts(
    session: Reading, machine_id: MachineId, only_open: OnlyOpen = False, limit: Limit = 100
) -> list[schemas.AlertOut]:
    """Alerts of one machine, newest first."""
    machines.get(session, machine_id)
    rows = alerts.find(session, machine_id=machine_id, only_open=only_open, limit=limit)
    return [rendering.alert(row) for row in rows]
