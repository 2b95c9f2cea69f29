"""Client of a running service: machines, runs, identifications, trends and alerts as rows, frames, and runs to identify."""

from datetime import datetime
from operator import index
from typing import Any, NoReturn, SupportsIndex
from urllib.parse import quote

import msgspec
from msgspec.structs import replace

from estimator.machine.document import Machine
from rotorundown.machine_files import read_machine
from rotorundown.runs import MachineRun, WrongRun, read_run
from rotorundown.service_requests import Requests, ServiceError
from rotorundown.service_rows import (
    AlertEntry,
    EstimateEntry,
    IdentificationEntry,
    MachineEntry,
    R,
    Rows,
    RunEntry,
    TrendPoint,
    rows_of,
)

MOST_POINTS = 5000
SERIES_COLUMNS = ("measured_at", "value", "lower", "upper", "quality", "run_kind", "identification")
"""Columns of a series that become those of its points."""


class Service:
    """A running service, for reading; `service.client.Rundown` also changes things.

    Nothing is asked before a method is called. Every method raises ServiceError where the service refuses or does not answer.

    Args:
        url: Address of the service.
        key: API key or token, where it asks for one.
    """

    def __init__(self, url: str = "http://localhost:8080", *, key: str | None = None) -> None:
        self._requests = Requests(url, key)

    def machines(self) -> Rows[MachineEntry]:
        """Return all machines, by id."""
        return self._rows(MachineEntry, "/machines")

    def machine(self, machine: str) -> Machine:
        """Return a machine, as its document in force describes it."""
        return read_machine(self._requests.read(f"/machines/{_id(machine)}")["document"])

    def runs(self, machine: str, *, first: datetime | None = None, last: datetime | None = None) -> Rows[RunEntry]:
        """Return the runs that began in a time range, newest first."""
        return self._rows(RunEntry, f"/machines/{_id(machine)}/runs", _period(first, last))

    def run(self, number: int, *, machine: Machine | None = None) -> MachineRun:
        """Return a recorded run, to identify here. machine: the machine to take it for; by default as the service knows it.

        Raises WrongRun where it is not a run of the machine in its own sense of rotation.
        """
        found = self._requests.read(f"/runs/{_number(number, 'run')}/phasors")
        described = self.machine(found["machine"]) if machine is None else machine
        if set(found["direction"]) - {described.rotation}:
            raise WrongRun(f"run {number} does not turn as '{described.id}' does, {described.rotation}")
        times = [datetime.fromisoformat(one).timestamp() for one in found["time"]]
        columns: dict[str, Any] = {"time": times, "speed": found["speed_rpm"]}
        for channel, amplitude, phase in zip(found["channels"], found["amplitude_um_pp"], found["phase_lag_deg"], strict=True):
            columns |= {f"{channel}_um_pp": amplitude, f"{channel}_lag_deg": phase}
        return replace(read_run(columns, machine=described), name=f"run {number}")

    def identifications(
        self, machine: str, *, first: datetime | None = None, last: datetime | None = None
    ) -> Rows[IdentificationEntry]:
        """Return the identifications measured in a time range, newest first."""
        path = f"/machines/{_id(machine)}/identifications"
        return self._rows(IdentificationEntry, path, _period(first, last))

    def estimates(self, identification: int) -> Rows[EstimateEntry]:
        """Return the estimates of an identification."""
        path = f"/identifications/{_number(identification, 'identification')}"
        return _decoded(EstimateEntry, self._requests.read(path)["estimates"])

    def trend(
        self,
        machine: str,
        *parameters: str,
        first: datetime | None = None,
        last: datetime | None = None,
        most: int = MOST_POINTS,
    ) -> Rows[TrendPoint]:
        """Return the histories of parameters such as `coupling.C1.kxx`, oldest first, each of at most `most` points."""
        wrong = next((one for one in parameters if not isinstance(one, str)), None)
        if wrong is not None or not parameters:
            raise ServiceError(
                f"a parameter is a name such as 'coupling.C1.kxx', {_not(wrong)}: name one or more, none in a list"
            )
        asked = {"parameter": list(parameters), "max_points": most} | _period(first, last)
        found = self._requests.read(f"/machines/{_id(machine)}/trends", asked)
        points = [
            {"parameter": series["parameter"], "unit": series["unit"]} | dict(zip(SERIES_COLUMNS, values, strict=True))
            for series in found["series"]
            for values in zip(*(series[column] for column in SERIES_COLUMNS), strict=True)
        ]
        return _decoded(TrendPoint, points)

    def alerts(self, machine: str | None = None, *, only_open: bool = False) -> Rows[AlertEntry]:
        """Return alerts, newest first. machine: those of one machine only."""
        path = "/alerts" if machine is None else f"/machines/{_id(machine)}/alerts"
        return self._rows(AlertEntry, path, {"open": str(only_open).lower()})

    def _rows(self, kind: type[R], path: str, asked: dict[str, Any] | None = None) -> Rows[R]:
        return _decoded(kind, [one for page in self._requests.pages(path, asked) for one in page])


def _decoded(kind: type[R], answers: list[Any]) -> Rows[R]:
    try:
        return rows_of(kind, answers)
    except msgspec.ValidationError as error:
        _refuse(kind, error)


def _refuse(kind: type[Any], error: Exception) -> NoReturn:
    raise ServiceError(f"the service's answer is no {kind.__name__}: {error}; is it of another release?") from None


def _id(machine: object) -> str:
    if not isinstance(machine, str):
        raise ServiceError(f"a machine is named by its id, {_not(machine)}: of an entry give its .id")
    return quote(machine, safe="")


def _number(given: object, what: str) -> int:
    if not isinstance(given, SupportsIndex):
        raise ServiceError(f"a whole number tells which {what}, {_not(given)}: of an entry give its .id")
    return index(given)


def _period(first: datetime | None, last: datetime | None) -> dict[str, str]:
    given = {"from": first, "to": last}
    for moment in given.values():
        if not isinstance(moment, datetime | None):
            raise ServiceError(f"first and last are moments such as datetime(2026, 11, 27), {_not(moment)}")
    return {name: moment.isoformat() for name, moment in given.items() if moment is not None}


def _not(given: object) -> str:
    return "nothing was given" if given is None else f"not a {type(given).__name__}"
