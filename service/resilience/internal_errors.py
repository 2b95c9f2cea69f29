"""Internal errors: failures in spite of valid input. They are kept beside rejected input, and raise an alarm."""

from collections.abc import Iterable

from formats.wire import InternalErrorReason
from storage.clock import now
from storage.measurements.quarantine import Rejection


def internal_error(reason: InternalErrorReason, *, of: str, machine_id: str, detail: str) -> Rejection:
    """Return a quarantine entry for an internal error. of: the subject affected, such as `run 5`."""
    return Rejection.of_message(received_at=now(), key=of, machine_id=machine_id, reason=reason, detail=detail, payload=b"")


def damaged_blocks(damaged: Iterable[str], *, run_id: int, machine_id: str) -> list[Rejection]:
    """Return entries for stored blocks that a run has to do without. damaged: the fault of each."""
    of = f"run {run_id}"
    return [internal_error("damaged_block", of=of, machine_id=machine_id, detail=words) for words in dict.fromkeys(damaged)]


def unexpected_error(error: Exception, *, of: str, machine_id: str, what: str) -> Rejection:
    """Return an entry for an unexpected error. what: the action that failed because of it."""
    return internal_error("unexpected_error", of=of, machine_id=machine_id, detail=f"{what}; {see_log(error)}")


def see_log(error: Exception) -> str:
    """Return the quarantine's text for an unexpected error."""
    return f"the service's log has it: {type(error).__name__}: {error}"
