"""HTTP status of each category of errors: the only table of statuses."""

from collections.abc import Mapping
from http import HTTPStatus

from estimator.errors import (
    Conflict,
    Damaged,
    DomainError,
    Gone,
    Invalid,
    LimitReached,
    Missing,
    NotAllowed,
    Outdated,
    Oversized,
    Unavailable,
    Unconditional,
    Unreadable,
)

STATUS: Mapping[type[DomainError], HTTPStatus] = {
    Invalid: HTTPStatus.UNPROCESSABLE_ENTITY,
    Unreadable: HTTPStatus.BAD_REQUEST,
    Oversized: HTTPStatus.REQUEST_ENTITY_TOO_LARGE,
    Missing: HTTPStatus.NOT_FOUND,
    Conflict: HTTPStatus.CONFLICT,
    NotAllowed: HTTPStatus.FORBIDDEN,
    Gone: HTTPStatus.GONE,
    Outdated: HTTPStatus.PRECONDITION_FAILED,
    Unconditional: HTTPStatus.PRECONDITION_REQUIRED,
    LimitReached: HTTPStatus.TOO_MANY_REQUESTS,
    Damaged: HTTPStatus.SERVICE_UNAVAILABLE,
    Unavailable: HTTPStatus.SERVICE_UNAVAILABLE,
}


def require_every_status() -> None:
    """Raise LookupError when a category of errors has no status: the service must not start without.

    The application calls it when all its modules are imported.
    """
    without = [one.__name__ for one in DomainError.__subclasses__() if one not in STATUS]
    if without:
        raise LookupError(
            f"categories of errors without a status in STATUS of service/http/error_status.py: {', '.join(without)}"
        )


def status_of(error: DomainError) -> HTTPStatus:
    """Return the status of an error's category."""
    return next(STATUS[kind] for kind in type(error).__mro__ if kind in STATUS)
