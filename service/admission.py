"""What came becomes a batch of a machine that is known, or is refused: kept in the quarantine, with the reason."""

import logging
from collections.abc import Callable

from service.inbox import Message
from service.journal import Arrived, Journal
from service.own_faults import in_the_log
from service.submissions import UNFORESEEN, NotStoring, Submission
from service.wire import Key, OwnFault, Reason, Rejected, decode_batch, decode_body, require_size
from storage.clock import now
from storage.errors import concerns_all
from storage.quarantine import Rejection

logger = logging.getLogger(__name__)


class Admission:
    """Decodes, and looks whether the machine is known. reject: takes what is to be kept of what was refused."""

    def __init__(self, journal: Journal, *, reject: Callable[[Rejection], None]) -> None:
        self._journal = journal
        self._reject = reject

    def published(self, key: Key, message: Message) -> Arrived | None:
        """A message that was published, or that a log has answered; None when it is refused. Raises what concerns all."""
        try:
            require_size(message.size)
            batch = decode_batch(key, message.payload, message.encoding)
            self._require_machine(key)
        except Rejected as rejected:
            self.refuse(message, key.machine, rejected)
            return None
        except Exception as error:
            if concerns_all(error):
                raise
            logger.exception("a message under %s cannot be looked at", message.key)
            self._refuse(message, key.machine, "unexpected_error", in_the_log(error))
            return None
        return Arrived(batch, message.key, message.payload, message.received_at)

    def submitted(self, submission: Submission) -> Arrived:
        """A body that came over HTTP. Raises Rejected or NotStoring when it is refused, and what concerns all."""
        machine, body = submission.machine, submission.body
        message = Message(f"POST /api/v1/machines/{machine}/samples", body, submission.encoding, len(body), now())
        try:
            require_size(message.size)
            batch = decode_body(body, message.encoding)
            if batch.machine != machine:
                raise Rejected("key_mismatch", f"body says machine '{batch.machine[:64]}', the path '{machine}'")
            self._require_machine(Key(batch.plant, batch.machine))
            # Its numbers must stay free for the corrected batch.
            self._journal.require_convertible(batch, received_at=message.received_at)
        except Rejected as rejected:
            self.refuse(message, machine, rejected)
            raise
        except Exception as error:
            if concerns_all(error):
                raise
            logger.exception("%s: a batch over HTTP cannot be looked at", machine)
            self._refuse(message, machine, "unexpected_error", in_the_log(error))
            raise NotStoring(UNFORESEEN) from error
        return Arrived(batch, message.key, body, message.received_at)

    def refuse(self, message: Message, machine: str | None, rejected: Rejected) -> None:
        """Keep a message that was not taken. machine: None where its key names none."""
        self._refuse(message, machine, rejected.reason, rejected.detail)

    def _refuse(self, message: Message, machine: str | None, reason: Reason | OwnFault, detail: str) -> None:
        rejection = Rejection.of_message(
            received_at=message.received_at,
            key=message.key,
            machine_id=machine,
            reason=reason,
            detail=detail,
            payload=message.payload,
            size=message.size,
        )
        self._reject(rejection)

    def _require_machine(self, key: Key) -> None:
        plant = self._journal.plant_of(key.machine)
        if plant is None:
            raise Rejected("unknown_machine", f"no machine '{key.machine}' is known; create it from its document first")
        if plant != key.plant:
            raise Rejected("unknown_machine", f"machine '{key.machine}' belongs to plant '{plant}', not '{key.plant}'")
