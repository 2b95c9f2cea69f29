"""Sample writers that fail in part, and an ingest that runs with them."""

from contextlib import ExitStack
from typing import Any

import zenoh
from sqlalchemy.exc import OperationalError

from service.ingest.ingest_thread import Ingest
from service.write_path.batch import ArrivedBatch, StoreOutcome
from service.write_path.http_queue import Submissions
from service.write_path.sample_writer import SampleWriter
from storage.database.engine import Database
from storage.measurements.quarantine import Rejection
from tests.service.ingest.plant_network import (
    rows,
)

AWAY = OperationalError("INSERT", {}, Exception("the server went away"))


class Partial(SampleWriter):
    """Meets an error that nobody foresaw where it stores what one source sends, until it is mended."""

    broken = True

    def store(self, arrived: list[ArrivedBatch], rejections: list[Rejection], **more: Any) -> list[StoreOutcome]:
        if self.broken and any(one.batch.source == "failing" for one in arrived):
            raise ZeroDivisionError("a fault of ours")
        return super().store(arrived, rejections, **more)


class AwayForOne(Partial):
    """The database goes away, once, where what the other source sends is stored by itself."""

    away = True

    def store(self, arrived: list[ArrivedBatch], rejections: list[Rejection], **more: Any) -> list[StoreOutcome]:
        if self.away and [one.batch.source for one in arrived] == ["working"]:
            self.away = False
            raise AWAY
        return super().store(arrived, rejections, **more)


def running(router: zenoh.Session, writer: SampleWriter, submissions: Submissions, until: ExitStack) -> Ingest:
    ingest = Ingest(router, writer, silence_s=60.0, submissions=submissions)
    ingest.start()
    until.callback(ingest.stop)
    return ingest


def counts_of(database: Database, name: str) -> tuple[int, int]:
    """Next sequence and received of a machine's only source."""
    (row,) = (row for row in rows(database) if row.machine_id == name)
    return row.next_sequence, row.received
