"""The whole service beside a broker: it is a part of its health, and the doctor looks at it."""

import subprocess
import sys
from pathlib import Path

import httpx

from service.doctor.checks import _broker
from tests.end_to_end.processes import Service, until
from tests.mosquitto import Mosquitto
from tests.service.mqtt.conftest import settings_of


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
