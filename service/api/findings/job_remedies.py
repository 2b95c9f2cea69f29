"""Remedies for failed jobs in plain words, by the error that ended the job."""

from collections.abc import Mapping

REMEDIES: Mapping[str, str] = {
    "NotEnoughData": "wait for a run over more of the speed range, or lower what the document asks of a run (collection)",
    "OutOfTime": "ask again when fewer jobs wait; where it happens again, allow more by RUNDOWN_IDENTIFICATION_TIMEOUT_S",
    "MemoryError": "ask again when fewer jobs wait; where it happens again, allow more by RUNDOWN_IDENTIFICATION_MEMORY_MB",
    "Stuck": "ask again; where it happens again, the service's log has what the computation hung at",
    "its data need more memory": "identify fewer or shorter runs together, or allow more memory",
    "its result cannot be stored": "look at disk and database (`rundown doctor`), then ask again",
    "SamplesReleased": "the run's samples are not kept any more: only newer runs can be identified (RUNDOWN_RUN_DAYS)",
}
"""Remedies by how the error begins, behind what it was given up after."""
ANY_OTHER = "ask again from the run; where it fails again, send the error and the service's log to whoever looks after it"
GIVEN_UP = " attempts: "


def remedy(error: str | None) -> str | None:
    """Return what a person can do about a job that ended with an error; None without one."""
    if error is None:
        return None
    _, given_up, cause = error.partition(GIVEN_UP)
    own = cause if given_up else error
    return next((words for begins, words in REMEDIES.items() if own.startswith(begins)), ANY_OTHER)
