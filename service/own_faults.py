"""What went wrong though nothing was wrong with what came: told where rejected input is told, and by an alarm."""

from sqlalchemy.exc import DataError, DBAPIError, IntegrityError, TimeoutError

from service.wire import OwnFault
from storage.clock import now
from storage.leases import NotHeld
from storage.quarantine import Rejection


def concerns_all(error: BaseException) -> bool:
    """Whether an error is the database's, or of who may write to it: whatever else is tried now would fail as well."""
    of_one = isinstance(error, DataError | IntegrityError)
    return isinstance(error, NotHeld | DBAPIError | TimeoutError) and not of_one


def own_fault(reason: OwnFault, *, of: str, machine_id: str, detail: str) -> Rejection:
    """An entry of the quarantine. of: what suffers from it, such as `run 5`."""
    return Rejection.of_message(received_at=now(), key=of, machine_id=machine_id, reason=reason, detail=detail, payload=b"")


def unexpected(error: Exception, *, of: str, machine_id: str, what: str) -> Rejection:
    """An error that nobody foresaw. what: could not be done for it."""
    detail = f"{what}; the service's log has it: {type(error).__name__}: {error}"
    return own_fault("unexpected_error", of=of, machine_id=machine_id, detail=detail)
