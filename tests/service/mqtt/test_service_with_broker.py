"""The whole service beside a broker: it is a part of its health, and the doctor looks at it."""

import subprocess
import sys
from pathlib import Path

import httpx
import pytest

from service.alerts import transitions
from service.alerts.transitions import AlertFinding, Person
from service.doctor.checks import _broker
from storage.alerts import alerts
from storage.database.engine import Database
from tests.end_to_end.processes import Service, until
from tests.mosquitto import Mosquitto
from tests.plant import KEY, START, document, identification, store_identification
from tests.service.mqtt.conftest import settings_of
from tests.service.mqtt.test_publisher import ALERT, TRENDS, state


def test_a_service_whose_broker_is_away_is_ready_and_says_so(tmp_path: Path) -> None:
    one = Mosquitto(tmp_path / "mosquitto", tls=False)
    service = Service(tmp_path, **one.environment)
    try:
        with service.running():
            told = until(lambda: _with_trouble(service), within_s=30, what="both parts say so")
            assert told.status_code == 503
            assert service.client.get("/ready").status_code == 200
            one.start()
            until(lambda: service.client.get("/health").status_code == 200, within_s=30, what="the broker is found")
            metrics = service.client.get(f"http://127.0.0.1:{service.port}/metrics").text
            assert "\nrundown_mqtt_samples_connected 1.0" in metrics
            assert 'rundown_part_ok{part="mqtt_alerts"} 1.0' in metrics
    finally:
        service.client.close()
        one.kill()


@pytest.mark.long
def test_the_last_state_is_right_after_a_kill_of_the_service_and_of_a_broker_that_forgets(tmp_path: Path) -> None:
    """An alert changes while nobody can tell of it."""
    one = Mosquitto(tmp_path / "mosquitto", tls=False)
    one.start()
    service = Service(tmp_path, **one.environment)
    status = "rundown/v1/status/rundown"
    try:
        with service.running() as process, one.connected("hmi", "", "rundown/v1/#") as hmi:
            assert service.client.post("/machines", json=document()).status_code == 201
            assert service.client.post("/subscriptions", json={"kind": "mqtt", "name": "broker"}).status_code == 201
            database = Database(service.database)
            with database.transaction() as session:
                number = store_identification(session, identification(), run_id=1, measured_at=START).id
                finding = AlertFinding({}, number, START)
                rule = {"rule": "misalignment", "element": "coupling.C1"}
                alert = transitions.raise_alert(session, KEY.machine, **rule, finding=finding).id
            until(lambda: state(hmi.last(ALERT)) == "unacknowledged", within_s=30, what="the alert is told")
            process.kill()
            until(lambda: hmi.last(status) == b"offline", within_s=60, what="the broker tells that the service is gone")
        with database.transaction() as session:
            transitions.acknowledge(session, alerts.get(session, alert, to_change=True), Person("anna"))
        database.close()
        one.kill()
        (one.folder / "mosquitto.db").unlink(missing_ok=True)
        one.start()
        with service.running(), one.connected("hmi", "", "rundown/v1/#") as hmi:
            until(lambda: state(hmi.last(ALERT)) == "acknowledged", within_s=30, what="the last state is told")
            until(lambda: hmi.last(status) == b"online" and hmi.last(TRENDS), within_s=30, what="and the newest trends")
    finally:
        service.client.close()
        one.kill()


def test_without_a_broker_its_library_is_not_loaded() -> None:
    script = "import sys\nfrom service.commands import service_threads\n"
    script += "assert not {'aiomqtt', 'paho', 'service.mqtt'} & set(sys.modules), 'loaded'\n"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def _with_trouble(service: Service) -> httpx.Response | None:
    told = service.client.get("/health")
    parts = told.json()["parts"]
    return told if all("cannot be used" in parts[name] for name in ("mqtt_samples", "mqtt_alerts")) else None


def test_the_doctor_says_whether_the_broker_lets_the_service_in(mosquitto: Mosquitto) -> None:
    assert [one.level for one in _broker(settings_of(mosquitto))] == ["ok"]
    wrong = settings_of(mosquitto, mqtt_password_file="", mqtt_password="wrong")
    (found,) = _broker(wrong)
    assert (found.level, "ot authori" in found.words) == ("wrong", True)
