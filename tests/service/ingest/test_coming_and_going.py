"""Sources, logs and shares that come and go while something is under way."""

from contextlib import ExitStack
from typing import Any

import pytest
import zenoh
from sqlalchemy.exc import OperationalError

from formats.wire import ALL_LIVE, Key
from service.ingest import ingest_thread as ingest_module
from service.ingest.ingest_thread import Ingest
from service.recovery import gap_recovery as recovery_module
from service.replication.work_share import WholeShare
from service.runs.collector import Collector
from service.write_path.sample_writer import SampleWriter
from service.write_path.source_backoff import SourceBackoff
from service.write_path.write_batch import WriteBatch
from storage.database.engine import Database
from storage.encoding.source_key import SourceKey
from tests.plant import KEY, arrived, batch, wait_until
from tests.service.ingest.plant_network import DroppedOnTheWay, FailingWriter, Surroundings, counts, heard, put_batch, received

BEYOND = arrived(batch([900.0] * 5, sequence=105))
"""Behind a gap: samples 100 to 104 are not there."""
AWAY = OperationalError("SELECT", {}, Exception("the server went away"))


def test_a_source_that_leaves_while_the_roll_is_called_is_not_taken_for_alive(
    router: zenoh.Session, client: zenoh.Session
) -> None:
    token = client.liveliness().declare_token(KEY.live)
    tokens = router.liveliness().declare_subscriber(ALL_LIVE, zenoh.handlers.FifoChannel(10), history=True)
    fetching = Surroundings().recovery(router)
    fetching.note_liveliness(tokens.recv())
    assert list(fetching.live) == [KEY]
    fetching.check_tails(quiet_s=3600.0)
    wait_until(lambda: roll(router) == [KEY.live])  # asked later, so the call before has its answer
    token.undeclare()
    fetching.note_liveliness(tokens.recv())
    wait_until(lambda: roll(router) == [])
    fetching.collect(100)
    assert list(fetching.live) == []
    tokens.undeclare()


def roll(session: zenoh.Session) -> list[str]:
    """Return who is alive."""
    return [str(reply.ok.key_expr) for reply in session.liveliness().get(ALL_LIVE, timeout=5.0) if reply.ok is not None]


def test_what_waits_of_a_source_without_a_log_is_taken_when_shares_change(router: zenoh.Session) -> None:
    around = Surroundings()
    fetching = around.recovery(router)
    fetching.place(KEY, BEYOND)
    assert around.taken == []
    fetching.review()
    assert around.taken == [BEYOND]
    assert fetching.waiting == {}


def test_what_waits_of_a_machine_that_another_stores_now_is_left_to_it(router: zenoh.Session) -> None:
    around = Surroundings()
    fetching = around.recovery(router)
    fetching.place(KEY, BEYOND)
    around.own = set()
    fetching.review()
    assert around.taken == []
    assert fetching.waiting == {}


def test_what_waits_of_a_source_with_a_log_is_left_to_the_log_when_shares_change(
    router: zenoh.Session, lossy: DroppedOnTheWay
) -> None:
    lossy.publish(dropped=True)
    around = Surroundings(answer=arrived(lossy.log[0]))
    fetching = around.recovery(router)

    def known() -> bool:
        fetching.check_tails(quiet_s=3600.0)
        fetching.collect(100)
        return bool(fetching.live.sources(KEY))

    wait_until(known)
    wait_until(lambda: fetching.collect(100) == 0 and not fetching.is_querying)
    around.taken.clear()
    fetching.place(KEY, BEYOND)
    fetching.review()
    assert around.taken == []
    assert fetching.waiting == {}


class AwayInTheReview(SampleWriter):
    """Its database goes away once, where what waited is to be taken."""

    away = False

    def next_sequence(self, source: SourceKey) -> int:
        if self.away:
            self.away = False
            raise AWAY
        return super().next_sequence(source)


class Moving(WholeShare):
    """All of it, though its share is said to have changed."""

    def __init__(self) -> None:
        self.changes = 0


def test_a_review_that_the_database_interrupted_is_done_again(
    router: zenoh.Session, plant: Database, client: zenoh.Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ingest_module, "RETRY_S", 0.05)
    monkeypatch.setattr(recovery_module, "PATIENCE_S", 3600.0)
    writer, share = AwayInTheReview(plant, Collector()), Moving()
    ingest = Ingest(router, writer, silence_s=60.0, share=share)
    with ExitStack() as until:
        ingest.start()
        until.callback(ingest.stop)
        wait_until(lambda: heard(client))
        put_batch(client, 0, 5)
        wait_until(lambda: received(plant) == 5)
        put_batch(client, 10, 15)
        wait_until(lambda: len(ingest._cycle.recovery.waiting) == 1)
        writer.away = True
        share.changes += 1
        wait_until(lambda: counts(plant) == (15, 10, 5))
    assert not writer.away


class Unreachable:
    """A network on which nothing can be asked."""

    def get(self, *_: Any, **__: Any) -> None:
        raise ZeroDivisionError("a fault of ours")


def test_what_waits_for_a_log_that_cannot_be_asked_is_not_put_aside_as_well() -> None:
    around = Surroundings()
    fetching = around.recovery(Unreachable())  # type: ignore[arg-type]
    fetching.place(KEY, BEYOND)  # an error here would put it aside
    fetching.collect(100)
    assert around.paused == [BEYOND.source]


def test_a_pause_is_not_undone_by_what_was_held_before_it(plant: Database) -> None:
    backoff = SourceBackoff()
    held = WriteBatch(SampleWriter(plant, Collector()), backoff)
    one = arrived(batch([900.0] * 5))
    held.take(one)
    backoff.failed(one.source)
    held.store()
    assert received(plant) == 5
    assert not backoff.accepts(one.source)


def test_a_question_that_cannot_be_answered_stops_nobody(
    router: zenoh.Session, plant: Database, client: zenoh.Session, caplog: pytest.LogCaptureFixture
) -> None:
    ingest = Ingest(router, FailingWriter(plant, Collector()), silence_s=60.0)
    with ExitStack() as until:
        ingest.start()
        until.callback(ingest.stop)
        wait_until(lambda: heard(client))
        questions = [client.get(Key(KEY.plant, "pump-9").received, timeout=10.0) for _ in range(5)]
        put_batch(client, 0, 5)
        assert [answer for question in questions for answer in question if answer.ok is not None] == []
        wait_until(lambda: received(plant) == 5)
        assert ingest.trouble is None
    assert caplog.text.count("pump-9: the sequence numbers stored of its sources cannot be sent") == 5
    assert "unexpected error in ingest" not in caplog.text
