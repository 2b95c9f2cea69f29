"""calibrations of a machine's model from runs with known unbalances"""

import sqlalchemy as sa
from alembic import op

revision = "0031"
down_revision = "0030"
branch_labels = None
depends_on = None


def _name(length: int) -> sa.String:
    return sa.String(length).with_variant(sa.String(length, collation="C"), "postgresql")


def upgrade() -> None:
    op.create_table(
        "model_calibrations",
        sa.Column("id", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), nullable=False),
        sa.Column("machine_id", _name(64), nullable=False),
        sa.Column("revision", sa.BigInteger(), nullable=False),
        sa.Column("job_id", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), nullable=True),
        sa.Column("asked", sa.JSON(), nullable=False),
        sa.Column("by", _name(120), nullable=False),
        sa.Column("comment", sa.Text(), nullable=False),
        sa.Column("created_at", sa.BigInteger(), nullable=False),
        sa.Column("computed_at", sa.BigInteger(), nullable=True),
        sa.Column("accepted", sa.Boolean(), nullable=True),
        sa.Column("verdict", sa.Text(), nullable=True),
        sa.Column("result", sa.JSON(), nullable=True),
        sa.Column("document", sa.JSON(), nullable=True),
        sa.Column("code_version", _name(64), nullable=True),
        sa.Column("revision_in_force", sa.BigInteger(), nullable=True),
        sa.ForeignKeyConstraint(["job_id"], ["identification_jobs.id"], name=op.f("fk_model_calibrations_job_id")),
        sa.ForeignKeyConstraint(["machine_id"], ["machines.id"], name=op.f("fk_model_calibrations_machine_id")),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_model_calibrations")),
    )
    op.create_index(op.f("ix_model_calibrations_machine_id_id"), "model_calibrations", ["machine_id", "id"])


def downgrade() -> None:
    op.drop_index(op.f("ix_model_calibrations_machine_id_id"), table_name="model_calibrations")
    op.drop_table("model_calibrations")
