"""Time of a year's report as PDF, over HTTP, printed in its worker process.

The machine has an identification a day, an alert that people comment on every week, and a note every month. The first report
starts the worker, the second finds it running; both read and print everything. The third is answered from memory.

    python -m benchmarks.report [--days 365]
"""

import argparse
import tempfile
import time
from datetime import UTC, datetime
from pathlib import Path

from service.alerts import transitions
from service.alerts.transitions import AlertFinding
from storage.database.engine import Database
from storage.machines import machines, timeline
from tests.api_in_process import Api
from tests.plant import KEY, SECOND, START, identification, machine, sqlite_url, store_identification

DAY = 86_400 * SECOND
ASKED_S = 10.0
"""Longest time of a year's report [s]."""


def furnish(database: Database, days: int) -> None:
    """Fill a database with a machine's days."""
    with database.transaction() as session:
        machines.create(session, machine())
        for day in range(days):
            drift = {"coupling.C1.kxx": 1.0 + 0.3 * day / days}
            row = store_identification(session, identification(drift), run_id=day, measured_at=START + day * DAY)
            if day % 30 == 0:
                timeline.add(session, KEY.machine, at=START + day * DAY, kind="note", text=f"round {day}: quiet", by="anna")
        finding = AlertFinding({}, row.id, row.measured_at)
        transitions.raise_alert(session, KEY.machine, rule="misalignment", element="coupling.C1", finding=finding)


def asked(api: Api, first: int) -> tuple[float, int]:
    """Ask for a report; time [s] and size [B]."""
    began = time.monotonic()
    begin = datetime.fromtimestamp(first / SECOND, UTC).isoformat()
    answer = api.get(f"/machines/{KEY.machine}/report.pdf", **{"from": begin})
    answer.raise_for_status()
    return time.monotonic() - began, len(answer.content)


def main() -> int:
    """Print the times beside what is asked; 1 where they are longer."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--days", type=int, default=365)
    days = parser.parse_args().days
    with tempfile.TemporaryDirectory() as folder:
        database = Database(sqlite_url(Path(folder) / "rundown.db"))
        database.claim()
        furnish(database, days)
        api = Api(database)
        found = [(name, asked(api, START - after)) for name, after in (("first", 0), ("second", SECOND), ("from memory", 0))]
        api.app.state.report_process.close()
        database.close()
    print(f"report of {days} days as PDF; asked: at most {ASKED_S:g} s")
    for name, (seconds, size) in found:
        print(f"  {name:12s} {seconds:6.2f} s  {size / 1e3:7.0f} kB")
    return int(max(seconds for _, (seconds, _) in found) > ASKED_S)


if __name__ == "__main__":
    raise SystemExit(main())
