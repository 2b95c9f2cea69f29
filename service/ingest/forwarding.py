"""Forwarding samples that came over HTTP or MQTT to the replica that stores them, through zenoh."""

import threading
from concurrent.futures import Future, ThreadPoolExecutor

import msgspec
import zenoh

from formats.wire import ALL_SUBMIT, IDENTIFIER, JSON, Fault, Key, Reason, Rejected
from service.replication.work_share import Share
from service.write_path.batch import StoreOutcome
from service.write_path.http_queue import Busy, NotStoring, Publication, Submissions
from storage.database.engine import Database
from storage.machines import machines

AT_ONCE = 16
"""Largest number of bodies forwarded concurrently."""
MAXIMUM_WAITING = 64
"""Largest number of bodies being forwarded or waiting for it; further ones are refused as busy."""
PATIENCE_S = 15.0
"""Time that the other replica may take to make a body durable."""


class ForwardedAnswer(msgspec.Struct, omit_defaults=True):
    """The outcome of a forwarded body: exactly one of these. stored: received, duplicates, lost, and the faults."""

    stored: tuple[int, int, int, list[tuple[int, Reason, str]]] | None = None
    rejected: tuple[Reason, str] | None = None
    busy: str | None = None
    not_storing: str | None = None


class Forwarding:
    """Acceptance of bodies for all machines: those stored here are queued, the others forwarded."""

    def __init__(self, session: zenoh.Session, database: Database, share: Share, own: Submissions) -> None:
        self._session = session
        self._database = database
        self._share = share
        self._own = own
        self._waiting = 0
        self._lock = threading.Lock()
        self._threads = ThreadPoolExecutor(AT_ONCE, thread_name_prefix="forwarding")
        self._queryable = session.declare_queryable(ALL_SUBMIT, self._on_query)

    def close(self) -> None:
        """Stop accepting bodies."""
        self._queryable.undeclare()
        self._threads.shutdown(wait=False, cancel_futures=True)

    @property
    def trouble(self) -> str | None:
        """Return why nothing can be stored at present, see `Submissions.trouble`."""
        return self._own.trouble

    def offer(self, machine: str, body: bytes, encoding: str, published: Publication | None = None) -> Future[StoreOutcome]:
        """Queue or forward a body, see `Submissions.offer`. Raises Busy or NotStoring."""
        if self._share.is_owner(machine):
            return self._own.offer(machine, body, encoding, published)
        if self._waiting >= MAXIMUM_WAITING:
            raise Busy(f"{self._waiting} batches are on their way to another replica")
        with self._lock:
            self._waiting += 1
        promise = self._threads.submit(self._request_storing, machine, body, encoding, published)
        promise.add_done_callback(self._arrived)
        return promise

    def __len__(self) -> int:
        return len(self._own) + self._waiting

    def _arrived(self, _promise: Future[StoreOutcome]) -> None:
        with self._lock:
            self._waiting -= 1

    def _request_storing(self, machine: str, body: bytes, encoding: str, published: Publication | None) -> StoreOutcome:
        with self._database.reading() as session:
            try:
                plant = machines.get(session, machine).plant
            except machines.MachineUnknown:
                raise Rejected("unknown_machine", f"no machine '{machine}' is known; create it first") from None
        replies = self._session.get(
            Key(plant, machine).submit,
            payload=body,
            encoding=encoding,
            attachment=_written(published),
            timeout=PATIENCE_S,
            target=zenoh.QueryTarget.ALL,
        )
        for reply in replies:
            if reply.ok is not None:
                return _outcome_of(msgspec.json.decode(reply.ok.payload.to_bytes(), type=ForwardedAnswer))
        raise NotStoring(f"no replica takes samples of '{machine}' at present")

    def _on_query(self, query: zenoh.Query) -> None:
        """Accept a body forwarded by another replica."""
        parts = str(query.key_expr).split("/")
        machine = parts[3] if len(parts) == 5 and IDENTIFIER.match(parts[3]) else ""
        if not self._share.is_owner(machine) or query.payload is None:
            query.drop()
            return
        try:
            came = _publication(query.attachment)
            promise = self._own.offer(machine, query.payload.to_bytes(), str(query.encoding), came)
        except Busy as busy:
            _reply(query, ForwardedAnswer(busy=str(busy)))
        except NotStoring as error:
            _reply(query, ForwardedAnswer(not_storing=str(error)))
        else:
            promise.add_done_callback(lambda done: _reply(query, _answer(done)))


class _ForwardedPublication(msgspec.Struct, omit_defaults=True):
    """Statements beside a body that came over MQTT, see `Publication`."""

    topic: str
    plant: str
    fault: tuple[Reason, str] | None = None


def _written(published: Publication | None) -> bytes | None:
    if published is None:
        return None
    fault = None if published.fault is None else (published.fault.reason, published.fault.detail)
    return msgspec.json.encode(_ForwardedPublication(published.topic, published.plant, fault))


def _publication(attachment: zenoh.ZBytes | None) -> Publication | None:
    if attachment is None:
        return None
    told = msgspec.json.decode(attachment.to_bytes(), type=_ForwardedPublication)
    return Publication(told.topic, told.plant, None if told.fault is None else Rejected(*told.fault))


def _answer(done: Future[StoreOutcome]) -> ForwardedAnswer:
    error = done.exception()
    if isinstance(error, Rejected):
        return ForwardedAnswer(rejected=(error.reason, error.detail))
    if error is not None:
        return ForwardedAnswer(not_storing=str(error))
    outcome = done.result()
    if outcome.rejected is not None:
        return ForwardedAnswer(rejected=(outcome.rejected.reason, outcome.rejected.detail))
    faults = [(fault.index, fault.reason, fault.detail) for fault in outcome.faults]
    return ForwardedAnswer(stored=(outcome.received, outcome.duplicates, outcome.lost, faults))


def _reply(query: zenoh.Query, answer: ForwardedAnswer) -> None:
    with query:
        query.reply(str(query.key_expr), msgspec.json.encode(answer), encoding=JSON)


def _outcome_of(answer: ForwardedAnswer) -> StoreOutcome:
    """Return the outcome in a reply. Raises Rejected, Busy, NotStoring."""
    if answer.rejected is not None:
        raise Rejected(*answer.rejected)
    if answer.busy is not None:
        raise Busy(answer.busy)
    if answer.stored is None:
        raise NotStoring(answer.not_storing or "the other replica said nothing")
    received, duplicates, lost, faults = answer.stored
    return StoreOutcome(received, duplicates, lost, tuple(Fault(*fault) for fault in faults))
