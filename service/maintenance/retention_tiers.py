"""The tiers of retention, samples as received and samples of runs: which of a machine's are old enough and no longer
needed."""

import logging
from collections.abc import Collection
from typing import Protocol

from sqlalchemy.exc import DBAPIError
from sqlalchemy.orm import Session

from service.configuration.settings import Settings
from service.maintenance.retention_cut_offs import DAY_NS, CutOff, initial_cut_off
from service.runs.collection_state import state_of
from service.runs.late_samples import BESIDE
from storage.machines import machines
from storage.measurements import runs
from storage.operation import retention
from storage.operation.retention import Extent

logger = logging.getLogger(__name__)

BLOCKS, RUNS = 200, 20
"""Largest number of blocks and of runs deleted in one transaction."""


class Tier(Protocol):
    """A tier of retention. name: as stored and displayed. kept: how long it is kept [ns]. most: deleted in one transaction.

    moment: present time by the clock [ns].
    """

    name: str
    kept: int
    most: int

    def before(self, session: Session, machine_id: str, *, moment: int) -> int:
        """Return the time before which a machine's data are old enough [ns]."""

    def has(self, session: Session, machine_id: str, *, before: int) -> bool:
        """Return whether a machine has anything that may be deleted."""

    def release(self, session: Session, machine_id: str, *, before: int) -> int:
        """Delete the oldest; return how many were examined, fewer than `most` when these were the last."""

    def extent(self, session: Session, machine_id: str, *, before: int) -> Extent | None:
        """Return the extent of what may be deleted; None when there is nothing."""


class Blocks:
    """The tier of samples as received."""

    name = "samples outside of runs"

    def __init__(self, days: float) -> None:
        self.kept = round(days * DAY_NS)
        self.most = BLOCKS

    def before(self, session: Session, machine_id: str, *, moment: int) -> int:
        """Return the time before which blocks are old enough, see `Tier.before`."""
        newest = retention.newest_sample(session, machine_id)
        if newest is None:
            return 0
        old = _age_limit(newest, self.kept, moment=moment)
        # Finding the needed blocks takes longer, and most machines have nothing old.
        return min(old, *_needed_since(session, machine_id)) if retention.has_blocks(session, machine_id, before=old) else old

    def has(self, session: Session, machine_id: str, *, before: int) -> bool:
        """Return whether a machine has old blocks, see `Tier.has`."""
        return retention.has_blocks(session, machine_id, before=before)

    def release(self, session: Session, machine_id: str, *, before: int) -> int:
        """Delete the oldest blocks, see `Tier.release`."""
        return retention.release_blocks(session, machine_id, before=before, limit=self.most)

    def extent(self, session: Session, machine_id: str, *, before: int) -> Extent | None:
        """Return the extent of the old blocks, see `Tier.extent`."""
        return retention.extent_of_blocks(session, machine_id, before=before)


class Runs:
    """The tier of samples of runs. baseline_runs: identifications that form a baseline without named ones."""

    name = "samples of runs"

    def __init__(self, days: float, baseline_runs: int) -> None:
        self.kept = round(days * DAY_NS)
        self.most = RUNS
        self._baseline_runs = baseline_runs

    def before(self, session: Session, machine_id: str, *, moment: int) -> int:
        """Return the time before which runs are old enough, see `Tier.before`."""
        newest = runs.of_machine(session, machine_id, limit=1)
        return _age_limit(newest[0].time_last or newest[0].time_first, self.kept, moment=moment) if newest else 0

    def has(self, session: Session, machine_id: str, *, before: int) -> bool:
        """Return whether a machine has old runs, see `Tier.has`."""
        return retention.has_runs(session, machine_id, before=before, baseline_runs=self._baseline_runs)

    def release(self, session: Session, machine_id: str, *, before: int) -> int:
        """Delete the samples of the oldest runs, see `Tier.release`."""
        kept = self._baseline_runs
        return retention.release_runs(session, machine_id, before=before, baseline_runs=kept, limit=self.most)

    def extent(self, session: Session, machine_id: str, *, before: int) -> Extent | None:
        """Return the extent of the old runs, see `Tier.extent`."""
        return retention.extent_of_runs(session, machine_id, before=before, baseline_runs=self._baseline_runs)


def tiers_of(settings: Settings) -> list[Tier]:
    """Return the tiers for which the settings limit the age."""
    found: list[Tier] = []
    if settings.raw_days:
        found.append(Blocks(settings.raw_days))
    if settings.run_days:
        found.append(Runs(settings.run_days, settings.baseline_runs))
    return found


def first_cut_off(session: Session, tier: Tier, machine_ids: Collection[str], *, moment: int) -> CutOff:
    """Return the cut-off of a store that has none yet. Raises the database's errors."""
    firsts = []
    for machine_id in machine_ids:
        try:
            extent = tier.extent(session, machine_id, before=tier.before(session, machine_id, moment=moment))
        except DBAPIError:
            raise
        except Exception:
            logger.exception("%s: the age of its samples is unknown", machine_id)
            continue
        if extent is not None:
            firsts.append(extent.first)
    return initial_cut_off(wanted=moment - tier.kept, oldest=min(firsts, default=None), kept=tier.kept)


def _age_limit(newest: int, kept: int, *, moment: int) -> int:
    """Return the age limit by the machine's newest time, if not in the future: a machine that was off for a year loses
    nothing."""
    return min(newest, moment) - kept


def _needed_since(session: Session, machine_id: str) -> list[int]:
    """Return times from which on a machine's blocks are needed by unfinished runs, speed bins and late samples [ns]."""
    found = [2**63 - 1]
    machine = machines.document(session, machine_id)
    before = round(1e9 * machine.collection.pre_trigger_s) + BESIDE
    found += [row.time_first - before for row in runs.unfinished(session, machine_id)]
    stands = state_of(session, machine_id)
    if stands is not None:
        found += [window[1] - before for window in stands.late]
        found += [stands.seen - before]
        if stands.bins is not None:
            found += stands.bins.all_times[:1]
    return found
