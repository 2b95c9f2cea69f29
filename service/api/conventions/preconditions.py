"""Guards changes against lost updates: strong ETags, and If-Match on changes (RFC 9110 §13, RFC 6585 §3).

An ETag is a digest of the answer that it comes with. It changes exactly when the answer changes.
"""

import hashlib
from typing import Annotated, TypeVar

from fastapi import Header, Response
from pydantic import BaseModel

from estimator.errors import Outdated, Unconditional

IfMatch = Annotated[
    str | None,
    Header(description="ETag of what was read, or * for whatever there is; without it a change is answered with 428"),
]


Answer = TypeVar("Answer", bound=BaseModel)


ANYTHING = "*"
"""If-Match value that matches any state."""


class PreconditionMissing(Unconditional):
    """A change came without If-Match."""


class Stale(Outdated):
    """The client's ETag does not match the current state."""


def etag(answer: BaseModel) -> str:
    """Return the strong ETag of an answer."""
    return f'"{hashlib.sha256(answer.model_dump_json().encode()).hexdigest()[:32]}"'


def tagged(response: Response, answer: Answer) -> Answer:
    """Return the answer and set its ETag in the response's header."""
    response.headers["ETag"] = etag(answer)
    return answer


def require(if_match: str | None, *current: BaseModel) -> None:
    """Raise PreconditionMissing without If-Match, and Stale where it names no ETag of the state in any representation."""
    if if_match is None:
        raise PreconditionMissing(
            "say with If-Match which state is to be changed: the ETag that it was read with, or * for whatever there is"
        )
    given = [one.strip() for one in if_match.split(",")]
    # A weak tag, W/"…", never matches here.
    if given != [ANYTHING] and not any(etag(one) in given for one in current):
        raise Stale("it was changed since it was read: read it again, and decide again with the new ETag")
