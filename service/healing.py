"""What is missing is fetched: batches wait for those before them while the source's log is asked. Nothing here blocks, so that
a source that does not answer holds up no other.
"""

import bisect
import logging
import math
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import zenoh

from service.bounded import Bounded
from service.holes import Hole
from service.journal import LARGEST_GAP, Arrived
from service.putting_off import PutOff
from service.wire import ALL_LIVE, IDENTIFIER, Key, source_key
from storage.errors import concerns_all
from storage.samples import SourceKey

logger = logging.getLogger(__name__)

MOST_QUERIES = 64
"""Logs asked at the same time."""
MOST_ASKED = 250
"""Batches that a log is asked for at a time: what it answers waits here until it is taken, and 64 logs answer at once."""
LARGEST_ANSWER = 5_000
"""Batches of an answer that may wait to be taken; more hold the asked source up, not this one."""
REPLAY_TIMEOUT_S = 2.0
HEALING_PATIENCE_S = 3.0
"""How long batches behind a gap wait for the source's log: it may still be on its way back to the network, …"""
HEALING_PAUSE_S = 0.3
"""… asked again after this long."""
REPLAY_PAUSE_S = 10.0
"""How long the gaps of a source without an answering log are then counted at once; a live one's are then asked for again."""
LARGEST_WAITING = 10_000
"""Batches that wait behind one gap; further ones are left to the log."""

Answers = zenoh.handlers.FifoChannel


@dataclass
class _Waiting:
    """Batches of a source that wait for those before them, in order."""

    key: Key
    deadline: float
    arrived: list[Arrived]
    next_try: float = 0.0


@dataclass
class _Replay:
    """A question to a log that is being answered.

    trusting: a hole in the answer is a hole in the log. Otherwise it may be a damaged reply, which is asked for again.
    """

    key: Key
    first: int
    answers: zenoh.Handler[zenoh.Reply]
    trusting: bool
    count: int = 0
    progress: bool = False


@dataclass
class _Recall:
    """Holes, first and last number, that were counted as lost while the log was away: it is asked for one after the other.

    heard: whether it has answered anything. progress: whether anything of the hole.
    """

    key: Key
    holes: list[tuple[int, int]]
    answers: "zenoh.Handler[zenoh.Reply] | None" = None
    heard: bool = False
    progress: bool = False


@dataclass
class Healing:
    """Decides what can be stored now, what waits, and what is gone.

    expected: number of the next sample of a source. missing: the holes before it. read: a reply as a batch, None when it is
    rejected. take: store a batch. owns: whether a machine's samples are stored here. takes: whether a source's are stored now.
    put_off: a source of which something failed that nobody foresaw.
    """

    session: zenoh.Session
    expected: Callable[[SourceKey], int]
    missing: Callable[[SourceKey], Sequence[Hole]]
    read: Callable[[Key, zenoh.Sample], Arrived | None]
    take: Callable[[Arrived], None]
    owns: Callable[[str], bool]
    takes: Callable[[SourceKey], bool]
    put_off: Callable[[SourceKey], None]
    live: dict[Key, dict[str, SourceKey]] = field(default_factory=dict)
    """Machines of which a source is connected, and the newest start of each of their sources, once known."""
    waiting: dict[SourceKey, _Waiting] = field(default_factory=dict)
    _replays: dict[SourceKey, _Replay] = field(default_factory=dict)
    _recalls: dict[SourceKey, _Recall] = field(default_factory=dict)
    _discoveries: dict[Key, "zenoh.Handler[zenoh.Reply]"] = field(default_factory=dict)
    _quiet: dict[tuple[Key, SourceKey | None], None] = field(default_factory=dict)
    """Whose logs are to be asked as soon as there is room, the longest waiting first."""
    _roll_call: "zenoh.Handler[zenoh.Reply] | None" = None
    _ceased: bool = False
    _heard: Bounded[SourceKey, float] = field(default_factory=Bounded)
    _answering: Bounded[SourceKey, bool] = field(default_factory=Bounded)
    """Sources that keep a log."""
    _silent_logs: Bounded[SourceKey, float] = field(default_factory=Bounded)
    _fruitless: Bounded[SourceKey, int] = field(default_factory=Bounded)
    _left: Bounded[SourceKey, None] = field(default_factory=Bounded)
    """Sources whose holes are to be asked for as soon as their samples are taken again."""
    _unheard: PutOff[SourceKey] = field(default_factory=PutOff[SourceKey])
    """Logs that did not answer when they were asked for holes, though they answer otherwise."""

    @property
    def asking(self) -> bool:
        """Whether answers of logs are expected."""
        return bool(self._replays or self._recalls or self._discoveries)

    def token(self, token: zenoh.Sample) -> None:
        """A source came or went."""
        key = _live_key(token)
        if key is None:
            return
        if token.kind == zenoh.SampleKind.PUT:
            logger.info("a source of %s/%s is alive", key.plant, key.machine)
            self.live[key] = {}
            if self.owns(key.machine):
                self._quiet.setdefault((key, None))
        else:
            logger.info("no source of %s/%s is alive any more", key.plant, key.machine)
            self.live.pop(key, None)
            self._roll_call = None  # what was answered before may say that it is alive

    def review(self) -> None:
        """What is stored here has changed: begin anew with what is known of the sources, and ask all logs."""
        self._take_what_no_log_has()
        self._drop_questions()
        known: tuple[dict[SourceKey, Any], ...] = self._heard, self._silent_logs, self._fruitless, self._left
        for one in known:
            one.clear()
        self._unheard = PutOff()
        for key in self.live:
            self.live[key] = {}
            if self.owns(key.machine):
                self._quiet.setdefault((key, None))

    def cease(self) -> None:
        """Ask no more, for the service ends: the next one asks the logs. What comes from a source whose log has never answered
        is taken as it is.
        """
        self._ceased = True
        self._take_what_no_log_has()
        self._drop_questions()

    def _take_what_no_log_has(self) -> None:
        """What waits of sources whose logs have never answered is taken as it is: nobody else has it."""
        for source, waiting in list(self.waiting.items()):
            if source not in self._answering and self.owns(source.machine_id):
                with self._alone(source):
                    for arrived in waiting.arrived:
                        self.take(arrived)
            self.waiting.pop(source, None)

    def _drop_questions(self) -> None:
        asked: tuple[dict[Any, Any], ...] = self.waiting, self._replays, self._recalls, self._discoveries, self._quiet
        for one in asked:
            one.clear()

    def leave(self, source: SourceKey) -> None:
        """Nothing of a source is taken for a while: what waits for its log's answers is the log's again."""
        asked: tuple[dict[SourceKey, Any], ...] = self.waiting, self._replays, self._recalls
        for one in asked:
            one.pop(source, None)
        self._left[source] = None

    def place(self, key: Key, arrived: Arrived) -> None:
        """Take a published batch, let it wait for what is missing before it, or leave it to its source's log."""
        source = source_key(arrived.batch)
        if key in self.live:
            self._know(key, source)
        self._heard[source] = time.monotonic()
        waiting = self.waiting.get(source)
        if not self.takes(source):
            return
        if not self._missing(arrived):
            self.take(arrived)
        elif self._ceased:
            if source not in self._answering:
                self.take(arrived)
        elif waiting is not None:
            if len(waiting.arrived) < LARGEST_WAITING:
                bisect.insort(waiting.arrived, arrived, key=lambda one: one.batch.sequence)
        elif self._silent_logs.get(source, 0.0) > time.monotonic():
            self.take(arrived)
        else:
            self.waiting[source] = _Waiting(key, time.monotonic() + HEALING_PATIENCE_S, [arrived])  # its log is asked next

    def check_tails(self, *, quiet_s: float) -> None:
        """Let each live source that was quiet for so long be asked what it has published beyond what came."""
        if self._roll_call is None:  # a token's arrival may itself have been missed
            self._roll_call = self.session.liveliness().get(
                ALL_LIVE, handler=Answers(LARGEST_ANSWER), timeout=REPLAY_TIMEOUT_S
            )
        for key, sources in list(self.live.items()):
            if not self.owns(key.machine):
                continue
            if not sources:
                self._quiet.setdefault((key, None))
            for source in sources.values():
                if self._silent_logs.get(source, math.inf) <= time.monotonic():
                    del self._silent_logs[source]
                    self._left[source] = None
                if source in self._left and self._unheard.is_due(source):
                    with self._alone(source):
                        self._recall(key, source)
                # While samples come, their numbers show every gap; only a quiet source can hide one.
                if time.monotonic() - self._heard.get(source, 0.0) > quiet_s:
                    self._quiet.setdefault((key, source))

    def collect(self, most: int) -> int:
        """Take what logs have answered, at most so many batches; ask again where something is missing. How many there were."""
        if self._ceased:
            return 0
        if self._roll_call is not None:
            for reply in _arrived(self._roll_call):
                if reply is None:
                    self._roll_call = None
                elif reply.ok is not None and (key := _live_key(reply.ok)) is not None:
                    self.live.setdefault(key, {})
        for key in list(self._discoveries):
            self._collect_discovery(key)
        while self._quiet and len(self._discoveries) + len(self._replays) < MOST_QUERIES:
            quiet = next(iter(self._quiet))
            del self._quiet[quiet]
            self._ask_quiet(*quiet)
        for source in list(self.waiting):
            with self._alone(source):
                self._release_if_healed(source)
        count = 0
        room = MOST_QUERIES - sum(one.answers is not None for one in self._recalls.values())
        for source, recall in list(self._recalls.items()):
            with self._alone(source):
                if recall.answers is not None:
                    count += self._collect_recall(source, recall)
                elif room > 0:
                    room -= 1
                    self._ask_for_hole(source, recall)
        for source, replay in list(self._replays.items()):
            with self._alone(source):
                count += self._collect_replay(source, replay, most=most - count)
            if count >= most:
                return count
        for source, waiting in list(self.waiting.items()):
            if waiting.next_try <= time.monotonic():
                with self._alone(source):
                    self._ask(waiting.key, source)
        return count

    @contextmanager
    def _alone(self, source: SourceKey) -> Iterator[None]:
        """What nobody foresaw within is the trouble of this source alone, which is put off."""
        try:
            yield
        except Exception as error:
            if concerns_all(error):
                raise
            logger.exception("%s, source %s: its log cannot be asked", source.machine_id, source.source)
            self.put_off(source)

    def _collect_replay(self, source: SourceKey, replay: _Replay, *, most: int) -> int:
        """Take what a log has answered. How many batches there were."""
        count = 0
        self.expected(source)  # asks the database, if it must, before an answer is in hand
        for reply in _arrived(replay.answers):
            if reply is None:
                del self._replays[source]
                self._answered(source, replay)
                break
            if reply.ok is not None:
                count += 1
                self._reply(source, replay, reply.ok)
            if count >= most:
                break
        return count

    def _missing(self, arrived: Arrived) -> bool:
        """Whether samples before these have not come."""
        return 0 < arrived.batch.sequence - self.expected(source_key(arrived.batch)) <= LARGEST_GAP

    def _ask(self, key: Key, source: SourceKey) -> None:
        """Ask a log for what follows the last sample known, unless that is being done, too much else, or none is taken."""
        if source in self._replays or len(self._replays) >= MOST_QUERIES or not self.takes(source):
            return
        first = self.expected(source)
        trusting = self._fruitless.get(source) == first
        question = f"from={first};epoch={source.epoch};limit={MOST_ASKED}"
        self._replays[source] = _Replay(key, first, self._query(key, question), trusting)

    def _reply(self, source: SourceKey, replay: _Replay, reply: zenoh.Sample) -> None:
        arrived = self.read(replay.key, reply)
        if arrived is not None and source_key(arrived.batch) != source:
            return  # another source of the machine keeps a log too
        self._answering[source] = True
        leading = replay.count == 0
        replay.count += 1
        # What a log begins with is all that it has; a hole behind that is a reply that was damaged or left out.
        if arrived is None or (self._missing(arrived) and not (leading or replay.trusting)):
            return
        before = self.expected(source)
        self.take(arrived)
        replay.progress |= self.expected(source) > before

    def _answered(self, source: SourceKey, replay: _Replay) -> None:
        """A log has answered all that it will."""
        if replay.progress:
            self._fruitless.pop(source, None)
        else:
            self._fruitless[source] = replay.first
        self._release_if_healed(source)
        waiting = self.waiting.get(source)
        if replay.progress:
            self._ask(replay.key, source)
        elif waiting is not None and waiting.deadline <= time.monotonic():
            self._silent_logs[source] = time.monotonic() + REPLAY_PAUSE_S
            self._release(source)
        elif waiting is not None:
            waiting.next_try = time.monotonic() + HEALING_PAUSE_S

    def _release_if_healed(self, source: SourceKey) -> None:
        waiting = self.waiting.get(source)
        if waiting is not None and not self._missing(waiting.arrived[0]):
            self._release(source)

    def _release(self, source: SourceKey) -> None:
        """What waited is placed anew: behind a further gap it waits again."""
        waiting = self.waiting[source]
        # Asks the database, if it must, before what waits is let go of.
        self.expected(source)
        if waiting.key in self.live:
            self._know(waiting.key, source)
        del self.waiting[source]
        for arrived in waiting.arrived:
            self.place(waiting.key, arrived)

    def _ask_quiet(self, key: Key, source: SourceKey | None) -> None:
        """Ask for what follows the last sample known, or which source it is: any batch of its log tells."""
        if source is not None:
            with self._alone(source):
                self._ask(key, source)
        elif key in self.live and key not in self._discoveries:
            self._discoveries[key] = self._query(key, "from=0;limit=1")

    def _collect_discovery(self, key: Key) -> None:
        for reply in _arrived(self._discoveries[key]):
            if reply is None:
                del self._discoveries[key]
                return
            arrived = None if reply.ok is None else self.read(key, reply.ok)
            if arrived is not None and key in self.live:
                source = source_key(arrived.batch)
                self._answering[source] = True
                with self._alone(source):
                    self._know(key, source)
                    self._ask(key, source)

    def _know(self, key: Key, source: SourceKey) -> None:
        """A source is there; that it was away before is a reason to ask for what it could not tell then."""
        if self.live[key].get(source.source) != source:
            self.live[key][source.source] = source
            self._recall(key, source)

    def _recall(self, key: Key, source: SourceKey) -> None:
        """Ask the log for what was counted as lost, now or as soon as it is taken."""
        self._left[source] = None
        if source in self._recalls or not self.takes(source):
            return  # what is being asked for may be older than the newest holes
        holes = [(hole[0], hole[1]) for hole in self.missing(source)]
        if holes:
            self._recalls[source] = _Recall(key, holes)
        del self._left[source]

    def _ask_for_hole(self, source: SourceKey, recall: _Recall) -> None:
        first, last = recall.holes[0]
        question = f"from={first};epoch={source.epoch};limit={min(last - first + 1, MOST_ASKED)}"
        recall.answers, recall.heard, recall.progress = self._query(recall.key, question), False, False

    def _collect_recall(self, source: SourceKey, recall: _Recall) -> int:
        """Take what the log has of a hole, then go on to the next one. How many batches there were."""
        assert recall.answers is not None
        first, last = recall.holes[0]
        count = 0
        self.expected(source)  # asks the database, if it must, before an answer is in hand
        for reply in _arrived(recall.answers):
            if reply is None:
                recall.answers = None
                if not recall.heard:
                    recall.holes.clear()
                    self._ask_again_later(source)
                elif first > last or not recall.progress:
                    recall.holes = [hole for hole in recall.holes[1:] if hole[1] >= first]
                if not recall.holes:
                    del self._recalls[source]
                break
            arrived = None if reply.ok is None else self.read(recall.key, reply.ok)
            if arrived is None or source_key(arrived.batch) != source:
                continue
            begin, end = arrived.batch.sequence, arrived.batch.sequence + len(arrived.batch.time_ns)
            if not recall.heard:  # before that the log has nothing any more
                first = max(first, begin)
            if begin <= last:
                self.take(arrived)
                recall.progress, first = True, max(first, end)
            count, recall.heard = count + 1, True
            recall.holes[0] = first, last
        if recall.heard:
            self._unheard.succeeded(source)
        return count

    def _ask_again_later(self, source: SourceKey) -> None:
        """A log that answers otherwise may have been held up."""
        if source in self._answering:
            self._unheard.failed(source)
            self._left[source] = None

    def _query(self, key: Key, question: str) -> "zenoh.Handler[zenoh.Reply]":
        return self.session.get(
            f"{key.log}?{question}",
            handler=Answers(LARGEST_ANSWER),
            consolidation=zenoh.ConsolidationMode.NONE,
            timeout=REPLAY_TIMEOUT_S,
            priority=zenoh.Priority.DATA_LOW,
        )


def _arrived(answers: "zenoh.Handler[zenoh.Reply]") -> "Iterator[zenoh.Reply | None]":
    """The replies that are there, and None when there will be no more."""
    while True:
        try:
            reply = answers.try_recv()
        except zenoh.ZError:  # empty and closed
            yield None
            return
        if reply is None:
            return
        yield reply


def _live_key(token: zenoh.Sample) -> Key | None:
    """Whose source a liveliness token stands for; None where these are no ids: zenoh itself takes wildcards and spaces."""
    plant, machine = str(token.key_expr).split("/")[3:5]
    return Key(plant, machine) if IDENTIFIER.match(plant) and IDENTIFIER.match(machine) else None
