"""history of what each machine was doing"""

import sqlalchemy as sa
from alembic import op

revision = "0005"
down_revision = "0004"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.create_table(
        "machine_states",
        sa.Column("id", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), nullable=False),
        sa.Column("machine_id", sa.String(64), nullable=False),
        sa.Column("since", sa.BigInteger(), nullable=False),
        sa.Column("mode", sa.String(16), nullable=False),
        sa.Column("speed", sa.Double(), nullable=True),
        sa.ForeignKeyConstraint(["machine_id"], ["machines.id"], name=op.f("fk_machine_states_machine_id")),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_machine_states")),
    )
    op.create_index(op.f("ix_machine_states_machine_id_since"), "machine_states", ["machine_id", "since"])


def downgrade() -> None:
    op.drop_table("machine_states")
