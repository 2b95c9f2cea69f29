"""Comparison of an identification with the baseline in force: the identifications of the baseline, and the runs since."""

import statistics
from collections.abc import Sequence
from dataclasses import dataclass

from sqlalchemy.orm import Session

from storage.clock import now
from storage.findings import identifications
from storage.findings.identifications import ComparisonGroup
from storage.machines import baselines, machines
from storage.machines.machines import RevisionHistory
from storage.tables.findings import IdentificationRow
from storage.tables.machines import BaselineRow

ALIKE = 0.5
"""Two runs are comparable when the speeds that both cover are at least this part of those that either covers."""
LONGEST_HISTORY = 520
"""Newest runs after a baseline over which trends are tested: ten years of one a week."""


@dataclass(frozen=True)
class ComparisonTerms:
    """The conditions under which an identification of a single run is compared.

    began: the baseline in force with its author and reason; None for the machine's first runs. today: the baseline for what
    is measured now. like: criteria of comparable runs: under revisions of the document that describe the same machine, of the
    same kind of run, with the same slow-roll vectors and balance of loads on films, after the beginning of the baseline.
    revisions: the revisions that describe this train.
    """

    identification: IdentificationRow
    began: BaselineRow | None
    today: BaselineRow | None
    like: ComparisonGroup
    revisions: RevisionHistory


@dataclass(frozen=True)
class Compared:
    """An identification, the runs of its machine's baseline, and the runs after the baseline, oldest first.

    began: the baseline with its author and reason; None for the machine's first runs. wanted: identifications that form it.
    after: comparable runs up to the identification, which is the last one unless it belongs to the baseline.
    balanced_otherwise: further accepted ones, by a release that balances the loads on oil films otherwise.
    """

    identification: IdentificationRow
    began: BaselineRow | None
    wanted: int
    baseline: Sequence[IdentificationRow]
    after: Sequence[IdentificationRow]
    balanced_otherwise: int = 0

    @property
    def missing(self) -> str | None:
        """Return why there is nothing to compare yet; None when there is."""
        number = self.identification.id
        if len(self.baseline) < self.wanted:
            return f"the baseline has {len(self.baseline)} of {self.wanted} identifications{self._otherwise}"
        if number in {row.id for row in self.baseline}:
            return f"identification {number} is part of the baseline"
        if not self.after or self.after[-1].id != number:
            why = "not accepted, identified again, dated in the future, or of other speeds than the baseline"
            return f"identification {number} does not count: {why}"
        return None

    @property
    def _otherwise(self) -> str:
        """Return what is to be done about identifications by another release; empty where there are none."""
        if not self.balanced_otherwise:
            return ""
        return (
            f"; {self.balanced_otherwise} more are by a release that balances the loads on oil films otherwise, with other "
            "stiffnesses of couplings and pedestals: they are not compared, identify their runs again"
        )


def terms_of(session: Session, stored: IdentificationRow) -> ComparisonTerms:
    """Read the conditions under which an identification is compared. Raises MachineUnknown."""
    began, today = baselines.in_force_at(session, stored.machine_id, (stored.measured_at, now()))
    revisions = machines.revision_history(session, stored.machine_id, stored.revision)
    like = ComparisonGroup(
        revisions=tuple(revisions.comparable(stored.revision)),
        run_kind=stored.run_kind,
        slow_roll_version=stored.slow_roll_version,
        since=0 if began is None else began.since,
        load_balance=stored.load_balance,
    )
    return ComparisonTerms(stored, began, today, like, revisions)


def compared(session: Session, stored: IdentificationRow, *, baseline_runs: int) -> Compared:
    """Read the accepted runs that an identification of a single run is compared with."""
    terms = terms_of(session, stored)
    first, wanted = baseline_of(session, stored.machine_id, terms.like, terms.began, baseline_runs=baseline_runs)
    return compared_with(session, terms, first, wanted)


def compared_with(
    session: Session,
    terms: ComparisonTerms,
    baseline: Sequence[IdentificationRow],
    wanted: int,
    *,
    accepted: bool = True,
    longest: int = LONGEST_HISTORY,
) -> Compared:
    """Read the runs between a baseline and an identification, over about the same speeds.

    baseline, wanted: see `baseline_of`. accepted: only accepted runs come after the baseline; otherwise the refused ones as
    well. longest: largest number of them.
    """
    stored, known = terms.identification, {row.id for row in baseline}
    newest = identifications.newest(
        session, stored.machine_id, terms.like, limit=longest + wanted, last=stored.measured_at, accepted=accepted
    )
    after = [row for row in reversed(newest) if row.id not in known]
    if terms.began is None and baseline:
        # What was refused before the machine's first good run belongs to nothing.
        after = [row for row in after if row.measured_at >= baseline[0].measured_at]
    after = [row for row in after if covers_same_speeds(row, baseline)]
    otherwise = 0 if len(baseline) >= wanted else _balanced_otherwise(session, terms)
    return Compared(stored, terms.began, wanted, baseline, after[-longest:], otherwise)


def _balanced_otherwise(session: Session, terms: ComparisonTerms) -> int:
    """Return how many identifications a baseline lacks for their balance of loads, of the named ones where it names some."""
    named = None if terms.began is None else terms.began.identification_ids
    return identifications.balanced_otherwise(session, terms.identification.machine_id, terms.like, among=named)


def covers_same_speeds(row: IdentificationRow, baseline: Sequence[IdentificationRow]) -> bool:
    """Return whether a run covers about the baseline's speeds: a sweep over few speeds shows another part of the machine."""
    if not baseline:
        return True
    lowest = statistics.median(one.speed_minimum for one in baseline)
    highest = statistics.median(one.speed_maximum for one in baseline)
    both = min(row.speed_maximum, highest) - max(row.speed_minimum, lowest)
    either = max(row.speed_maximum, highest) - min(row.speed_minimum, lowest)
    return either <= 0.0 or both >= ALIKE * either


def baseline_of(
    session: Session, machine_id: str, like: ComparisonGroup, began: BaselineRow | None, *, baseline_runs: int
) -> tuple[Sequence[IdentificationRow], int]:
    """Return the identifications that form a baseline so far, oldest first, and how many it needs."""
    if began is None or began.identification_ids is None:
        return identifications.first_accepted(session, machine_id, like, limit=baseline_runs), baseline_runs
    return identifications.accepted_among(session, machine_id, like, began.identification_ids), len(
        set(began.identification_ids)
    )
