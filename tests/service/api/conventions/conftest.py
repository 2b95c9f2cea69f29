"""An API with something of everything."""

import pytest

from service.alerts import transitions
from service.alerts.transitions import AlertFinding
from storage.alerts import deliveries, suppressions
from storage.database.engine import Database
from tests.api_in_process import Api
from tests.plant import KEY, SECOND, START, identification, store_identification


@pytest.fixture
def api(plant: Database) -> Api:
    """Over a machine with identifications, of which one raised an alert, and a subscription."""
    with plant.transaction() as session:
        for number in range(7):
            row = store_identification(session, identification(), run_id=number, measured_at=START + number * SECOND)
        finding = AlertFinding("it moves", {}, row.id, START)
        transitions.raise_alert(session, KEY.machine, rule="misalignment", element="coupling.C1", finding=finding)
        deliveries.subscribe(session, kind="zenoh", name="plant", target="", secret=None)
        suppressions.add(
            session, KEY.machine, kind="out_of_service", rule="misfit", element=None, until=None, by="anna", comment=""
        )
    return Api(plant)
