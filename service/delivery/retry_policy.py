"""Schedule of retries, and the end of them, as Standard Webhooks recommends."""

import logging

from sqlalchemy.orm import Session

from service.delivery.channel import DeliveryOutcome
from storage.alerts import deliveries
from storage.clock import now
from storage.encoding.text import plain_text

logger = logging.getLogger(__name__)

RETRIES_S = (5.0, 300.0, 1800.0, 7200.0, 18_000.0, 36_000.0, 50_400.0, 72_000.0, 86_400.0)
"""Pauses before the second attempt and each later one [s]; after the last the delivery is given up."""
LONGEST_RETRY_AFTER_S = 86_400.0
"""Largest Retry-After of a receiver that is respected [s]."""
LONGEST_ANSWER = 2000
"""Largest number of characters of an answer that are stored."""
SECOND = 1_000_000_000


def record_outcome(session: Session, number: int, outcome: DeliveryOutcome) -> None:
    """Store the outcome of a delivery and the time of its next attempt. Raises DeliveryUnknown."""
    row = deliveries.delivery(session, number)
    row.attempts += 1
    row.last_try_at = now()
    # The answer is untrusted: characters that cannot be stored must not stop the deliveries to others.
    answer = row.answer = plain_text(outcome.answer)[:LONGEST_ANSWER]
    if outcome.result == "delivered":
        row.state = deliveries.DELIVERED
    elif outcome.result == "gone":
        row.state = deliveries.GIVEN_UP
        subscription = deliveries.get(session, row.subscription_id)
        deliveries.disable(session, subscription, f"the receiver answered {answer[:200]}")
        logger.warning("subscription '%s' is disabled: its receiver is gone", subscription.name)
    elif row.attempts > len(RETRIES_S):
        row.state = deliveries.GIVEN_UP
        logger.warning("delivery %d is given up after %d tries: %s", number, row.attempts, answer[:200])
    elif row.state == deliveries.PENDING:
        retry_after = min(outcome.retry_after or 0.0, LONGEST_RETRY_AFTER_S)
        row.next_try_at = now() + int(max(RETRIES_S[row.attempts - 1], retry_after) * SECOND)


def give_up(session: Session, number: int, reason: str) -> None:
    """Give a delivery up. Raises DeliveryUnknown."""
    row = deliveries.delivery(session, number)
    row.state, row.last_try_at, row.answer = deliveries.GIVEN_UP, now(), plain_text(reason)[:LONGEST_ANSWER]
