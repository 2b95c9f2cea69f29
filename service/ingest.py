"""To the journal: receives messages from zenoh and HTTP, notices gaps, asks the source's log for what is missing."""

import logging
import threading
import time
from collections import deque
from concurrent.futures import Future
from dataclasses import dataclass

import msgspec
import zenoh
from sqlalchemy.exc import DBAPIError

from service.journal import LARGEST_GAP, Arrived, Journal, Outcome
from service.submissions import NotStoring, Submission, Submissions
from service.wire import (
    ALL_LIVE,
    ALL_RECEIVED,
    ALL_SAMPLES,
    JSON,
    Key,
    Received,
    Rejected,
    decode_batch,
    decode_body,
    require_size,
    source_key,
)
from storage.clock import now
from storage.quarantine import Rejection
from storage.samples import SourceKey

logger = logging.getLogger(__name__)

QUEUE_SIZE = 50_000
LARGEST_CYCLE = 1_000
"""Messages stored in one transaction."""
CYCLE_S = 0.05
"""Pause between looks into an empty queue."""
TAIL_CHECK_S = 2.0
"""How often a live source's log is asked for samples that never came."""
REPLAY_TIMEOUT_S = 2.0
HEALING_PATIENCE_S = 3.0
"""How long batches behind a gap wait for the source's log: it may still be on its way back to the network, …"""
HEALING_PAUSE_S = 0.3
"""… asked again after this long."""
REPLAY_PAUSE_S = 10.0
"""How long the gaps of a source without an answering log are then counted at once."""
RETRY_S = 1.0
"""Pause after the database refused to store."""


@dataclass
class _Waiting:
    """Batches of a source that wait for those before them."""

    key: Key
    deadline: float
    arrived: list[Arrived]
    next_try: float = 0.0


class Ingest:
    """The thread that takes what zenoh and HTTP deliver. Callbacks only enqueue; everything else happens here."""

    def __init__(
        self, session: zenoh.Session, journal: Journal, *, silence_s: float, submissions: Submissions | None = None
    ) -> None:
        self._session = session
        self._journal = journal
        self._silence_s = silence_s
        self._submissions = Submissions() if submissions is None else submissions
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="ingest", daemon=True)
        self._expected: dict[SourceKey, int] = {}
        self._live: dict[Key, SourceKey | None] = {}
        self._silent_logs: dict[SourceKey, float] = {}
        self._heard: dict[SourceKey, float] = {}
        self._waiting: dict[SourceKey, _Waiting] = {}
        self._inbox: deque[zenoh.Sample] = deque()
        self._arrived: list[Arrived] = []
        self._promises: dict[int, Future[Outcome]] = {}  # by place in `_arrived`
        self._refused: list[tuple[Future[Outcome], Rejected]] = []
        self._rejections: list[Rejection] = []
        self.trouble: str | None = None
        """Why the last cycle could not be stored."""
        self.depth = 0
        """Messages that waited at the beginning of the last cycle."""

    def start(self) -> None:
        """Subscribe and begin."""
        self._samples = self._session.declare_subscriber(ALL_SAMPLES, zenoh.handlers.FifoChannel(QUEUE_SIZE))
        self._tokens = self._session.liveliness().declare_subscriber(
            ALL_LIVE, zenoh.handlers.FifoChannel(QUEUE_SIZE), history=True
        )
        self._questions = self._session.declare_queryable(ALL_RECEIVED, zenoh.handlers.FifoChannel(LARGEST_CYCLE))
        self._thread.start()

    def stop(self) -> None:
        """Take no more, store what is queued, end the thread."""
        self._stop.set()
        self._thread.join()
        self._samples.undeclare()
        self._tokens.undeclare()
        self._questions.undeclare()

    @property
    def alive(self) -> bool:
        """Whether the thread runs."""
        return self._thread.is_alive()

    def _run(self) -> None:
        next_check = 0.0
        while True:
            stopping = self._stop.is_set()
            try:
                count = self._cycle()
                if time.monotonic() >= next_check and not stopping:
                    self._check_tails()
                    alive = {key.machine for key in self._live}
                    self._journal.close_silent(silence_s=self._silence_s, alive=alive)
                    next_check = time.monotonic() + TAIL_CHECK_S
                self.trouble = self._submissions.trouble = None
            except DBAPIError as error:
                # What was received stays in memory and in the queue until the database takes it.
                self.trouble = self._submissions.trouble = str(error.orig)
                logger.error("samples cannot be stored, trying again: %s", error.orig)
                self._break_promises(NotStoring(self.trouble))
                self._expected.clear()
                if stopping:
                    return
                self._stop.wait(RETRY_S)
                continue
            except Exception as error:
                # One message must never end the ingest of all others.
                logger.exception("unexpected error in ingest; the cycle's messages are dropped")
                self._break_promises(error)
                self._arrived.clear()
                self._rejections.clear()
                self._expected.clear()
                self._stop.wait(RETRY_S)
                continue
            if stopping and count == 0:
                return
            if count == 0:
                self._submissions.wait(CYCLE_S)

    def _cycle(self) -> int:
        """Take what is queued, at most LARGEST_CYCLE messages a way, and store it. Returns how many there were."""
        while (token := self._tokens.try_recv()) is not None:
            self._token(token)
        while (question := self._questions.try_recv()) is not None:
            self._answer(question)
        while len(self._inbox) < QUEUE_SIZE and (sample := self._samples.try_recv()) is not None:
            self._inbox.append(sample)
        self.depth = len(self._inbox)
        taken = min(self.depth, LARGEST_CYCLE)
        for _ in range(taken):
            sample = self._inbox.popleft()
            self._admit(str(sample.key_expr), sample.payload, str(sample.encoding), healing=True)
        submitted = 0
        while submitted < LARGEST_CYCLE and (submission := self._submissions.take()) is not None:
            submitted += 1
            self._submit(submission)
        count = taken + submitted
        self._revisit(give_up=self._stop.is_set() and count == 0)
        self._store()
        return count

    def _store(self) -> None:
        if self._arrived or self._rejections:
            outcomes = self._journal.store(self._arrived, self._rejections)
            for place, promise in self._promises.items():
                promise.set_result(outcomes[place])
            for promise, rejected in self._refused:
                promise.set_exception(rejected)
            self._promises.clear()
            self._refused.clear()
            self._arrived.clear()
            self._rejections.clear()

    def _break_promises(self, error: Exception) -> None:
        """Say to all who wait that what they sent is not known to be durable."""
        waiting = [*self._promises.values(), *(promise for promise, _ in self._refused)]
        while (submission := self._submissions.take()) is not None:
            waiting.append(submission.promise)
        for promise in waiting:
            promise.set_exception(error)
        self._promises.clear()
        self._refused.clear()

    def _answer(self, question: zenoh.Query) -> None:
        """How far the sources of a machine are durable."""
        with question:
            try:
                key = Key.parse(str(question.key_expr))
            except Rejected:
                return  # of all machines at once: each is asked for by itself
            if self._journal.plant_of(key.machine) == key.plant:
                answer = Received(plant=key.plant, machine=key.machine, sources=self._journal.received(key.machine))
                question.reply(key.received, msgspec.json.encode(answer), encoding=JSON)

    def _submit(self, submission: Submission) -> None:
        """Queue a batch that came over HTTP: its source keeps no log, so nothing is asked for that may be missing."""
        received_at = now()
        where = f"POST /api/v1/machines/{submission.machine}/samples"
        try:
            require_size(len(submission.body))
            batch = decode_body(submission.body, submission.encoding)
            if batch.machine != submission.machine:
                raise Rejected("key_mismatch", f"body says machine '{batch.machine[:64]}', the path '{submission.machine}'")
            self._require_machine(Key(batch.plant, batch.machine))
            # Its numbers must stay free for the corrected batch.
            self._journal.require_convertible(batch, received_at=received_at)
        except Rejected as rejected:
            self._rejections.append(
                Rejection(received_at, where, submission.machine, rejected.reason, rejected.detail, submission.body)
            )
            self._refused.append((submission.promise, rejected))
            return
        self._take(Arrived(batch, where, submission.body, received_at), submission.promise)

    def _admit(self, key_text: str, payload: zenoh.ZBytes, encoding: str, *, healing: bool) -> None:
        """Decode a message and queue it for storing, after whatever is missing before it."""
        received_at = now()
        data = payload.to_bytes()
        try:
            key = Key.parse(key_text)
            batch = decode_batch(key, data, encoding)
            self._require_machine(key)
        except Rejected as rejected:
            machine_id = _machine_in(key_text)
            self._rejections.append(Rejection(received_at, key_text, machine_id, rejected.reason, rejected.detail, data))
            return
        source = source_key(batch)
        if key in self._live:
            self._live[key] = source
        self._heard[source] = time.monotonic()
        arrived = Arrived(batch, key_text, data, received_at)
        if source in self._waiting and healing:
            self._waiting[source].arrived.append(arrived)
            return
        if healing and self._missing(arrived):
            self._heal(key, source, until=batch.sequence)
            if self._missing(arrived) and self._silent_logs.get(source, 0.0) <= time.monotonic():
                self._waiting[source] = _Waiting(key, time.monotonic() + HEALING_PATIENCE_S, [arrived])
                return
        self._take(arrived)

    def _missing(self, arrived: Arrived) -> bool:
        """Whether samples before these have not come."""
        return 0 < arrived.batch.sequence - self._next(source_key(arrived.batch)) <= LARGEST_GAP

    def _take(self, arrived: Arrived, promise: Future[Outcome] | None = None) -> None:
        """Queue a batch for storing."""
        batch, source = arrived.batch, source_key(arrived.batch)
        if batch.sequence - self._next(source) <= LARGEST_GAP:
            self._expected[source] = max(self._next(source), batch.sequence + len(batch.time_ns))
        if promise is not None:
            self._promises[len(self._arrived)] = promise
        self._arrived.append(arrived)
        if len(self._arrived) >= LARGEST_CYCLE:
            self._store()

    def _revisit(self, *, give_up: bool) -> None:
        """Try again to fill the gaps for which batches wait; those whose time is over are taken as they are."""
        for source, waiting in list(self._waiting.items()):
            if not give_up and waiting.next_try > time.monotonic():
                continue
            waiting.next_try = time.monotonic() + HEALING_PAUSE_S
            self._heal(waiting.key, source, until=waiting.arrived[0].batch.sequence)
            healed = not self._missing(waiting.arrived[0])
            if not healed and not give_up and waiting.deadline > time.monotonic():
                continue
            if not healed:
                self._silent_logs[source] = time.monotonic() + REPLAY_PAUSE_S
            del self._waiting[source]
            for arrived in waiting.arrived:
                self._take(arrived)

    def _require_machine(self, key: Key) -> None:
        plant = self._journal.plant_of(key.machine)
        if plant is None:
            raise Rejected("unknown_machine", f"no machine '{key.machine}' is known; create it from its document first")
        if plant != key.plant:
            raise Rejected("unknown_machine", f"machine '{key.machine}' belongs to plant '{plant}', not '{key.plant}'")

    def _next(self, source: SourceKey) -> int:
        if source not in self._expected:
            self._expected[source] = self._journal.next_sequence(source)
        return self._expected[source]

    def _token(self, token: zenoh.Sample) -> None:
        key = _live_key(token)
        if token.kind == zenoh.SampleKind.PUT:
            logger.info("a source of %s/%s is alive", key.plant, key.machine)
            self._live[key] = None
        else:
            logger.info("no source of %s/%s is alive any more", key.plant, key.machine)
            self._live.pop(key, None)

    def _check_tails(self) -> None:
        """Ask each live source for what it has published beyond what came."""
        # A token's arrival may itself have been missed.
        for reply in self._session.liveliness().get(ALL_LIVE, timeout=REPLAY_TIMEOUT_S):
            if reply.ok is not None:
                self._live.setdefault(_live_key(reply.ok), None)
        for key, source in list(self._live.items()):
            if self._journal.plant_of(key.machine) != key.plant:
                continue  # nothing of it would be taken
            if source is None:
                self._live[key] = source = self._discovered(key)
            # While samples come, their numbers show every gap; only a quiet source can hide one.
            if source is not None and time.monotonic() - self._heard.get(source, 0.0) > TAIL_CHECK_S:
                self._heal(key, source, until=None)
        self._store()

    def _heal(self, key: Key, source: SourceKey, *, until: int | None) -> None:
        """Pull from the source's log what is missing before sample `until`, or all that it has."""
        while until is None or self._next(source) < until:
            before = self._next(source)
            self._replies(key, f"from={before};epoch={source.epoch}")
            if self._next(source) == before:
                return

    def _discovered(self, key: Key) -> SourceKey | None:
        """Which start of which source is alive there: any batch of its log tells."""
        for answer in self._asked(key, "from=0;limit=1"):
            try:
                return source_key(decode_batch(key, answer.payload.to_bytes(), str(answer.encoding)))
            except Rejected as rejected:
                logger.warning("the log of %s/%s cannot be read: %s", key.plant, key.machine, rejected.detail)
        return None

    def _replies(self, key: Key, question: str) -> int:
        """Admit every batch in the answer to a log query; returns how many there were."""
        answers = self._asked(key, question)
        for answer in answers:
            self._admit(key.samples, answer.payload, str(answer.encoding), healing=False)
        return len(answers)

    def _asked(self, key: Key, question: str) -> list[zenoh.Sample]:
        replies = self._session.get(
            f"{key.log}?{question}",
            zenoh.handlers.FifoChannel(QUEUE_SIZE),
            consolidation=zenoh.ConsolidationMode.NONE,
            timeout=REPLAY_TIMEOUT_S,
            priority=zenoh.Priority.DATA_LOW,
        )
        return [reply.ok for reply in replies if reply.ok is not None]


def _machine_in(key_text: str) -> str | None:
    """The machine that a key names, None when it is no key of a machine."""
    try:
        return Key.parse(key_text).machine
    except Rejected:
        return None


def _live_key(token: zenoh.Sample) -> Key:
    """Whose source a liveliness token stands for."""
    parts = str(token.key_expr).split("/")
    return Key(parts[3], parts[4])
