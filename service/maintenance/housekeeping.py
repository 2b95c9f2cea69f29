"""Housekeeping: deletes samples that are old enough, returns disk space and memory, and warns well before the disk is full."""

import logging
import time
from collections.abc import Callable

from sqlalchemy.exc import DBAPIError
from sqlalchemy.orm import Session

from service.configuration.settings import Settings
from service.maintenance.disk_watch import DiskWatch
from service.maintenance.retention_cut_offs import DAY_NS, CutOff, advanced_cut_off
from service.maintenance.retention_tiers import Blocks, Runs, Tier, first_cut_off, tiers_of
from service.replication.work_share import RETENTION, Share, WholeShare
from service.resilience.heap_trim import release_free_memory
from service.resilience.supervised_thread import SupervisedThread
from storage.clock import now, to_datetime
from storage.database import disk
from storage.database.engine import Database
from storage.database.errors import is_database_wide
from storage.machines import machines
from storage.operation import retention

logger = logging.getLogger(__name__)

INTERVAL_S = 600.0
"""Interval of the rounds."""
LOOK_S = 10.0
"""Interval of looks at disk and memory."""
PAUSE_S = 0.05
"""Pause between two transactions, for other writers."""
COUNTED_NS = 60_000_000_000
"""Service time is stored when it is more than this [ns]."""


class Housekeeping(SupervisedThread):
    """The thread that keeps the store within its limits."""

    def __init__(self, database: Database, settings: Settings, share: Share | None = None) -> None:
        super().__init__("housekeeping", failure="housekeeping is postponed", retry_s=LOOK_S)
        self._share = WholeShare() if share is None else share
        self._database = database
        self._disk = DiskWatch(database, budget=int(settings.disk_budget_gb * 1e9) or None)
        self._disk_checked_at = time.monotonic()
        self._next_round = 0.0
        self.unfinished: str | None = None
        """Why the last round was not finished; kept until one is."""
        self.unseen: str | None = None
        """Why the last look could not read how much space is left."""
        self.released = dict.fromkeys((Blocks.name, Runs.name), 0)
        """Deleted blocks and runs since the start, by tier."""
        self._tiers = tiers_of(settings)
        self._cut_offs: dict[str, CutOff] = {}
        self._counted_to = time.monotonic_ns()
        """Time up to which service time is included in the stored cut-offs."""
        self._counts = False
        """Whether any cut-offs are stored."""
        self._waiting = 0
        self._waiting_warning = ""

    @property
    def warnings(self) -> list[str]:
        """Return warnings of too little space, and why the store is not kept within its limits."""
        hindered = [f"old samples are not deleted: {self.unfinished}"] if self.unfinished else []
        blind = [f"the free disk space is unknown: {self.unseen}"] if self.unseen else []
        return [words for words in (self._disk.warning, self._waiting_warning) if words] + hindered + blind

    @property
    def gauges(self) -> dict[str, float]:
        """Return figures for monitoring, by the name of the metric."""
        own: dict[str, float] = {
            "rundown_released_sample_blocks": self.released[Blocks.name],
            "rundown_released_runs": self.released[Runs.name],
            "rundown_retention_waiting": self._waiting,
            "rundown_housekeeping_working": int(self.unfinished is None and self.unseen is None),
        }
        return own | self._disk.gauges

    def round(self) -> None:
        """Delete all samples that are old enough. Raises the database's errors, and at the end an error with a machine."""
        moment = now()
        with self._database.reading() as session:
            every = [row.id for row in machines.list_all(session)]
        self._move_cut_offs(every, moment)
        failed: Exception | None = None
        waiting: set[str] = set()
        for machine_id in every:
            try:
                for tier in self._tiers:
                    if not self._release(tier, machine_id, moment):
                        waiting.add(machine_id)
            except Exception as error:
                if is_database_wide(error):
                    raise
                logger.exception("%s: its old samples are not deleted; those of the others are", machine_id)
                failed = error
            if not self._wait_unless_stopped():
                return
        self._warn_of_waiting(waiting, moment)
        while disk.release_free_pages(self._database) and self._wait_unless_stopped(PAUSE_S):
            pass
        if failed is not None:
            raise failed

    def _wait_unless_stopped(self, pause: float = 0.0) -> bool:
        """Wait, and look at disk and memory when that is due, since a round may take long; return False to stop."""
        if time.monotonic() >= self._disk_checked_at + LOOK_S:
            self.check_disk()
        return not self._stop.wait(pause)

    def check_disk(self) -> None:
        """Check the disk space, and give free memory back to the system."""
        self._disk_checked_at = time.monotonic()
        release_free_memory()
        self.unseen = _attempt(self._disk.check)

    def run_once(self) -> float:
        """Look at disk and memory, and do a round when one is due. A stop takes effect between two transactions."""
        self.check_disk()
        if not self._share.is_leader(RETENTION):
            self._leave_to_another()
        elif time.monotonic() >= self._next_round:
            self._next_round = time.monotonic() + INTERVAL_S
            self.unfinished = _attempt(self.round)
        return LOOK_S

    def finish(self) -> None:
        """Store the service time since the last round, so that it counts after a restart, too."""
        if self._counts and self.unfinished is None and self._share.is_leader(RETENTION):
            _attempt(lambda: self._move_cut_offs([], now()))

    def _leave_to_another(self) -> None:
        """Leave retention to another replica, forgetting its state here; service time is not counted twice."""
        self.unfinished, self._counts, self._waiting, self._waiting_warning = None, False, 0, ""
        self._counted_to = time.monotonic_ns()

    def _move_cut_offs(self, machine_ids: list[str], moment: int) -> None:
        """Move each tier's cut-off as near to what clock and settings ask for as the service time allows."""
        if not self._tiers:
            return
        served = time.monotonic_ns() - self._counted_to
        with self._database.reading() as session:
            found = {tier.name: _advanced(session, tier, moment, served) for tier in self._tiers}
            self._cut_offs = {
                tier.name: found[tier.name] or first_cut_off(session, tier, machine_ids, moment=moment) for tier in self._tiers
            }
            known = None not in found.values()
            set_back = any(_is_set_back(session, tier, self._cut_offs[tier.name]) for tier in self._tiers)
            if not known and retention.is_empty(session):
                return  # the clock may still be set after a first start
        self._counts = True
        if known and served < COUNTED_NS and not set_back:
            return  # too little for other writers to wait
        with self._database.transaction() as session:  # read again: a person may have confirmed meanwhile
            for tier in self._tiers:
                cut_off = _advanced(session, tier, moment, served) or self._cut_offs[tier.name]
                self._cut_offs[tier.name] = cut_off
                retention.store_cut_off(session, tier.name, time=cut_off.time, allowance=cut_off.allowance)
        self._counted_to += served

    def _release(self, tier: Tier, machine_id: str, moment: int) -> bool:
        """Delete what is old enough of a machine; return False when some of it lies behind the cut-off and waits."""
        limit = self._cut_offs[tier.name].time
        with self._database.reading() as session:
            wanted = tier.before(session, machine_id, moment=moment)
            if not tier.has(session, machine_id, before=wanted):
                return True
            some = tier.has(session, machine_id, before=min(wanted, limit))
        while some and self._wait_unless_stopped(PAUSE_S):
            with self._database.transaction() as session:
                wanted = tier.before(session, machine_id, moment=moment)
                count = tier.release(session, machine_id, before=min(wanted, limit))
            self.released[tier.name] += count
            some = count == tier.most
        with self._database.reading() as session:
            return wanted <= limit or not tier.has(session, machine_id, before=wanted)

    def _warn_of_waiting(self, machine_ids: set[str], moment: int) -> None:
        """Warn that old samples wait for a person, as long as they do."""
        before, self._waiting = self._waiting, len(machine_ids)
        self._waiting_warning = _waiting_words(machine_ids, moment) if machine_ids else ""
        if machine_ids and not before:
            logger.warning(self._waiting_warning)


def _attempt(work: Callable[[], None]) -> str | None:
    """Run some work; return why it was not finished, None when it was.

    The next attempt may succeed, and nothing else depends on this one.
    """
    try:
        work()
    except DBAPIError as error:
        logger.warning("housekeeping is postponed: %s", error.orig)
        return str(error.orig)
    except Exception as error:
        logger.exception("unexpected error in housekeeping")
        return f"{type(error).__name__}: {error}"
    return None


def _advanced(session: Session, tier: Tier, moment: int, served: int) -> CutOff | None:
    """Return the cut-off of a tier after `served` more service time [ns]; None when none is stored yet."""
    kept = retention.cut_off(session, tier.name)
    return None if kept is None else advanced_cut_off(CutOff(*kept), wanted=moment - tier.kept, served=served)


def _is_set_back(session: Session, tier: Tier, cut_off: CutOff) -> bool:
    """Return whether a cut-off is far before the stored one: a clock that was ahead stored that."""
    kept = retention.cut_off(session, tier.name)
    return kept is not None and cut_off.time < kept[0] - DAY_NS


def _waiting_words(machine_ids: set[str], moment: int) -> str:
    names, others = sorted(machine_ids)[:3], len(machine_ids) - 3
    named = ", ".join(names) + (f" and {others} more machines" if others > 0 else "")
    return (
        f"old samples of {named} wait to be deleted: by this machine's clock "
        f"({to_datetime(moment):%Y-%m-%d %H:%M} UTC) and the settings more of them are old than time has passed here. If both "
        "are right, `rundown retention confirm` shows them and deletes them"
    )
