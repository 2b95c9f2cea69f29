"""A sample writer behind which runs are closed at once; in `rundown serve` another thread does it, tenths of seconds later."""

from collections.abc import Set
from typing import Any

from service.runs.closing import Closing
from service.runs.collector import Collector
from service.write_path.batch import ArrivedBatch, StoreOutcome
from service.write_path.sample_writer import SampleWriter
from storage.database.engine import Database
from storage.measurements.quarantine import Rejection


class PromptWriter(SampleWriter):
    """Closes what has ended behind each message; `settle` ends what is silent and sorts in what came late."""

    def __init__(self, database: Database, collector: Collector | None = None) -> None:
        collector = collector or Collector()
        super().__init__(database, collector)
        self.closing = Closing(database, collector)

    def store(self, arrived: list[ArrivedBatch], rejections: list[Rejection], **more: Any) -> list[StoreOutcome]:
        """Store as SampleWriter does, then close the runs that have ended."""
        outcomes = super().store(arrived, rejections, **more)
        self.closing.close_ended()
        return outcomes

    def settle(self, *, silence_s: float, alive: Set[str] = frozenset()) -> None:
        """Do what is done now and then: runs of silent machines end, late samples are sorted in."""
        self.end_silent(silence_s=silence_s, alive=alive)
        self.closing.close_ended()
        self.closing.sort_in_late()
