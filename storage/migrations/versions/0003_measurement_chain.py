"""measurement chain: slow-roll vectors, coverage and quality of runs, holes in a source's sequence"""

from typing import Any

import sqlalchemy as sa
from alembic import op

revision = "0003"
down_revision = "0002"
branch_labels = None
depends_on = None

COLUMNS: tuple[tuple[str, str, sa.types.TypeEngine[Any]], ...] = (
    ("machines", "slow_roll_version", sa.BigInteger()),
    ("sources", "missing", sa.JSON()),
    ("runs", "reopened_at", sa.BigInteger()),
    ("runs", "coverage", sa.JSON()),
    ("runs", "quality", sa.JSON()),
    ("runs", "flags", sa.LargeBinary()),
    ("identification_jobs", "options", sa.JSON()),
    ("identifications", "slow_roll_version", sa.BigInteger()),
)


def upgrade() -> None:
    for table, name, kind in COLUMNS:
        op.add_column(table, sa.Column(name, kind, nullable=True))
    op.create_table(
        "slow_roll_vectors",
        sa.Column("machine_id", sa.String(64), nullable=False),
        sa.Column("version", sa.BigInteger(), nullable=False),
        sa.Column("created_at", sa.BigInteger(), nullable=False),
        sa.Column("origin", sa.String(16), nullable=False),
        sa.Column("direction", sa.BigInteger(), nullable=False),
        sa.Column("vectors", sa.JSON(), nullable=False),
        sa.Column("speed_minimum", sa.Double(), nullable=True),
        sa.Column("speed_maximum", sa.Double(), nullable=True),
        sa.Column("time_first", sa.BigInteger(), nullable=True),
        sa.Column("time_last", sa.BigInteger(), nullable=True),
        sa.Column("comment", sa.Text(), nullable=False),
        sa.ForeignKeyConstraint(["machine_id"], ["machines.id"], name=op.f("fk_slow_roll_vectors_machine_id")),
        sa.PrimaryKeyConstraint("machine_id", "version", name=op.f("pk_slow_roll_vectors")),
    )


def downgrade() -> None:
    op.drop_table("slow_roll_vectors")
    for table, name, _ in reversed(COLUMNS):
        op.drop_column(table, name)
