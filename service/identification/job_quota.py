"""Quotas of waiting identifications that people requested: further ones are refused until some are computed.

`storage.findings.job_order` defines the order in which waiting ones are taken.
"""

from dataclasses import dataclass

from sqlalchemy.orm import Session

from estimator.errors import LimitReached
from storage.findings import jobs

RETRY_AFTER_S = 30
"""Time after which a refused request should be repeated [s]: some are computed by then."""
LONGEST_IDENTITY = 255


class QuotaExceeded(LimitReached):
    """A quota of waiting identifications is exhausted; the message says whose."""

    retry_after_s = RETRY_AFTER_S


@dataclass(frozen=True)
class JobQuota:
    """Quotas of waiting identifications. per_principal: requested by one person; per_machine: requested for one machine."""

    per_principal: int = 500
    per_machine: int = 200

    @property
    def at_once(self) -> int:
        """Return how many identifications one request may ask for."""
        return min(self.per_principal, self.per_machine)

    def require(self, session: Session, *, by: str, machine_id: str) -> None:
        """Raise QuotaExceeded unless another identification may be requested."""
        if jobs.count_waiting_of(session, asked_by=by, most=self.per_principal) >= self.per_principal:
            raise QuotaExceeded(
                f"{self.per_principal} identifications that you asked for wait, as many as may: ask again when some are done"
            )
        if jobs.count_requested_of_machine(session, machine_id, most=self.per_machine) >= self.per_machine:
            raise QuotaExceeded(
                f"{self.per_machine} identifications of machine '{machine_id}' that were asked for wait, as many as may: "
                "ask again when some are done"
            )
