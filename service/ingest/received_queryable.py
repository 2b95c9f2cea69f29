"""Replies to sources that query through zenoh how far their samples are durable."""

import logging

import msgspec
import zenoh

from formats.wire import ALL_RECEIVED, JSON, Key, Received, Rejected
from service.replication.work_share import Share
from service.write_path.sample_writer import SampleWriter
from storage.database.errors import is_database_wide

logger = logging.getLogger(__name__)

MAXIMUM_WAITING = 1_000
"""Largest number of waiting queries."""


class ReceivedQueryable:
    """The queryable on `…/received`; the ingest thread replies when it has time."""

    def __init__(self, session: zenoh.Session, writer: SampleWriter, share: Share) -> None:
        self._session = session
        self._writer = writer
        self._share = share

    def open(self) -> None:
        """Declare the queryable."""
        self._queryable = self._session.declare_queryable(ALL_RECEIVED, zenoh.handlers.FifoChannel(MAXIMUM_WAITING))

    def close(self) -> None:
        """Undeclare the queryable."""
        self._queryable.undeclare()

    def answer_waiting(self) -> None:
        """Reply to the waiting queries. Raises errors that affect all batches."""
        while (query := self._queryable.try_recv()) is not None:
            self._answer(query)

    def _answer(self, query: zenoh.Query) -> None:
        with query:
            try:
                key = Key.parse(str(query.key_expr))
            except Rejected:
                return  # a query over all machines: each must be queried by itself
            try:
                self._reply(query, key)
            except Exception as error:
                if is_database_wide(error):
                    raise
                logger.exception("%s: the sequence numbers stored of its sources cannot be sent", key.machine)

    def _reply(self, query: zenoh.Query, key: Key) -> None:
        if self._share.is_owner(key.machine) and self._writer.plant_of(key.machine) == key.plant:
            answer = Received(plant=key.plant, machine=key.machine, sources=self._writer.received(key.machine))
            query.reply(key.received, msgspec.json.encode(answer), encoding=JSON)
