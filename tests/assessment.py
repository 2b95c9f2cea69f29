"""Assess in one go what `rundown serve` judges in a worker, between two transactions."""

from sqlalchemy.orm import Session

from service.monitoring import conclusions
from service.monitoring.assessment.assess import assess
from service.monitoring.context_loading import load_context, load_state
from storage.tables.findings import IdentificationRow


def judge(session: Session, stored: IdentificationRow, *, baseline_runs: int) -> None:
    """Load the context, assess it and apply the assessment."""
    context = load_context(session, stored, baseline_runs=baseline_runs)
    if context is not None:
        conclusions.apply(session, stored, context, assess(context), load_state(session, stored))
