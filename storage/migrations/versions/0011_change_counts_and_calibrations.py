"""calibrations; counts of each table's changes, by which answers kept in memory are known to hold (SQLite)"""

import sqlalchemy as sa
from alembic import op

revision = "0011"
down_revision = "0010"
branch_labels = None
depends_on = None

TABLES = (
    "machines",
    "machine_revisions",
    "collectors",
    "runs",
    "identifications",
    "estimates",
    "derived_quantities",
    "baselines",
    "timeline",
    "alerts",
    "alert_events",
)
WRITES = ("INSERT", "UPDATE", "DELETE")


def upgrade() -> None:
    op.create_table(
        "calibrations",
        sa.Column("id", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), nullable=False),
        sa.Column("machine_id", sa.String(64), nullable=False),
        sa.Column("channel", sa.String(64), nullable=False),
        sa.Column("at", sa.BigInteger(), nullable=False),
        sa.Column("certificate", sa.Text(), nullable=False),
        sa.Column("by", sa.String(120), nullable=False),
        sa.Column("created_at", sa.BigInteger(), nullable=False),
        sa.ForeignKeyConstraint(["machine_id"], ["machines.id"], name=op.f("fk_calibrations_machine_id")),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_calibrations")),
    )
    op.create_index(op.f("ix_calibrations_machine_id_at"), "calibrations", ["machine_id", "at"])
    made = op.create_table(
        "change_counts",
        sa.Column("table_name", sa.String(64), nullable=False),
        sa.Column("count", sa.BigInteger(), nullable=False),
        sa.PrimaryKeyConstraint("table_name", name=op.f("pk_change_counts")),
    )
    if op.get_bind().dialect.name != "sqlite":
        return
    op.bulk_insert(made, [{"table_name": table, "count": 0} for table in TABLES])
    for table in TABLES:
        for write in WRITES:
            op.execute(
                f"CREATE TRIGGER count_{write.lower()}_{table} AFTER {write} ON {table} "
                f"BEGIN UPDATE change_counts SET count = count + 1 WHERE table_name = '{table}'; END"
            )


def downgrade() -> None:
    if op.get_bind().dialect.name == "sqlite":
        for table in TABLES:
            for write in WRITES:
                op.execute(f"DROP TRIGGER count_{write.lower()}_{table}")
    op.drop_table("change_counts")
    op.drop_table("calibrations")
