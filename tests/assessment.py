"""Assess in one go what `rundown serve` judges in a worker, between two transactions."""

from sqlalchemy.orm import Session

from service.monitoring import conclusions
from service.monitoring.assessment.assess import assess
from service.monitoring.context_loading import load_context, load_state
from storage.database.engine import Database
from storage.findings import identifications
from storage.tables.findings import IdentificationRow


def judge(session: Session, stored: IdentificationRow, *, baseline_runs: int) -> None:
    """Load the context, assess it and apply the assessment."""
    context = load_context(session, stored, baseline_runs=baseline_runs)
    if context is not None:
        conclusions.apply(session, stored, context, assess(context), load_state(session, stored))


def judge_between(database: Database, identification_id: int, *, baseline_runs: int) -> None:
    """Load the context in one transaction and apply the assessment in another: it takes longer than one may stay idle."""
    with database.reading() as session:
        stored = identifications.get(session, identification_id)
        context = load_context(session, stored, baseline_runs=baseline_runs)
    if context is None:
        return
    assessment = assess(context)
    with database.transaction() as session:
        stored = identifications.get(session, identification_id)
        conclusions.apply(session, stored, context, assessment, load_state(session, stored))
