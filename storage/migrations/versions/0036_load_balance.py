"""version of the balance of loads on oil films that identifications were made with"""

import sqlalchemy as sa
from alembic import op

revision = "0036"
down_revision = "0035"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.add_column("identifications", sa.Column("load_balance", sa.BigInteger(), nullable=True))


def downgrade() -> None:
    op.drop_column("identifications", "load_balance")
