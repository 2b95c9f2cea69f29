"""Housekeeping: lets go of samples that are old enough, gives disk and memory back, and warns well before the disk is full."""

import logging
import threading
import time
from collections.abc import Callable

from sqlalchemy.exc import DBAPIError
from sqlalchemy.orm import Session

from service.collection import standing
from service.late import BESIDE
from service.memory import give_back
from service.settings import Settings
from service.sharing import RETENTION, Share, Whole
from storage import disk, machines, retention, runs
from storage.clock import now
from storage.database import Database
from storage.disk import DiskUse
from storage.errors import concerns_all

logger = logging.getLogger(__name__)

INTERVAL_S = 600.0
"""Between two rounds."""
LOOK_S = 10.0
"""Between two looks at disk and memory."""
PAUSE_S = 0.05
"""Between two transactions, for those who wait."""
BLOCKS, RUNS = 200, 20
"""At most so many are let go of in one transaction."""
DAY_NS = 86_400_000_000_000
TIGHT, FULL = 0.80, 0.95
"""Parts of the room from which on it is warned of, and urgently."""


class Housekeeping:
    """The thread that keeps the store in bounds."""

    def __init__(self, database: Database, settings: Settings, share: Share | None = None) -> None:
        self._share = Whole() if share is None else share
        self._database = database
        self._settings = settings
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="housekeeping", daemon=True)
        self._use: DiskUse | None = None
        self._said = ""
        self._level = 0
        self._looked_at = time.monotonic()
        self.trouble: str | None = None
        """Why the last round was not finished; it stands until one is."""
        self.unseen: str | None = None
        """Why the last look did not show how much room is left."""
        self.released_blocks = self.released_runs = 0
        """Since the start."""

    def start(self) -> None:
        """Begin."""
        self._thread.start()

    def stop(self) -> None:
        """End between two transactions."""
        self._stop.set()
        if self._thread.is_alive():
            self._thread.join()

    @property
    def alive(self) -> bool:
        """Whether the thread runs."""
        return self._thread.is_alive()

    @property
    def warnings(self) -> list[str]:
        """What is to be said of the room, and why the store is not kept in bounds."""
        hindered = [f"old samples are not let go of: {self.trouble}"] if self.trouble else []
        blind = [f"how much room is left cannot be told: {self.unseen}"] if self.unseen else []
        return [*([self._said] if self._said else []), *hindered, *blind]

    @property
    def gauges(self) -> dict[str, float]:
        """Figures for a monitoring system, by the name of the metric."""
        found: dict[str, float] = {
            "rundown_released_sample_blocks": self.released_blocks,
            "rundown_released_runs": self.released_runs,
            "rundown_housekeeping_working": int(self.trouble is None and self.unseen is None),
        }
        use = self._use
        if use is not None:
            found["rundown_database_bytes"] = use.data
            known = {
                "rundown_disk_used_ratio": use.part,
                "rundown_disk_free_bytes": use.free,
                "rundown_disk_budget_bytes": use.budget,
            }
            found |= {name: value for name, value in known.items() if value is not None}
        return found

    def round(self) -> None:
        """Let go of all that is old enough. Raises what the database raises, and at the end what failed of a machine."""
        with self._database.reading() as session:
            every = [row.id for row in machines.every(session)]
        failed: Exception | None = None
        for machine_id in every:
            try:
                self._release(machine_id)
            except Exception as error:
                if concerns_all(error):
                    raise
                logger.exception("%s: its old samples are not let go of; those of the others are", machine_id)
                failed = error
            if not self._goes_on():
                return
        while disk.give_back(self._database) and self._goes_on(PAUSE_S):
            pass
        if failed is not None:
            raise failed

    def _goes_on(self, pause: float = 0.0) -> bool:
        """Wait, and look at disk and memory where that is due, as a round of a large fleet takes long; False to stop."""
        if time.monotonic() >= self._looked_at + LOOK_S:
            self._look_at_all()
        return not self._stop.wait(pause)

    def _look_at_all(self) -> None:
        self._looked_at = time.monotonic()
        give_back()
        self.unseen = _tried(self._look)

    def _run(self) -> None:
        next_round, pause = time.monotonic(), 0.0
        while not self._stop.wait(pause):
            pause = LOOK_S
            self._look_at_all()
            if not self._share.leads(RETENTION):
                self.trouble = None  # it is another replica's
            elif time.monotonic() >= next_round:
                next_round = time.monotonic() + INTERVAL_S
                self.trouble = _tried(self.round)

    def _release(self, machine_id: str) -> None:
        if self._settings.raw_days:
            self._release_blocks(machine_id)
        if self._settings.run_days:
            self._release_runs(machine_id)

    def _release_blocks(self, machine_id: str) -> None:
        with self._database.reading() as session:
            if not retention.has_blocks(session, machine_id, before=self._blocks_before(session, machine_id)):
                return
        while self._goes_on(PAUSE_S):
            with self._database.transaction() as session:
                before = self._blocks_before(session, machine_id)
                count = retention.release_blocks(session, machine_id, before=before, limit=BLOCKS)
            self.released_blocks += count
            if count < BLOCKS:
                return

    def _blocks_before(self, session: Session, machine_id: str) -> int:
        """Time before which a machine's sample blocks are let go of [ns]."""
        newest = retention.newest_sample(session, machine_id)
        if newest is None:
            return 0
        old = _ago(newest, self._settings.raw_days)
        # What is needed takes longer to find out, and most have nothing old.
        return min(old, *_needed_since(session, machine_id)) if retention.has_blocks(session, machine_id, before=old) else old

    def _release_runs(self, machine_id: str) -> None:
        kept = self._settings.baseline_runs
        with self._database.reading() as session:
            before = self._runs_before(session, machine_id)
            if not retention.has_runs(session, machine_id, before=before, baseline_runs=kept):
                return
        while self._goes_on(PAUSE_S):
            with self._database.transaction() as session:
                before = self._runs_before(session, machine_id)
                count = retention.release_runs(session, machine_id, before=before, baseline_runs=kept, limit=RUNS)
            self.released_runs += count
            if count < RUNS:
                return

    def _runs_before(self, session: Session, machine_id: str) -> int:
        """Time before which a machine's runs lose their samples [ns]."""
        newest = runs.of_machine(session, machine_id, limit=1)
        return _ago(newest[0].time_last or newest[0].time_first, self._settings.run_days) if newest else 0

    def _look(self) -> None:
        """See how much room is left, and say when that has become too little."""
        budget = int(self._settings.disk_budget_gb * 1e9) or None
        found = None  # old figures would look like good ones
        try:
            found = disk.used(self._database, budget=budget)
        except OSError as error:
            raise RuntimeError(f"the disk cannot be looked at: {error}") from error
        finally:
            self._use = found
        self._said = warning(found)
        used = found.part or 0.0
        before, self._level = self._level, sum(used >= part for part in (TIGHT, FULL))
        if self._level > before:
            logger.warning(self._said)
        elif self._level < before:
            logger.info("there is more room on the disk again: %.0f %% are used", 100 * used)


def _tried(work: Callable[[], None]) -> str | None:
    """Do it; returns why it was not finished. The next time may do better, and nothing else depends on this one."""
    try:
        work()
    except DBAPIError as error:
        logger.warning("housekeeping is put off: %s", error.orig)
        return str(error.orig)
    except Exception as error:
        logger.exception("unexpected error in housekeeping")
        return f"{type(error).__name__}: {error}"
    return None


def warning(use: DiskUse) -> str:
    """What is to be said of the room; empty where there is enough."""
    if use.part is None or use.part < TIGHT:
        return ""
    urgent = "nearly full: samples will soon not be stored" if use.part >= FULL else "filling"
    left = "" if use.free is None else f", {use.free / 1e9:.1f} GB are free on its disk"
    budget = "" if use.budget is None else f" of {use.budget / 1e9:.1f} GB that it may take"
    return (
        f"the store is {urgent}: {100 * use.part:.0f} % are used; the database has {use.data / 1e9:.1f} GB{budget}{left}. "
        "Shorten raw_days or run_days, or give it more room"
    )


def _ago(newest: int, days: float) -> int:
    """By the machine's own newest time, as far as that is not in the future: one that was off for a year loses nothing."""
    return min(newest, now()) - round(days * DAY_NS)


def _needed_since(session: Session, machine_id: str) -> list[int]:
    """Times from which on the blocks of a machine are needed by its open run, its speed bins, and what came late [ns]."""
    found = [2**63 - 1]
    machine = machines.document(session, machine_id)
    before = round(1e9 * machine.collection.pre_trigger_s) + BESIDE
    row = runs.current(session, machine_id)
    if row is not None:
        found.append(row.time_first - before)
    stands = standing(session, machine_id)
    if stands is not None:
        found += [window[1] - before for window in stands.late]
        found += [stands.seen - before]
        if stands.bins is not None:
            found += stands.bins.all_times[:1]
    return found
