"""Client of a running service: machines, runs, identifications, trends and alerts as rows, frames, and runs to identify."""

from datetime import datetime
from typing import Any, NoReturn
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
        return read_machine(self._requests.read(f"/machines/{quote(machine, safe='')}")["document"])

    def runs(self, machine: str, *, first: datetime | None = None, last: datetime | None = None) -> Rows[RunEntry]:
        """Return the runs that began in a time range, newest first."""
        return self._rows(RunEntry, f"/machines/{quote(machine, safe='')}/runs", _period(first, last))

    def run(self, number: int, *, machine: Machine | None = None) -> MachineRun:
        """Return a recorded run, to identify here. machine: the machine to take it for; by default as the service knows it.

        Raises WrongRun where it is not a run of the machine in its own sense of rotation.
        """
        found = self._requests.read(f"/runs/{int(number)}/phasors")
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
        path = f"/machines/{quote(machine, safe='')}/identifications"
        return self._rows(IdentificationEntry, path, _period(first, last))

    def estimates(self, identification: int) -> Rows[EstimateEntry]:
        """Return the estimates of an identification."""
        return _decoded(EstimateEntry, self._requests.read(f"/identifications/{int(identification)}")["estimates"])

    def trend(
        self,
        machine: str,
        *parameters: str,
        first: datetime | None = None,
        last: datetime | None = None,
        most: int = MOST_POINTS,
    ) -> Rows[TrendPoint]:
        """Return the histories of parameters such as `coupling.C1.kxx`, oldest first, each of at most `most` points."""
        asked = {"parameter": list(parameters), "max_points": most} | _period(first, last)
        found = self._requests.read(f"/machines/{quote(machine, safe='')}/trends", asked)
        points = [
            {"parameter": series["parameter"], "unit": series["unit"]} | dict(zip(SERIES_COLUMNS, values, strict=True))
            for series in found["series"]
            for values in zip(*(series[column] for column in SERIES_COLUMNS), strict=True)
        ]
        return _decoded(TrendPoint, points)

    def alerts(self, machine: str | None = None, *, only_open: bool = False) -> Rows[AlertEntry]:
        """Return alerts, newest first. machine: those of one machine only."""
        path = "/alerts" if machine is None else f"/machines/{quote(machine, safe='')}/alerts"
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


def _period(first: datetime | None, last: datetime | None) -> dict[str, str]:
    return {name: moment.isoformat() for name, moment in {"from": first, "to": last}.items() if moment is not None}
