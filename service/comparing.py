"""What an identification is compared with: the baseline in force, and the runs between it and now."""

import statistics
from collections.abc import Sequence
from dataclasses import dataclass

from sqlalchemy.orm import Session

from storage import baselines, identifications, machines
from storage.identifications import Like
from storage.tables import BaselineRow, IdentificationRow

ALIKE = 0.5
"""Two runs are compared when the speeds that both cover are at least this part of those that either covers."""
LONGEST_HISTORY = 520
"""Newest runs behind a baseline that trends are tested over: ten years of one a week."""
WEEK = 7 * 86_400 * 1_000_000_000
"""[ns]"""


@dataclass(frozen=True)
class Compared:
    """An identification, the runs that are its machine's baseline and those that came after it, oldest first.

    began: who began the baseline and why; None for the machine's first runs. wanted: identifications that make it. after:
    alike and up to the identification, which is the last one unless it belongs to the baseline.
    """

    identification: IdentificationRow
    began: BaselineRow | None
    wanted: int
    baseline: Sequence[IdentificationRow]
    after: Sequence[IdentificationRow]

    @property
    def missing(self) -> str | None:
        """Why there is nothing to compare yet; None when there is."""
        number = self.identification.id
        if len(self.baseline) < self.wanted:
            return f"the baseline has {len(self.baseline)} of {self.wanted} identifications"
        if number in {row.id for row in self.baseline}:
            return f"identification {number} is part of the baseline"
        if not self.after or self.after[-1].id != number:
            why = "not accepted, identified again, dated in the future, or of other speeds than the baseline"
            return f"identification {number} does not count: {why}"
        return None


def compared(
    session: Session, stored: IdentificationRow, *, baseline_runs: int, accepted: bool = True, longest: int = LONGEST_HISTORY
) -> Compared:
    """What an identification of a single run is compared with.

    accepted: only such runs come after the baseline; otherwise the refused ones as well. longest: at most so many of them.

    Like is compared with like: under revisions of the document that describe the same machine, of the same kind of run, with
    the same slow-roll vectors, over about the same speeds, behind the beginning of the baseline in force.
    """
    began = baselines.in_force(session, stored.machine_id, at=stored.measured_at)
    like = Like(
        revisions=tuple(machines.comparable(session, stored.machine_id, stored.revision)),
        run_kind=stored.run_kind,
        slow_roll_version=stored.slow_roll_version,
        since=0 if began is None else began.since,
    )
    first, wanted = baseline_of(session, stored.machine_id, like, began, baseline_runs=baseline_runs)
    known = {row.id for row in first}
    newest = identifications.newest(
        session, stored.machine_id, like, limit=longest + wanted, last=stored.measured_at, accepted=accepted
    )
    after = [row for row in reversed(newest) if row.id not in known]
    if began is None and first:
        # What was refused before the machine's first good run belongs to nothing.
        after = [row for row in after if row.measured_at >= first[0].measured_at]
    after = [row for row in after if alike_speeds(row, first)]
    return Compared(stored, began, wanted, first, after[-longest:])


def alike_speeds(row: IdentificationRow, baseline: Sequence[IdentificationRow]) -> bool:
    """Whether a run covers about the speeds of the baseline's: a sweep of a few speeds sees another part of the machine."""
    if not baseline:
        return True
    lowest = statistics.median(one.speed_minimum for one in baseline)
    highest = statistics.median(one.speed_maximum for one in baseline)
    both = min(row.speed_maximum, highest) - max(row.speed_minimum, lowest)
    either = max(row.speed_maximum, highest) - min(row.speed_minimum, lowest)
    return either <= 0.0 or both >= ALIKE * either


def baseline_of(
    session: Session, machine_id: str, like: Like, began: BaselineRow | None, *, baseline_runs: int
) -> tuple[Sequence[IdentificationRow], int]:
    """The identifications that make a baseline so far, oldest first, and how many it needs."""
    if began is None or began.identification_ids is None:
        return identifications.first_accepted(session, machine_id, like, limit=baseline_runs), baseline_runs
    return identifications.named(session, machine_id, like, began.identification_ids), len(set(began.identification_ids))
