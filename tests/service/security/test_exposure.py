"""Secure by default, as a process: what is refused at the start, TLS with real certificates, and that no secret is logged."""

import re
import ssl
import subprocess
from pathlib import Path
from typing import Any

import httpx
import pytest

from service.configuration.settings import Settings
from service.security.exposure import Exposed, beyond, require_authentication
from tests.end_to_end.processes import ROOT, Service, rundown, until
from tests.plant import sqlite_url
from tests.ports import free_port

TWICE: dict[str, Any] = {"allow_no_authentication": True, "everybody_may_change_everything": True}


@pytest.mark.parametrize("host", ["127.0.0.1", "::1", "localhost", "127.8.8.8"])
def test_on_loopback_nothing_is_needed(host: str) -> None:
    assert require_authentication(Settings(host=host), keys_are_there=False) == []


@pytest.mark.parametrize("host", ["0.0.0.0", "::", "192.168.1.7", "plant.example", ""])
def test_beyond_it_credentials_are(host: str) -> None:
    with pytest.raises(Exposed, match="say so twice"):
        require_authentication(Settings(host=host), keys_are_there=False)
    for name, value in TWICE.items():
        once = {name: value}
        with pytest.raises(Exposed):
            require_authentication(Settings(host=host, **once), keys_are_there=False)
    assert len(require_authentication(Settings(host=host, **TWICE), keys_are_there=False)) == 1
    assert require_authentication(Settings(host=host), keys_are_there=True) == []
    assert require_authentication(Settings(host=host, authentication="required"), keys_are_there=False) == []
    issuer = Settings(host=host, oidc_issuer="https://id.example", oidc_audience="rundown")
    assert require_authentication(issuer, keys_are_there=False) == []


def test_zenoh_endpoints_beyond_loopback_need_certificates_and_rules() -> None:
    endpoints = ["tcp/127.0.0.1:7447", "tcp/[::1]:7447", "unixsock-stream/x", "tcp/0.0.0.0:7447", "tls/[::]:7448"]
    assert beyond(endpoints) == endpoints[3:]
    with pytest.raises(Exposed, match="anybody could publish"):
        require_authentication(Settings(zenoh_listen=endpoints), keys_are_there=True)


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"oidc_issuer": "https://id.example"}, "oidc_audience"),
        ({"oidc_issuer": "http://id.example", "oidc_audience": "x"}, "must be https"),
        ({"oidc_client_id": "rundown"}, "public_url"),
        ({"oidc_jwks": "http://id.example/keys"}, "must be https"),
        ({"tls_certificate": "x.crt"}, "both, or neither"),
        ({"zenoh_tls_ca": "x.crt"}, "all three, or none"),
        ({"zenoh_access": "x.yaml"}, "zenoh_tls_ca"),
        ({"smtp_password_file": "/nowhere/password"}, "cannot be read"),
    ],
)
def test_settings_that_would_be_open_are_refused(wrong: dict[str, Any], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        Settings(**wrong)


def test_a_secret_comes_from_a_file_that_others_cannot_read(tmp_path: Path) -> None:
    file = tmp_path / "password"
    file.write_text("s3cret-of-the-mail-server\n")
    file.chmod(0o604)
    with pytest.raises(ValueError, match="chmod 640 or 600") as refused:
        Settings(smtp_password_file=str(file))
    assert "s3cret" not in str(refused.value)
    file.chmod(0o600)
    settings = Settings(smtp_password_file=str(file))
    assert settings.smtp_password.get_secret_value() == "s3cret-of-the-mail-server"
    assert "s3cret" not in repr(settings)


def test_the_command_refuses_and_says_what_to_do(tmp_path: Path) -> None:
    database = sqlite_url(tmp_path / "rundown.db")
    refused = rundown("serve", "--host", "0.0.0.0", "--port", "0", "--database", database)
    assert refused.returncode == 1
    assert "rundown key create" in refused.stderr
    assert "--allow-no-authentication" in refused.stderr
    once = rundown("serve", "--host", "0.0.0.0", "--port", "0", "--database", database, "--allow-no-authentication")
    assert once.returncode == 1


WRONG = "postgres://rundown:s3cret@db/x"


@pytest.mark.parametrize(
    ("url", "command"),
    [
        (WRONG, ("serve",)),
        ("mysql://u:s3cret@db/x", ("serve",)),
        ("postgresql//u:s3cret@db/x", ("serve",)),
        (WRONG, ("key", "list")),
        (WRONG, ("export", "pump-7", "x")),
        (WRONG, ("router",)),
        (WRONG, ("doctor",)),
    ],
)
def test_no_command_says_the_password_of_a_database_that_is_wrong(tmp_path: Path, url: str, command: tuple[str, ...]) -> None:
    file = tmp_path / "url"
    file.write_text(url)
    file.chmod(0o600)
    told = rundown(*command, RUNDOWN_DATABASE_FILE=str(file), RUNDOWN_ROLE="api", RUNDOWN_ZENOH_LISTEN="[]")
    assert told.returncode == 1
    assert "Traceback" not in told.stderr
    assert "PostgreSQL database" in told.stderr or "cannot be used" in told.stderr, told.stderr
    assert "s3cret" not in told.stderr + told.stdout


@pytest.mark.parametrize("command", [("key", "list"), ("audit", "verify"), ("export", "pump-7", "x")])
def test_a_store_that_is_not_there_is_not_made_by_a_question(tmp_path: Path, command: tuple[str, ...]) -> None:
    file = tmp_path / "elsewhere.db"
    told = rundown(*command, "--database", sqlite_url(file))
    assert (told.returncode, told.stdout) == (1, "")
    assert f"there is no database file {file}" in told.stderr
    assert not file.exists()


def test_a_service_over_tls_with_secrets_logs_none_of_them(tmp_path: Path) -> None:
    """Started with a password, a client's secret, a key in a URL and one in a header; nothing of it is in the log."""
    script = ROOT / "deploy" / "certificates.sh"
    for names in (("authority",), ("service", "127.0.0.1")):
        subprocess.run([script, tmp_path, *names], check=True, capture_output=True, timeout=30)
    (tmp_path / "password").write_text("s3cret-mail\n")
    (tmp_path / "password").chmod(0o600)
    secrets = {"RUNDOWN_OIDC_CLIENT_SECRET": "s3cret-client", "RUNDOWN_SMTP_PASSWORD_FILE": str(tmp_path / "password")}
    service = Service(
        tmp_path,
        **secrets,
        RUNDOWN_LOG_LEVEL="DEBUG",
        RUNDOWN_TLS_CERTIFICATE=str(tmp_path / "service.crt"),
        RUNDOWN_TLS_KEY=str(tmp_path / "service.key"),
        RUNDOWN_SMTP_HOST="127.0.0.1",
        RUNDOWN_SMTP_PORT=str(free_port()),
        RUNDOWN_OIDC_ISSUER="https://127.0.0.1:1/issuer",
        RUNDOWN_OIDC_AUDIENCE="rundown",
        RUNDOWN_OIDC_CLIENT_ID="rundown",
        RUNDOWN_PUBLIC_URL="https://rundown.example",
    )
    key = rundown("key", "create", "anna", "--role", "admin", "--database", sqlite_url(tmp_path / "rundown.db")).stdout.strip()
    trusted = ssl.create_default_context(cafile=str(tmp_path / "authority.crt"))
    url = f"https://127.0.0.1:{service.port}"
    with service.started() as started, httpx.Client(base_url=url, verify=trusted, trust_env=False, timeout=20.0) as client:

        def ready() -> bool:
            assert started.poll() is None, service.log.read_text()
            try:
                return client.get("/api/v1/ready").status_code == 200
            except httpx.TransportError:
                return False

        until(ready, within_s=30, what="the service is ready")
        given = {"Authorization": f"Bearer {key}"}
        me = client.get("/api/v1/me", headers=given)
        assert (me.json()["name"], me.headers["strict-transport-security"]) == ("anna", "max-age=31536000")
        assert client.get("/api/v1/me").status_code == 401
        figures = client.get("/metrics", headers=given).text
        assert 390 < float(re.findall(r"^rundown_certificate_days_left (.*)$", figures, re.MULTILINE)[0]) <= 397
        assert client.get("/api/v1/me", headers={"Authorization": "Bearer eyJ.s3cret-token.x"}).status_code == 401
        assert client.get(f"/api/v1/machines?key={key}").status_code == 401
        login = client.post("/login", data={"key": key})
        assert login.headers["set-cookie"].startswith("__Host-rundown_session=")
        cookie = login.headers["set-cookie"].split("=")[1].split(";")[0]
        said = {"kind": "email", "name": "shift", "target": "anna@plant.example"}
        made = client.post("/api/v1/subscriptions", json=said, headers=given)
        assert made.status_code == 201, made.text
        client.post(f"/api/v1/subscriptions/{made.json()['id']}/test", headers=given)
        with pytest.raises(httpx.TransportError):
            httpx.get(f"http://127.0.0.1:{service.port}/", timeout=5.0)
    log = service.log.read_text()
    assert f"ready: {url}/" in log
    for secret in ("s3cret", key, key.split("_", 2)[2], cookie, (tmp_path / "service.key").read_text().split("\n")[1]):
        assert secret not in log
    (tmp_path / "service.key").chmod(0o644)
    with service.started() as refused:
        assert refused.wait(30) == 1
    assert "chmod 640 or 600" in service.log.read_text()
