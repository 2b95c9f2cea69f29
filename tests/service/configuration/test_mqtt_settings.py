"""Settings of the broker: what is wrong is named before anything starts; without them nothing of it is loaded."""

import subprocess
import sys
from pathlib import Path

import pytest

from service.configuration.settings import SettingsWrong, settings_of


@pytest.mark.parametrize(
    ("told", "words"),
    [
        ({"mqtt_url": "tcp://broker"}, "it must be mqtts://HOST:PORT or mqtt://HOST:PORT"),
        ({"mqtt_url": "mqtts://anna:secret@broker"}, "settings of their own, mqtt_user and mqtt_password_file"),
        ({"mqtt_url": "mqtt://broker.example", "mqtt_password": "secret"}, "a password goes over mqtts:// only"),
        ({"mqtt_tls_certificate": "a.crt"}, "both, or neither"),
        ({"mqtt_password_file": "/nowhere/password"}, "cannot be read"),
        ({"mqtt_topic_prefix": "plant/#"}, "mqtt_topic_prefix"),
        ({"mqtt_qos": 2}, "mqtt_qos"),
        ({"mqtt_url": "mqtts://broker:none"}, "mqtt_url"),
    ],
)
def test_what_is_wrong_is_named(told: dict[str, object], words: str) -> None:
    with pytest.raises(SettingsWrong, match=words) as raised:
        settings_of(**told)
    assert "secret" not in str(raised.value)


def test_ports_are_those_of_mqtt() -> None:
    assert settings_of(mqtt_url="mqtts://broker").mqtt_broker == ("broker", 8883)
    assert settings_of(mqtt_url="mqtt://127.0.0.1", mqtt_password="secret").mqtt_broker == ("127.0.0.1", 1883)


def test_a_password_comes_from_a_file(tmp_path: Path) -> None:
    file = tmp_path / "password"
    file.write_text("secret\n")
    file.chmod(0o600)
    assert settings_of(mqtt_password_file=str(file)).mqtt_password.get_secret_value() == "secret"


def test_nothing_of_it_is_loaded_unless_it_is_configured() -> None:
    script = (
        "import sys, service.commands.app, service.commands.serve, service.delivery.channels, service.doctor.checks;"
        "print([one for one in sys.modules if one.split('.')[0] in ('aiomqtt', 'paho') or one.startswith('service.mqtt')])"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True, timeout=60)
    assert done.stdout.strip() == "[]"
