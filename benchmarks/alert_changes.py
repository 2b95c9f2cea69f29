"""Alerts that change, for benchmarks of what listeners hear of them: one machine, whose couplings' alerts come and go."""

from pathlib import Path

from sqlalchemy.orm import Session

from service.alerts import transitions
from service.alerts.transitions import AlertFinding, Person
from storage.alerts import alerts
from storage.database.engine import Database
from storage.machines import machines
from storage.tables.alerting import AlertRow
from tests.plant import KEY, START, identification, machine, store_identification

RULE = "misalignment"


def alerting_machine(folder: Path) -> tuple[Database, int]:
    """Return a database with the machine, and the number of the identification that its alerts come from."""
    database = Database(f"sqlite:///{folder}/alerts.db")
    with database.transaction() as session:
        machines.create(session, machine())
        number = store_identification(session, identification(), run_id=1, measured_at=START).id
    return database, number


def change_alert(session: Session, element: str, identified: int) -> AlertRow:
    """Raise, acknowledge or clear the alert of an element, whichever is next; return the alert."""
    row = alerts.open_alert(session, KEY.machine, rule=RULE, element=element)
    if row is None:
        finding = AlertFinding({}, identified, START)
        row = transitions.raise_alert(session, KEY.machine, rule=RULE, element=element, finding=finding)
        assert row is not None, "nothing suppresses it"
    elif row.state == "unacknowledged":
        transitions.acknowledge(session, row, Person("anna"))
    else:
        transitions.clear_alert(session, row)
    return row
