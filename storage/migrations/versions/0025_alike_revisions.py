"""which revisions of a document describe the same machine"""

from collections.abc import Iterator
from itertools import groupby
from typing import Any

import sqlalchemy as sa
from alembic import op

from estimator.machine.document import DocumentError, Machine, parse_machine

revision = "0025"
down_revision = "0023"
branch_labels = None
depends_on = None

INDEX = "ix_machine_revisions_machine_id_same_since_alike_since_revision"
REVISIONS = sa.table(
    "machine_revisions",
    sa.column("machine_id", sa.String()),
    sa.column("revision", sa.BigInteger()),
    sa.column("document", sa.JSON()),
    sa.column("same_since", sa.BigInteger()),
    sa.column("alike_since", sa.BigInteger()),
)
OWN = sa.and_(REVISIONS.c.machine_id == sa.bindparam("of"), REVISIONS.c.revision == sa.bindparam("number"))


def upgrade() -> None:
    for name in ("same_since", "alike_since"):
        op.add_column("machine_revisions", sa.Column(name, sa.BigInteger(), nullable=False, server_default="1"))
    bind = op.get_bind()
    # A machine with one revision, as most are, has 1 in both.
    several = sa.select(REVISIONS.c.machine_id).group_by(REVISIONS.c.machine_id).having(sa.func.max(REVISIONS.c.revision) > 1)
    keys = bind.execute(
        sa.select(REVISIONS.c.machine_id, REVISIONS.c.revision)
        .where(REVISIONS.c.machine_id.in_(several))
        .order_by(REVISIONS.c.machine_id, REVISIONS.c.revision)
    ).all()
    found = [one for _, own in groupby(keys, key=lambda key: str(key.machine_id)) for one in _since(bind, list(own))]
    if found:
        bind.execute(sa.update(REVISIONS).where(OWN), found)
    op.create_index(INDEX, "machine_revisions", ["machine_id", "same_since", "alike_since", "revision"])


def downgrade() -> None:
    op.drop_index(INDEX, "machine_revisions")
    for name in ("alike_since", "same_since"):
        op.drop_column("machine_revisions", name)


def _since(bind: sa.Connection, keys: list[Any]) -> Iterator[dict[str, Any]]:
    """Yield of each revision of a machine from which one on they are the same."""
    before: Machine | None = None
    same = alike = 0
    for machine_id, number in keys:
        machine = _machine(bind, machine_id, number)
        if machine is None or before is None or not machine.is_the_same_train_as(before):
            same = alike = number
        elif machine.conditions != before.conditions:
            alike = number
        yield {"of": machine_id, "number": number, "same_since": same, "alike_since": alike}
        before = machine


def _machine(bind: sa.Connection, machine_id: str, number: int) -> Machine | None:
    """Return a document as it is understood today; None where it is not."""
    query = sa.select(REVISIONS.c.document).where(REVISIONS.c.machine_id == machine_id, REVISIONS.c.revision == number)
    try:
        return parse_machine(bind.execute(query).scalar_one())
    except DocumentError:
        return None
