"""alerts and their events hold numbers and no sentences; those of older releases that have no numbers keep theirs"""

import json
from typing import Any

import sqlalchemy as sa
from alembic import op

revision = "0029"
down_revision = "0028"
branch_labels = None
depends_on = None

TELLABLE = frozenset({"since", "quantities"})
"""Fields of evidence of which words can be made; that of a rate has the other."""
RATE = "per_week_per_cent"
BLANK = sa.text("UPDATE alerts SET message = '' WHERE id = :id")
NAMED = "UPDATE {} SET message = rule || ' of ' || element WHERE message = ''"


def upgrade() -> None:
    op.add_column("alert_events", sa.Column("evidence", sa.JSON(), nullable=True))
    bind = op.get_bind()
    for number, evidence in bind.execute(sa.text("SELECT id, evidence FROM alerts ORDER BY id")).all():
        if _is_tellable(json.loads(evidence) if isinstance(evidence, str) else evidence):
            bind.execute(BLANK, {"id": number})


def downgrade() -> None:
    op.drop_column("alert_events", "evidence")
    for table in ("alerts", "alert_events"):
        op.execute(NAMED.format(table))


def _is_tellable(evidence: Any) -> bool:
    return isinstance(evidence, dict) and (evidence.keys() >= TELLABLE or RATE in evidence)
