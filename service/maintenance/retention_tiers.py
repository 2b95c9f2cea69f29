"""The tiers of retention, samples as received and those of runs: what of a machine is old enough, and not needed any more."""

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
"""At most so many are let go of in one transaction."""


class Tier(Protocol):
    """name: as stored, and as people call it. kept: how long it is kept [ns]. most: let go of in one transaction.

    moment: what the clock says [ns].
    """

    name: str
    kept: int
    most: int

    def before(self, session: Session, machine_id: str, *, moment: int) -> int:
        """Time before which what a machine has of it is old enough [ns]."""

    def has(self, session: Session, machine_id: str, *, before: int) -> bool:
        """Whether a machine has anything that may be let go of."""

    def release(self, session: Session, machine_id: str, *, before: int) -> int:
        """Let go of the oldest; how many were looked at, fewer than `most` where these were the last."""

    def extent(self, session: Session, machine_id: str, *, before: int) -> Extent | None:
        """What may be let go of; None where there is nothing."""


class Blocks:
    """Samples as received."""

    name = "samples outside of runs"

    def __init__(self, days: float) -> None:
        self.kept = round(days * DAY_NS)
        self.most = BLOCKS

    def before(self, session: Session, machine_id: str, *, moment: int) -> int:
        """As of Tier."""
        newest = retention.newest_sample(session, machine_id)
        if newest is None:
            return 0
        old = _ago(newest, self.kept, moment=moment)
        # What is needed takes longer to find out, and most have nothing old.
        return min(old, *_needed_since(session, machine_id)) if retention.has_blocks(session, machine_id, before=old) else old

    def has(self, session: Session, machine_id: str, *, before: int) -> bool:
        """As of Tier."""
        return retention.has_blocks(session, machine_id, before=before)

    def release(self, session: Session, machine_id: str, *, before: int) -> int:
        """As of Tier."""
        return retention.release_blocks(session, machine_id, before=before, limit=self.most)

    def extent(self, session: Session, machine_id: str, *, before: int) -> Extent | None:
        """As of Tier."""
        return retention.extent_of_blocks(session, machine_id, before=before)


class Runs:
    """Samples of runs. baseline_runs: identifications that make a baseline where none are named."""

    name = "samples of runs"

    def __init__(self, days: float, baseline_runs: int) -> None:
        self.kept = round(days * DAY_NS)
        self.most = RUNS
        self._baseline_runs = baseline_runs

    def before(self, session: Session, machine_id: str, *, moment: int) -> int:
        """As of Tier."""
        newest = runs.of_machine(session, machine_id, limit=1)
        return _ago(newest[0].time_last or newest[0].time_first, self.kept, moment=moment) if newest else 0

    def has(self, session: Session, machine_id: str, *, before: int) -> bool:
        """As of Tier."""
        return retention.has_runs(session, machine_id, before=before, baseline_runs=self._baseline_runs)

    def release(self, session: Session, machine_id: str, *, before: int) -> int:
        """As of Tier."""
        kept = self._baseline_runs
        return retention.release_runs(session, machine_id, before=before, baseline_runs=kept, limit=self.most)

    def extent(self, session: Session, machine_id: str, *, before: int) -> Extent | None:
        """As of Tier."""
        return retention.extent_of_runs(session, machine_id, before=before, baseline_runs=self._baseline_runs)


def tiers_of(settings: Settings) -> list[Tier]:
    """Those of which anything is let go of."""
    found: list[Tier] = []
    if settings.raw_days:
        found.append(Blocks(settings.raw_days))
    if settings.run_days:
        found.append(Runs(settings.run_days, settings.baseline_runs))
    return found


def first_cut_off(session: Session, tier: Tier, machine_ids: Collection[str], *, moment: int) -> CutOff:
    """That of a store that has none yet. Raises what the database raises."""
    firsts = []
    for machine_id in machine_ids:
        try:
            extent = tier.extent(session, machine_id, before=tier.before(session, machine_id, moment=moment))
        except DBAPIError:
            raise
        except Exception:
            logger.exception("%s: how old its samples are cannot be told", machine_id)
            continue
        if extent is not None:
            firsts.append(extent.first)
    return initial_cut_off(wanted=moment - tier.kept, oldest=min(firsts, default=None), kept=tier.kept)


def _ago(newest: int, kept: int, *, moment: int) -> int:
    """By the machine's own newest time, as far as that is not in the future: one that was off for a year loses nothing."""
    return min(newest, moment) - kept


def _needed_since(session: Session, machine_id: str) -> list[int]:
    """Times from which on a machine's blocks are needed by unfinished runs, its speed bins, and what came late [ns]."""
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
