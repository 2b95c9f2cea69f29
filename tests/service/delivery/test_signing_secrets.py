"""Secrets of webhooks are nowhere in the database as they are; references lead to nothing but secrets of webhooks."""

import base64
import os
import stat
from contextlib import closing
from pathlib import Path

import pytest
from sqlalchemy.orm import Session

from service.configuration.settings import Settings, SettingsWrong, settings_of
from service.delivery import secret_upkeep, signing_secrets
from service.delivery.secret_upkeep import SecretReport
from service.delivery.signing import new_secret
from service.delivery.signing_secrets import SecretUnusable, SigningSecrets, key_file
from service.secrets.sealing import Sealing
from storage.alerts import deliveries
from storage.database.engine import Database
from storage.operation import idempotency
from storage.operation.idempotency import StoredResponse
from storage.tables.alerting import SubscriptionRow
from tests.api_in_process import PREFIX, Api, problem
from tests.conftest import Stores

TARGET = "https://historian.example/hook"
WANTED = {"kind": "webhook", "name": "a", "target": TARGET}
FIRST, SECOND = bytes(32), bytes(range(32))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return where files with secrets are."""
    found = tmp_path / "secrets"
    found.mkdir()
    return found


def private(file: Path, text: str) -> None:
    file.write_text(text)
    file.chmod(0o600)


def key_text(*keys: bytes) -> str:
    return "".join(base64.b64encode(key).decode() + "\n" for key in keys)


def stored(database: Database, number: int) -> str:
    with database.reading() as session:
        return deliveries.get(session, number).secret or ""


def told(secret: str) -> StoredResponse:
    """An answer of some pages that tells a secret, as an older release kept it."""
    return StoredResponse(201, [], b'{"secret":"' + secret.encode() + b'"}' + b" " * 9000)


def keep_deleted(session: Session) -> None:
    """Let what is deleted stay in its pages, which not every SQLite does by itself."""
    session.connection().exec_driver_sql("PRAGMA secure_delete = OFF")


def held(folder: Path, *texts: str) -> list[str]:
    """Return which files of a folder hold one of these texts."""
    return [one.name for one in folder.iterdir() if one.is_file() and any(text.encode() in one.read_bytes() for text in texts)]


def test_a_secret_that_is_shown_once_is_in_no_file_of_the_store(stores: Stores, tmp_path: Path) -> None:
    """Nor in the answer that is kept for who asks again under the same key, who gets it all the same."""
    with closing(Database(stores.databases("sqlite").copy(stores.empty("sqlite"), tmp_path / "rundown.db"))) as database:
        api = Api(database)
        wanted = {"kind": "webhook", "name": "historian", "target": TARGET}
        once = {"Idempotency-Key": "abc"}
        first = api.ask("POST", PREFIX + "/subscriptions", json=wanted, headers=once)
        again = api.ask("POST", PREFIX + "/subscriptions", json=wanted, headers=once)
        assert (first.status_code, again.headers["Idempotency-Replayed"]) == (201, "true")
        assert first.json() == again.json()
        secret, number = first.json()["secret"], first.json()["id"]
        assert first.json()["secret_kept"] == "sealed"
        assert secret not in api.get("/subscriptions").text + api.get(f"/subscriptions/{number}").text
        assert held(tmp_path, secret, base64.b64decode(secret.removeprefix("whsec_")).hex()) == []
        assert held(tmp_path, "sealed:") != []
        lost = Api(database, secrets=SigningSecrets())
        told = problem(lost.ask("POST", PREFIX + "/subscriptions", json=wanted, headers=once), 409)
        assert "cannot be opened" in told["detail"]


def test_without_a_key_a_webhook_is_refused_with_words_about_what_to_set(plant: Database) -> None:
    api = Api(plant, secrets=SigningSecrets())
    said = {"kind": "webhook", "name": "historian", "target": TARGET}
    told = problem(api.ask("POST", PREFIX + "/subscriptions", json=said), 409)
    assert "RUNDOWN_SEALING_KEY_FILE" in told["detail"]
    assert "secret_env" in told["detail"]
    assert api.value("/subscriptions") == []
    assert api("POST", "/subscriptions", 201, json={"kind": "zenoh", "name": "network"})["secret"] is None


@pytest.mark.parametrize(
    "name",
    ["../key", "/etc/passwd", "a/b", ".hidden", "", "out", "pipe", "missing", "folder", "url", "short", "open", "big", "a\n"],
)
def test_no_file_but_a_secret_of_the_folder_can_be_referred_to(folder: Path, tmp_path: Path, name: str) -> None:
    """By a name that leads elsewhere, by a link, by a pipe that nobody writes to; and nothing is said of what is in it."""
    secret = new_secret()
    private(tmp_path / "key", secret)
    (folder / "out").symlink_to(tmp_path / "key")
    (folder / "folder").mkdir()
    os.mkfifo(folder / "pipe", 0o600)
    private(folder / "url", "postgresql://rundown:s3cret@db/rundown")
    private(folder / "short", "whsec_c2VjcmV0")
    private(folder / "big", "whsec_" + "A" * 5000)
    private(folder / "open", secret)
    (folder / "open").chmod(0o644)
    with pytest.raises(SecretUnusable) as refused:
        SigningSecrets(None, folder).referred(file=name, variable=None)
    assert not any(part in str(refused.value) for part in ("s3cret", secret, str(tmp_path / "key"), "AAAA"))


@pytest.mark.parametrize("name", ["RUNDOWN_DATABASE", "PATH", "RUNDOWN_WEBHOOK_SECRET_", "RUNDOWN_WEBHOOK_SECRET_URL", ""])
def test_no_variable_but_a_secret_of_the_prefix_can_be_referred_to(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    monkeypatch.setenv("RUNDOWN_DATABASE", new_secret())
    monkeypatch.setenv("RUNDOWN_WEBHOOK_SECRET_URL", "postgresql://rundown:s3cret@db/rundown")
    with pytest.raises(SecretUnusable) as refused:
        SigningSecrets().referred(file=None, variable=name)
    assert "s3cret" not in str(refused.value)


def test_references_are_followed_at_each_delivery(
    plant: Database, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A file that is replaced is a secret that is changed; a link within the folder is how containers mount one."""
    first, second = new_secret(), new_secret()
    (folder / "..data").mkdir()
    private(folder / "..data" / "historian", first + "\n")
    (folder / "historian").symlink_to(Path("..data") / "historian")
    secrets = SigningSecrets(None, folder)
    monkeypatch.setenv("RUNDOWN_WEBHOOK_SECRET_SCADA", second)
    api = Api(plant, secrets=secrets)
    said = {"kind": "webhook", "target": TARGET}
    made = api("POST", "/subscriptions", 201, json=said | {"name": "a", "secret_file": "historian"})
    assert (made["secret"], made["secret_kept"], made["trouble"]) == (None, "file historian", None)
    other = api("POST", "/subscriptions", 201, json=said | {"name": "b", "secret_env": "RUNDOWN_WEBHOOK_SECRET_SCADA"})
    with plant.reading() as session:
        assert secrets.reveal(deliveries.get(session, made["id"])) == first
        assert secrets.reveal(deliveries.get(session, other["id"])) == second
        private(folder / "..data" / "historian", second)
        assert secrets.reveal(deliveries.get(session, made["id"])) == second
    assert held(tmp_path, first, second) == []
    (folder / "historian").unlink()
    assert "historian" in api.value(f"/subscriptions/{made['id']}")["trouble"]
    problem(api.ask("POST", PREFIX + "/subscriptions", json=said | {"name": "c", "secret_file": "historian"}), 409)
    both = {"secret_env": "RUNDOWN_WEBHOOK_SECRET_A", "secret_file": "a"}
    for wrong in ({"secret_file": "../x"}, {"secret_env": "PATH"}, both):
        problem(api.ask("POST", PREFIX + "/subscriptions", json=said | {"name": "d"} | wrong), 422)


def test_plain_secrets_of_an_older_release_are_sealed_and_leave_no_copy(stores: Stores, tmp_path: Path) -> None:
    """Neither in rows, nor in kept answers, nor in free pages, nor in the log; a row that another key sealed stays."""
    url = stores.databases("sqlite").copy(stores.empty("sqlite"), tmp_path / "rundown.db")
    plain = [new_secret() for _ in range(40)]
    with closing(Database(url)) as database:
        with database.transaction() as session:
            keep_deleted(session)
            for number, secret in enumerate(plain):
                deliveries.subscribe(session, kind="webhook", name=f"{number}", target=TARGET, secret=secret)
                idempotency.claim(session, f"key {number}", "")
                idempotency.store_response(session, f"key {number}", told(secret))
            idempotency.claim(session, "other", "")
            idempotency.store_response(session, "other", StoredResponse(201, [], b"{}"))
        with database.transaction() as session:  # these leave their pages behind
            keep_deleted(session)
            for number in range(20):
                idempotency.release(session, f"key {number}")
            for row in deliveries.list_subscriptions_with_secret(session):
                row.reason = "x" * 300
        secrets = secret_upkeep.open_secrets(database, Settings(database=url))
        assert held(tmp_path, *plain) == []
        with database.reading() as session:
            rows = deliveries.list_subscriptions_with_secret(session)
            assert [secrets.reveal(row) for row in rows] == plain
            assert SecretReport.at(rows, secrets) == SecretReport([], [])
        with database.transaction() as session:
            assert idempotency.claim(session, "other", "") is not None
    key = tmp_path / "rundown.db.key"
    assert stat.S_IMODE(key.stat().st_mode) == 0o600
    text = key.read_text()
    with closing(Database(url)) as database:
        assert secret_upkeep.open_secrets(database, Settings(database=url)).trouble(rows[0]) is None
    assert key.read_text() == text


def test_a_lost_key_is_stated_and_no_other_one_is_made_in_its_place(stores: Stores, tmp_path: Path) -> None:
    url = stores.databases("sqlite").copy(stores.empty("sqlite"), tmp_path / "rundown.db")
    with closing(Database(url)) as database:
        secrets = secret_upkeep.open_secrets(database, Settings(database=url))
        made = Api(database, secrets=secrets)("POST", "/subscriptions", 201, json=WANTED)
        before = stored(database, made["id"])
        key = tmp_path / "rundown.db.key"
        for text in (None, "rubbish\n", key_text(SECOND)):
            key.unlink(missing_ok=True)
            if text is not None:
                private(key, text)
            without = secret_upkeep.open_secrets(database, Settings(database=url))
            told = Api(database, secrets=without).value(f"/subscriptions/{made['id']}")
            assert "put back" in told["trouble"]
            assert stored(database, made["id"]) == before
        key.unlink()
        secret_upkeep.open_secrets(database, Settings(database=url))
        assert not key.exists()


def test_the_first_of_several_keys_seals_again_what_the_others_sealed(plant: Database, tmp_path: Path) -> None:
    file = tmp_path / "keys"
    private(file, key_text(FIRST))
    settings = Settings(sealing_key_file=str(file))
    api = Api(plant, secrets=secret_upkeep.open_secrets(plant, settings))
    made = api("POST", "/subscriptions", 201, json=WANTED)
    private(file, key_text(SECOND, FIRST))
    secret_upkeep.open_secrets(plant, settings)
    private(file, key_text(SECOND))
    now = secret_upkeep.open_secrets(plant, settings)
    with plant.reading() as session:
        row = deliveries.get(session, made["id"])
        assert now.reveal(row) == made["secret"]
        assert SigningSecrets(Sealing([FIRST])).trouble(row) is not None


@pytest.mark.parametrize("text", ["", "rubbish", "YWJj\n", key_text(FIRST) + "YWJj", "ü"])
def test_a_file_that_holds_no_keys_is_refused_as_a_setting(tmp_path: Path, text: str) -> None:
    private(tmp_path / "keys", text)
    with pytest.raises(SettingsWrong, match="openssl rand") as refused:
        settings_of(sealing_key_file=str(tmp_path / "keys"))
    assert not text.strip() or text.strip() not in str(refused.value)


def test_on_a_server_of_databases_a_key_must_be_set() -> None:
    assert key_file(Settings(database="postgresql+psycopg://db/rundown")) is None
    assert key_file(Settings(database="sqlite://")) is None


def test_without_a_key_what_an_older_release_left_plain_stays_in_use(plant: Database, monkeypatch: pytest.MonkeyPatch) -> None:
    """As on a server of databases at an upgrade, until a key is set."""
    monkeypatch.setattr(signing_secrets, "key_file", lambda _: None)
    with plant.transaction() as session:
        number = deliveries.subscribe(session, kind="webhook", name="old", target=TARGET, secret="whsec_c2VjcmV0").id
    secrets = secret_upkeep.open_secrets(plant, Settings())
    told = Api(plant, secrets=secrets).value(f"/subscriptions/{number}")
    assert (told["secret_kept"], told["trouble"], stored(plant, number)) == ("plain", None, "whsec_c2VjcmV0")


def test_a_plain_secret_still_signs_and_is_reported_where_there_is_no_key() -> None:
    row = SubscriptionRow(id=1, name="old", kind="webhook", target=TARGET, secret="whsec_c2VjcmV0", state="active")
    secrets = SigningSecrets()
    assert (secrets.reveal(row), secrets.renewed(row)) == ("whsec_c2VjcmV0", None)
    (words,) = SecretReport.at([row], secrets).plain
    assert "RUNDOWN_SEALING_KEY_FILE" in words
