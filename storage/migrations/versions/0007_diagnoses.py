"""effects of channels' errors on each fit, and diagnoses"""

import sqlalchemy as sa
from alembic import op

revision = "0007"
down_revision = "0006"
branch_labels = None
depends_on = None

KEY = sa.BigInteger().with_variant(sa.Integer(), "sqlite")


def upgrade() -> None:
    op.add_column("identifications", sa.Column("channel_effects", sa.LargeBinary(), nullable=True))
    op.create_table(
        "diagnoses",
        sa.Column("identification_id", KEY, nullable=False),
        sa.Column("machine_id", sa.String(64), nullable=False),
        sa.Column("measured_at", sa.BigInteger(), nullable=False),
        sa.Column("made_at", sa.BigInteger(), nullable=False),
        sa.Column("baseline", sa.JSON(), nullable=False),
        sa.Column("runs", sa.BigInteger(), nullable=False),
        sa.Column("causes", sa.JSON(), nullable=False),
        sa.ForeignKeyConstraint(["identification_id"], ["identifications.id"], name=op.f("fk_diagnoses_identification_id")),
        sa.PrimaryKeyConstraint("identification_id", name=op.f("pk_diagnoses")),
    )
    op.create_index(op.f("ix_diagnoses_machine_id_measured_at"), "diagnoses", ["machine_id", "measured_at"])


def downgrade() -> None:
    op.drop_table("diagnoses")
    op.drop_column("identifications", "channel_effects")
