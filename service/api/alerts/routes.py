"""Alerts, the changes that people make to them, and their histories."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, cast

from fastapi import APIRouter, Query, Request, Response
from sqlalchemy.orm import Session

from service.advice.alert_advice import alert_event
from service.advice.site_texts import SiteTexts
from service.alerts import transitions
from service.alerts.event_message import AlertEvent
from service.alerts.lifecycle import Forbidden
from service.alerts.transitions import Person
from service.api.alerts import rendering, schemas
from service.api.cache.response_cache import Cached
from service.api.conventions.dependencies import MachineId, Number, Reading, database, instant
from service.api.conventions.paging import ById, ByTime, Paging
from service.api.conventions.preconditions import ANYTHING, IfMatch, Stale, require, tagged
from service.api.conventions.problems import CHANGES, RESPONSES
from service.api.conventions.reader_language import VARIES_BY_LANGUAGE, reader_language, vary_by_language
from service.security.requirement import ANALYST, OPERATOR, VIEWER
from service.wording.language import LANGUAGES
from storage.alerts import alerts
from storage.alerts.alerts import ListedAlert
from storage.clock import to_datetime
from storage.machines import machines
from storage.paging import Keys
from storage.tables.alerting import AlertRow

router = APIRouter(tags=["alerts"], responses=RESPONSES, dependencies=[VIEWER, VARIES_BY_LANGUAGE])
lists = APIRouter(tags=["alerts"], responses=RESPONSES, dependencies=[VIEWER])
"""Routes whose answers are cached, with their language in them: asked most often, they need no dependency for it."""

OnlyOpen = Annotated[bool, Query(alias="open", description="only alerts that are still open")]
After = Annotated[int, Query(ge=0, le=2**62, description="only events after this one")]


@lists.get("/alerts", operation_id="list_alerts", response_model=list[schemas.AlertOut])
async def list_alerts(request: Request, cache: Cached, paging: ByTime, only_open: OnlyOpen = False) -> Response:
    """List alerts of all machines, newest first."""

    def read() -> Response:
        with database(request).reading() as session:
            return _listed(request, session, paging, machine_id=None, only_open=only_open)

    return await cache.answer(request, ("alerts",), read, apart=reader_language(request))


@router.get("/alert-events", operation_id="list_alert_events")
def list_alert_events(request: Request, session: Reading, paging: ById, after: After = 0) -> list[AlertEvent]:
    """List the events of all alerts, oldest first; ask again with the last id for later ones."""
    begin = after if paging.after is None else int(paging.after[0])
    rows = alerts.events_after(session, begin, limit=paging.wanted)
    return [alert_event(row, _texts(request)) for row in paging.page(rows, lambda row: (row.id,))]


@router.get("/alerts/{alert_id}", operation_id="read_alert")
def read_alert(request: Request, session: Reading, response: Response, alert_id: Number) -> schemas.AlertOut:
    """Read one alert with its evidence, and the ETag that a change needs."""
    return tagged(response, rendering.alert(alerts.get(session, alert_id), _texts(request)))


@router.get("/alerts/{alert_id}/events", operation_id="list_events_of_alert")
def list_events_of_alert(request: Request, session: Reading, alert_id: Number, paging: ById) -> list[AlertEvent]:
    """List the events of one alert, oldest first."""
    alerts.get(session, alert_id)
    rows = alerts.history(session, alert_id, limit=paging.wanted, after=paging.after)
    return [alert_event(row, _texts(request)) for row in paging.page(rows, lambda row: (row.number,))]


@lists.get("/machines/{machine_id}/alerts", operation_id="list_machine_alerts", response_model=list[schemas.AlertOut])
async def list_machine_alerts(
    request: Request, cache: Cached, machine_id: MachineId, paging: ByTime, only_open: OnlyOpen = False
) -> Response:
    """List alerts of one machine, newest first."""

    def read() -> Response:
        with database(request).reading() as session:
            machines.get(session, machine_id)
            return _listed(request, session, paging, machine_id=machine_id, only_open=only_open)

    return await cache.answer(request, ("machines", "alerts"), read, apart=reader_language(request))


def _listed(request: Request, session: Session, paging: Paging, *, machine_id: str | None, only_open: bool) -> Response:
    texts = _texts(request)
    rows = alerts.find(session, machine_id=machine_id, only_open=only_open, limit=paging.wanted, after=paging.after)
    response = paging.json(_worded(request).all(paging.page(rows, _place), texts))
    vary_by_language(request, response)
    return response


@router.post("/alerts/{alert_id}/acknowledge", operation_id="acknowledge_alert", dependencies=[OPERATOR], responses=CHANGES)
def acknowledge_alert(
    request: Request, response: Response, alert_id: Number, body: schemas.By, if_match: IfMatch = None
) -> schemas.AlertOut:
    """Acknowledge an alert: a person has seen it."""
    change = AlertChange(request, response, alert_id, if_match)
    return change.apply(lambda session, row: transitions.acknowledge(session, row, _person(body)))


@router.post("/alerts/{alert_id}/reset", operation_id="reset_alert", dependencies=[OPERATOR], responses=CHANGES)
def reset_alert(
    request: Request, response: Response, alert_id: Number, body: schemas.By, if_match: IfMatch = None
) -> schemas.AlertOut:
    """Unlatch an acknowledged alert whose cause is gone."""
    change = AlertChange(request, response, alert_id, if_match)
    return change.apply(lambda session, row: transitions.reset(session, row, _person(body)))


@router.post("/alerts/{alert_id}/shelve", operation_id="shelve_alert", dependencies=[OPERATOR], responses=CHANGES)
def shelve_alert(
    request: Request, response: Response, alert_id: Number, body: schemas.Shelving, if_match: IfMatch = None
) -> schemas.AlertOut:
    """Shelve an alert until a moment: it notifies nobody, nor, unless `until_cleared`, when its cause returns before then."""
    until, once = instant(body.until), body.until_cleared
    change = AlertChange(request, response, alert_id, if_match)
    return change.apply(lambda session, row: transitions.shelve(session, row, _person(body), until=until, until_cleared=once))


@router.post("/alerts/{alert_id}/unshelve", operation_id="unshelve_alert", dependencies=[OPERATOR], responses=CHANGES)
def unshelve_alert(
    request: Request, response: Response, alert_id: Number, body: schemas.By, if_match: IfMatch = None
) -> schemas.AlertOut:
    """End a shelving before its time."""
    change = AlertChange(request, response, alert_id, if_match)
    return change.apply(lambda session, row: transitions.unshelve(session, row, _person(body)))


@router.post("/alerts/{alert_id}/comments", operation_id="comment_alert", dependencies=[ANALYST])
def comment_alert(request: Request, response: Response, alert_id: Number, body: schemas.Remark) -> schemas.AlertOut:
    """Add a comment to an alert, open or closed."""
    person = Person(body.by, body.comment)
    change = AlertChange(request, response, alert_id, ANYTHING)
    return change.apply(lambda session, row: transitions.comment(session, row, person))


@dataclass
class AlertChange:
    """A change of an alert under the ETag that the client has read; comments need none."""

    request: Request
    response: Response
    alert_id: int
    if_match: str | None

    def apply(self, change: Callable[[Session, AlertRow], None]) -> schemas.AlertOut:
        """Apply a change and return the alert. Raises AlertUnknown, PreconditionMissing, Stale and the change's errors."""
        with database(self.request).transaction() as session:
            row = alerts.get(session, self.alert_id, to_change=True)
            try:
                texts = _texts(self.request)
                # It was read in any language: the state is the same.
                require(self.if_match, *(rendering.alert(row, texts.in_language(one)) for one in LANGUAGES))
                change(session, row)
            except (Stale, Forbidden) as refused:
                raise type(refused)(f"{refused}; {_last_event_text(session, row)}") from refused
            return tagged(self.response, rendering.alert(row, _texts(self.request)))


def _last_event_text(session: Session, row: AlertRow) -> str:
    """Describe the alert's last event: people who act at the same time learn of each other."""
    last = alerts.last_event(session, row.id)
    kind, at = last.kind.replace("_", " "), to_datetime(last.at)
    return f"the last thing to happen to it: {kind} by {last.by}, {at:%Y-%m-%dT%H:%M:%SZ}"


def _texts(request: Request) -> SiteTexts:
    """Return the texts in the language of who asks."""
    return cast(SiteTexts, request.app.state.texts).in_language(reader_language(request))


def _worded(request: Request) -> rendering.RenderedAlertCache:
    return cast(rendering.RenderedAlertCache, request.app.state.worded_alerts)


def _place(row: ListedAlert) -> Keys:
    return row.opened_at, row.id


def _person(body: schemas.By) -> Person:
    return Person(body.by, body.comment)
