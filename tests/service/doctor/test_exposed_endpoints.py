"""`rundown doctor --exposed`: what it says of settings, and that it finds out where a real service answers otherwise."""

import ipaddress
import json
import socket
import ssl
import subprocess
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from service.api.application import every_operation
from service.configuration.settings import Settings
from service.doctor.endpoint_probes import probe_endpoints
from service.doctor.exposed_endpoints import ExposedEndpoint, exposed_endpoints
from service.security.role import Role
from tests.end_to_end.processes import ROOT, Service, rundown, until
from tests.plant import sqlite_url
from tests.ports import free_port

TWICE: dict[str, Any] = {"allow_no_authentication": True, "everybody_may_change_everything": True}
OPEN_OPC_UA: dict[str, Any] = {"opcua_listen": "opc.tcp://0.0.0.0:4840", "opcua_allow_unencrypted": True}
API = "REST API, page and metrics"


@pytest.fixture(scope="module")
def certificates(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Certificates that the script makes, with rules for one source."""
    folder = tmp_path_factory.mktemp("certificates")
    for names in (("authority",), ("service", "127.0.0.1")):
        subprocess.run([ROOT / "deploy" / "certificates.sh", folder, *names], check=True, capture_output=True, timeout=30)
    (folder / "access.yaml").write_text("sources: {edge-7: [plant-1/pump-7]}\n")
    return folder


def zenoh_tls(folder: Path, **besides: str) -> dict[str, str]:
    """Settings that name the certificates."""
    files = {"ca": "authority.crt", "certificate": "service.crt", "key": "service.key"}
    return {f"zenoh_tls_{name}": str(folder / file) for name, file in files.items()} | besides


def found(what: str, **settings: Any) -> ExposedEndpoint:
    (one,) = [door for door in exposed_endpoints(Settings(**({"zenoh_listen": []} | settings))) if door.what == what]
    return one


@pytest.mark.parametrize(
    ("settings", "level", "words"),
    [
        ({}, "local", "host=127.0.0.1"),
        ({"host": "0.0.0.0"}, "open", "refuses to start so"),
        (
            {"host": "0.0.0.0", "allow_no_authentication": True, "everybody_may_change_everything": True},
            "open",
            "let it start so",
        ),
        ({"host": "::", "authentication": "required"}, "weak", "authentication=required"),
        ({"host": "plant.example", "oidc_issuer": "https://id.example", "oidc_audience": "x"}, "weak", "id.example"),
        ({"public_url": "https://rundown.example"}, "open", "public_url=https://rundown.example"),
        ({"public_url": "https://rundown.example", "authentication": "required"}, "guarded", "passes requests on"),
        ({"public_url": "http://rundown.example", "authentication": "required"}, "weak", "passes requests on"),
        ({"public_url": "http://localhost:8080"}, "local", "host=127.0.0.1"),
    ],
)
def test_the_api_is_reported_with_the_setting_that_makes_it_so(
    tmp_path: Path, settings: dict[str, Any], level: str, words: str
) -> None:
    one = found(API, database=sqlite_url(tmp_path / "none.db"), **settings)
    assert (one.level, words in one.because) == (level, True), one
    assert not (tmp_path / "none.db").exists()


def test_what_anybody_may_ask_is_that_of_the_table_of_operations(tmp_path: Path) -> None:
    key = rundown("key", "create", "anna", "--role", "viewer", "--database", sqlite_url(tmp_path / "rundown.db"))
    assert key.returncode == 0, key.stderr
    database = sqlite_url(tmp_path / "rundown.db")
    guarded = found(API, database=database, host="0.0.0.0")
    assert "there are API keys" in guarded.because
    told = {one.split()[1] for one in guarded.lets.partition(": ")[2].split(", ")}
    assert told == {one.path for one in every_operation() if one.requirement.role is None}
    assert "/metrics" not in told
    assert not any(one.requirement.role is Role.VIEWER and one.path in told for one in every_operation())


@pytest.mark.parametrize(
    ("what", "settings", "level", "words"),
    [
        ("zenoh, for sources", {"zenoh_listen": ["tcp/127.0.0.1:7447"]}, "local", "zenoh_listen"),
        ("zenoh, for sources", {"zenoh_listen": ["tcp/0.0.0.0:7447"]}, "open", "no zenoh_access"),
        ("zenoh, for sources", {"zenoh_listen": ["udp/[::]:7447"]}, "open", "no zenoh_access"),
        ("zenoh router", {"zenoh_connect": ["tcp/10.0.0.5:7447"]}, "weak", "zenoh_connect"),
        ("zenoh router", {"zenoh_connect": ["tls/10.0.0.5:7447"]}, "guarded", "zenoh_connect"),
        ("OPC UA server", OPEN_OPC_UA | {"opcua_listen": "opc.tcp://127.0.0.1:4840"}, "local", "opcua_listen"),
        ("OPC UA server", OPEN_OPC_UA, "open", "there is no store yet"),
        ("OPC UA server", OPEN_OPC_UA | {"authentication": "required"}, "weak", "opcua_allow_unencrypted=True"),
        ("MQTT broker", {"mqtt_url": "mqtt://127.0.0.1:1883"}, "local", "mqtt_url"),
        ("MQTT broker", {"mqtt_url": "mqtt://broker.plant:1883"}, "weak", "mqtt_samples=taken"),
        ("MQTT broker", {"mqtt_url": "mqtts://broker.plant:8883"}, "guarded", "mqtt_url"),
        ("Dask scheduler", {"dask_scheduler": "tcp://10.0.0.5:8786"}, "open", "dask_scheduler"),
        ("Dask scheduler", {"dask_scheduler": "tls://10.0.0.5:8786"}, "guarded", "dask_scheduler"),
        ("Dask scheduler", {"dask_scheduler": "tcp://127.0.0.1:8786"}, "local", "dask_scheduler"),
        ("PostgreSQL", {"database": "postgresql+psycopg://u:s3cret@0.0.0.0:1/x"}, "weak", "sslmode=prefer"),
        ("PostgreSQL", {"database": "postgresql+psycopg://u@127.0.0.1:1/x"}, "local", "sslmode=prefer"),
        ("PostgreSQL", {"database": "postgresql+psycopg://127.0.0.1:1/x?host=/run/nowhere"}, "local", "database"),
        ("inner addresses for webhooks", {"delivery_networks": ["10.1.0.0/16"]}, "guarded", "10.1.0.0/16"),
        ("inner addresses for webhooks", {"delivery_networks": ["127.0.0.1/32"]}, "weak", "127.0.0.1/32"),
        ("inner addresses for webhooks", {"delivery_networks": ["::/0"]}, "weak", "::/0"),
    ],
)
def test_every_other_door_is_reported(tmp_path: Path, what: str, settings: dict[str, Any], level: str, words: str) -> None:
    one = found(what, **({"database": sqlite_url(tmp_path / "none.db")} | settings))
    assert (one.level, words in one.because) == (level, True), one
    assert "s3cret" not in repr(one)


def test_zenoh_with_certificates_and_rules_is_guarded(certificates: Path, tmp_path: Path) -> None:
    store = {"database": sqlite_url(tmp_path / "none.db")}
    access = str(certificates / "access.yaml")
    endpoints = {"zenoh_listen": ["tls/0.0.0.0:7447"]}
    one = found("zenoh, for sources", **store, **endpoints, **zenoh_tls(certificates))
    assert (one.level, "no rules" in one.asks) == ("weak", True)
    one = found("zenoh, for sources", **store, **endpoints, **zenoh_tls(certificates, zenoh_access=access))
    assert (one.level, "1 sources, 0 readers" in one.lets) == ("guarded", True)
    plain = {"zenoh_listen": ["tcp/0.0.0.0:7447"]}
    one = found("zenoh, for sources", **store, **plain, **zenoh_tls(certificates, zenoh_access=access))
    assert "may do nothing" in one.asks


def test_files_that_others_may_read_are_named_and_the_worst_comes_first(tmp_path: Path) -> None:
    database = tmp_path / "rundown.db"
    for name in ("rundown.db", "rundown.db.key", "backups/monday", "backups/tuesday"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).touch(mode=0o600)
    settings = Settings(database=sqlite_url(database), backups=str(tmp_path / "backups"), host="0.0.0.0")
    assert [one.address for one in exposed_endpoints(settings) if one.what == "file"] == []
    readable = ("rundown.db", "rundown.db.key", "backups/monday")
    for name in readable:
        (tmp_path / name).chmod(0o644)
    told = exposed_endpoints(settings)
    files = [one for one in told if one.what == "file"]
    assert {one.address for one in files} == {
        str(tmp_path / one) for one in ("rundown.db", "rundown.db.key", "backups/monday")
    }
    assert [one.level for one in told] == ["open", "weak", "weak", "weak", "local"]


def exposed(service: Service, **environment: str) -> subprocess.CompletedProcess[str]:
    listen = json.dumps([service.endpoint])
    own = {"RUNDOWN_DATABASE": service.database, "RUNDOWN_PORT": str(service.port), "RUNDOWN_ZENOH_LISTEN": listen}
    return rundown("doctor", "--exposed", timeout=60.0, **(own | environment))


@pytest.mark.long
def test_a_real_service_is_asked_whether_it_answers_as_its_settings_say(tmp_path: Path) -> None:
    service = Service(tmp_path)
    with service.running():
        told = exposed(service)
        assert told.returncode == 0, told.stdout + told.stderr
        assert "GET /api/v1/sources is answered, as nobody needs any" in told.stdout
        # It was started with other settings than those that are looked at.
        told = exposed(service, RUNDOWN_AUTHENTICATION="required")
        assert told.returncode == 1
        assert "answers anybody: " in told.stdout
        assert "/api/v1/machines, " in told.stdout
        assert rundown("key", "create", "anna", "--role", "viewer", "--database", service.database).returncode == 0
        until(lambda: service.client.get("/machines").status_code == 401, within_s=10, what="the service has seen the key")
        assert "there are API keys" in (told := exposed(service)).stdout
        assert told.returncode == 0, told.stdout
        count = sum(
            "GET" in one.methods and "{" not in one.path and one.requirement.role is not None for one in every_operation()
        )
        assert f"{count} of {count} paths that can be read are answered 401" in told.stdout
    told = exposed(service, RUNDOWN_HOST="0.0.0.0", RUNDOWN_DATABASE=sqlite_url(tmp_path / "none.db"))
    assert told.returncode == 1
    assert told.stdout.startswith("open     REST API")
    assert "nothing answers at" in told.stdout
    assert "1 open to everybody" in told.stderr
    service.client.close()


def test_a_real_zenoh_door_refuses_who_shows_no_certificate(certificates: Path, tmp_path: Path) -> None:
    settings = zenoh_tls(certificates, zenoh_access=str(certificates / "access.yaml"))
    service = Service(tmp_path, **{f"RUNDOWN_{name.upper()}": value for name, value in settings.items()})
    service.endpoint = service.endpoint.replace("tcp/", "tls/")
    with service.running():
        chosen = Settings.model_validate({"zenoh_listen": [service.endpoint], "port": service.port} | settings)
        told = {one.what: one for one in probe_endpoints(chosen, asked=False)}
        assert told[f"{service.endpoint} without a certificate"].level == "ok", told
    service.client.close()


def test_a_door_with_tls_that_lets_anybody_in_is_found(certificates: Path) -> None:
    with anybody(certificates) as port:
        endpoint = f"tls/127.0.0.1:{port}"
        chosen = Settings.model_validate({"zenoh_listen": [endpoint], "port": free_port()} | zenoh_tls(certificates))
        api, zenoh = probe_endpoints(chosen, asked=True)
    assert (api.level, zenoh.level) == ("not tried", "open")


@contextmanager
def anybody(folder: Path) -> Iterator[int]:
    """A TLS server that asks for no certificate and greets who comes; its port."""
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(folder / "service.crt", folder / "service.key")
    with socket.create_server(("127.0.0.1", 0)) as listener:

        def greet() -> None:
            plain, _ = listener.accept()
            with plain, context.wrap_socket(plain, server_side=True) as secured:
                secured.sendall(b"hello")

        thread = threading.Thread(target=greet)
        thread.start()
        yield listener.getsockname()[1]
        thread.join()


def test_networks_are_compared_within_their_own_family() -> None:
    one = found("inner addresses for webhooks", delivery_networks=[ipaddress.ip_network("fd00::/64")], database="sqlite://")
    assert "service's machine itself" not in one.lets
