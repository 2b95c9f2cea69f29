"""How many identifications that people ask for may wait: beyond that they are refused until some are computed.

In which order those that wait are taken says `storage.findings.job_order`.
"""

from dataclasses import dataclass

from sqlalchemy.orm import Session

from estimator.errors import LimitReached
from storage.findings import jobs

RETRY_AFTER_S = 30
"""When somebody who was refused should ask again [s]: by then some are computed."""
LONGEST_IDENTITY = 255


class QuotaExceeded(LimitReached):
    """As many identifications wait as may; the message says whose."""

    retry_after_s = RETRY_AFTER_S


@dataclass(frozen=True)
class JobQuota:
    """per_principal: identifications that may wait of those that somebody asked for; per_machine: that people asked for."""

    per_principal: int = 500
    per_machine: int = 200

    @property
    def at_once(self) -> int:
        """As many may be asked for in one request."""
        return min(self.per_principal, self.per_machine)

    def require(self, session: Session, *, by: str, machine_id: str) -> None:
        """Raises QuotaExceeded unless one more may be asked for."""
        if jobs.count_waiting_of(session, asked_by=by, most=self.per_principal) >= self.per_principal:
            raise QuotaExceeded(
                f"{self.per_principal} identifications that you asked for wait, as many as may: ask again when some are done"
            )
        if jobs.count_requested_of_machine(session, machine_id, most=self.per_machine) >= self.per_machine:
            raise QuotaExceeded(
                f"{self.per_machine} identifications of machine '{machine_id}' that were asked for wait, as many as may: "
                "ask again when some are done"
            )
