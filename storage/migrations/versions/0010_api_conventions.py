"""idempotency keys, and indexes for lists and overviews of many machines"""

import sqlalchemy as sa
from alembic import op

revision = "0010"
down_revision = "0009"
branch_labels = None
depends_on = None

INDEXES = (
    ("ix_alerts_opened_at", "alerts", ["opened_at"]),
    ("ix_alerts_machine_id_opened_at", "alerts", ["machine_id", "opened_at"]),
    ("ix_alert_events_at", "alert_events", ["at"]),
    ("ix_identifications_computed_at", "identifications", ["computed_at"]),
    ("ix_runs_time_first", "runs", ["time_first"]),
    ("ix_runs_machine_id_state", "runs", ["machine_id", "state"]),
)


def upgrade() -> None:
    op.create_table(
        "idempotency_keys",
        sa.Column("key", sa.String(255), nullable=False),
        sa.Column("fingerprint", sa.String(64), nullable=False),
        sa.Column("created_at", sa.BigInteger(), nullable=False),
        sa.Column("status", sa.BigInteger(), nullable=True),
        sa.Column("headers", sa.JSON(), nullable=True),
        sa.Column("body", sa.LargeBinary(), nullable=True),
        sa.PrimaryKeyConstraint("key", name=op.f("pk_idempotency_keys")),
    )
    op.create_index(op.f("ix_idempotency_keys_created_at"), "idempotency_keys", ["created_at"])
    for name, table, columns in INDEXES:
        op.create_index(op.f(name), table, columns)


def downgrade() -> None:
    for name, table, _ in INDEXES:
        op.drop_index(op.f(name), table)
    op.drop_table("idempotency_keys")
