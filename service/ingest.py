"""To the journal: the thread that takes what zenoh and HTTP deliver, and goes on whatever happens.

`service/admission.py` makes batches of it, `service/healing.py` fetches what is missing before them, `service/storing.py`
stores them.
"""

import logging
import threading
import time
from collections.abc import Callable
from dataclasses import replace

import msgspec
import zenoh

from service.admission import Admission
from service.clock_doubt import OwnClock
from service.healing import Healing
from service.inbox import Inbox, PublishedMessage
from service.journal import Arrived, Journal
from service.sharing import Share, Whole
from service.storing import Storing
from service.submissions import UNFORESEEN, NotStoring, Submission, Submissions
from service.wire import ALL_LIVE, ALL_RECEIVED, ALL_SAMPLES, JSON, Key, Received, Rejected, source_key
from storage.errors import concerns_all, words
from storage.leases import NotHeld
from storage.longest import Longest

logger = logging.getLogger(__name__)

TOKENS = 50_000
"""Comings and goings of sources that wait."""
LARGEST_CYCLE = 1_000
"""Messages that are held at once."""
LARGEST_COLLECTION = 200
"""Of those that logs answer, taken at once."""
TAKING_S = 0.03
"""After so long no further message is taken before those that are held are stored."""
CYCLE_S = 0.1
"""What comes within this time is stored together, as far as it is not much, …"""
BACKLOG = 200
"""… unless so many messages have come: then there is no pause."""
HEALING_CYCLE_S = 0.05
"""Pause between looks for what logs answer."""
TAIL_CHECK_S = 2.0
"""How often a live source's log is asked for samples that never came."""
DOUBTED_CHECK_S = 30.0
"""The same while the own clock is wrong: what logs answer has to wait, too."""
STALLED_S = 5.0
"""A cycle that lasts longer waits for the database, and the service is not ready."""
RETRY_S = 1.0
"""Pause after the database refused to store."""
LAST_TRIES = 2
"""To store what is held, of a service that ends."""
TROUBLE_OF_OUR_OWN = "unexpected error; the log has it"


class Ingest:
    """The thread. Callbacks only enqueue; everything else happens here."""

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
        self._share = share or Whole()
        self._changes = self._share.changes
        self._storing = Storing(journal, leave=lambda source: self._healing.leave(source))
        self._own_clock = OwnClock(journal.newest_receipt)
        self._admission = Admission(journal, reject=self._storing.reject, own_clock=self._own_clock)
        self._healing = Healing(
            session,
            expected=self._storing.next_sequence,
            missing=journal.missing,
            read=self._read_reply,
            take=self._storing.take,
            owns=self._share.owns,
            takes=self._storing.takes,
            put_off=self._storing.put_off,
        )
        self._inbox = Inbox()
        self._longest_cycle = Longest()
        self._is_behind = False  # there was more than there was time for
        self._errors = 0  # that nobody foresaw, in a row
        self._last_tries = LAST_TRIES
        self._trouble: str | None = None
        self._unchecked: str | None = None  # why what is done now and then was not done
        self._next_check = 0.0
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
        return {
            "rundown_ingest_queue_messages": len(self._inbox),
            "rundown_ingest_queue_bytes": self._inbox.size,
            "rundown_ingest_longest_cycle_seconds": self._longest_cycle.seconds,
            "rundown_clock_doubted": int(self._own_clock.doubt is not None),
        }

    @property
    def warnings(self) -> list[str]:
        """What does not hinder all of it and should be seen to."""
        return [] if self._own_clock.doubt is None else [self._own_clock.doubt]

    def _run(self) -> None:
        while True:
            stopping = self._stop.is_set()
            self._began = time.monotonic()
            try:
                with self._longest_cycle.measured():
                    count = self._cycle(stopping=stopping)
            except NotHeld as error:
                self._leave(error)
                continue
            except Exception as error:
                if concerns_all(error):
                    logger.error("samples cannot be stored, trying again: %s", words(error))
                    self._tell(words(error))
                else:
                    # One message must never end the ingest of all others.
                    logger.exception("unexpected error in ingest, going on")
                    self._errors += 1
                    if self._errors == 1:
                        continue
                    self._tell(TROUBLE_OF_OUR_OWN)
                if stopping and not self._tries_again(error):
                    return
                if stopping:
                    time.sleep(RETRY_S)
                else:
                    self._stop.wait(RETRY_S)
                continue
            if len(self._storing) or self._is_behind:
                continue
            if stopping and count == 0:
                return
            if count == 0 or (count < BACKLOG and not self._healing.asking):
                self._submissions.wait(HEALING_CYCLE_S if self._healing.asking else CYCLE_S)

    def _tries_again(self, error: Exception) -> bool:
        """Whether what could not be stored while stopping is tried once more; if not, it is said how much is given up."""
        self._last_tries -= 1
        if self._last_tries == 0:
            count = len(self._inbox) + len(self._storing)
            logger.error("at the end %d messages are not stored; only sources' logs have them still: %s", count, words(error))
        return self._last_tries > 0

    def _cycle(self, *, stopping: bool) -> int:
        """Take and store what has come; look after what is to be done now and then. Returns how many messages there were."""
        count = self._take_and_store()
        if self._own_clock.look():
            self._next_check = 0.0  # what was left to the logs is asked for
        if time.monotonic() >= self._next_check and not stopping:
            doubted = self._own_clock.doubt is not None
            self._next_check = time.monotonic() + (DOUBTED_CHECK_S if doubted else TAIL_CHECK_S)
            self._check()
        self.trouble = self._submissions.trouble = None
        self._errors = 0
        return count

    def _leave(self, error: NotHeld) -> None:
        """Drop what is another replica's to store."""
        logger.warning("machines were taken over by another replica: %s", error)
        self._storing.drop(error.names)
        self._journal.forget()
        self._stop.wait(CYCLE_S)

    def _tell(self, trouble: str) -> None:
        """Say why nothing is stored; to all who wait, that what they sent is not known to be durable."""
        self.trouble = self._submissions.trouble = trouble
        self._storing.look_again()
        self._storing.break_promises(NotStoring(trouble))
        while (submission := self._submissions.take()) is not None:
            submission.promise.set_exception(NotStoring(trouble))

    def _check(self) -> None:
        """What is done now and then; samples are stored though it fails."""
        unasked = self._tried("logs cannot be asked", lambda: self._healing.check_tails(quiet_s=TAIL_CHECK_S))
        alive = {key.machine for key in self._healing.live}
        unended = self._tried("runs cannot be ended", lambda: self._journal.end_silent(silence_s=self._silence_s, alive=alive))
        self._unchecked = unended or unasked

    def _tried(self, trouble: str, do: Callable[[], None]) -> str | None:
        """Do it; returns why it could not be done. Raises NotHeld."""
        try:
            do()
        except NotHeld:
            raise
        except Exception as error:
            if concerns_all(error):
                logger.error("%s, trying again: %s", trouble, words(error))
                return f"{trouble}: {words(error)}"
            logger.exception("%s, trying again", trouble)
            return f"{trouble}: {TROUBLE_OF_OUR_OWN}"
        return None

    def _take_and_store(self) -> int:
        """Take what is queued, as much as there is room and time for, and store as much as a short transaction takes.

        Returns how many messages were taken.
        """
        left = len(self._storing) > 0
        self._storing.store()  # what the database refused before; nothing more is taken until some of it is in
        if self._changes != self._share.changes:
            self._storing.store_all()
            self._storing.look_again()
            self._journal.forget()
            self._own_clock.forget()
            changes = self._share.changes
            self._healing.review()
            self._changes = changes  # reviewed again where the database went away within
        while (token := self._tokens.try_recv()) is not None:
            self._healing.token(token)
        while (question := self._questions.try_recv()) is not None:
            self._answer(question)
        if self._stop.is_set():
            self._inbox.close()  # what comes from now on waits in the sources' logs
            self._healing.cease()
        self._journal.give_way.begin(hurried=len(self._inbox) >= BACKLOG or self._healing.asking)
        self._is_behind = False
        count = self._take_published() + self._take_submitted() + self._healing.collect(min(self._room, LARGEST_COLLECTION))
        if not left:
            self._storing.store()
        return count

    @property
    def _room(self) -> int:
        """How many messages may still be held."""
        return max(0, LARGEST_CYCLE - len(self._storing))

    def _take_published(self) -> int:
        count, ends = 0, time.monotonic() + TAKING_S
        while self._room and time.monotonic() < ends and (message := self._inbox.take()) is not None:
            count += 1
            try:
                self._publication(message)
            except Exception as error:
                if concerns_all(error):
                    self._inbox.put_back(message)
                raise
            self._journal.give_way()
        self._is_behind |= time.monotonic() >= ends
        return count

    def _take_submitted(self) -> int:
        count, ends = 0, time.monotonic() + TAKING_S
        while self._room and time.monotonic() < ends and (submission := self._submissions.take()) is not None:
            count += 1
            try:
                self._submission(submission)
            except Exception as error:
                submission.promise.set_exception(NotStoring(words(error) if concerns_all(error) else UNFORESEEN))
                raise
        self._is_behind |= time.monotonic() >= ends
        return count

    def _publication(self, message: PublishedMessage) -> None:
        """Decode a published message and place it."""
        try:
            key = Key.parse(message.key)
        except Rejected as rejected:
            if self._share.owns(message.key):
                self._admission.refuse(message, None, rejected)
            return
        if self._share.owns(key.machine) and (arrived := self._admission.published(key, message)) is not None:
            with self._storing.guarding(arrived):
                self._healing.place(key, arrived)

    def _submission(self, submission: Submission) -> None:
        """Take a batch that came over HTTP: its source keeps no log, so nothing is asked for that may be missing."""
        try:
            arrived = self._admission.submitted(submission)
        except (Rejected, NotStoring) as refusal:
            self._storing.refuse(submission.promise, refusal)
            return
        if not self._storing.takes(source_key(arrived.batch)):
            where = f"source '{arrived.batch.source}' of machine '{submission.machine}'"
            submission.promise.set_exception(NotStoring(f"unexpected errors with {where}; it is tried again later"))
            return
        with self._storing.guarding(arrived, submission.promise):
            self._storing.take(arrived, submission.promise)

    def _read_reply(self, key: Key, reply: zenoh.Sample) -> Arrived | None:
        return self._admission.published(key, replace(PublishedMessage.of(reply), key=key.samples))

    def _answer(self, question: zenoh.Query) -> None:
        """How far the sources of a machine are durable."""
        with question:
            try:
                key = Key.parse(str(question.key_expr))
            except Rejected:
                return  # of all machines at once: each is asked for by itself
            try:
                self._reply_received(question, key)
            except Exception as error:
                if concerns_all(error):
                    raise
                logger.exception("%s: how far its sources are durable cannot be told", key.machine)

    def _reply_received(self, question: zenoh.Query, key: Key) -> None:
        if self._share.owns(key.machine) and self._journal.plant_of(key.machine) == key.plant:
            answer = Received(plant=key.plant, machine=key.machine, sources=self._journal.received(key.machine))
            question.reply(key.received, msgspec.json.encode(answer), encoding=JSON)
