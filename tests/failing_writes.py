"""A database that refuses to write some rows, as a constraint of it would."""

from sqlalchemy import text
from sqlalchemy.orm import Session


def refuse(session: Session, table: str, *, write: str, when: str = "TRUE") -> None:
    """Make every INSERT or UPDATE of a table an integrity error where a condition on the row NEW holds."""
    if session.get_bind().dialect.name == "sqlite":
        abort = "SELECT RAISE(ABORT, 'refused by the test')"
        session.execute(text(f"CREATE TRIGGER refuse BEFORE {write} ON {table} WHEN {when} BEGIN {abort}; END"))
        return
    session.execute(
        text(
            "CREATE FUNCTION refuse() RETURNS trigger LANGUAGE plpgsql AS $$ BEGIN "
            "RAISE EXCEPTION 'refused by the test' USING ERRCODE = 'check_violation'; END $$"
        )
    )
    each = f"FOR EACH ROW WHEN ({when}) EXECUTE FUNCTION refuse()"
    session.execute(text(f"CREATE TRIGGER refuse BEFORE {write} ON {table} {each}"))
