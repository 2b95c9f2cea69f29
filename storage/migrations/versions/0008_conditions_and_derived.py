"""operating conditions of identifications, and the quantities derived from them"""

import sqlalchemy as sa
from alembic import op

revision = "0008"
down_revision = "0007"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.add_column("identifications", sa.Column("conditions", sa.JSON(), nullable=True))
    op.create_table(
        "derived_quantities",
        sa.Column("identification_id", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), nullable=False),
        sa.Column("name", sa.String(160), nullable=False),
        sa.Column("place", sa.BigInteger(), nullable=False),
        sa.Column("machine_id", sa.String(64), nullable=False),
        sa.Column("measured_at", sa.BigInteger(), nullable=False),
        sa.Column("unit", sa.String(16), nullable=False),
        sa.Column("value", sa.Double(), nullable=True),
        sa.Column("lower", sa.Double(), nullable=True),
        sa.Column("upper", sa.Double(), nullable=True),
        sa.Column("reason", sa.Text(), nullable=True),
        sa.ForeignKeyConstraint(
            ["identification_id"], ["identifications.id"], name=op.f("fk_derived_quantities_identification_id")
        ),
        sa.PrimaryKeyConstraint("identification_id", "name", name=op.f("pk_derived_quantities")),
    )
    op.create_index(
        op.f("ix_derived_quantities_machine_id_name_measured_at"), "derived_quantities", ["machine_id", "name", "measured_at"]
    )


def downgrade() -> None:
    op.drop_table("derived_quantities")
    op.drop_column("identifications", "conditions")
