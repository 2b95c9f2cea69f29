"""`rundown doctor` against a real service, and against what is wrong with one."""

import datetime
import itertools
import shutil
import subprocess
from collections.abc import Callable, Iterable
from contextlib import closing
from pathlib import Path

import pytest
from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec

from service.configuration.settings import Settings
from service.doctor.checks import CheckResult, examine
from storage.backup.backup import back_up
from storage.backup.backup_file import description_path
from storage.database.engine import Database
from storage.machines import machines
from tests.conftest import Stores
from tests.databases import Databases
from tests.end_to_end.processes import ROOT, START_TIMEOUT_S, Service, rundown, until
from tests.plant import document, machine, sqlite_url
from tests.ports import free_port


def settings(service: Service, **changes: object) -> Settings:
    """Return settings of a running service."""
    listen = [service.endpoint]
    return Settings.model_validate({"database": service.database, "port": service.port, "zenoh_listen": listen} | changes)


def found(settings: Settings) -> dict[str, tuple[str, str]]:
    """Level and words by what was looked at; of several findings about one thing, the worst."""
    return worst_of(examine(settings))


def found_without_the_service(settings: Settings) -> dict[str, tuple[str, str]]:
    """The same of what is looked at before the service is asked: nobody waits for one that is not there."""
    return worst_of(itertools.takewhile(lambda one: one.what != "API", examine(settings)))


def worst_of(findings: Iterable[CheckResult]) -> dict[str, tuple[str, str]]:
    """Level and words by what was looked at."""
    order = ["ok", "warning", "wrong"]
    worst: dict[str, tuple[str, str]] = {}
    for one in findings:
        if one.what not in worst or order.index(one.level) > order.index(worst[one.what][0]):
            worst[one.what] = one.level, one.words
    return worst


@pytest.mark.long
def test_a_service_that_works_is_found_to_work_down_to_its_ingest(tmp_path: Path, databases: Databases) -> None:
    service = Service(tmp_path, database=databases.new(tmp_path / "rundown.db"))
    with service.running():
        before = found(settings(service))
        assert "wrong" not in {level for level, _ in before.values()}, before
        assert before["machines"][0] == "warning"
        assert service.client.post("/machines", json=document()).status_code == 201
        told = found(settings(service))
        assert "wrong" not in {level for level, _ in told.values()}, told
        assert {told[name][0] for name in ("API", "schema", "zenoh", "way to the store", "machines")} == {"ok"}
        assert "how far" in told["way to the store"][1]
        elsewhere = found(settings(service, zenoh_listen=[f"tcp/127.0.0.1:{free_port()}"]))
        assert elsewhere["zenoh"][0] == "wrong"
    told = found(settings(service))
    assert told["API"][0] == told["zenoh"][0] == "wrong"
    assert told["database"][0] != "wrong"
    service.client.close()


def test_what_is_missing_or_over_is_named(tmp_path: Path) -> None:
    certificate, key = _expired(tmp_path)
    told = found(
        Settings(
            database=f"sqlite:///{tmp_path / 'nowhere.db'}",
            port=free_port(),
            zenoh_listen=[f"tcp/127.0.0.1:{free_port()}"],
            tls_certificate=str(certificate),
            tls_key=str(key),
            smtp_host="127.0.0.1",
            smtp_port=free_port(),
            dask_scheduler=f"tcp://127.0.0.1:{free_port()}",
            oidc_issuer=f"http://127.0.0.1:{free_port()}",
            oidc_audience="rundown",
        )
    )
    for what in ("database", "API certificate", "mail server", "Dask scheduler", "issuer", "API", "zenoh"):
        assert told[what][0] == "wrong", (what, told)
    assert "expired on 2020-02-01" in told["API certificate"][1]
    assert not (tmp_path / "nowhere.db").exists()


def test_a_store_that_others_may_read_is_named(tmp_path: Path) -> None:
    path = tmp_path / "rundown.db"
    chosen = Settings(database=sqlite_url(path), port=free_port(), zenoh_listen=[f"tcp/127.0.0.1:{free_port()}"])
    with closing(Database(chosen.database)):
        assert "database file" not in found_without_the_service(chosen)
        for name in (path, tmp_path / "rundown.db-wal"):
            name.chmod(0o644)
        assert found_without_the_service(chosen)["database file"] == (
            "warning",
            f"others may read it, and secrets in it: chmod 600 {path} {path}-wal",
        )
    path.chmod(0o640)
    assert "database file" not in found_without_the_service(chosen)


def test_the_log_of_a_service_that_was_killed_is_read_and_left_as_it_is(tmp_path: Path) -> None:
    """Opening it otherwise plays it back and deletes it."""
    path, log = tmp_path / "killed" / "rundown.db", tmp_path / "killed" / "rundown.db-wal"
    path.parent.mkdir()
    with closing(Database(sqlite_url(tmp_path / "rundown.db"))) as database:
        with database.transaction() as session:
            machines.create(session, machine())
        for end in ("", "-wal"):
            shutil.copy(tmp_path / f"rundown.db{end}", path.with_name(f"rundown.db{end}"))
    before = path.read_bytes(), log.read_bytes()
    chosen = Settings(database=sqlite_url(path), port=free_port(), zenoh_listen=[f"tcp/127.0.0.1:{free_port()}"])
    told = found_without_the_service(chosen)
    assert {told[what][0] for what in ("schema", "pages", "room")} == {"ok"}
    assert (path.read_bytes(), log.read_bytes()) == before


def test_a_store_that_nobody_uses_gets_no_log(tmp_path: Path) -> None:
    path = tmp_path / "rundown.db"
    Database(sqlite_url(path)).close()
    before = path.read_bytes()
    chosen = Settings(database=sqlite_url(path), port=free_port(), zenoh_listen=[f"tcp/127.0.0.1:{free_port()}"])
    assert found_without_the_service(chosen)["pages"] == ("ok", f"{path} is whole")
    assert [one.name for one in tmp_path.iterdir()] == ["rundown.db"]
    assert path.read_bytes() == before


def test_damaged_pages_are_named(tmp_path: Path) -> None:
    path = tmp_path / "rundown.db"
    Database(sqlite_url(path)).close()
    with path.open("r+b") as file:
        file.seek(path.stat().st_size // 2)
        file.write(bytes(16_384))
    chosen = Settings(database=sqlite_url(path), port=free_port(), zenoh_listen=[f"tcp/127.0.0.1:{free_port()}"])
    level, words = found_without_the_service(chosen)["pages"]
    assert level == "wrong"
    assert f"{path} is damaged: " in words
    with path.open("r+b") as file:
        file.write(b"no database" * 10)
    assert found_without_the_service(chosen)["database"][0] == "wrong"


def test_the_command_ends_with_status_1_where_something_is_wrong(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RUNDOWN_DATABASE", f"sqlite:///{tmp_path / 'nowhere.db'}")
    monkeypatch.setenv("RUNDOWN_PORT", str(free_port()))
    monkeypatch.setenv("RUNDOWN_ZENOH_LISTEN", f'["tcp/127.0.0.1:{free_port()}"]')
    told = rundown("doctor")
    assert told.returncode == 1
    assert "wrong    database: the file" in told.stdout
    assert "docs/runbook.md" in told.stderr


def _expired(folder: Path) -> tuple[Path, Path]:
    key = ec.generate_private_key(ec.SECP256R1())
    name = x509.Name([x509.NameAttribute(x509.NameOID.COMMON_NAME, "old")])
    day = datetime.datetime(2020, 1, 1, tzinfo=datetime.UTC)
    made = x509.CertificateBuilder(name, name, key.public_key(), 1, day, day + datetime.timedelta(days=31))
    certificate, secret = folder / "old.crt", folder / "old.key"
    certificate.write_bytes(made.sign(key, hashes.SHA256()).public_bytes(serialization.Encoding.PEM))
    pem = serialization.PrivateFormat.PKCS8
    secret.write_bytes(key.private_bytes(serialization.Encoding.PEM, pem, serialization.NoEncryption()))
    secret.chmod(0o600)
    return certificate, secret


def _of_the_script(folder: Path) -> tuple[Path, Path]:
    """A certificate and its key, as deploy/certificates.sh makes them: the authority stands in another file."""
    script = ROOT / "deploy" / "certificates.sh"
    for names in (("authority",), ("service", "127.0.0.1")):
        subprocess.run([script, folder, *names], check=True, capture_output=True, timeout=30)
    return folder / "service.crt", folder / "service.key"


def _of_a_chain(folder: Path) -> tuple[Path, Path]:
    """A certificate with the one of the authority between in one file, as public authorities give them, without the root."""
    named = {
        who: x509.Name([x509.NameAttribute(x509.NameOID.COMMON_NAME, who)]) for who in ("root", "between", "rundown.example")
    }
    keys = {who: ec.generate_private_key(ec.SECP256R1()) for who in named}
    made = []
    for number, (who, by) in enumerate((("rundown.example", "between"), ("between", "root"))):
        day = datetime.datetime.now(datetime.UTC) - datetime.timedelta(days=1)
        builder = x509.CertificateBuilder(
            named[by], named[who], keys[who].public_key(), number + 1, day, day + datetime.timedelta(days=100)
        ).add_extension(x509.BasicConstraints(ca=who == "between", path_length=None), critical=True)
        made.append(builder.sign(keys[by], hashes.SHA256()).public_bytes(serialization.Encoding.PEM))
    certificate, secret = folder / "chain.crt", folder / "chain.key"
    certificate.write_bytes(b"".join(made))
    pem = serialization.PrivateFormat.PKCS8
    secret.write_bytes(keys["rundown.example"].private_bytes(serialization.Encoding.PEM, pem, serialization.NoEncryption()))
    secret.chmod(0o600)
    return certificate, secret


@pytest.mark.parametrize("made", [_of_the_script, _of_a_chain])
def test_a_service_over_tls_is_found_to_answer(tmp_path: Path, made: Callable[[Path], tuple[Path, Path]]) -> None:
    certificate, key = made(tmp_path)
    service = Service(tmp_path, RUNDOWN_TLS_CERTIFICATE=str(certificate), RUNDOWN_TLS_KEY=str(key))
    with service.started() as started:

        def ready() -> bool:
            assert started.poll() is None, service.log.read_text()
            return "ready: https" in service.log.read_text()

        until(ready, within_s=START_TIMEOUT_S, what="the service is ready")
        chosen = settings(service, tls_certificate=str(certificate), tls_key=str(key))
        until(lambda: "does not answer: [Errno" not in found(chosen)["API"][1], within_s=20, what="it listens")
        told = found(chosen)
        assert told["API"] == ("ok", f"https://127.0.0.1:{service.port} answers")
        others, secret = _expired(tmp_path)
        strange = found(settings(service, tls_certificate=str(others), tls_key=str(secret)))
        assert strange["API"][0] == "wrong"
    service.client.close()


def test_the_newest_backup_is_looked_at(stores: Stores, tmp_path: Path) -> None:
    database = stores.databases("sqlite").copy(stores.empty("sqlite"), tmp_path / "rundown.db")
    folder = tmp_path / "backups"
    chosen = Settings(database=database, port=free_port(), zenoh_listen=[f"tcp/127.0.0.1:{free_port()}"], backups=str(folder))
    assert found_without_the_service(chosen)["backups"] == (
        "wrong",
        f"{folder} cannot be read: No such file or directory",
    )
    folder.mkdir()
    level, words = found_without_the_service(chosen)["backups"]
    assert (level, words) == ("wrong", f"there is none in {folder}: rundown backup FILE makes one")
    made = back_up(database, folder / "nightly")
    level, words = found_without_the_service(chosen)["backups"]
    assert (level, words[:-4]) == ("ok", f"the newest in {folder} is of {made.made_at[:16].replace('T', ' ')}")
    description = description_path(folder / "nightly")
    description.write_text(description.read_text().replace(made.made_at, "2026-01-02T03:04:05Z"))
    assert found_without_the_service(chosen)["backups"] == ("warning", f"the newest in {folder} is of 2026-01-02 03:04 UTC")


def test_room_that_nothing_is_known_of_is_warned_of(stores: Stores, tmp_path: Path) -> None:
    """The disk of a server of databases is not seen: without a budget there is nothing to be near the end of."""
    database = stores.databases("postgresql").copy(stores.empty("postgresql"), tmp_path / "unused")
    chosen = Settings(database=database, port=free_port(), zenoh_listen=[f"tcp/127.0.0.1:{free_port()}"])
    level, words = found_without_the_service(chosen)["room"]
    assert level == "warning"
    assert "disk_budget_gb is not set" in words
    level, words = found_without_the_service(chosen.model_copy(update={"disk_budget_gb": 50.0}))["room"]
    assert level == "ok"
    assert "0 % of the room are used" in words
