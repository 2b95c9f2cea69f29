"""A source's log in a file: bounded, exact after its process was killed, and clear about what is wrong with it."""

import os
import signal
import sqlite3
import subprocess
import sys
import textwrap
import time
from functools import partial
from pathlib import Path

import pytest
import zenoh

from formats.wire import decode_batch
from service.sources.publisher import Source
from service.sources.replay_log import LogDamaged, LogEntry, LogError, LogFull, LogInUse, LogOfAnother, MemoryLog, SourceLog
from service.sources.sqlite_replay_log import SqliteReplayLog
from tests.plant import KEY, SECOND, START, batch, listened_to, wait_until


def opened(path: Path, **bounds: int) -> SqliteReplayLog:
    return SqliteReplayLog(path, source="edge", **bounds)


def entry(first: int, count: int = 2, *, payload: bytes = b"x", position: str | None = None) -> LogEntry:
    return LogEntry(first, count, payload, "application/msgpack", position)


def ignored(_: LogEntry) -> None:
    """Send nothing."""


def firsts(log: SourceLog, first: int = 0, limit: int = 1000) -> list[int]:
    log.flush()
    return [one.first for one in log.entries_from(first, limit)]


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "edge.log"


def test_another_start_goes_on_in_the_same_epoch(path: Path) -> None:
    log = opened(path)
    assert (log.next_sequence, log.position) == (0, None)
    for number in range(0, 10, 2):
        log.append(entry(number, payload=bytes([number]), position=f"at {number}"), logged=ignored)
    log.append(entry(10), logged=ignored)
    log.close()
    again = opened(path)
    assert (again.epoch, again.next_sequence, again.position) == (log.epoch, 12, "at 8")
    assert [one.payload for one in again.entries_from(0, 3)] == [b"\0", b"\2", b"\4"]
    assert firsts(again, 5) == [4, 6, 8, 10]
    assert firsts(again, 12) == []
    again.close()


@pytest.mark.parametrize("bounds", [{"samples": 7}, {"payload_bytes": 350}])
def test_the_oldest_batches_go_and_are_counted(path: Path, bounds: dict[str, int]) -> None:
    """Both logs alike: 3 batches of 2 samples or 100 bytes are within the bounds, 4 are not."""
    for log in (opened(path, **bounds), MemoryLog(**bounds)):
        for number in range(0, 20, 2):
            log.append(entry(number, payload=b"x" * 100), logged=ignored)
        assert firsts(log) == [14, 16, 18]
        status = log.status()
        assert (status.oldest, status.samples, status.payload_bytes, status.dropped_samples) == (14, 6, 300, 14)
        log.append(entry(20, 50, payload=b"x" * 1000), logged=ignored)
        assert firsts(log) == [20]  # the newest stays, however large
        log.close()


def test_the_file_stays_bounded(path: Path) -> None:
    log = opened(path, payload_bytes=100_000)
    for number in range(0, 4000, 2):
        log.append(entry(number, payload=os.urandom(1000)), logged=ignored)
    log.close()
    assert path.stat().st_size < 600_000  # a group of batches is in it before the oldest go


def test_a_batch_is_sent_only_when_it_is_in_the_log_and_in_order(path: Path) -> None:
    log = opened(path)
    seen: list[tuple[int, bool]] = []

    def sent(one: LogEntry) -> None:
        seen.append((one.first, bool(log.entries_from(one.first, 1))))

    for number in range(0, 400, 2):
        log.append(entry(number), logged=sent)
    log.flush()
    log.close()
    assert seen == [(number, True) for number in range(0, 400, 2)]


@pytest.mark.parametrize("first", [1, 4])
def test_a_hole_or_an_overlap_is_not_taken(path: Path, first: int) -> None:
    for log in (opened(path), MemoryLog()):
        log.append(entry(0), logged=ignored)
        with pytest.raises(ValueError, match=f"2 samples from number {first} do not follow 1"):
            log.append(entry(first), logged=ignored)
        log.close()


def test_two_processes_cannot_have_it(path: Path) -> None:
    log = opened(path)
    with pytest.raises(LogInUse, match="a source runs once"):
        opened(path)
    log.append(entry(0), logged=ignored)
    assert firsts(log) == [0]
    log.close()
    opened(path).close()


def test_the_log_of_another_source_is_refused(path: Path) -> None:
    opened(path).close()
    with pytest.raises(LogOfAnother, match="the log of edge, not of other"):
        SqliteReplayLog(path, source="other")
    with sqlite3.connect(path) as database:
        database.execute("pragma user_version = 2")
    database.close()
    with pytest.raises(LogOfAnother, match="has schema 2; this version knows 1"):
        opened(path)


def test_a_file_that_is_no_log_is_refused_and_left_alone(path: Path) -> None:
    path.write_text("a shopping list, long enough to be taken for something\n" * 100)
    with pytest.raises(LogDamaged, match="move it away"):
        opened(path)
    assert path.read_text().startswith("a shopping list")
    path.unlink()
    database = sqlite3.connect(path)
    database.execute("create table something (value)")
    database.close()
    with pytest.raises(LogOfAnother, match="not a source's log"):
        opened(path)
    with pytest.raises(LogError, match="cannot be used: unable to open"):
        opened(path / "nowhere")


def filled(path: Path, batches: int) -> None:
    log = opened(path)
    for number in range(batches):
        log.append(entry(number, 1, payload=bytes([number]) * 3000), logged=ignored)
    log.close()


def test_damage_is_named(path: Path) -> None:
    filled(path, 50)
    content = bytearray(path.read_bytes())
    content[4096 : 3 * 4096] = b"\xff" * (2 * 4096)
    path.write_bytes(content)
    with pytest.raises(LogDamaged, match="a new one begins a new epoch"):
        opened(path)


def test_a_damaged_payload_is_not_replayed(path: Path, caplog: pytest.LogCaptureFixture) -> None:
    filled(path, 5)
    content = path.read_bytes()
    place = content.index(bytes([3]) * 3000)
    path.write_bytes(content[: place + 100] + b"?" + content[place + 101 :])
    log = opened(path)
    assert firsts(log) == [0, 1, 2, 4]
    assert "the batch from number 3 is damaged" in caplog.text
    log.close()


def test_a_full_disk_is_named_and_what_was_refused_can_be_given_again(path: Path) -> None:
    """SQLite's own limit of pages stands for the disk's: the same error comes of it."""
    log = opened(path)
    sent: list[int] = []
    (limit,) = log._file._database.execute("pragma max_page_count = 20").fetchone()
    assert limit == 20

    def fill() -> None:
        while True:
            log.append(entry(log.next_sequence, payload=b"x" * 3000), logged=lambda one: sent.append(one.first))
            log.flush()

    with pytest.raises(LogFull, match="cannot grow: database or disk is full"):
        fill()
    with pytest.raises(LogFull):
        log.append(entry(log.next_sequence), logged=ignored)
    before = log.next_sequence
    assert sent == list(range(0, before - 2, 2))  # the one that met the limit waits, unsent
    log._file._database.execute("pragma max_page_count = 1000")
    wait_until(lambda: len(sent) == before // 2)
    log.append(entry(before), logged=ignored)
    assert firsts(log) == list(range(0, before + 2, 2))
    log.close()


WRITER = """
    import sys
    from pathlib import Path
    from service.sources.sqlite_replay_log import SqliteReplayLog
    from service.sources.replay_log import LogEntry

    log = SqliteReplayLog(Path(sys.argv[1]), source="edge", samples=10**9)
    print(log.epoch, log.next_sequence, flush=True)
    while True:
        first = log.next_sequence
        # A number lives in its payload and in the position, as in a batch.
        log.append(
            LogEntry(first, 3, b"%d " % first * 100, "", str(first + 3)), logged=lambda one: print(one.first, flush=True)
        )
"""


def test_killed_at_any_instant_nothing_sent_is_missing_and_no_number_comes_twice(path: Path) -> None:
    """Six lives of a process that writes as fast as it can, each ended by SIGKILL at another time."""
    sent: list[int] = []
    epochs = set()
    for life in range(6):
        writer = subprocess.Popen(
            [sys.executable, "-c", textwrap.dedent(WRITER), str(path)], stdout=subprocess.PIPE, text=True
        )
        assert writer.stdout is not None
        epoch, start = writer.stdout.readline().split()
        writer.stdout.readline()  # it has begun
        time.sleep(0.03 + 0.037 * life)
        writer.send_signal(signal.SIGKILL)
        # What came before the kill was sent; a line cut off by it was not seen whole.
        rest = [int(line) for line in writer.stdout.read().splitlines(keepends=True) if line.endswith("\n")]
        writer.wait()
        writer.stdout.close()
        epochs.add(epoch)
        assert not rest or (not sent or int(start) > sent[-1])
        sent += [number for number in rest if number >= int(start)]
    log = opened(path, samples=10**9)
    found = log.entries_from(0, 10**9)
    while following := log.entries_from(found[-1].first + 3, 10**9):
        found += following
    assert epochs == {str(log.epoch)}
    assert [one.first for one in found] == list(range(0, log.next_sequence, 3))
    assert [int(one.payload.split()[0]) for one in found] == [one.first for one in found]
    assert log.position == str(log.next_sequence)
    assert len(sent) > 100
    assert sorted(set(sent)) == sent
    assert set(sent) <= {one.first for one in found}
    log.close()


def test_a_source_with_it_goes_on_after_a_restart(path: Path, router: zenoh.Session, client: zenoh.Session) -> None:
    heard: list[zenoh.Sample] = []
    subscriber = router.declare_subscriber(KEY.samples, heard.append)
    epochs = []
    for _ in range(2):
        with Source(client, KEY, name="edge", log=opened(path)) as source:
            wait_until(partial(listened_to, source._publisher))
            first = source.sequence
            source.publish(batch([900.0] * 5, start=START + first * SECOND), position=str(first + 5))
            epochs.append(source.epoch)
    wait_until(lambda: len(heard) >= 2)
    subscriber.undeclare()
    decoded = [decode_batch(KEY, bytes(one.payload), str(one.encoding)) for one in heard]
    assert [(one.epoch, one.sequence) for one in decoded] == [(epochs[0], 0), (epochs[0], 5)]
    assert epochs[0] == epochs[1]


def test_many_batches_a_second_are_logged(path: Path) -> None:
    """2,000 batches of 25 samples of 8 channels: each waits for a disk, together they do not wait 2,000 times."""
    payload = os.urandom(25 * 8 * 16)
    log = opened(path)
    commits = 0
    commit = log._file.add

    def counted(entries: list[LogEntry]) -> None:
        nonlocal commits
        commits += 1
        time.sleep(0.01)  # a slow disk
        commit(entries)

    log._file.add = counted  # type: ignore[method-assign]
    for number in range(0, 50_000, 25):
        log.append(entry(number, 25, payload=payload), logged=ignored)
    log.flush()
    assert log.status().next_sequence == 50_000
    assert commits < 200
    log.close()
