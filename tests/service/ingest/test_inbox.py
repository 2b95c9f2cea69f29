"""Messages that wait cost their own size, are bounded by number and by bytes, and keep their order."""

import gc
import threading
import time
from collections.abc import Iterator

import psutil
import pytest
import zenoh

from formats.wire import LARGEST_MESSAGE
from service.ingest import inbox as inbox_module
from service.ingest.inbox import Inbox, PublishedMessage
from service.resilience.heap_trim import release_free_memory
from storage.measurements.quarantine import KEPT_BYTES
from tests.plant import listened_to, wait_until

KEY = "inbox/test"
SIZE = 4_000


@pytest.fixture
def inbox(router: zenoh.Session) -> Iterator[Inbox]:
    one = Inbox()
    one.open(router, KEY)
    yield one
    one.close()


def taken(inbox: Inbox) -> list[PublishedMessage]:
    return list(iter(inbox.take, None))


def test_messages_are_taken_in_the_order_in_which_they_came(router: zenoh.Session, inbox: Inbox) -> None:
    for number in range(500):
        router.put(KEY, str(number).encode(), encoding="text/plain")
    wait_until(lambda: len(inbox) == 500)
    messages = taken(inbox)
    assert [int(one.payload) for one in messages] == list(range(500))
    assert {(one.key, one.encoding) for one in messages} == {(KEY, "text/plain")}
    assert [one.received_at for one in messages] == sorted(one.received_at for one in messages)
    assert (len(inbox), inbox.size, inbox.take()) == (0, 0, None)


def test_of_a_message_that_is_too_large_the_beginning_waits(router: zenoh.Session, inbox: Inbox) -> None:
    router.put(KEY, b"x" * LARGEST_MESSAGE)
    router.put(KEY, b"y" * (LARGEST_MESSAGE + 1))
    wait_until(lambda: len(inbox) == 2)
    assert inbox.size == LARGEST_MESSAGE + KEPT_BYTES
    whole, beginning = taken(inbox)
    assert (len(whole.payload), whole.size) == (LARGEST_MESSAGE, LARGEST_MESSAGE)
    assert (beginning.payload, beginning.size) == (b"y" * KEPT_BYTES, LARGEST_MESSAGE + 1)


@pytest.mark.parametrize(("bound", "most", "kept"), [("MAXIMUM_MESSAGES", 10, 10), ("MAXIMUM_BYTES", 10_000, 10)])
def test_beyond_its_bounds_the_sender_waits_and_nothing_is_lost(
    router: zenoh.Session, monkeypatch: pytest.MonkeyPatch, bound: str, most: int, kept: int
) -> None:
    monkeypatch.setattr(inbox_module, bound, most)
    monkeypatch.setattr(inbox_module, "CHANNEL_SIZE", 5)
    inbox = Inbox()
    inbox.open(router, KEY)

    def send() -> None:
        for number in range(50):
            router.put(KEY, number.to_bytes(1000))

    sender = threading.Thread(target=send, daemon=True)
    sender.start()
    wait_until(lambda: len(inbox) == kept)
    sender.join(0.3)
    assert sender.is_alive(), "it was not held back"
    assert len(inbox) == kept
    found: list[PublishedMessage] = []

    def everything() -> bool:
        found.extend(taken(inbox))
        return len(found) == 50

    wait_until(everything)
    sender.join(5)
    inbox.close()
    assert [int.from_bytes(one.payload) for one in found] == list(range(50))


def test_what_has_come_before_it_is_closed_can_still_be_taken(router: zenoh.Session, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(inbox_module, "LOOK_S", 60.0)
    inbox = Inbox()
    inbox.open(router, KEY)
    for number in range(100):
        router.put(KEY, bytes([number]))
    assert len(inbox) == 0
    inbox.close()
    router.put(KEY, b"afterwards")
    assert not inbox.alive
    assert [one.payload[0] for one in taken(inbox)] == list(range(100))
    inbox.close()


def test_a_message_that_cannot_be_copied_stops_none_of_the_others(
    router: zenoh.Session, inbox: Inbox, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    copy = PublishedMessage.of

    def failing(sample: zenoh.Sample) -> PublishedMessage:
        if sample.payload.to_bytes() == b"bad":
            raise MemoryError("no room")
        return copy(sample)

    monkeypatch.setattr(PublishedMessage, "of", failing)
    for payload in (b"one", b"bad", b"two"):
        router.put(KEY, payload)
    wait_until(lambda: len(inbox) == 2)
    assert [one.payload for one in taken(inbox)] == [b"one", b"two"]
    assert "a message cannot be copied" in caplog.text


def test_what_waits_costs_little_more_than_its_own_size(router: zenoh.Session, client: zenoh.Session) -> None:
    """As zenoh hands it over, a message of 4 kB that came by itself kept 49 kB."""
    inbox, process = Inbox(), psutil.Process()
    inbox.open(router, KEY)
    publisher = client.declare_publisher(KEY, congestion_control=zenoh.CongestionControl.BLOCK)
    wait_until(lambda: listened_to(publisher))
    gc.collect()
    release_free_memory()
    before = process.memory_info().rss
    for _ in range(1_500):
        publisher.put(bytes(SIZE))
        time.sleep(0.001)
    wait_until(lambda: len(inbox) == 1_500)
    release_free_memory()
    cost = (process.memory_info().rss - before) / len(inbox)
    publisher.undeclare()
    inbox.close()
    assert cost < 2 * SIZE
