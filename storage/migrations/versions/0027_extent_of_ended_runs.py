"""what a run that is over is still to be made of"""

import sqlalchemy as sa
from alembic import op

revision = "0027"
down_revision = "0026"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.add_column("runs", sa.Column("extent", sa.JSON(), nullable=True))


def downgrade() -> None:
    op.drop_column("runs", "extent")
