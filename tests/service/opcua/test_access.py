"""Tests who may connect, and what a client sees and may do: keys, roles, plants, certificates."""

import time
from datetime import timedelta
from pathlib import Path
from typing import Any

import pytest

from service.security import api_keys
from service.security.role import Role
from storage.database.engine import Database
from storage.operation import audit
from tests.plant import KEY, wait_until
from tests.service.opcua.second_stack import ConnectionRefused, SecondStack, second_stack
from tests.service.opcua.served_plants import ServedPlants, add_key
from tests.service.opcua.test_machines_and_alarms import ALERT, MACHINE, STIFFNESS
from tests.service.security.two_plants import HIDDEN, HIDDEN_PLANT

HIDDEN_MACHINE = f"ns=2;s={HIDDEN_PLANT}/{HIDDEN}"


def refused(served: ServedPlants, folder: Path, **how: Any) -> str:
    """Return what a client says that is not taken."""
    with pytest.raises(ConnectionRefused) as error, second_stack(served.endpoint, folder, **how):
        pass
    return str(error.value)


def test_a_client_sees_nothing_of_another_plant(operator: SecondStack) -> None:
    nodes = [HIDDEN_MACHINE, f"{HIDDEN_MACHINE}/Parameters/coupling.C1.kxx", f"ns=2;s={HIDDEN_PLANT}"]
    for attribute in ("Value", "DisplayName", "NodeId"):
        assert {one["status"] for one in operator.ask("read", nodes=nodes, attribute=attribute)} == {"BadNodeIdUnknown"}
    never = operator.ask("read", nodes=["ns=2;s=never/was"], attribute="DisplayName")[0]
    assert never["status"] == "BadNodeIdUnknown", "what is hidden answers as what is not there"
    assert operator.ask("browse", node=HIDDEN_MACHINE) == operator.ask("browse", node="ns=2;s=never/was")
    assert operator.ask("find", node="ns=2;i=1", path=f"/2:{HIDDEN_PLANT}")["nodes"] == []
    assert set(operator.ask("watch", nodes=nodes)) == {"BadNodeIdUnknown"}
    history = operator.ask("history", node=nodes[1], begin="2020-01-01", end="2030-01-01")
    assert (history["status"], history["values"]) == ("BadNodeIdUnknown", [])
    hidden_alert = f"{HIDDEN_MACHINE}/Alerts/misalignment coupling.C1"
    assert operator.ask("call", object=hidden_alert, method="i=18199") == "BadNodeIdUnknown"


def test_who_sees_all_plants_sees_both(served: ServedPlants, folder: Path) -> None:
    with second_stack(served.endpoint, folder, **served.client("everywhere")) as client:
        assert sorted(client.ask("browse", node="ns=2;i=1")["names"]) == [HIDDEN_PLANT, KEY.plant]
        assert client.ask("read", nodes=[f"{HIDDEN_MACHINE}/Name"])[0]["value"] == "Quince nine"


def test_a_viewer_reads_and_changes_nothing(served: ServedPlants, store: Database, folder: Path) -> None:
    with second_stack(served.endpoint, folder, **served.client("viewer")) as client:
        (event,) = client.ask("read", nodes=[f"{ALERT}/EventId"])
        for _ in range(3):
            found = client.ask("acknowledge", condition=ALERT, event=event["value"], comment="")
            assert found == "BadUserAccessDenied"
        assert client.ask("write", node=STIFFNESS, value=1.0) == "BadNotWritable"
    with store.reading() as session:
        entries = [one for one in audit.newest(session, limit=20) if one.who.startswith("viewer")]
    assert [(one.operation, one.outcome) for one in entries] == [("acknowledge_alert", "refused")], "once a minute"


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"password": "rundown_00000000_guessed"}, "BadUserAccessDenied"),
        ({"user": "somebody-else"}, "BadUserAccessDenied"),
        ({"user": "", "password": ""}, "BadUserAccessDenied"),
    ],
)
def test_a_wrong_key_or_name_or_none_is_refused(
    served: ServedPlants, folder: Path, change: dict[str, str], words: str
) -> None:
    assert words in refused(served, folder, **(served.client("operator") | change))


def test_a_source_has_no_business_here(served: ServedPlants, folder: Path) -> None:
    assert "BadUserAccessDenied" in refused(served, folder, **served.client("probe"))


@pytest.mark.parametrize(
    ("certificate", "words"),
    [
        ({"ends": timedelta(days=-1)}, "BadCertificateTimeInvalid"),
        ({"foreign": True}, "BadCertificateUntrusted"),
    ],
)
def test_an_expired_or_foreign_certificate_is_refused(
    served: ServedPlants, folder: Path, certificate: dict[str, Any], words: str
) -> None:
    found = refused(served, folder, **served.client("operator", **certificate))
    assert words in found or "certificate" in found.lower()


@pytest.mark.parametrize("policy", ["Aes128_Sha256_RsaOaep", "Aes256_Sha256_RsaPss"])
def test_each_policy_that_encrypts_is_taken(served: ServedPlants, folder: Path, policy: str) -> None:
    with second_stack(served.endpoint, folder, **(served.client("operator") | {"security": policy})) as client:
        assert client.ask("read", nodes=[f"{MACHINE}/Name"])[0]["value"] == "Pump 7"


def test_without_security_nobody_gets_in(served: ServedPlants, folder: Path) -> None:
    assert refused(served, folder, **(served.client("operator") | {"security": "none"}))


def test_a_revoked_key_ends_its_session(served: ServedPlants, store: Database, folder: Path) -> None:
    prefix, text = add_key(store, "passing", Role.OPERATOR, [KEY.plant])
    served.keys["passing"] = text
    with second_stack(served.endpoint, folder, **served.client("passing")) as client:
        assert client.ask("read", nodes=[f"{MACHINE}/Name"])[0]["value"] == "Pump 7"
        with store.transaction() as session:
            api_keys.revoke(session, prefix)

        def ended() -> bool:
            client.say({"number": 0, "request": "read", "nodes": [f"{MACHINE}/Name"]})
            found = client.answer()
            return "failed" in found

        wait_until(ended, seconds=20.0)
    assert "BadUserAccessDenied" in refused(served, folder, **served.client("passing"))


@pytest.mark.long
def test_rubbish_among_the_trusted_is_said_and_ends_nobodys_session(
    served: ServedPlants, operator: SecondStack, folder: Path
) -> None:
    rubbish = served.authority.trusted / "rubbish.crl"
    rubbish.write_text("-----BEGIN RUBBISH-----")
    try:
        wait_until(lambda: "rubbish.crl cannot be read" in str(served.serving.trouble), seconds=20.0)
        assert operator.ask("read", nodes=[f"{MACHINE}/Name"])[0]["value"] == "Pump 7"
        with second_stack(served.endpoint, folder, **served.client("operator")) as client:
            assert client.ask("browse", node="ns=2;i=1")["status"] == "Good"
    finally:
        rubbish.unlink()
    wait_until(lambda: served.serving.trouble is None, seconds=20.0)


@pytest.mark.long
def test_a_revoked_certificate_is_refused(served: ServedPlants, folder: Path) -> None:
    how = served.client("everywhere", key_size=3072)
    with second_stack(served.endpoint, folder, **how) as client:
        assert client.ask("browse", node="ns=2;i=1")["status"] == "Good"
    served.authority.revoke(Path(how["certificate"]))
    time.sleep(5.5)  # until the folder is read again
    assert refused(served, folder, **how)
