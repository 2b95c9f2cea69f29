"""What went wrong though nothing was wrong with what came: told where rejected input is told, and by an alarm."""

from collections.abc import Iterable

from service.wire import OwnFault
from storage.clock import now
from storage.quarantine import Rejection


def own_fault(reason: OwnFault, *, of: str, machine_id: str, detail: str) -> Rejection:
    """An entry of the quarantine. of: what suffers from it, such as `run 5`."""
    return Rejection.of_message(received_at=now(), key=of, machine_id=machine_id, reason=reason, detail=detail, payload=b"")


def damaged_blocks(damaged: Iterable[str], *, run_id: int, machine_id: str) -> list[Rejection]:
    """Blocks that a run is without, though their samples were stored once. damaged: what is wrong with each."""
    of = f"run {run_id}"
    return [own_fault("damaged_block", of=of, machine_id=machine_id, detail=words) for words in dict.fromkeys(damaged)]


def unexpected(error: Exception, *, of: str, machine_id: str, what: str) -> Rejection:
    """An error that nobody foresaw. what: could not be done for it."""
    return own_fault("unexpected_error", of=of, machine_id=machine_id, detail=f"{what}; {in_the_log(error)}")


def in_the_log(error: Exception) -> str:
    """What the quarantine says of an error that nobody foresaw."""
    return f"the service's log has it: {type(error).__name__}: {error}"
