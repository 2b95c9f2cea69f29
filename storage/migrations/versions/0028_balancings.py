"""field balancings"""

import sqlalchemy as sa
from alembic import op

revision = "0028"
down_revision = "0027"
branch_labels = None
depends_on = None


def _name(length: int) -> sa.String:
    return sa.String(length).with_variant(sa.String(length, collation="C"), "postgresql")


def upgrade() -> None:
    op.create_table(
        "balancings",
        sa.Column("id", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), nullable=False),
        sa.Column("machine_id", _name(64), nullable=False),
        sa.Column("revision", sa.BigInteger(), nullable=False),
        sa.Column("state", _name(16), nullable=False),
        sa.Column("steps", sa.JSON(), nullable=False),
        sa.Column("by", _name(120), nullable=False),
        sa.Column("comment", sa.Text(), nullable=False),
        sa.Column("created_at", sa.BigInteger(), nullable=False),
        sa.Column("updated_at", sa.BigInteger(), nullable=False),
        sa.ForeignKeyConstraint(["machine_id"], ["machines.id"], name=op.f("fk_balancings_machine_id")),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_balancings")),
    )
    op.create_index(op.f("ix_balancings_machine_id_id"), "balancings", ["machine_id", "id"])


def downgrade() -> None:
    op.drop_index(op.f("ix_balancings_machine_id_id"), table_name="balancings")
    op.drop_table("balancings")
