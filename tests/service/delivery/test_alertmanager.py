"""Against Debian's real Prometheus Alertmanager."""

import os
import shutil
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest
import zenoh

from service.alerts import transitions
from service.alerts.lifecycle import Severity
from service.alerts.transitions import AlertFinding, Person
from service.delivery import dispatcher as dispatcher_module
from service.delivery.dispatcher import Dispatcher
from storage.alerts import alerts, deliveries
from storage.database.engine import Database
from storage.tables.findings import IdentificationRow
from tests.plant import machine, wait_until
from tests.ports import free_endpoint
from tests.service.delivery.receivers import raise_one, settings, subscribe

PROGRAM = "prometheus-alertmanager"
CONFIGURATION = """
route: {receiver: nobody, group_wait: 0s}
receivers: [{name: nobody}]
global: {resolve_timeout: 2s}
"""


@pytest.fixture
def alertmanager(tmp_path: Path) -> Iterator[str]:
    """URL of an Alertmanager that forgets after two seconds what is not told again."""
    program = shutil.which(PROGRAM)
    if program is None:
        if os.environ.get("RUNDOWN_REQUIRE_ALL"):
            pytest.fail(f"{PROGRAM} is not installed; .ci/run installs it")
        pytest.skip(f"{PROGRAM} is not installed")
    (tmp_path / "alertmanager.yml").write_text(CONFIGURATION)
    address = free_endpoint().removeprefix("tcp/")
    arguments = [
        f"--config.file={tmp_path}/alertmanager.yml",
        f"--storage.path={tmp_path}/data",
        f"--web.listen-address={address}",
    ]
    with (
        (tmp_path / "log").open("w") as log,
        subprocess.Popen([program, *arguments, "--cluster.listen-address="], stdout=log, stderr=log) as process,
    ):
        try:
            wait_until(lambda: _ready(address))
            yield f"http://{address}"
        finally:
            process.kill()


def _ready(address: str) -> bool:
    try:
        return httpx.get(f"http://{address}/-/ready", trust_env=False).is_success
    except httpx.TransportError:
        return False


def shown(url: str) -> list[tuple[str, str, str]]:
    """Active alerts as element, severity and state annotation."""
    answer: list[dict[str, Any]] = httpx.get(f"{url}/api/v2/alerts", params={"active": "true"}, trust_env=False).json()
    return sorted((one["labels"]["element"], one["labels"]["severity"], one["annotations"]["state"]) for one in answer)


def test_an_alert_fires_changes_its_severity_and_is_resolved(
    plant: Database,
    found: IdentificationRow,
    network: tuple[zenoh.Session, str],
    alertmanager: str,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(dispatcher_module, "RESEND_S", 0.5)
    subscribe(plant, alertmanager, name="prometheus", kind="alertmanager")
    one = Dispatcher(plant, network[0], settings(public_url="http://rundown:8080"))
    one.start()
    try:
        alert = raise_one(plant, found, machine())
        wait_until(lambda: shown(alertmanager) == [("coupling.C1", "alert", "unacknowledged")])
        (labels,) = (entry["labels"] for entry in httpx.get(f"{alertmanager}/api/v2/alerts", trust_env=False).json())
        assert labels["alertname"] == "Rundown_misalignment"
        assert (labels["machine"], labels["plant"], labels["rule"]) == ("pump-7", machine().plant, "misalignment")
        # Told again and again, it lasts longer than Alertmanager remembers.
        time.sleep(3.0)
        assert shown(alertmanager) == [("coupling.C1", "alert", "unacknowledged")]
        with plant.transaction() as session:
            finding = AlertFinding({}, found.id, found.measured_at, Severity.DANGER)
            transitions.raise_alert(session, "pump-7", rule="misalignment", element="coupling.C1", finding=finding)
        wait_until(lambda: shown(alertmanager) == [("coupling.C1", "danger", "unacknowledged")])
        with plant.transaction() as session:
            row = alerts.get(session, alert)
            transitions.acknowledge(session, row, Person("anna"))
            transitions.clear_alert(session, row)
        wait_until(lambda: shown(alertmanager) == [])
    finally:
        one.stop()


def test_an_unreachable_alertmanager_keeps_its_deliveries(
    plant: Database, found: IdentificationRow, network: tuple[zenoh.Session, str]
) -> None:
    subscription = subscribe(plant, f"http://{free_endpoint().removeprefix('tcp/')}", name="prometheus", kind="alertmanager")
    one = Dispatcher(plant, network[0], settings())
    one.start()
    try:
        raise_one(plant, found, machine())

        def tried() -> bool:
            with plant.reading() as session:
                return deliveries.of_subscription(session, subscription, limit=1)[0].attempts == 1

        wait_until(tried)
    finally:
        one.stop()
    with plant.reading() as session:
        (row,) = deliveries.of_subscription(session, subscription, limit=9)
        assert row.state == "pending"
        assert "ClientConnectorError" in (row.answer or "")
