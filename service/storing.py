"""What was taken waits here until the end of the cycle, and is stored in one transaction; one by one where that fails, so that
what cannot be stored stops nothing else. A source of which nothing can be stored again and again is put off.
"""

import logging
from collections import Counter
from collections.abc import Callable, Collection, Iterator
from concurrent.futures import Future
from contextlib import contextmanager
from dataclasses import dataclass

from sqlalchemy.exc import DBAPIError, IntegrityError

from service.bounded import Bounded
from service.journal import LARGEST_GAP, Arrived, Journal, StoreOutcome
from service.own_faults import in_the_log
from service.putting_off import PutOff
from service.sharing import lease_of
from service.submissions import UNFORESEEN, NotStoring
from service.wire import OwnFault, Reason, Rejected, source_key
from storage.damage import is_damage
from storage.errors import concerns_all
from storage.quarantine import Rejection
from storage.samples import SourceKey

logger = logging.getLogger(__name__)

LONGEST_TRANSACTION_S = 0.012
"""After so long no further batch is taken into a transaction; what those that are in it cause comes on top."""
FEWEST_AT_ONCE, MOST_AT_ONCE = 20, 1000
"""Batches that a transaction is begun with: twice as many as the last one had time for, within these."""
FREE_FAILURES = 2
"""So often in a row a source may meet an unforeseen error before it is put off."""
MOST_TRIES = 50
"""Batches of a source that are tried by themselves though none of them could be stored; the others are left to its log."""
MOST_DOUBLINGS = 6
"""Of these tries, once for each time that it failed: behind many that cannot be stored there may be some that can."""


@dataclass(frozen=True)
class _Held:
    """A batch, and who waits to hear what became of it."""

    arrived: Arrived
    source: SourceKey
    promise: Future[StoreOutcome] | None


class Storing:
    """What is to be stored, and how far each source has come with it. For the ingest thread only.

    leave: told of a source that is put off. What it sends is left to its log until `takes` says otherwise.
    """

    def __init__(self, journal: Journal, *, leave: Callable[[SourceKey], None]) -> None:
        self._journal = journal
        self._leave = leave
        self._held: list[_Held] = []
        self._at_once = FEWEST_AT_ONCE
        self._rejections: list[Rejection] = []
        self._refused: list[tuple[Future[StoreOutcome], Exception]] = []
        self._expected: Bounded[SourceKey, int] = Bounded()
        self._waits = PutOff[SourceKey](free=FREE_FAILURES)

    def __len__(self) -> int:
        """Batches that are held."""
        return len(self._held)

    def takes(self, source: SourceKey) -> bool:
        """Whether a source's batches are stored now."""
        return self._waits.is_due(source)

    def next_sequence(self, source: SourceKey) -> int:
        """Number of the next sample of a source, what is held here included."""
        if source not in self._expected:
            self._expected[source] = self._journal.next_sequence(source)
        return self._expected[source]

    def take(self, arrived: Arrived, promise: Future[StoreOutcome] | None = None) -> None:
        """Hold a batch for storing."""
        batch, source = arrived.batch, source_key(arrived.batch)
        if batch.sequence - self.next_sequence(source) <= LARGEST_GAP:
            self._expected[source] = max(self.next_sequence(source), batch.sequence + len(batch.time_ns))
        self._held.append(_Held(arrived, source, promise))

    def reject(self, rejection: Rejection) -> None:
        """Keep what was refused."""
        self._rejections.append(rejection)

    def refuse(self, promise: Future[StoreOutcome], answer: Exception) -> None:
        """Answer who waits as soon as what was refused is kept."""
        self._refused.append((promise, answer))

    def store(self) -> None:
        """What is held, as much as one short transaction takes; each by itself where that fails. What is left is held still.

        Raises what concerns all, as `Journal.store` does; then nothing was stored.
        """
        try:
            self._store_together()
        except Exception as error:
            if concerns_all(error):
                raise
            logger.error("%d messages cannot be stored together: one by one", len(self._held), exc_info=error)
            self._store_one_by_one()
            self._keep_rejections()  # what was put aside
            self._answer_refused()

    def store_all(self) -> None:
        """All that is held. Raises as `store`."""
        while self._held or self._rejections:
            self.store()

    @contextmanager
    def guarding(self, arrived: Arrived, promise: Future[StoreOutcome] | None = None) -> Iterator[None]:
        """What nobody foresaw within is the trouble of this batch alone: it is put aside."""
        try:
            yield
        except Exception as error:
            if concerns_all(error):
                raise
            self.put_aside(arrived, error, promise)

    def put_aside(self, arrived: Arrived, error: Exception, promise: Future[StoreOutcome] | None = None) -> None:
        """Keep a batch that cannot be stored, and say so to who waits."""
        answer: Exception
        reason: Reason | OwnFault
        if isinstance(error, DBAPIError) and not is_damage(error):
            reason, detail = "undecodable", f"the database cannot hold it: {error.orig}"
            answer = Rejected(reason, detail)
        else:
            logger.error("%s: a message cannot be stored", arrived.batch.machine, exc_info=error)
            reason, detail = "unexpected_error", in_the_log(error)
            answer = NotStoring(UNFORESEEN)
        rejection = Rejection.of_message(
            received_at=arrived.received_at,
            key=arrived.key,
            machine_id=arrived.batch.machine,
            reason=reason,
            detail=detail,
            payload=arrived.payload,
        )
        self.reject(rejection)
        if promise is not None:
            self.refuse(promise, answer)

    def put_off(self, source: SourceKey, *, at_once: bool = True) -> None:
        """Nothing of it is taken for a while, lest it hold up all others again and again; its log has it."""
        pause = self._waits.failed(source, at_once=at_once)
        if pause:
            words = "%s, source %s: nothing could be stored again; it is left to its log for %.0f s"
            logger.error(words, source.machine_id, source.source, pause)
            self._expected.pop(source, None)
            self._leave(source)

    def drop(self, leases: Collection[str]) -> None:
        """Let go of what is another replica's to store: it fetches it from the sources' logs."""
        held, self._held = self._held, []
        for one in held:
            if lease_of(one.arrived.batch.machine) not in leases:
                self._held.append(one)
            elif one.promise is not None:
                one.promise.set_exception(NotStoring("another replica takes this machine's samples now"))
        self.look_again()

    def look_again(self) -> None:
        """What is stored may have changed: how far each source has come is to be read anew."""
        self._expected.clear()

    def break_promises(self, answer: Exception) -> None:
        """Say to all who wait that what they sent is not known to be durable. It is held still."""
        for one in self._held:
            if one.promise is not None:
                one.promise.set_exception(answer)
        for promise, _ in self._refused:
            promise.set_exception(answer)
        self._held = [_Held(one.arrived, one.source, None) for one in self._held]
        self._refused.clear()

    def _store_together(self) -> None:
        if self._held or self._rejections:
            arrived = [one.arrived for one in self._held[: self._at_once]]
            outcomes = self._journal.store(arrived, self._rejections, within_s=LONGEST_TRANSACTION_S)
            for one, outcome in zip(self._held, outcomes, strict=False):
                self._stored(one, outcome)
            del self._held[: len(outcomes)]
            self._rejections.clear()
            # What a transaction looks up for batches that it has no time for is looked up in vain.
            fitted = len(outcomes) == len(arrived)
            self._at_once = min(2 * self._at_once, MOST_AT_ONCE) if fitted else max(2 * len(outcomes), FEWEST_AT_ONCE)
        self._answer_refused()

    def _answer_refused(self) -> None:
        for promise, answer in self._refused:
            promise.set_exception(answer)
        self._refused.clear()

    def _store_one_by_one(self) -> None:
        """What cannot be stored is put aside; sources of which nothing could be, and that failed before, are put off."""
        self._keep_rejections()
        stored, failed = set[SourceKey](), Counter[SourceKey]()
        left: list[_Held] = []
        try:
            while self._held:
                one = self._held[0]
                if one.source not in stored and failed[one.source] >= self._most_tries(one.source):
                    left.append(one)
                elif self._stored_alone(one):
                    stored.add(one.source)
                else:
                    failed[one.source] += 1
                self._held.pop(0)
        except Exception:
            self._held[:0] = left
            raise
        for one in left:
            if one.promise is not None:
                self.refuse(one.promise, NotStoring(UNFORESEEN))
        at_once = {one.source for one in left}
        for source in failed.keys() - stored:
            self.put_off(source, at_once=source in at_once)

    def _stored(self, one: _Held, outcome: StoreOutcome) -> None:
        if self._waits and self._waits.is_due(one.source):  # not what was held already when it was put off
            self._waits.succeeded(one.source)
        if one.promise is not None:
            one.promise.set_result(outcome)

    def _keep_rejections(self) -> None:
        """One by one: one that cannot be kept takes no other with it."""
        while self._rejections:
            one = self._rejections[0]
            try:
                self._journal.store([], [one])
            except Exception as error:
                if concerns_all(error):
                    raise
                logger.exception("a message of %s, refused as %s, cannot be put aside", one.machine_id, one.reason)
            del self._rejections[0]

    def _most_tries(self, source: SourceKey) -> int:
        return MOST_TRIES << min(self._waits.failures(source), MOST_DOUBLINGS)

    def _stored_alone(self, one: _Held) -> bool:
        """Tried twice: what another replica wrote at the same moment is there the second time."""
        try:
            try:
                (outcome,) = self._journal.store([one.arrived], [])
            except IntegrityError:
                (outcome,) = self._journal.store([one.arrived], [])
        except Exception as error:
            if concerns_all(error):
                raise
            self.put_aside(one.arrived, error, one.promise)
            return False
        self._stored(one, outcome)
        return True
