"""the head of the audit trail only goes on, by one entry that was appended"""

from alembic import op

revision = "0022"
down_revision = "0021"
branch_labels = None
depends_on = None

REFUSED = "the head of the audit trail only follows an entry that was appended"
FOLLOWS = """
    NEW.id = OLD.id AND NEW.number = OLD.number + 1 AND EXISTS
    (SELECT 1 FROM audit WHERE number = NEW.number AND hash = NEW.hash AND previous = OLD.hash)
"""


def upgrade() -> None:
    if op.get_bind().dialect.name == "sqlite":
        refuse = f"BEGIN SELECT RAISE(ABORT, '{REFUSED}'); END"
        op.execute(f"CREATE TRIGGER audit_head_follows BEFORE UPDATE ON audit_head WHEN NOT ({FOLLOWS}) {refuse}")
        op.execute(f"CREATE TRIGGER audit_head_no_delete BEFORE DELETE ON audit_head {refuse}")
        # What SQLite replaces is deleted without a trigger that refuses it.
        there = "EXISTS (SELECT 1 FROM audit_head WHERE id = NEW.id)"
        op.execute(f"CREATE TRIGGER audit_head_no_replace BEFORE INSERT ON audit_head WHEN {there} {refuse}")
        return
    op.execute(
        f"""
        CREATE FUNCTION audit_head_follows() RETURNS trigger LANGUAGE plpgsql AS $$
        BEGIN
            IF TG_OP = 'UPDATE' THEN
                IF {FOLLOWS} THEN
                    RETURN NEW;
                END IF;
            END IF;
            RAISE EXCEPTION '{REFUSED}';
        END $$
        """
    )
    for name, changes, each in (("follows", "UPDATE OR DELETE", "ROW"), ("no_truncate", "TRUNCATE", "STATEMENT")):
        op.execute(
            f"CREATE TRIGGER audit_head_{name} BEFORE {changes} ON audit_head "
            f"FOR EACH {each} EXECUTE FUNCTION audit_head_follows()"
        )


def downgrade() -> None:
    if op.get_bind().dialect.name == "sqlite":
        for name in ("follows", "no_delete", "no_replace"):
            op.execute(f"DROP TRIGGER audit_head_{name}")
        return
    for name in ("follows", "no_truncate"):
        op.execute(f"DROP TRIGGER audit_head_{name} ON audit_head")
    op.execute("DROP FUNCTION audit_head_follows()")
