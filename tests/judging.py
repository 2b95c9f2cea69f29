"""Judging in one go what `rundown serve` judges in a worker, between two transactions."""

from sqlalchemy.orm import Session

from service import watching
from service.judging import judged
from storage.tables import IdentificationRow


def judge(session: Session, stored: IdentificationRow, *, baseline_runs: int) -> None:
    """Ask, answer and carry out."""
    question = watching.question(session, stored, baseline_runs=baseline_runs)
    if question is not None:
        watching.carry_out(session, stored, question, judged(question))
