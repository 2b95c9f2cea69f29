"""Quarantine entries for batches and samples that are not stored."""

from collections.abc import Sequence
from dataclasses import replace

from sqlalchemy.exc import DBAPIError

from formats.wire import Fault, InternalErrorReason, Reason, Rejected
from service.resilience.internal_errors import see_log
from service.write_path.batch import ArrivedBatch
from service.write_path.http_queue import UNFORESEEN, NotStoring
from storage.database.damage import is_damage
from storage.measurements.quarantine import Rejection

LARGEST_FAULT_COUNT = 5
"""Faults per reason and batch that the quarantine shows: a source with a wrong unit has one in every value."""


def of_batch(arrived: ArrivedBatch, reason: str, detail: str) -> Rejection:
    """Return the entry for a batch that is rejected as a whole."""
    return Rejection(arrived.received_at, arrived.key, arrived.batch.machine, reason, detail, arrived.payload)


def of_samples(arrived: ArrivedBatch, faults: Sequence[Fault]) -> list[Rejection]:
    """Return entries for the first few faults of each reason; the last of them represents all others of the batch, too."""
    found = []
    for reason in dict.fromkeys(fault.reason for fault in faults):
        same = [fault for fault in faults if fault.reason == reason]
        kept = [_of_sample(arrived, fault) for fault in same[:LARGEST_FAULT_COUNT]]
        if others := len(same) - len(kept):
            kept[-1] = replace(kept[-1], detail=f"{kept[-1].detail}; and {others} more in this batch", count=1 + others)
        found += kept
    return found


def of_error(arrived: ArrivedBatch, error: Exception) -> tuple[Rejection, Exception]:
    """Return the entry for a batch that could not be stored, and the answer to whoever waits for it."""
    reason: Reason | InternalErrorReason
    answer: Exception
    if isinstance(error, DBAPIError) and not is_damage(error):
        reason, detail = "undecodable", f"the database cannot hold it: {error.orig}"
        answer = Rejected(reason, detail)
    else:
        reason, detail = "unexpected_error", see_log(error)
        answer = NotStoring(UNFORESEEN)
    rejection = Rejection.of_message(
        received_at=arrived.received_at,
        key=arrived.key,
        machine_id=arrived.batch.machine,
        reason=reason,
        detail=detail,
        payload=arrived.payload,
    )
    return rejection, answer


def _of_sample(arrived: ArrivedBatch, fault: Fault) -> Rejection:
    batch, i = arrived.batch, fault.index
    sample = {
        "source": batch.source,
        "epoch": batch.epoch,
        "sequence": batch.sequence + i,
        "time_ns": batch.time_ns[i],
        "speed": batch.speed[i],
        "channels": batch.channels,
        "amplitude": batch.amplitude[i],
        "phase": batch.phase[i],
    }
    payload = repr(sample).encode()
    return Rejection(arrived.received_at, arrived.key, batch.machine, fault.reason, fault.detail, payload)
