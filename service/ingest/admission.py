"""Admission: each message becomes a batch of a known machine, or is rejected and kept in the quarantine with the reason."""

import logging
from dataclasses import replace

import zenoh

from formats.wire import InternalErrorReason, Key, Reason, Rejected, SampleBatch, decode_batch, decode_body, require_size
from service.ingest.clock_doubt import OwnClock
from service.ingest.inbox import PublishedMessage
from service.resilience.internal_errors import see_log
from service.write_path.batch import ArrivedBatch
from service.write_path.http_queue import UNFORESEEN, NotStoring, Submission
from service.write_path.refusals import Refusals
from service.write_path.sample_writer import SampleWriter
from storage.clock import now
from storage.database.errors import is_database_wide
from storage.measurements.quarantine import Rejection

logger = logging.getLogger(__name__)


class Admission:
    """Decoder of incoming messages, which also checks that the machine is known.

    own_clock: decides which batches must wait until the clock is right; these are neither stored nor rejected.
    """

    def __init__(self, writer: SampleWriter, refusals: Refusals, own_clock: OwnClock) -> None:
        self._writer = writer
        self._refusals = refusals
        self._own_clock = own_clock

    def published(self, key: Key, message: PublishedMessage) -> ArrivedBatch | None:
        """Return a published message as a batch; None when it is rejected or has to wait.

        Raises errors that affect all batches.
        """
        try:
            require_size(message.size)
            batch = decode_batch(key, message.payload, message.encoding)
            self._require_machine(key)
            if self._withholds(batch):
                return None
        except Rejected as rejected:
            self.refuse(message, key.machine, rejected)
            return None
        except Exception as error:
            if is_database_wide(error):
                raise
            logger.exception("a message under %s cannot be checked", message.key)
            self._refuse(message, key.machine, "unexpected_error", see_log(error))
            return None
        return ArrivedBatch(batch, message.key, message.payload, message.received_at)

    def replied(self, key: Key, reply: zenoh.Sample) -> ArrivedBatch | None:
        """Return a reply from a log as a batch; None when it is rejected or has to wait.

        Raises errors that affect all batches.
        """
        return self.published(key, replace(PublishedMessage.of(reply), key=key.samples))

    def submitted(self, submission: Submission) -> ArrivedBatch:
        """Return a body that came over HTTP or MQTT as a batch.

        Raises Rejected or NotStoring when it is not accepted, and errors that affect all batches.
        """
        machine, body, published = submission.machine, submission.body, submission.published
        where = f"POST /api/v1/machines/{machine}/samples" if published is None else published.topic
        message = PublishedMessage(where, body, submission.encoding, len(body), now())
        try:
            require_size(message.size)
            batch = _body_of(submission)
            arrived = ArrivedBatch(batch, message.key, body, message.received_at)
            self._require_machine(Key(batch.plant, batch.machine))
            if self._withholds(batch):
                raise NotStoring(self._own_clock.doubt or "this machine's clock is wrong")
            if published is None:  # its numbers must stay free for the corrected batch
                self._writer.require_convertible(arrived)
        except Rejected as rejected:
            self.refuse(message, machine or None, rejected)
            raise
        except NotStoring:
            raise
        except Exception as error:
            if is_database_wide(error):
                raise
            logger.exception("%s: a batch cannot be checked", where)
            self._refuse(message, machine or None, "unexpected_error", see_log(error))
            raise NotStoring(UNFORESEEN) from error
        return arrived

    def _withholds(self, batch: SampleBatch) -> bool:
        if not self._own_clock.withholds(batch):
            return False
        self._writer.note_activity(batch.machine)
        return True

    def refuse(self, message: PublishedMessage, machine: str | None, rejected: Rejected) -> None:
        """Store a rejected message in the quarantine. machine: None when its key names none."""
        self._refuse(message, machine, rejected.reason, rejected.detail)

    def _refuse(
        self, message: PublishedMessage, machine: str | None, reason: Reason | InternalErrorReason, detail: str
    ) -> None:
        rejection = Rejection.of_message(
            received_at=message.received_at,
            key=message.key,
            machine_id=machine,
            reason=reason,
            detail=detail,
            payload=message.payload,
            size=message.size,
        )
        self._refusals.reject(rejection)

    def _require_machine(self, key: Key) -> None:
        plant = self._writer.plant_of(key.machine)
        if plant is None:
            raise Rejected("unknown_machine", f"no machine '{key.machine}' is known; create it from its document first")
        if plant != key.plant:
            raise Rejected("unknown_machine", f"machine '{key.machine}' belongs to plant '{plant}', not '{key.plant}'")


def _body_of(submission: Submission) -> SampleBatch:
    """Return the batch in a body, which must be of the machine that it came for. Raises Rejected."""
    published = submission.published
    if published is not None and published.fault is not None:
        raise published.fault
    batch = decode_body(submission.body, submission.encoding)
    if published is not None and (batch.plant, batch.machine) != (published.plant, submission.machine):
        told = f"{batch.plant[:64]}/{batch.machine[:64]}"
        raise Rejected("key_mismatch", f"body says {told}, topic says {published.plant}/{submission.machine}")
    if batch.machine != submission.machine:
        raise Rejected("key_mismatch", f"body says machine '{batch.machine[:64]}', the path '{submission.machine}'")
    return batch
