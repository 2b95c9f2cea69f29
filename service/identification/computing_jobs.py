"""Jobs that are being computed by the executor."""

from concurrent.futures import Future
from dataclasses import dataclass

from service.identification.calibration_task import CalibrationOutcome
from service.identification.task import IdentificationOutcome


@dataclass(frozen=True)
class TakenJob:
    """A job that was taken to be computed.

    automatic: see `storage.findings.job_order`. reopened: how often each of its runs had been rebuilt when it was taken.
    holder: this replica's number when it was taken; None when it is the only one.
    """

    job_id: int
    automatic: bool
    reopened: tuple[int, ...]
    holder: int | None


JobFuture = Future[IdentificationOutcome] | Future[CalibrationOutcome]
ComputingJobs = dict[JobFuture, TakenJob]
"""Jobs that are being computed, or whose outcome is still to be filed, in the order in which filing is tried."""
