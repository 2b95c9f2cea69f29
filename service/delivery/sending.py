"""Sends within a deadline: every failure of a channel becomes an outcome."""

import asyncio
from collections.abc import Coroutine
from typing import Any

from service.delivery.channel import DeliveryOutcome

DEADLINE_S = 30.0
"""Time limit of an attempt [s], whatever it waits for: a name server, a free thread, a server that sends byte by byte."""


async def within_deadline(sending: Coroutine[Any, Any, DeliveryOutcome]) -> DeliveryOutcome:
    """Return the outcome of sending; exceeding the deadline or raising is a failure."""
    try:
        return await asyncio.wait_for(sending, DEADLINE_S)
    except TimeoutError:
        return DeliveryOutcome("failed", f"it was not done within {DEADLINE_S:g} s")
    except Exception as error:  # noqa: BLE001 - whatever a channel meets becomes the delivery's recorded failure
        return DeliveryOutcome("failed", f"{type(error).__name__}: {error}")


def outcome_of(ended: asyncio.Task[DeliveryOutcome]) -> DeliveryOutcome:
    """Return the outcome of a finished task, also of a cancelled or crashed one."""
    error = asyncio.CancelledError() if ended.cancelled() else ended.exception()
    return ended.result() if error is None else DeliveryOutcome("failed", f"{type(error).__name__}: {error}")
