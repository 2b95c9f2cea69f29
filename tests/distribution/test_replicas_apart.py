"""Replicas of which one's clock is wrong, or has lost its way to the database: the others go on, and nothing is lost."""

import contextlib
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

from formats.wire import JSON, encode_body
from tests.databases import PostgresqlDatabases
from tests.distribution.layout import Layout
from tests.end_to_end.processes import until
from tests.faults.network import Wire
from tests.plant import SECOND, batch, document
from tests.postgresql import PostgresServer

pytestmark = pytest.mark.long

MACHINES = [f"pump-{number}" for number in range(8)]
"""Enough that each replica stores some of them."""
HOUR_S = 3600.0
READY_WITHIN_S, SHARED_WITHIN_S, TAKEN_OVER_WITHIN_S = 120.0, 120.0, 90.0
"""On a busy machine."""


@pytest.fixture
def layout(tmp_path: Path, postgresql: PostgresServer) -> Iterator[Layout]:
    databases = PostgresqlDatabases(postgresql)
    url = databases.new(tmp_path / "apart.db")
    try:
        with Layout(tmp_path, database=url) as one:
            yield one
    finally:
        databases.drop(url)


class Monitors:
    """A monitor at each machine, which measures now and sends each batch until it is acknowledged."""

    def __init__(self, layout: Layout) -> None:
        self._layout = layout
        self.acknowledged: Counter[str] = Counter()

    def send(self, name: str) -> dict[str, tuple[int, str]]:
        """One batch of each machine, measured now, to a replica; status and words of each answer."""
        found = {}
        for machine in MACHINES:
            first = self.acknowledged[machine]
            sent = batch([900.0] * 5, machine=machine, sequence=first, start=time.time_ns() - SECOND, step=SECOND // 1000)
            content, path = encode_body(sent, JSON), f"/machines/{machine}/samples"
            answer = self._layout.client(name).post(path, content=content, headers={"content-type": JSON})
            found[machine] = answer.status_code, answer.text
            self.acknowledged[machine] += 5 if answer.status_code == 200 else 0
        return found

    def check(self, name: str) -> None:
        """Check that all acknowledged samples are stored once, and that no number is missing."""
        rows = {row["machine"]: row for row in self._layout.get(name, "/sources")}
        for machine in MACHINES:
            row, count = rows[machine], self.acknowledged[machine]
            assert (row["received"], row["next_sequence"], row["lost"]) == (count, count, 0), row


def begin(layout: Layout) -> None:
    layout.start("all1")
    until(lambda: layout._ready("all1"), within_s=READY_WITHIN_S, what="the first one is ready")


def shared(layout: Layout, name: str) -> bool:
    return len(found := layout.shares(name)) == 2 and min(found.values()) > 0


def readiness(client: httpx.Client) -> int | None:
    """Status of its readiness; None where it does not listen yet."""
    with contextlib.suppress(httpx.ConnectError):
        return client.get("/ready", timeout=60.0).status_code
    return None


def accepted(answers: dict[str, tuple[int, str]]) -> bool:
    return {status for status, _ in answers.values()} == {200}


@pytest.mark.parametrize("offset_s", [-HOUR_S, HOUR_S])
def test_a_replica_whose_clock_is_wrong_harms_no_machine_of_the_other(layout: Layout, tmp_path: Path, offset_s: float) -> None:
    clock = tmp_path / "offset"
    clock.write_text("0")
    begin(layout)
    layout.start("all2", clock=clock)
    until(lambda: shared(layout, "all1"), within_s=SHARED_WITHIN_S, what="both store some machines")
    for machine in MACHINES:
        layout.create_machine("all1", document(id=machine))
    monitors = Monitors(layout)
    until(lambda: accepted(monitors.send("all1")), within_s=60, what="all machines are stored")
    new = clock.with_suffix(".new")
    new.write_text(str(offset_s))
    new.replace(clock)
    shares = layout.shares("all1")
    statuses: Counter[int] = Counter()
    for _ in range(20):
        answers = monitors.send("all1")
        statuses.update(status for status, _ in answers.values())
        waits = [words for status, words in answers.values() if status == 503]
        assert all("clock" in words and "is behind" in words for words in waits), waits
        time.sleep(0.3)
    assert layout.shares("all1") == shares, "leases go by the database's clock"
    if offset_s < 0:
        assert statuses[200] > 0
        assert statuses[503] > 0, "whoever is behind takes nothing that lies ahead of it, and says so"
    else:
        assert set(statuses) == {200}
    new.write_text("0")
    new.replace(clock)
    until(lambda: accepted(monitors.send("all1")), within_s=60, what="all machines are stored again, without a restart")
    monitors.check("all1")


def test_a_replica_without_its_database_says_so_and_the_other_takes_over(layout: Layout, postgresql: PostgresServer) -> None:
    with Wire(postgresql.port) as wire:
        port = wire.endpoint.rpartition(":")[2]
        begin(layout)
        layout.start("all2", database=layout.database.replace(f":{postgresql.port}/", f":{port}/"))
        until(lambda: shared(layout, "all1"), within_s=SHARED_WITHIN_S, what="both store some machines")
        until(lambda: readiness(layout.client("all2")) == 200, within_s=READY_WITHIN_S, what="the second one is ready, too")
        for machine in MACHINES:
            layout.create_machine("all1", document(id=machine))
        monitors = Monitors(layout)
        until(lambda: accepted(monitors.send("all1")), within_s=60, what="all machines are stored")
        wire.hold()
        alone = layout.client("all2")
        until(lambda: readiness(alone) == 503, within_s=READY_WITHIN_S, what="it is not ready")
        assert alone.get("/alive").status_code == 200
        until(lambda: accepted(monitors.send("all1")), within_s=TAKEN_OVER_WITHIN_S, what="the other stores all machines")
        monitors.check("all1")
        wire.release()
        until(lambda: readiness(alone) == 200, within_s=READY_WITHIN_S, what="it is ready again")
        until(lambda: shared(layout, "all1"), within_s=SHARED_WITHIN_S, what="both store some machines again")
        until(lambda: accepted(monitors.send("all2")), within_s=60, what="all machines are stored by way of either")
        monitors.check("all2")
