"""how far back samples were let go of: blocks of a machine, and those of a run"""

import sqlalchemy as sa
from alembic import op

revision = "0013"
down_revision = "0012"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.add_column("machines", sa.Column("blocks_since", sa.BigInteger(), nullable=True))
    op.add_column("runs", sa.Column("released_at", sa.BigInteger(), nullable=True))


def downgrade() -> None:
    op.drop_column("runs", "released_at")
    op.drop_column("machines", "blocks_since")
