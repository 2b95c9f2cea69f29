"""From the start of `rundown serve` to ready, on a store with many machines and years of identifications.

The store is built first, row by row like those that one real identification made; the last week ends now. Ready is when
`/ready` says so; then first answers are timed, for which nothing is kept from before.

    python -m benchmarks.cold_start [--database sqlite|postgresql] [--machines 10000] [--identified 1000] [--weeks 260]
        [--store FILE]
"""

import argparse
import contextlib
import itertools
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import psutil
from sqlalchemy import event, insert, select

from storage.database.engine import Database
from storage.machines import machines
from storage.tables.base import Base
from storage.tables.findings import EstimateRow, IdentificationRow, JobRow
from storage.tables.machines import MachineRow, RevisionRow
from storage.tables.measurements import RunRow
from tests.end_to_end.processes import Service
from tests.faults.storage_faults import own_server
from tests.plant import KEY, identification, machine, store_identification

ASKED_S = 5.0
WEEK_NS = 7 * 86_400 * 10**9
FIRST_ANSWERS: dict[str, dict[str, str]] = {
    "/fleet": {},
    "/machines/{machine}/trends": {"parameter": "coupling.C1.kxx"},
    "/machines": {},
    "/health": {},
    "/machines/{machine}/runs": {},
    "/machines/{machine}/identifications": {},
    "/machines/{machine}/alerts": {},
}
PARTS = 20_000
"""Rows inserted at a time."""

StoredRow = dict[str, Any]


def build(url: str, *, count: int, identified: int, weeks: int) -> None:
    """Store machines, and for some of them a run, a job, an identification and its estimates per week."""
    database = Database(url)
    with database.transaction() as session:
        machines.create(session, machine())
        store_identification(session, identification(), run_id=1)
    with database.engine.connect() as reading:
        models = (MachineRow, RevisionRow, JobRow, IdentificationRow, EstimateRow)
        known = {model: [dict(row._mapping) for row in reading.execute(select(model.__table__))] for model in models}
    if database.kind == "sqlite":
        database.engine.dispose()
        event.listen(database.engine, "connect", _hurry)
    for model, rows in known.items():
        _insert(database, model, _copies(model, rows, count, identified, weeks))
    _insert(database, RunRow, _runs(identified, weeks))
    with database.engine.connect().execution_options(isolation_level="AUTOCOMMIT") as connection:
        connection.exec_driver_sql("ANALYZE")
    database.close()


def _name(number: int) -> str:
    return f"{KEY.machine}-{number:05d}"


def _first_week(weeks: int) -> int:
    return time.time_ns() - (weeks - 1) * WEEK_NS - 3600 * 10**9


def _copies(model: type, rows: list[StoredRow], count: int, identified: int, weeks: int) -> Iterator[StoredRow]:
    """Yield rows like those known, for every machine or for every identification."""
    if model is MachineRow:
        return (rows[0] | {"id": _name(i)} for i in range(count))
    if model is RevisionRow:
        return (rows[0] | {"machine_id": _name(i), "document": rows[0]["document"] | {"id": _name(i)}} for i in range(count))
    every = ((i, week, 2 + i * weeks + week) for i in range(identified) for week in range(weeks))
    if model is JobRow:
        return (rows[0] | {"id": n, "machine_id": _name(i), "run_ids": [n], "request": f"run:{n}"} for i, _, n in every)
    begin = _first_week(weeks)
    if model is IdentificationRow:
        own = ("id", "job_id")
        return (
            rows[0]
            | dict.fromkeys(own, n)
            | {"machine_id": _name(i), "run_ids": [n]}
            # Identified on the day of the measurement: of years of identifications few are of any one day.
            | dict.fromkeys(("measured_at", "computed_at"), begin + week * WEEK_NS)
            for i, week, n in every
        )
    return (
        row | {"identification_id": n, "machine_id": _name(i), "measured_at": begin + week * WEEK_NS}
        for i, week, n in every
        for row in rows
    )


def _runs(identified: int, weeks: int) -> Iterator[StoredRow]:
    """Yield closed runs whose samples were deleted."""
    first = _first_week(weeks)
    for i in range(identified):
        for week in range(weeks):
            begin = first + week * WEEK_NS
            yield {
                "id": 2 + i * weeks + week,
                "machine_id": _name(i),
                "revision": 1,
                "kind": "run-down",
                "direction": 1,
                "state": "closed",
                "time_first": begin,
                "time_last": begin + 10**9,
                "count": 40,
                "released_at": begin,
            }


def _hurry(connection: Any, _record: Any) -> None:
    # The store is thrown away afterwards: it has to be written fast, not safely.
    connection.execute("PRAGMA synchronous = OFF")
    connection.execute("PRAGMA cache_size = -2000000")


def _insert(database: Database, model: type[Base], rows: Iterator[StoredRow]) -> None:
    while part := list(itertools.islice(rows, PARTS)):
        with database.for_writing.begin() as connection:
            connection.execute(insert(model), part)


def measure(folder: Path, url: str, options: argparse.Namespace) -> bool:
    """Build the store, start the service, print the figures; return whether it was ready in time."""
    began = time.perf_counter()
    if options.store is None or not options.store.exists():
        build(url, count=options.machines, identified=options.identified, weeks=options.weeks)
    built = time.perf_counter() - began
    service = Service(folder, database=url)
    began = time.perf_counter()
    with service.running() as started:
        ready = time.perf_counter() - began
        times = psutil.Process(started.pid).cpu_times()
        answers = {}
        for path, asked_for in FIRST_ANSWERS.items():
            asked = time.perf_counter()
            service.get(path.format(machine=_name(0)), **asked_for)
            answers[path] = time.perf_counter() - asked
        memory = psutil.Process(started.pid).memory_info().rss / 2**20
        time.sleep(8.0)
        still = service.client.get("/ready").status_code
    service.client.close()
    print(
        f"{options.machines} machines, {options.identified} with {options.weeks} identifications each; built in {built:.0f} s"
    )
    busy = times.user + times.system
    print(f"  start to ready: {ready:.2f} s, of them {busy:.2f} s of processor time; asked: {ASKED_S} s")
    print(f"  {memory:.0f} MiB; answer of /ready 8 s later: {still}")
    for path, seconds in answers.items():
        print(f"  first answer of {path}: {seconds:.2f} s")
    return ready <= ASKED_S and still == 200


def main() -> None:
    """Print the figures; status 1 when it took too long."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--database", choices=("sqlite", "postgresql"), default="sqlite")
    parser.add_argument("--machines", type=int, default=10_000)
    parser.add_argument("--identified", type=int, default=1_000)
    parser.add_argument("--weeks", type=int, default=260)
    parser.add_argument("--store", type=Path, help="SQLite file that is kept, and used again where it is there")
    options = parser.parse_args()
    with contextlib.ExitStack() as around:
        folder = Path(around.enter_context(tempfile.TemporaryDirectory()))
        url = f"sqlite:///{options.store or folder / 'rundown.db'}"
        if options.database == "postgresql":
            _, url = around.enter_context(own_server())
        if not measure(folder, url, options):
            raise SystemExit(1)


if __name__ == "__main__":
    main()
