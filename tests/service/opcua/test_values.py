"""Values of every group of a machine as another stack reads them: before its first run, with it, and without a value in it."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml

from estimator.machine.document import parse_machine
from estimator.updated_model.derived_quantities import Derived
from service.configuration.settings import Settings
from service.opcua.serving import OpcUaServing
from storage.database.engine import Database
from storage.findings import derived
from storage.findings.jobs import VARIANT
from storage.machines import machines
from storage.measurements import runs
from tests.paths import EXAMPLES
from tests.plant import KEY, SECOND, START, identification, machine, samples, store_identification, wait_until
from tests.ports import free_port
from tests.service.opcua.second_stack import SecondStack, second_stack

MACHINE = f"ns=2;s={KEY.plant}/{KEY.machine}"
FILMS = yaml.safe_load((EXAMPLES / "motor-compressor.yaml").read_text(encoding="utf-8"))
ON_FILMS = f"ns=2;s={FILMS['plant']}/{FILMS['id']}"
UNBALANCE = f"{MACHINE}/Parameters/disc.D1.unbalance"
OFFSET = f"{MACHINE}/Alignment/coupling.C1.offset_vertical"
LOAD = f"{MACHINE}/Loads/bearing.B1.load_vertical"
SPEED = f"{MACHINE}/Derived/critical_speed.1"
VALUES = [
    Derived("coupling.C1.offset_vertical", "m", 1.2e-4, 1.0e-4, 1.4e-4),
    Derived("bearing.B1.load_vertical", "N", 800.0, 750.0, 850.0),
    Derived("critical_speed.1", "rad/s", 150.0, 149.0, 151.0),
]
ENDED = "2023-11-15T03:14:00.000Z"
"""End of the run: its source time."""


@pytest.fixture(scope="module")
def client(store: Database, tmp_path_factory: pytest.TempPathFactory) -> Iterator[SecondStack]:
    """A client of a server whose machines have no run yet."""
    with store.transaction() as session:
        machines.create(session, machine())
        machines.create(session, parse_machine(FILMS))
    endpoint = f"opc.tcp://127.0.0.1:{free_port()}"
    serving = OpcUaServing(store, Settings(opcua_listen=endpoint, opcua_allow_unencrypted=True))
    serving.start()
    try:
        wait_until(lambda: serving.ready)
        folder: Path = tmp_path_factory.mktemp("client")
        with second_stack(endpoint, folder, application="urn:second-stack:client") as one:
            yield one
    finally:
        serving.stop()


def read(client: SecondStack, node: str) -> dict[str, Any]:
    (found,) = client.ask("read", nodes=[node])
    return dict(found)


def test_before_the_first_run_all_that_the_document_names_is_there_and_waits(client: SecondStack) -> None:
    """Whoever sets up a control system looks for its tags then."""
    (coupling,) = [one["id"] for one in FILMS["couplings"]]
    alignment = client.ask("browse", node=f"{ON_FILMS}/Alignment")["names"]
    assert sorted(alignment) == sorted(
        f"coupling.{coupling}.{one}" for one in ("offset_vertical", "offset_horizontal", "angle_vertical", "angle_horizontal")
    )
    loads = client.ask("browse", node=f"{ON_FILMS}/Loads")["names"]
    assert {f"bearing.{one['id']}.load_vertical" for one in FILMS["bearings"]} < set(loads)
    assert f"coupling.{coupling}.misalignment_force" in loads
    for node in (f"{ON_FILMS}/Alignment/{alignment[0]}", f"{ON_FILMS}/Loads/{loads[0]}", UNBALANCE, f"{UNBALANCE}/AngleDeg"):
        assert read(client, node)["status"] == "BadWaitingForInitialData"
    assert read(client, f"{ON_FILMS}/Alignment/{alignment[0]}/EngineeringUnits")["value"]["displayName"] in ("m", "rad")
    assert read(client, f"{UNBALANCE}/Quality")["value"] == "not_identified"


def test_each_group_has_value_unit_interval_quality_source_time_and_history(client: SecondStack, store: Database) -> None:
    with store.transaction() as session:
        held = samples(10, start=START)
        run = runs.open_run(session, KEY.machine, revision=1, kind="run-down", direction=1, time_first=START)
        runs.close(run, samples=held, state=runs.CLOSED, reason="standing")
        row = store_identification(session, identification(), run_id=run.id, measured_at=START + 18_040 * SECOND)
        derived.add(session, row, VALUES)
        number, ran = row.id, run.id
    wait_until(lambda: read(client, SPEED)["status"] == "Good")
    for node, one in zip((OFFSET, LOAD, SPEED), VALUES, strict=True):
        assert read(client, node) == {"value": one.value, "status": "Good", "source": ENDED}
        for name, value in (("Lower95", one.lower), ("Upper95", one.upper), ("Quality", "accepted")):
            assert read(client, f"{node}/{name}") == {"value": value, "status": "Good", "source": ENDED}
        assert read(client, f"{node}/EngineeringUnits")["value"]["displayName"] == one.unit
        told = client.ask("history", node=node, begin="2020-01-01", end="2030-01-01")
        assert [(each["value"], each["source"]) for each in told["values"]] == [(one.value, ENDED)]
    assert read(client, f"{UNBALANCE}/AngleDeg")["value"] == pytest.approx(333.435, abs=1e-3)
    assert read(client, f"{MACHINE}/Identification/Id") == {"value": number, "status": "Good", "source": ENDED}
    last = f"2023-11-14T22:13:{20 + 9}.000Z"
    for name, value in (("Id", ran), ("Kind", "run-down"), ("State", "closed"), ("EndedAt", last)):
        assert read(client, f"{MACHINE}/Runs/{name}") == {"value": value, "status": "Good", "source": last}
    for name in ("Alerts/Open", "Name", "Revision"):
        assert read(client, f"{MACHINE}/{name}")["source"] is not None, "when it was noticed"


def test_a_variant_of_the_newest_run_does_not_stand_in_its_place(client: SecondStack, store: Database) -> None:
    """The values are those of the run's own identification; so is what is said of it."""
    before = read(client, f"{MACHINE}/Identification/Id")
    with store.transaction() as session:
        other = identification(accepted=False)
        store_identification(session, other, run_id=1, measured_at=START + 18_040 * SECOND, scope=VARIANT)
        machines.revise(session, machine(name="Pump seven"))
    wait_until(lambda: read(client, f"{MACHINE}/Name")["value"] == "Pump seven")
    assert read(client, f"{MACHINE}/Identification/Id") == before
    assert read(client, f"{MACHINE}/Identification/Accepted")["value"] is True


def test_what_the_newest_identification_has_not_is_bad_with_all_that_belongs_to_it(
    client: SecondStack, store: Database
) -> None:
    outcome = identification(accepted=False)
    with store.transaction() as session:
        store_identification(session, outcome, run_id=2, measured_at=START + 20_000 * SECOND)
        store_identification(session, outcome, run_id=3, measured_at=START + 20_000 * SECOND, machine_id=FILMS["id"])
    wait_until(lambda: read(client, OFFSET)["status"] != "Good")
    (coupling,) = [one["id"] for one in FILMS["couplings"]]
    named = f"{ON_FILMS}/Alignment/coupling.{coupling}.offset_vertical"
    wait_until(lambda: read(client, named)["status"] == "BadDataUnavailable")
    for node, why in ((OFFSET, "has no such quantity"), (named, "follows from an accepted identification only")):
        for part in ("", "/Lower95", "/Upper95"):
            found = read(client, node + part)
            assert (found["status"], found["value"]) == ("BadDataUnavailable", None)
        assert read(client, f"{node}/Quality")["value"] == "not_estimable"
        assert why in read(client, f"{node}/Reason")["value"]
