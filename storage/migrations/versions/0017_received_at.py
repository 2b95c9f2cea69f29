"""when samples came, by the service's clock, beside when they were measured, by the source's"""

import sqlalchemy as sa
from alembic import op

revision = "0017"
down_revision = "0016"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.add_column("sample_blocks", sa.Column("received_at", sa.BigInteger(), nullable=True))
    op.add_column("sources", sa.Column("last_received_at", sa.BigInteger(), nullable=True))


def downgrade() -> None:
    op.drop_column("sources", "last_received_at")
    op.drop_column("sample_blocks", "received_at")
