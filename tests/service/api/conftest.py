"""APIs over real databases: with a machine only, with something of everything, filled with runs and findings."""

import math
from collections.abc import Iterator
from pathlib import Path

import pytest

from service.alerts import transitions
from service.alerts.transitions import AlertFinding, raise_alert
from service.runs.collector import Collector
from storage.alerts import deliveries, suppressions
from storage.database.engine import Database
from storage.findings import jobs
from storage.measurements.quarantine import Rejection
from tests.api_in_process import Api
from tests.databases import Databases, opened
from tests.plant import (
    KEY,
    SECOND,
    START,
    arrived,
    batch,
    identification,
    store_identification,
    sweep_rpm,
)
from tests.prompt_writer import PromptWriter
from tests.slow_roll import slow_roll_and_run_down, train_with_run_out


@pytest.fixture
def api(plant: Database) -> Api:
    """An API over a database that knows the machine and nothing else."""
    return Api(plant)


@pytest.fixture
def pump(plant: Database) -> Api:
    """An API over a machine with a slow roll and a run-down."""
    return slow_roll_and_run_down(plant)


@pytest.fixture
def train(database: Database) -> tuple[Database, int]:
    """The Chapter 3 train with one run-down whose channels all have a large run-out; the run's number."""
    return database, train_with_run_out(database)


@pytest.fixture
def furnished(plant: Database) -> Api:
    """Something of everything: over a machine with identifications, of which one raised an alert, and a subscription."""
    with plant.transaction() as session:
        for number in range(7):
            row = store_identification(session, identification(), run_id=number, measured_at=START + number * SECOND)
        finding = AlertFinding({}, row.id, START)
        transitions.raise_alert(session, KEY.machine, rule="misalignment", element="coupling.C1", finding=finding)
        deliveries.subscribe(session, kind="zenoh", name="plant", target="", secret=None)
        suppressions.add(
            session, KEY.machine, kind="out_of_service", rule="misfit", element=None, until=None, by="anna", comment=""
        )
    return Api(plant)


@pytest.fixture(scope="session")
def filled_template(databases: Databases, plant_template: str, tmp_path_factory: pytest.TempPathFactory) -> str:
    """URL of a database filled with runs and findings."""
    url = databases.copy(plant_template, tmp_path_factory.mktemp("filled") / "filled.db")
    database = Database(url)
    fill(database)
    database.close()
    return url


@pytest.fixture(scope="session")
def filled(databases: Databases, filled_template: str, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Api]:
    """An API over a filled database, which no test changes."""
    with opened(databases, filled_template, tmp_path_factory.mktemp("filled") / "filled.db") as database:
        yield Api(database)


@pytest.fixture
def changing(databases: Databases, filled_template: str, tmp_path: Path) -> Iterator[Api]:
    """An API over a filled database of the test's own."""
    with opened(databases, filled_template, tmp_path / "rundown.db") as database:
        yield Api(database)


def fill(database: Database) -> None:
    """A run-down, an open run-up, three identifications of which one was not accepted, an alert, a queued and a failed job."""
    rpm = [*sweep_rpm(2990.0, 310.0), 250.0, *sweep_rpm(310.0, 1500.0)]
    one = batch(rpm, sequence=3)
    one.amplitude[0][1] = None
    writer = PromptWriter(database, Collector())
    writer.store([arrived(one)], [Rejection(START, "some/key", "pump-7", "bad_frame", "no frame", b"\xff\x00noise")])
    with database.transaction() as session:
        for number, (factor, accepted) in enumerate([(1.0, True), (1.1, False), (1.2, True)]):
            outcome = identification(
                {"coupling.C1.kxx": factor}, unknown=["bearing.B1.kxy"], accepted=accepted, condition_number=math.inf
            )
            row = store_identification(session, outcome, run_id=100 + number, measured_at=START + number * 3600 * SECOND)
        gathered = identification({"coupling.C1.kxx": 1.5})
        store_identification(session, gathered, run_id=200, scope=jobs.GATHERED, run_kind="gathered")
        failed = jobs.enqueue(session, "pump-7", scope=jobs.GATHERED, run_ids=[1, 2])
        assert failed is not None
        jobs.finish(failed, state=jobs.FAILED, error="NotEnoughData: too few")
        finding = AlertFinding({"shift": math.nan, "parts": [math.inf, 1.0]}, row.id, row.measured_at)
        raise_alert(session, "pump-7", rule="misalignment", element="coupling.C1", finding=finding)
