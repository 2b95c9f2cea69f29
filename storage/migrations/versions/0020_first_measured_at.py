"""when what raised an alert was measured"""

import sqlalchemy as sa
from alembic import op

revision = "0020"
down_revision = "0019"
branch_labels = None
depends_on = None

FIRST = """
UPDATE alerts SET first_measured_at = COALESCE(
    (SELECT identifications.measured_at FROM alert_events JOIN identifications
        ON identifications.id = alert_events.identification_id
        WHERE alert_events.alert_id = alerts.id AND alert_events.number = 1),
    measured_at)
"""


def upgrade() -> None:
    op.add_column("alerts", sa.Column("first_measured_at", sa.BigInteger(), nullable=False, server_default="0"))
    op.execute(FIRST)


def downgrade() -> None:
    op.drop_column("alerts", "first_measured_at")
