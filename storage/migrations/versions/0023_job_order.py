"""identification jobs by plant, priority and turn, and who asked for them"""

import sqlalchemy as sa
from alembic import op

revision = "0023"
down_revision = "0022"
branch_labels = None
depends_on = None

INDICES = (
    ("state", "priority", "turn", "id"),
    ("state", "priority", "plant", "turn"),
    ("machine_id", "state"),
    ("asked_by", "state"),
)
PLANT = (
    "UPDATE identification_jobs SET plant = (SELECT plant FROM machines WHERE machines.id = identification_jobs.machine_id)"
)
TRIED = "UPDATE identification_jobs SET priority = 3 WHERE state = 'queued' AND attempts > 0"


def _name(length: int) -> sa.String:
    return sa.String(length).with_variant(sa.String(length, collation="C"), "postgresql")


def upgrade() -> None:
    op.add_column("identification_jobs", sa.Column("plant", _name(64), nullable=False, server_default="?"))
    op.add_column("identification_jobs", sa.Column("priority", sa.BigInteger(), nullable=False, server_default="0"))
    op.add_column("identification_jobs", sa.Column("turn", sa.BigInteger(), nullable=False, server_default="0"))
    op.add_column("identification_jobs", sa.Column("asked_by", _name(255), nullable=True))
    op.execute(PLANT)
    op.execute(TRIED)
    op.drop_index("ix_identification_jobs_state", "identification_jobs")
    for columns in INDICES:
        op.create_index(f"ix_identification_jobs_{'_'.join(columns)}", "identification_jobs", columns)


def downgrade() -> None:
    for columns in INDICES:
        op.drop_index(f"ix_identification_jobs_{'_'.join(columns)}", "identification_jobs")
    op.create_index("ix_identification_jobs_state", "identification_jobs", ["state"])
    for name in ("asked_by", "turn", "priority", "plant"):
        op.drop_column("identification_jobs", name)
