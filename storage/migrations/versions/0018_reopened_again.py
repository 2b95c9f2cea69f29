"""how often late samples have made a run anew"""

import sqlalchemy as sa
from alembic import op

revision = "0018"
down_revision = "0017"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.add_column("runs", sa.Column("times_reopened", sa.BigInteger(), nullable=True))


def downgrade() -> None:
    op.drop_column("runs", "times_reopened")
