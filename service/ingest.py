"""To the journal: takes what came from zenoh and HTTP; what is missing before it is fetched in `service/healing.py`."""

import logging
import threading
import time
from collections import Counter
from collections.abc import Collection
from concurrent.futures import Future
from dataclasses import replace

import msgspec
import zenoh
from sqlalchemy.exc import DataError, DBAPIError, IntegrityError, TimeoutError

from service.bounded import Bounded
from service.healing import Healing
from service.inbox import Inbox, Message
from service.journal import LARGEST_GAP, Arrived, Journal, Outcome
from service.own_faults import concerns_all
from service.putting_off import PutOff
from service.sharing import Share, Whole, lease_of
from service.submissions import NotStoring, Submission, Submissions
from service.wire import (
    ALL_LIVE,
    ALL_RECEIVED,
    ALL_SAMPLES,
    JSON,
    Key,
    OwnFault,
    Reason,
    Received,
    Rejected,
    decode_batch,
    decode_body,
    require_size,
    source_key,
)
from storage.clock import now
from storage.leases import NotHeld
from storage.quarantine import Rejection
from storage.samples import SourceKey

logger = logging.getLogger(__name__)

TOKENS = 50_000
"""Comings and goings of sources that wait."""
LARGEST_CYCLE = 1_000
"""Messages stored in one transaction."""
CYCLE_S = 0.1
"""What comes within this time is stored in one transaction, …"""
BACKLOG = 200
"""… unless so many messages have come: then there is no pause."""
HEALING_CYCLE_S = 0.05
"""Pause between looks for what logs answer."""
TAIL_CHECK_S = 2.0
"""How often a live source's log is asked for samples that never came."""
STALLED_S = 5.0
"""A cycle that lasts longer waits for the database, and the service is not ready."""
UNEXPECTED = "unexpected error; the service's log has it"
"""What is answered to who waits."""
RETRY_S = 1.0
"""Pause after the database refused to store."""
MOST_TRIES = 50
"""Messages of a machine that are tried by themselves though none of them could be stored; the others are left to the logs."""
FREE_FAILURES = 2
"""So often in a row a machine may meet an unforeseen error before it is put off."""


class Ingest:
    """The thread that takes what zenoh and HTTP deliver. Callbacks only enqueue; everything else happens here."""

    def __init__(
        self,
        session: zenoh.Session,
        journal: Journal,
        *,
        silence_s: float,
        submissions: Submissions | None = None,
        share: Share | None = None,
    ) -> None:
        self._session = session
        self._journal = journal
        self._silence_s = silence_s
        self._submissions = Submissions() if submissions is None else submissions
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="ingest", daemon=True)
        self._expected: Bounded[SourceKey, int] = Bounded()
        self._share = share or Whole()
        self._changes = self._share.changes
        self._healing = Healing(
            session,
            expected=self._next,
            missing=journal.missing,
            read=self._read_reply,
            take=self._take,
            owns=self._takes,
        )
        self._inbox = Inbox()
        self._held: dict[int, tuple[Arrived, Future[Outcome] | None]] = {}  # what is to be stored, by a running number
        self._count = 0  # of all that were held
        self._apart = False  # whether what is held is to be stored one by one
        self._put_off = PutOff(free=FREE_FAILURES)  # machines
        self._errors = 0  # that nobody foresaw, in a row
        self._refused: list[tuple[Future[Outcome], Rejected]] = []
        self._rejections: list[Rejection] = []
        self._trouble: str | None = None
        self._unchecked: str | None = None  # why what is done now and then was not done
        self._began = time.monotonic()  # the cycle

    def start(self) -> None:
        """Subscribe and begin."""
        self._inbox.start(self._session, ALL_SAMPLES)
        self._tokens = self._session.liveliness().declare_subscriber(
            ALL_LIVE, zenoh.handlers.FifoChannel(TOKENS), history=True
        )
        self._questions = self._session.declare_queryable(ALL_RECEIVED, zenoh.handlers.FifoChannel(LARGEST_CYCLE))
        self._thread.start()

    def stop(self) -> None:
        """Take no more, store what is queued, end the thread."""
        self._stop.set()
        self._thread.join()
        self._inbox.close()
        self._tokens.undeclare()
        self._questions.undeclare()

    @property
    def trouble(self) -> str | None:
        """Why the last cycle could not be stored, or that the present one does not end."""
        lasts = time.monotonic() - self._began
        if self._trouble is None and lasts > STALLED_S and self.alive:
            return f"storing has not ended for {lasts:.0f} s"
        return self._trouble or self._unchecked

    @trouble.setter
    def trouble(self, words: str | None) -> None:
        self._trouble = words

    @property
    def alive(self) -> bool:
        """Whether the threads run."""
        return self._thread.is_alive() and self._inbox.alive

    @property
    def gauges(self) -> dict[str, float]:
        """Figures for a monitoring system, by the name of the metric."""
        return {"rundown_ingest_queue_messages": len(self._inbox), "rundown_ingest_queue_bytes": self._inbox.size}

    def _run(self) -> None:
        next_check = 0.0
        while True:
            stopping = self._stop.is_set()
            self._began = time.monotonic()
            try:
                if self._apart:
                    self._one_by_one()
                count = self._cycle()
                if time.monotonic() >= next_check and not stopping:
                    next_check = time.monotonic() + TAIL_CHECK_S
                    self._check()
                self.trouble = self._submissions.trouble = None
                self._errors = 0
            except NotHeld as error:
                logger.warning("machines were taken over by another replica: %s", error)
                self._leave(error.names)
                self._stop.wait(CYCLE_S)
                continue
            except (DataError, IntegrityError) as error:
                logger.error("the database cannot hold something of %d messages: %s", len(self._held), error.orig)
                self._apart = True
                continue
            except (DBAPIError, TimeoutError) as error:
                # What was received stays in memory and in the queue until the database takes it.
                self.trouble = self._submissions.trouble = _words(error)
                logger.error("samples cannot be stored, trying again: %s", self.trouble)
                self._break_promises(NotStoring(self.trouble))
                self._expected.clear()
                if stopping:
                    return
                self._stop.wait(RETRY_S)
                continue
            except Exception:
                # One message must never end the ingest of all others.
                logger.exception("unexpected error in ingest; %d messages are stored one by one", len(self._held))
                self._apart = True
                self._errors += 1
                if self._errors > 1:  # storing one by one was no help
                    self.trouble = "unexpected error; the log has it"
                    if stopping:
                        self._break_promises(NotStoring(self.trouble))
                        return
                    self._stop.wait(RETRY_S)
                continue
            if stopping and count == 0:
                return
            if count == 0 or (count < BACKLOG and not self._healing.asking):
                self._submissions.wait(HEALING_CYCLE_S if self._healing.asking else CYCLE_S)

    def _check(self) -> None:
        """What is done now and then; samples are stored though it fails."""
        try:
            self._healing.check_tails(quiet_s=TAIL_CHECK_S)
            alive = {key.machine for key in self._healing.live}
            self._journal.close_silent(silence_s=self._silence_s, alive=alive)
            self._unchecked = None
        except NotHeld:
            raise
        except (DBAPIError, TimeoutError) as error:
            self._unchecked = f"runs cannot be closed: {_words(error)}"
            logger.error("runs cannot be closed, trying again: %s", _words(error))
        except Exception:
            self._unchecked = "unexpected error; the log has it"
            logger.exception("unexpected error while logs are asked and runs are closed, trying again")

    def _cycle(self) -> int:
        """Take what is queued, at most LARGEST_CYCLE messages a way, and store it. Returns how many there were."""
        self._store()  # what the database refused before; nothing more is taken until it is in
        if self._changes != self._share.changes:
            self._changes = self._share.changes
            self._expected.clear()
            self._journal.forget()
            self._healing.review()
        while (token := self._tokens.try_recv()) is not None:
            self._healing.token(token)
        while (question := self._questions.try_recv()) is not None:
            self._answer(question)
        if self._stop.is_set():
            self._inbox.close()  # what comes from now on waits in the sources' logs
            self._healing.cease()
        self._journal.give_way.begin(hurried=len(self._inbox) >= BACKLOG or self._healing.asking)
        taken = 0
        while taken < LARGEST_CYCLE and (message := self._inbox.take()) is not None:
            taken += 1
            try:
                self._admit(message)
            except (DBAPIError, TimeoutError):
                self._inbox.put_back(message)
                raise
            self._journal.give_way()
        submitted, failing = 0, set[str]()
        while submitted < LARGEST_CYCLE and (submission := self._submissions.take()) is not None:
            submitted += 1
            try:
                self._submit(submission)
            except Exception as error:
                if concerns_all(error):
                    submission.promise.set_exception(NotStoring(_words(error)))
                    raise
                logger.exception("%s: a batch over HTTP cannot be looked at", submission.machine)
                where = f"POST /api/v1/machines/{submission.machine}/samples"
                self._refuse_unexpected(where, submission.machine, submission.body, error, received_at=now())
                submission.promise.set_exception(NotStoring(UNEXPECTED))
                failing.add(submission.machine)
        replayed = self._healing.collect(LARGEST_CYCLE)
        failing -= {arrived.batch.machine for arrived, _ in self._held.values()}
        self._store()
        for machine in failing:
            self._put_machine_off(machine)
        return taken + submitted + replayed

    def _store(self) -> None:
        if self._held or self._rejections:
            outcomes = self._journal.store([arrived for arrived, _ in self._held.values()], self._rejections)
            for (_, promise), outcome in zip(self._held.values(), outcomes, strict=True):
                if promise is not None:
                    promise.set_result(outcome)
            if self._put_off:
                for arrived, _ in self._held.values():
                    self._put_off.succeeded(arrived.batch.machine)
            self._held.clear()
            self._rejections.clear()
        for promise, rejected in self._refused:
            promise.set_exception(rejected)
        self._refused.clear()

    def _one_by_one(self) -> None:
        """Store each message by itself; one that cannot be stored is put aside, and stops nothing. Of the machines of which
        nothing could be stored, those that failed before are put off.

        Raises what concerns all of them; what is not yet stored is then tried again.
        """
        try:
            self._journal.store([], self._rejections)
        except Exception as error:
            if concerns_all(error):
                raise
            logger.exception("%d rejections cannot be kept", len(self._rejections))
        self._rejections.clear()
        stored, failed, left = set[str](), Counter[str](), set[str]()
        for number, (one, promise) in list(self._held.items()):
            machine = one.batch.machine
            # More each time: behind many that cannot be stored there may be some that can.
            most = MOST_TRIES << min(self._put_off.failures(machine), 6)
            if failed[machine] >= most and machine not in stored:
                left.add(machine)
                if promise is not None:
                    promise.set_exception(NotStoring(UNEXPECTED))
            else:
                try:
                    outcome = self._stored_alone(one)
                except Exception as error:
                    if concerns_all(error):
                        raise
                    failed[machine] += 1
                    self._put_aside(one, error, promise)
                else:
                    stored.add(machine)
                    if promise is not None:
                        promise.set_result(outcome)
            del self._held[number]
        self._apart = False
        for machine in stored:
            self._put_off.succeeded(machine)
        for machine in failed.keys() - stored:
            self._put_machine_off(machine, at_once=machine in left)

    def _put_machine_off(self, machine: str, *, at_once: bool = False) -> None:
        """Nothing of it is taken for a while, lest it hold up all others again and again; its sources' logs have it."""
        pause = self._put_off.failed(machine, at_once=at_once)
        if pause:
            logger.error("%s: nothing of it could be stored again; it is left to its sources' logs for %.0f s", machine, pause)
            self._healing.leave(machine)
            for source in [source for source in self._expected if source.machine_id == machine]:
                del self._expected[source]

    def _takes(self, machine: str) -> bool:
        """Whether a machine's samples are stored here, now."""
        return self._share.owns(machine) and self._put_off.is_due(machine)

    def _put_aside(self, one: Arrived, error: Exception, promise: Future[Outcome] | None) -> None:
        answer: Exception
        reason: Reason | OwnFault
        if isinstance(error, DBAPIError):
            reason, detail = "undecodable", f"the database cannot hold it: {error.orig}"
            answer = Rejected(reason, detail)
        else:
            logger.error("%s: a message cannot be stored", one.batch.machine, exc_info=error)
            reason, detail = "unexpected_error", _unexpected(error)
            answer = NotStoring(UNEXPECTED)
        self._reject(one.key, one.batch.machine, one.payload, reason, detail, received_at=one.received_at)
        if promise is not None:
            promise.set_exception(answer)

    def _stored_alone(self, one: Arrived) -> Outcome:
        """Tried twice: what another replica wrote at the same moment is there the second time."""
        try:
            (outcome,) = self._journal.store([one], [])
        except IntegrityError:
            (outcome,) = self._journal.store([one], [])
        return outcome

    def _leave(self, names: Collection[str]) -> None:
        """Drop what is another replica's to store: it fetches it from the sources' logs."""
        held, self._held = self._held, {}
        for number, (one, promise) in held.items():
            if lease_of(one.batch.machine) not in names:
                self._held[number] = one, promise
            elif promise is not None:
                promise.set_exception(NotStoring("another replica takes this machine's samples now"))
        self._expected.clear()
        self._journal.forget()

    def _break_promises(self, error: Exception) -> None:
        """Say to all who wait that what they sent is not known to be durable."""
        waiting = [promise for _, promise in self._held.values() if promise is not None]
        waiting += [promise for promise, _ in self._refused]
        while (submission := self._submissions.take()) is not None:
            waiting.append(submission.promise)
        for promise in waiting:
            promise.set_exception(error)
        self._held = {number: (one, None) for number, (one, _) in self._held.items()}
        self._refused.clear()

    def _answer(self, question: zenoh.Query) -> None:
        """How far the sources of a machine are durable."""
        with question:
            try:
                key = Key.parse(str(question.key_expr))
            except Rejected:
                return  # of all machines at once: each is asked for by itself
            if self._share.owns(key.machine) and self._journal.plant_of(key.machine) == key.plant:
                answer = Received(plant=key.plant, machine=key.machine, sources=self._journal.received(key.machine))
                question.reply(key.received, msgspec.json.encode(answer), encoding=JSON)

    def _submit(self, submission: Submission) -> None:
        """Queue a batch that came over HTTP: its source keeps no log, so nothing is asked for that may be missing."""
        received_at = now()
        if not self._put_off.is_due(submission.machine):
            words = f"unexpected errors with machine '{submission.machine}'; it is tried again later"
            submission.promise.set_exception(NotStoring(words))
            return
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
            reason, detail = rejected.reason, rejected.detail
            self._reject(where, submission.machine, submission.body, reason, detail, received_at=received_at)
            self._refused.append((submission.promise, rejected))
            return
        self._take(Arrived(batch, where, submission.body, received_at), submission.promise)

    def _admit(self, message: Message) -> None:
        """Decode a published message and place it."""
        try:
            key = Key.parse(message.key)
        except Rejected as rejected:
            if self._share.owns(message.key):
                self._refuse(message, None, rejected)
            return
        if not self._takes(key.machine):
            return
        arrived = self._read(key, message)
        if arrived is not None:
            self._healing.place(key, arrived)

    def _read_reply(self, key: Key, reply: zenoh.Sample) -> Arrived | None:
        return self._read(key, replace(Message.of(reply), key=key.samples))

    def _read(self, key: Key, message: Message) -> Arrived | None:
        """A message as a batch, None when it is rejected."""
        try:
            require_size(message.size)
            batch = decode_batch(key, message.payload, message.encoding)
            self._require_machine(key)
        except Rejected as rejected:
            self._refuse(message, key.machine, rejected)
            return None
        except Exception as error:
            if concerns_all(error):
                raise
            logger.exception("a message under %s cannot be looked at", message.key)
            self._refuse_unexpected(message.key, key.machine, message.payload, error, received_at=message.received_at)
            return None
        return Arrived(batch, message.key, message.payload, message.received_at)

    def _refuse(self, message: Message, machine: str | None, rejected: Rejected) -> None:
        received_at, size = message.received_at, message.size
        reason, detail = rejected.reason, rejected.detail
        self._reject(message.key, machine, message.payload, reason, detail, received_at=received_at, size=size)

    def _refuse_unexpected(self, key: str, machine: str | None, payload: bytes, error: Exception, *, received_at: int) -> None:
        self._reject(key, machine, payload, "unexpected_error", _unexpected(error), received_at=received_at)

    def _reject(
        self,
        key: str,
        machine: str | None,
        payload: bytes,
        reason: Reason | OwnFault,
        detail: str,
        *,
        received_at: int,
        size: int | None = None,
    ) -> None:
        """Keep what was not taken, by its reason. size: of all of it, where the payload is not [bytes]."""
        self._rejections.append(
            Rejection.of_message(
                received_at=received_at,
                key=key,
                machine_id=machine,
                reason=reason,
                detail=detail,
                payload=payload,
                size=size,
            )
        )

    def _take(self, arrived: Arrived, promise: Future[Outcome] | None = None) -> None:
        """Queue a batch for storing."""
        batch, source = arrived.batch, source_key(arrived.batch)
        if batch.sequence - self._next(source) <= LARGEST_GAP:
            self._expected[source] = max(self._next(source), batch.sequence + len(batch.time_ns))
        self._held[self._count] = arrived, promise
        self._count += 1

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


def _words(error: Exception) -> str:
    """What the database said, or what said that there is none."""
    return str(getattr(error, "orig", None) or error)


def _unexpected(error: Exception) -> str:
    return f"the service's log has it: {type(error).__name__}: {error}"
