"""The service's own clock is behind: what is live waits, is numbered by nobody, and is stored once the clock is right."""

import time
from collections.abc import Iterator
from contextlib import contextmanager

import httpx
import pytest
import zenoh

from formats.wire import JSON, encode_body
from service.ingest.ingest_thread import Ingest
from service.runs.collector import Collector
from service.sources.publisher import Source
from service.write_path.http_queue import Submissions
from service.write_path.sample_writer import SampleWriter
from storage.database.engine import Database
from tests.api_in_process import Api
from tests.plant import KEY, SECOND, batch, wait_until
from tests.service.ingest.plant_network import counts, heard, put_batch, received, rejected, rows

YEAR = 365 * 86_400 * SECOND
PATH = f"/api/v1/machines/{KEY.machine}/samples"


class Live:
    """The service, and sources whose clocks are right."""

    def __init__(self, database: Database, ingest: Ingest, submissions: Submissions, off: list[int]) -> None:
        self.database, self.ingest, self._off = database, ingest, off
        self.api = Api(database, submissions=submissions, warnings=lambda: ingest.warnings, gauges=lambda: ingest.gauges)

    @property
    def time(self) -> int:
        return time.time_ns() - self._off[0]

    def publish(self, source: Source) -> None:
        source.publish(batch([900.0] * 5, start=self.time, step=1000))

    def put(self, client: zenoh.Session, sequence: int) -> None:
        put_batch(client, sequence, sequence + 5, time_ns=[self.time + k for k in range(5)])

    def post(self, sequence: int, *, ahead: int = 0) -> httpx.Response:
        one = batch([900.0] * 5, sequence=sequence, start=self.time + ahead, step=1000, source="http")
        return self.api.ask("POST", PATH, content=encode_body(one, JSON), headers={"content-type": JSON})

    @property
    def is_doubted(self) -> bool:
        """Return whether the clock is doubted; warning and figure must agree."""
        while True:  # until nothing has changed between the two
            before = self._figure
            said = any("this machine's clock" in words for words in self.api.value("/health")["warnings"])
            if self._figure == before:
                break
        assert before == float(said)
        return said

    @property
    def _figure(self) -> float:
        lines = self.api.ask("GET", "/metrics").text.splitlines()
        return next(float(one.split()[1]) for one in lines if one.startswith("rundown_clock_doubted "))


@contextmanager
def running(router: zenoh.Session, plant: Database, off: list[int]) -> Iterator[Live]:
    submissions = Submissions()
    ingest = Ingest(router, SampleWriter(plant, Collector()), silence_s=600.0, submissions=submissions)
    ingest.start()
    try:
        yield Live(plant, ingest, submissions, off)
    finally:
        ingest.stop()


@pytest.fixture
def live(router: zenoh.Session, plant: Database, off: list[int]) -> Iterator[Live]:
    with running(router, plant, off) as one:
        yield one


def test_what_a_log_keeps_is_fetched_as_soon_as_the_clock_is_right(
    plant: Database, client: zenoh.Session, live: Live, off: list[int]
) -> None:
    with Source(client, KEY, name="edge") as source:
        live.publish(source)
        wait_until(lambda: received(plant) == 5)
        off[0] = -YEAR
        for _ in range(3):
            live.publish(source)
        wait_until(lambda: live.is_doubted)
        time.sleep(0.5)
        assert (counts(plant), rejected(plant)) == ((5, 5, 0), {})
        off[0] = 0
        wait_until(lambda: received(plant) == 20)
        live.publish(source)
        wait_until(lambda: received(plant) == 25)
        assert (counts(plant), rejected(plant)) == ((25, 25, 0), {})
        assert not live.is_doubted


def test_what_no_log_keeps_is_lost_and_counted_once_it_is_missed(
    plant: Database, client: zenoh.Session, live: Live, off: list[int]
) -> None:
    wait_until(lambda: heard(client))
    live.put(client, 0)
    wait_until(lambda: received(plant) == 5)
    off[0] = -YEAR
    live.put(client, 5)
    wait_until(lambda: live.is_doubted)
    assert counts(plant) == (5, 5, 0)
    off[0] = 0
    live.put(client, 10)
    wait_until(lambda: received(plant) == 10)
    assert (counts(plant), rejected(plant)) == ((15, 10, 5), {})


def test_over_http_numbers_stay_free(plant: Database, live: Live, off: list[int]) -> None:
    assert live.post(0).status_code == 200
    off[0] = -YEAR
    answer = live.post(5)
    assert answer.status_code == 503
    assert "this machine's clock" in answer.json()["detail"]
    assert "365.0 days later" in answer.json()["detail"]
    assert live.is_doubted
    off[0] = 0
    assert live.post(5).json() == {"received": 5, "duplicates": 0, "missing_before": 0, "faults": [], "ignored": []}
    assert (counts(plant), rejected(plant)) == ((10, 10, 0), {})
    assert not live.is_doubted


def test_a_service_that_starts_with_a_clock_that_is_behind(plant: Database, router: zenoh.Session, off: list[int]) -> None:
    with running(router, plant, off) as live:
        assert live.post(0).status_code == 200
    off[0] = -YEAR
    with running(router, plant, off) as live:
        wait_until(lambda: live.is_doubted)
        assert live.post(5).status_code == 503
        assert counts(plant) == (5, 5, 0)
        off[0] = 0
        assert live.post(5).status_code == 200
        wait_until(lambda: not live.is_doubted)


def test_one_source_that_is_ahead_stops_nobody(plant: Database, client: zenoh.Session, live: Live) -> None:
    """It is told so, and its numbers stay free; published, they are used up as those of any wrong sample."""
    wait_until(lambda: heard(client))
    answer = live.post(0, ahead=YEAR)
    assert answer.status_code == 422
    assert "set the source's clock" in answer.json()["detail"]
    live.put(client, 0)
    wait_until(lambda: received(plant) == 5)
    assert not live.is_doubted
    assert live.post(0).status_code == 200
    assert {row.source: (row.received, row.lost) for row in rows(plant)} == {"http": (5, 0), "monitor": (5, 0)}


def test_a_machine_whose_samples_wait_has_not_fallen_silent(plant: Database, off: list[int]) -> None:
    collector = Collector()
    writer = SampleWriter(plant, collector)
    assert not collector.has_fallen_silent(KEY.machine, silence_s=0.2, alive=False)
    time.sleep(0.3)
    writer.note_activity(KEY.machine)
    assert not collector.has_fallen_silent(KEY.machine, silence_s=0.2, alive=False)
    assert off == [0]
