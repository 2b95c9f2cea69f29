"""Tells whether a train as its document describes it would whirl, or its journals touch, within its speed range.

Its oil films take seconds, too long for the answer to POST and PUT: it is computed once for each revision, when first asked
for, and kept in memory.
"""

from fastapi import APIRouter, Request
from pydantic import BaseModel, Field

from estimator.machine.checks.document_warnings import DocumentWarning
from estimator.statics.whirl_in_range import instability_words
from service.api.cache.computed_cache import ComputedCache
from service.api.cache.model_process import ModelProcess, is_long
from service.api.cache.worker_computation import caller_of, has_gone
from service.api.conventions.dependencies import MachineId, database
from service.api.conventions.problems import RESPONSES
from service.security.requirement import VIEWER
from storage.machines import machines

router = APIRouter(prefix="/machines", tags=["machines"], responses=RESPONSES, dependencies=[VIEWER])


class Stability(BaseModel):
    """A train's stability within its speed range, by its document in force."""

    machine: str
    revision: int
    warnings: list[str] = Field(
        description="with field and what is usual, as those of the document: from which speed on it would whirl, or which "
        "journal touches; none where it would run"
    )


@router.get("/{machine_id}/stability", operation_id="read_stability")
def read_stability(request: Request, machine_id: MachineId) -> Stability:
    """Read whether the train would whirl, or its journals touch, within its speed range; on oil films that takes seconds."""
    with database(request).reading() as session:  # not while the computation waits for its turn
        revision = machines.get(session, machine_id).revision
        document = machines.document(session, machine_id, revision)
    cache: ComputedCache = request.app.state.computed_cache
    process: ModelProcess = request.app.state.model_process
    long = is_long(document)

    def work() -> str:
        return process.compute(instability_words, document) if long else instability_words(document)

    words = cache.compute_queued(
        ("stability", machine_id, revision),
        work,
        long=long,
        caller=caller_of(request),
        wanted=lambda: not has_gone(request),
    )
    warnings = [str(DocumentWarning("bearings", words))] if words else []
    return Stability(machine=machine_id, revision=revision, warnings=warnings)
