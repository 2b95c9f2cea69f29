"""A source over a real loopback network: its numbers, its log and how it answers replay queries."""

import time

import pytest
import zenoh

from formats.wire import JSON, MESSAGEPACK, SampleBatch, decode_batch
from service.sources import publisher as source_module
from service.sources.publisher import Source
from service.sources.replay_log import MemoryLog
from tests.plant import KEY, batch, wait_until


def replayed(router: zenoh.Session, question: str = "") -> list[SampleBatch]:
    """Return what the log answers."""
    replies = router.get(
        f"{KEY.log}?{question}", zenoh.handlers.FifoChannel(1000), consolidation=zenoh.ConsolidationMode.NONE, timeout=5.0
    )
    good = [reply.ok for reply in replies if reply.ok is not None]
    return [decode_batch(KEY, bytes(one.payload), str(one.encoding)) for one in good]


def wait_until_asked(router: zenoh.Session) -> None:
    """Wait until the router knows the source's log: only then does a query reach it."""
    wait_until(lambda: bool(replayed(router, "limit=1")))


def numbers(batches: list[SampleBatch]) -> list[int]:
    return [one.sequence for one in batches]


def publish(source: Source, *sizes: int) -> None:
    for size in sizes:
        source.publish(batch([900.0] * size))


def test_samples_are_numbered_without_a_hole(router: zenoh.Session, client: zenoh.Session) -> None:
    with Source(client, KEY, name="edge") as source:
        publish(source, 3, 1, 4)
        wait_until_asked(router)
        found = replayed(router)
        assert numbers(found) == [0, 3, 4]
        assert source.sequence == 8
        assert {(one.source, one.epoch) for one in found} == {("edge", source.epoch)}


def test_each_start_is_a_later_epoch(client: zenoh.Session) -> None:
    with Source(client, KEY, name="edge") as first:
        before = first.epoch
    time.sleep(0.001)
    with Source(client, KEY, name="edge") as second:
        assert second.epoch > before


@pytest.mark.parametrize(
    ("question", "expected"),
    [
        ("", [0, 3, 6, 9]),
        ("from=0", [0, 3, 6, 9]),
        ("from=3", [3, 6, 9]),
        ("from=4", [3, 6, 9]),  # the batch that holds sample 4
        ("from=11", [9]),
        ("from=12", []),
        ("from=0;limit=2", [0, 3]),
        ("from=4;limit=1", [3]),
        ("limit=0", []),
        ("from=-1", [0, 3, 6, 9]),
        ("from=x;limit=y", [0, 3, 6, 9]),
        ("epoch=1", []),
        ("epoch=x", []),
    ],
)
def test_the_log_answers_from_a_sample_on(
    router: zenoh.Session, client: zenoh.Session, question: str, expected: list[int]
) -> None:
    with Source(client, KEY, name="edge") as source:
        publish(source, 3, 3, 3, 3)
        wait_until_asked(router)
        assert numbers(replayed(router, question)) == expected
        assert numbers(replayed(router, f"epoch={source.epoch};from=9")) == [9]


def test_a_digit_that_is_none_does_not_silence_the_log(router: zenoh.Session, client: zenoh.Session) -> None:
    """`str.isdigit` is true for superscripts, `int` takes none."""
    with Source(client, KEY, name="edge") as source:
        publish(source, 3)
        wait_until_asked(router)
        assert numbers(replayed(router, "from=²")) == [0]
        assert numbers(replayed(router)) == [0]


def test_the_log_is_bounded(router: zenoh.Session, client: zenoh.Session) -> None:
    with Source(client, KEY, name="edge", log=MemoryLog(samples=10)) as source:
        publish(source, *[3] * 20)
        wait_until_asked(router)
        assert numbers(replayed(router)) == [51, 54, 57]
        publish(source, 10)
        assert numbers(replayed(router)) == [60]


def test_one_answer_is_bounded_and_the_next_goes_on(
    router: zenoh.Session, client: zenoh.Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(source_module, "LARGEST_REPLY_COUNT", 2)
    with Source(client, KEY, name="edge") as source:
        publish(source, 3, 3, 3)
        wait_until_asked(router)
        assert numbers(replayed(router, "limit=100")) == [0, 3]
        assert numbers(replayed(router, "from=6;limit=100")) == [6]


@pytest.mark.parametrize("encoding", [MESSAGEPACK, JSON])
def test_what_is_published_arrives(router: zenoh.Session, client: zenoh.Session, encoding: str) -> None:
    received: list[zenoh.Sample] = []
    subscriber = router.declare_subscriber(KEY.samples, received.append)
    with Source(client, KEY, name="edge", encoding=encoding) as source:

        def arrived() -> bool:
            publish(source, 2)
            # A message of the test before may still be on its way.
            return any(str(one.encoding) == encoding for one in received)

        wait_until(arrived)
        one = decode_batch(KEY, bytes(received[-1].payload), encoding)
        assert (one.epoch, one.speed) == (source.epoch, [900.0, 900.0])
    subscriber.undeclare()


def test_a_source_is_alive_until_it_leaves(router: zenoh.Session, client: zenoh.Session) -> None:
    def alive() -> bool:
        return any(reply.ok is not None for reply in router.liveliness().get(KEY.live, zenoh.handlers.FifoChannel(10)))

    wait_until(lambda: not alive())  # the token of the test before may linger
    with Source(client, KEY, name="edge") as source:
        publish(source, 1)
        wait_until(alive)
    wait_until(lambda: not alive())
    assert replayed(router) == []
