"""Samples over HTTP, for sources without zenoh: the same batches, answered once they are durable."""

import asyncio
import base64
import binascii
import hashlib
import re
from collections.abc import Mapping, Sequence
from http import HTTPStatus
from typing import Any, cast

from fastapi import APIRouter, HTTPException, Request, status

from estimator.close_matches import did_you_mean
from estimator.errors import Conflict, DomainError, Invalid, Missing, Oversized, Unavailable, Unreadable
from formats.wire import ENCODINGS, LARGEST_MESSAGE, Fault, Reason, Rejected, SampleBatch, unknown_fields
from service.api.conventions.dependencies import MachineId
from service.api.conventions.problems import RESPONSES
from service.api.measurements import schemas
from service.http.error_status import STATUS
from service.http.problem import Problem
from service.security.requirement import SOURCE
from service.write_path.http_queue import RETRY_AFTER_S, SubmissionSink

router = APIRouter(tags=["measurements"], responses=RESPONSES)

FIELDS = SampleBatch.__struct_fields__
"""Fields that a batch has."""
MOST_FAULTS = 100
"""Most faults that the refusal of a whole batch lists."""
PATIENCE_S = 15.0
"""Longest time that a request waits for its batch to be durable [s]."""

CATEGORY: Mapping[Reason, type[DomainError]] = {
    "too_large": Oversized,
    "bad_frame": Unreadable,
    "undecodable": Unreadable,
    "unknown_machine": Missing,
    "sequence_out_of_range": Conflict,
}
"""Category of a batch rejected as a whole, by its reason; all others are `Invalid`."""


class NotConfirmed(Unavailable):
    """Raised when a batch is not known to be durable, so that the source sends it again."""

    retry_after_s = RETRY_AFTER_S


class BatchRejected(Invalid):
    """Raised when every sample of a batch was refused. `faults`: why; `ignored`: fields of it that there are not."""

    def __init__(self, faults: Sequence[Fault], ignored: Sequence[str] = ()) -> None:
        first = f"{faults[0].reason}: {faults[0].detail}"
        super().__init__(f"no sample was taken, {len(faults)} faults, the first {first}; send them mended, under new numbers")
        self.faults, self.ignored = faults, ignored

    @property
    def field_errors(self) -> Sequence[tuple[str, str]]:
        """Return the first faults, each at its sample, then the fields that there are not."""
        found = [(f"samples[{one.index}]", f"{one.reason}: {one.detail}") for one in self.faults[:MOST_FAULTS]]
        return found + [(name, f"there is no such field{did_you_mean(name, FIELDS)}") for name in self.ignored]


_DIGEST = re.compile(r"\s*([a-z0-9-]+)=:([A-Za-z0-9+/=]*):\s*\Z")
_HASHES = {"sha-256": hashlib.sha256, "sha-512": hashlib.sha512}

_SCHEMA: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "description": "a batch of samples, as docs/integrators.md describes it, without the frame line",
        "content": {encoding: {} for encoding in ENCODINGS},
    }
}
_ANSWERS: dict[int | str, dict[str, Any]] = {
    code: {"model": Problem, "description": HTTPStatus(code).phrase} for code in (400, 409, 413, 415, 429, 503)
}


@router.post(
    "/machines/{machine_id}/samples",
    operation_id="add_samples",
    dependencies=[SOURCE],
    responses=_ANSWERS,
    openapi_extra=_SCHEMA,
)
async def add_samples(request: Request, machine_id: MachineId) -> schemas.Submitted:
    """Store a batch of samples, each once: the same batch may be sent again until an answer comes.

    Everything confirmed by the answer is durable. Invalid samples are listed with the reason, and the others are stored;
    where none is left, the answer is 422. Fields that there are not are named. A
    batch rejected as a whole may be sent again corrected, under the same numbers.
    """
    submissions = cast(SubmissionSink | None, request.app.state.submissions)
    if submissions is None:
        raise NotConfirmed("this process takes no samples")
    encoding = request.headers.get("content-type", "")
    if encoding.split(";")[0].strip().lower() not in ENCODINGS:
        raise HTTPException(
            status.HTTP_415_UNSUPPORTED_MEDIA_TYPE, f"Content-Type '{encoding}' is not one of {', '.join(ENCODINGS)}"
        )
    body = await _body(request)
    try:
        promise = submissions.offer(machine_id, body, encoding)
        outcome = await asyncio.wait_for(asyncio.wrap_future(promise), PATIENCE_S)
        if outcome.rejected is not None:
            raise outcome.rejected
    except Rejected as rejected:
        code = STATUS[CATEGORY.get(rejected.reason, Invalid)]
        unknown = await _named_unknown(body, encoding)
        also = f"; there is no field {', no field '.join(unknown)}" if unknown else ""
        raise HTTPException(code, f"{rejected.reason}: {rejected.detail}{also}") from None
    except TimeoutError:
        raise NotConfirmed(f"not known to be durable after {PATIENCE_S:.0f} s; send it again") from None
    if outcome.faults and outcome.received == outcome.duplicates == 0:
        raise BatchRejected(outcome.faults, await asyncio.to_thread(unknown_fields, body, encoding))
    return schemas.Submitted(
        received=outcome.received,
        duplicates=outcome.duplicates,
        missing_before=outcome.lost,
        faults=[schemas.SampleFault(index=f.index, reason=f.reason, detail=f.detail) for f in outcome.faults],
        ignored=await _named_unknown(body, encoding),
    )


async def _named_unknown(body: bytes, encoding: str) -> list[str]:
    """Return the fields of a batch that there are not, each with what was probably meant."""
    found = await asyncio.to_thread(unknown_fields, body, encoding)
    return [f"{name}{did_you_mean(name, FIELDS)}" for name in found]


async def _body(request: Request) -> bytes:
    """Read the whole body. Raises HTTPException when it is too large, Unreadable when it does not match its digest."""
    announced = request.headers.get("content-length", "")
    if announced.isdigit() and int(announced) > LARGEST_MESSAGE:
        raise _too_large(int(announced))
    parts, size = [], 0
    async for part in request.stream():
        parts.append(part)
        size += len(part)
        if size > LARGEST_MESSAGE:
            raise _too_large(size)
    body = b"".join(parts)
    for entry in request.headers.get("content-digest", "").split(","):
        if entry.strip():
            _require_digest(entry, body)
    return body


def _too_large(size: int) -> HTTPException:
    return HTTPException(
        STATUS[Oversized],
        f"too_large: {size} bytes or more; at most {LARGEST_MESSAGE} are taken",
        {"Connection": "close"},  # the rest is not read
    )


def _require_digest(entry: str, body: bytes) -> None:
    """Require that the body matches one digest of RFC 9530; unknown algorithms are ignored, as the RFC asks."""
    match = _DIGEST.match(entry)
    if match is None:
        raise Unreadable("bad_frame: Content-Digest is not of the form sha-256=:<base64>:")
    if match[1] not in _HASHES:
        return
    try:
        expected = base64.b64decode(match[2], validate=True)
    except binascii.Error:
        raise Unreadable("bad_frame: Content-Digest holds no base64") from None
    if _HASHES[match[1]](body).digest() != expected:
        raise Unreadable(f"bad_frame: the body does not fit its {match[1]} digest")
