"""PostgreSQL compares names by their letters' codes, as SQLite does, and not in the language of its server"""

import sqlalchemy as sa
from alembic import op

revision = "0012"
down_revision = "0011"
branch_labels = None
depends_on = None

COLUMNS = (
    ("machines", "id", 64),
    ("machines", "plant", 64),
    ("slow_roll_vectors", "machine_id", 64),
    ("slow_roll_vectors", "origin", 16),
    ("machine_revisions", "machine_id", 64),
    ("sources", "machine_id", 64),
    ("sources", "source", 64),
    ("sample_blocks", "machine_id", 64),
    ("sample_blocks", "source", 64),
    ("collectors", "machine_id", 64),
    ("machine_states", "machine_id", 64),
    ("machine_states", "mode", 16),
    ("runs", "machine_id", 64),
    ("runs", "kind", 16),
    ("runs", "state", 16),
    ("identification_jobs", "machine_id", 64),
    ("identification_jobs", "scope", 16),
    ("identification_jobs", "request", 200),
    ("identification_jobs", "state", 16),
    ("identifications", "machine_id", 64),
    ("identifications", "scope", 16),
    ("identifications", "run_kind", 16),
    ("identifications", "code_version", 64),
    ("diagnoses", "machine_id", 64),
    ("estimates", "parameter", 160),
    ("estimates", "machine_id", 64),
    ("estimates", "quantity", 32),
    ("estimates", "element", 80),
    ("estimates", "unit", 16),
    ("derived_quantities", "name", 160),
    ("derived_quantities", "machine_id", 64),
    ("derived_quantities", "unit", 16),
    ("alerts", "machine_id", 64),
    ("alerts", "rule", 64),
    ("alerts", "element", 80),
    ("alerts", "state", 32),
    ("alerts", "condition", 32),
    ("alert_events", "machine_id", 64),
    ("alert_events", "rule", 64),
    ("alert_events", "element", 80),
    ("alert_events", "kind", 32),
    ("alert_events", "state_before", 32),
    ("alert_events", "state", 32),
    ("alert_events", "by", 120),
    ("suppressions", "machine_id", 64),
    ("suppressions", "rule", 64),
    ("suppressions", "element", 80),
    ("suppressions", "kind", 32),
    ("suppressions", "by", 120),
    ("suppressions", "ended_by", 120),
    ("timeline", "machine_id", 64),
    ("timeline", "kind", 32),
    ("timeline", "by", 120),
    ("calibrations", "machine_id", 64),
    ("calibrations", "channel", 64),
    ("calibrations", "by", 120),
    ("baselines", "machine_id", 64),
    ("baselines", "by", 120),
    ("limits", "machine_id", 64),
    ("limits", "by", 120),
    ("subscriptions", "kind", 32),
    ("subscriptions", "name", 120),
    ("subscriptions", "state", 16),
    ("deliveries", "state", 16),
    ("quarantine", "key", 512),
    ("quarantine", "machine_id", 64),
    ("quarantine", "reason", 32),
    ("quarantine_counts", "reason", 32),
    ("idempotency_keys", "key", 255),
    ("idempotency_keys", "fingerprint", 64),
)


def upgrade() -> None:
    _collate("C")


def downgrade() -> None:
    _collate("default")


def _collate(collation: str) -> None:
    if op.get_bind().dialect.name == "postgresql":
        for table, column, length in COLUMNS:
            op.alter_column(table, column, type_=sa.String(length, collation=collation))
