"""reports of machines by mail: how often a subscription gets them, and until when it has them"""

import sqlalchemy as sa
from alembic import op

revision = "0030"
down_revision = "0029"
branch_labels = None
depends_on = None


def _name(length: int) -> sa.String:
    return sa.String(length).with_variant(sa.String(length, collation="C"), "postgresql")


def upgrade() -> None:
    op.add_column("subscriptions", sa.Column("reports", _name(16), nullable=True))
    op.add_column("subscriptions", sa.Column("reported_until", sa.BigInteger(), nullable=True))


def downgrade() -> None:
    op.drop_column("subscriptions", "reported_until")
    op.drop_column("subscriptions", "reports")
