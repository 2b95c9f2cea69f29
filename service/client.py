"""A typed client of the REST API: it returns the same models that the service answers with.

with Rundown("http://localhost:8080") as rundown:
    for alert in rundown.alerts(only_open=True):
        rundown.acknowledge(alert, by="anna", comment="on it")
"""

import json
import time
import uuid
from collections.abc import Iterator, Mapping
from datetime import datetime
from types import TracebackType
from typing import Any, Self, TypeVar

import httpx
from pydantic import BaseModel

from estimator.machine.document import Machine
from service.alerts.event_message import AlertEvent
from service.api.alerts.schemas import AlertOut
from service.api.findings.deviation_schemas import DeviationsOut
from service.api.findings.model_schemas import Bode, CriticalSpeeds
from service.api.findings.schemas import IdentificationDetail, IdentificationSummary
from service.api.machines.fleet import FleetMachine
from service.api.machines.machine_state import MachineState
from service.api.machines.schemas import MachineRevision, MachineSummary
from service.api.machines.timeline_schemas import TimelineOut
from service.api.measurements.schemas import Phasors, Run
from service.api.trends.routes import Trends
from service.http.problem import Problem

M = TypeVar("M", bound=BaseModel)

PREFIX = "/api/v1"
TRIES = 3
"""Attempts of a request that got no answer, all under one Idempotency-Key."""
PAUSE_S = 0.5
PASSING = {429, 502, 503, 504}
"""Statuses of temporary failures, of the service or of a proxy in front of it."""


class Refused(Exception):
    """The service refused a request; `problem` says what is wrong."""

    def __init__(self, problem: Problem) -> None:
        fields = "; ".join(f"{one.field}: {one.message}" for one in problem.errors)
        super().__init__(f"{problem.status} {problem.title}: {problem.detail}{f' ({fields})' if fields else ''}")
        self.problem = problem


class ChangedMeanwhile(Exception):
    """The object was changed since it was read."""


class Rundown:
    """Client of the service at an address. key: an API key or a token; http: another client to use, such as one with proxy."""

    def __init__(
        self, url: str = "http://127.0.0.1:8080", *, key: str | None = None, http: httpx.Client | None = None
    ) -> None:
        self._http = http or httpx.Client(base_url=url, timeout=30.0)
        if key is not None:
            self._http.headers["Authorization"] = f"Bearer {key}"

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self._http.close()

    # --- machines

    def machines(self) -> Iterator[MachineSummary]:
        """Yield all machines, by id."""
        return self._items(MachineSummary, "/machines")

    def machine(self, machine: str) -> MachineRevision:
        """Return a machine's document in force."""
        return self._get(MachineRevision, f"/machines/{machine}")

    def create_machine(self, document: Machine) -> MachineRevision:
        """Create a machine from its document."""
        return self._post(MachineRevision, "/machines", document.model_dump(mode="json"))

    def revise_machine(self, read: MachineRevision, document: Machine) -> MachineRevision:
        """Replace the document that was read by another one. Raises ChangedMeanwhile."""
        path = f"/machines/{read.id}"
        headers = {"If-Match": self._tag(path, read)}
        body = document.model_dump(mode="json")
        try:
            return self._model(MachineRevision, self._request("PUT", path, json=body, headers=headers))
        except ChangedMeanwhile:
            there = self.machine(read.id)
            if there.document != document:
                raise
            return there  # it was replaced, and the answer was lost on the way

    def fleet(self, *, since: datetime | None = None) -> Iterator[FleetMachine]:
        """Yield every machine's overview, with the counts of events since a time, by default a day ago."""
        for part in self._parts("/fleet", {} if since is None else {"since": since.isoformat()}):
            yield from (FleetMachine.model_validate(one) for one in part["machines"])

    def state(self, machine: str) -> MachineState:
        """Return a machine's operating state."""
        return self._get(MachineState, f"/machines/{machine}/state")

    # --- runs and identifications

    def runs(self, machine: str, *, first: datetime | None = None, last: datetime | None = None) -> Iterator[Run]:
        """Yield runs that began in a time range, newest first."""
        return self._items(Run, f"/machines/{machine}/runs", _period(first, last))

    def phasors(self, run: int) -> Phasors:
        """Return a run's 1× phasors."""
        return self._get(Phasors, f"/runs/{run}/phasors")

    def identifications(
        self, machine: str, *, first: datetime | None = None, last: datetime | None = None
    ) -> Iterator[IdentificationSummary]:
        """Yield identifications measured in a time range, newest first."""
        return self._items(IdentificationSummary, f"/machines/{machine}/identifications", _period(first, last))

    def identification(self, number: int) -> IdentificationDetail:
        """Return one identification with its estimates."""
        return self._get(IdentificationDetail, f"/identifications/{number}")

    def bode(self, identification: int, *, units: str = "rpm,um_pp,deg_lag") -> Bode:
        """Return the fitted curve, measured points and residuals."""
        return self._get(Bode, f"/identifications/{identification}/bode", {"units": units})

    def critical_speeds(self, identification: int, *, units: str = "rpm") -> CriticalSpeeds:
        """Return the critical speeds of the updated model."""
        path = f"/identifications/{identification}/model/critical-speeds"
        return self._get(CriticalSpeeds, path, {"units": units})

    def trends(
        self, machine: str, *parameters: str, first: datetime | None = None, last: datetime | None = None, most: int = 5000
    ) -> Trends:
        """Return histories of parameters and derived quantities, each of at most `most` points."""
        asked = {"parameter": list(parameters), "max_points": most} | _period(first, last)
        return self._get(Trends, f"/machines/{machine}/trends", asked)

    def deviations(self, machine: str) -> DeviationsOut:
        """Return the deviations of the newest identification from the baseline."""
        return self._get(DeviationsOut, f"/machines/{machine}/deviations")

    # --- alerts

    def alerts(self, *, machine: str | None = None, only_open: bool = False) -> Iterator[AlertOut]:
        """Yield alerts, newest first."""
        path = "/alerts" if machine is None else f"/machines/{machine}/alerts"
        return self._items(AlertOut, path, {"open": only_open})

    def acknowledge(self, read: AlertOut, *, by: str, comment: str = "") -> AlertOut:
        """Acknowledge an alert, unless it was changed since it was read. Raises ChangedMeanwhile."""
        path = f"/alerts/{read.id}"
        headers = {"If-Match": self._tag(path, read)}
        return self._post(AlertOut, f"{path}/acknowledge", {"by": by, "comment": comment}, headers)

    def note(self, machine: str, text: str, *, by: str, at: datetime, kind: str = "note") -> TimelineOut:
        """Add a note, a marker or a maintenance to a machine's timeline."""
        body = {"text": text, "by": by, "at": at.isoformat(), "kind": kind}
        return self._post(TimelineOut, f"/machines/{machine}/timeline", body)

    def events(self, *, after: int | None = None) -> Iterator[AlertEvent]:
        """Yield alert events without end: from now on, or behind an event; reconnects when the stream breaks off."""
        while True:
            try:
                for number, event in self._stream(after):
                    if event is not None:
                        yield event
                    after = number
            except httpx.TransportError:
                pass
            except (Refused, httpx.HTTPStatusError) as error:
                if _status(error) not in PASSING:
                    raise
            time.sleep(PAUSE_S)

    # --- requests

    def _stream(self, after: int | None) -> Iterator[tuple[int, AlertEvent | None]]:
        """Yield events with their numbers; first the number behind which the stream begins."""
        headers = {} if after is None else {"Last-Event-ID": str(after)}
        patience = httpx.Timeout(30.0, read=60.0)
        with self._http.stream("GET", f"{PREFIX}/alert-events/stream", headers=headers, timeout=patience) as answer:
            if answer.is_error:
                answer.read()
                raise _refused(answer)
            number: int | None = None
            event: AlertEvent | None = None
            for line in answer.iter_lines():
                if line.startswith("id: "):
                    number = int(line[4:])
                elif line.startswith("data: "):
                    event = AlertEvent.model_validate_json(line[6:])
                elif not line and number is not None:
                    yield number, event
                    number = event = None

    def _tag(self, path: str, read: BaseModel) -> str:
        answer = self._request("GET", path)
        if type(read).model_validate_json(answer.content) != read:
            raise ChangedMeanwhile(f"{path} was changed since it was read: read it again")
        return answer.headers["etag"]

    def _get(self, model: type[M], path: str, asked: Mapping[str, Any] | None = None) -> M:
        return self._model(model, self._request("GET", path, params=asked))

    def _post(self, model: type[M], path: str, body: Any, headers: Mapping[str, str] | None = None) -> M:
        keyed = {"Idempotency-Key": str(uuid.uuid4())} | dict(headers or {})
        return self._model(model, self._request("POST", path, json=body, headers=keyed))

    def _items(self, model: type[M], path: str, asked: Mapping[str, Any] | None = None) -> Iterator[M]:
        for part in self._parts(path, asked or {}):
            yield from (model.model_validate(one) for one in part)

    def _parts(self, path: str, asked: Mapping[str, Any]) -> Iterator[Any]:
        answer = self._request("GET", path, params=asked)
        while True:
            yield json.loads(answer.content)
            following = answer.links.get("next")
            if following is None:
                return
            answer = self._request("GET", following["url"].removeprefix(PREFIX))

    def _model(self, model: type[M], answer: httpx.Response) -> M:
        return model.model_validate_json(answer.content)

    def _request(self, method: str, path: str, **how: Any) -> httpx.Response:
        for left in reversed(range(TRIES)):
            try:
                answer = self._http.request(method, PREFIX + path, **how)
            except httpx.TransportError:
                if not left:
                    raise
                time.sleep(PAUSE_S)
                continue
            if answer.status_code == httpx.codes.CONFLICT and "retry-after" in answer.headers and left:
                time.sleep(PAUSE_S)  # the first attempt is still under way
                continue
            if answer.status_code == httpx.codes.PRECONDITION_FAILED:
                raise ChangedMeanwhile(f"{path} was changed since it was read: read it again")
            if answer.is_error:
                raise _refused(answer)
            return answer
        raise AssertionError("a try returns or raises")


def _status(error: Refused | httpx.HTTPStatusError) -> int:
    return error.problem.status if isinstance(error, Refused) else error.response.status_code


def _refused(answer: httpx.Response) -> Exception:
    try:
        return Refused(Problem.model_validate_json(answer.content))
    except ValueError:  # the answer is not the service's, perhaps a proxy's
        return httpx.HTTPStatusError(f"{answer.status_code} {answer.text[:200]}", request=answer.request, response=answer)


def _period(first: datetime | None, last: datetime | None) -> dict[str, str]:
    return {name: moment.isoformat() for name, moment in {"from": first, "to": last}.items() if moment is not None}
