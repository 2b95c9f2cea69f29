"""how far each tier of retention has come"""

import sqlalchemy as sa
from alembic import op

revision = "0026"
down_revision = "0025"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.create_table(
        "retention",
        sa.Column("tier", sa.String(32), nullable=False),
        sa.Column("cut_off", sa.BigInteger(), nullable=False),
        sa.Column("allowance", sa.BigInteger(), nullable=False),
        sa.PrimaryKeyConstraint("tier", name=op.f("pk_retention")),
    )


def downgrade() -> None:
    op.drop_table("retention")
