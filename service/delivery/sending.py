"""Sending within a deadline: whatever a channel meets becomes an outcome."""

import asyncio
from collections.abc import Coroutine
from typing import Any

from service.delivery.channel import DeliveryOutcome

DEADLINE_S = 30.0
"""After so long a try has failed, whatever it waits for: a name server, a turn, a server that says a word now and then."""


async def within_deadline(sending: Coroutine[Any, Any, DeliveryOutcome]) -> DeliveryOutcome:
    """Return how sending ended; it has failed where it takes longer than the deadline or raises."""
    try:
        return await asyncio.wait_for(sending, DEADLINE_S)
    except TimeoutError:
        return DeliveryOutcome("failed", f"it was not done within {DEADLINE_S:g} s")
    except Exception as error:  # noqa: BLE001 - whatever a channel meets becomes the delivery's recorded failure
        return DeliveryOutcome("failed", f"{type(error).__name__}: {error}")


def outcome_of(ended: asyncio.Task[DeliveryOutcome]) -> DeliveryOutcome:
    """Return how a task ended, also where it broke off in a way that no channel should."""
    error = asyncio.CancelledError() if ended.cancelled() else ended.exception()
    return ended.result() if error is None else DeliveryOutcome("failed", f"{type(error).__name__}: {error}")
