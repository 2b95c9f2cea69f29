"""Two clients of another stack at once, changes by others as both hear them, and a server that starts again under them."""

import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from service.alerts import transitions
from service.alerts.transitions import AlertFinding, Person
from service.opcua.serving import OpcUaServing
from service.security.role import Role
from storage.alerts import alerts
from storage.clock import now
from storage.database.engine import Database
from storage.operation import audit
from tests.plant import KEY, SECOND, START, identification, store_identification, wait_until
from tests.service.opcua.cut_line import cut_line
from tests.service.opcua.second_stack import SecondStack, second_stack
from tests.service.opcua.served_plants import ServedPlants, add_key
from tests.service.opcua.test_machines_and_alarms import ALERT, MACHINE, STIFFNESS, read

SHELVING = f"{ALERT}/ShelvingState"
RESET, ENABLE, DISABLE = "i=18199", "i=9027", "i=9028"
TIMED_SHELVE, UNSHELVE, ONE_SHOT_SHELVE = "i=2949", "i=2947", "i=2948"


@pytest.fixture(scope="module")
def colleague(served: ServedPlants, tmp_path_factory: pytest.TempPathFactory) -> Iterator[SecondStack]:
    """A second client, of somebody who sees all plants."""
    with second_stack(served.endpoint, tmp_path_factory.mktemp("colleague"), **served.client("everywhere")) as client:
        yield client


def found(store: Database, served: ServedPlants, *, element: str) -> int:
    """Let something be found; the id of its alert."""
    with store.transaction() as session:
        finding = AlertFinding({}, served.harbour.identification_id, now(), latching=True)
        return transitions.raise_alert(session, KEY.machine, rule="looseness", element=element, finding=finding).id


def test_of_two_who_acknowledge_at_once_one_does(
    operator: SecondStack, colleague: SecondStack, served: ServedPlants, store: Database
) -> None:
    clients = (operator, colleague)
    for client in clients:
        assert client.ask("listen", node="i=2253") == "Good"
    event = read(operator, f"{ALERT}/EventId")["value"]
    for number, client in enumerate(clients):
        told = {"condition": ALERT, "event": event, "comment": f"client {number}"}
        client.say({"number": -1, "request": "acknowledge", **told})
    answers = sorted(str(client.answer()["answer"]) for client in clients)
    assert answers == ["BadConditionBranchAlreadyAcked", "Good"]
    for client in clients:
        wait_until(lambda: client.heard(lambda one: one["ConditionId"] == ALERT and one["AckedState.Id"]))  # noqa: B023
        assert len(client.events(lambda one: one["ConditionId"] == ALERT and one["AckedState.Id"])) == 1
    with store.reading() as session:
        kinds = [one.kind for one in alerts.history(session, served.harbour.alert_id)]
        entries = [one for one in audit.newest(session, limit=50) if one.operation == "acknowledge_alert"]
    assert kinds.count("acknowledged") == 1
    assert [one.outcome for one in entries].count("done") == 1


def test_what_others_do_is_heard_as_it_would_be_of_a_client(
    operator: SecondStack, colleague: SecondStack, served: ServedPlants, store: Database
) -> None:
    """Acknowledged, commented, shelved in both ways, unshelved, gone and reset on the page: each with whom and what."""
    number = found(store, served, element="bearing.B2")
    condition = f"{MACHINE}/Alerts/looseness bearing.B2"
    anna = Person("anna", "by the page")

    def change(what: str) -> None:
        with store.transaction() as session:
            row = alerts.get(session, number, to_change=True)
            if what == "clear":
                transitions.clear_alert(session, row)
            elif what in ("timed_shelve", "one_shot_shelve"):
                transitions.shelve(session, row, anna, until=now() + 3600 * SECOND, until_cleared=what == "one_shot_shelve")
            else:
                getattr(transitions, what)(session, row, anna)

    shelved = "ShelvingState.CurrentState"
    expected: list[tuple[str, dict[str, object]]] = [
        ("comment", {"Comment": "by the page", "ClientUserId": "anna", "AckedState.Id": False}),
        ("timed_shelve", {shelved: "Timed Shelved", "SuppressedOrShelved": True}),
        ("unshelve", {shelved: "Unshelved", "SuppressedOrShelved": False, "AckedState.Id": False}),
        ("one_shot_shelve", {shelved: "One Shot Shelved", "SuppressedOrShelved": True}),
        ("unshelve", {shelved: "Unshelved"}),
        ("acknowledge", {"AckedState.Id": True, "ActiveState.Id": True, "ClientUserId": "anna"}),
        ("clear", {"ActiveState.Id": False, "LatchedState.Id": True, "ConfirmedState.Id": False, "Retain": True}),
        ("reset", {"LatchedState.Id": False, "ConfirmedState.Id": True, "Retain": False, "ClientUserId": "anna"}),
    ]
    for client in (operator, colleague):
        wait_until(lambda: client.heard(lambda one: one["ConditionId"] == condition))  # noqa: B023
    for what, fields in expected:
        before = [len(client.events(lambda one: one["ConditionId"] == condition)) for client in (operator, colleague)]
        change(what)
        for client, many in zip((operator, colleague), before, strict=True):
            wait_until(lambda: len(client.events(lambda one: one["ConditionId"] == condition)) > many)  # noqa: B023
            last = client.events(lambda one: one["ConditionId"] == condition)[-1]
            assert {name: last[name] for name in fields} == fields, what


def test_a_refresh_of_one_item_tells_that_item_of_what_is_open(operator: SecondStack) -> None:
    operator.told.clear()
    assert operator.ask("refresh_item") == "Good"
    wait_until(lambda: operator.heard(lambda one: one["ConditionId"] == ALERT))
    assert operator.events(lambda one: one["ConditionId"] == ALERT)[-1]["AckedState.Id"]
    assert not operator.heard(lambda one: one["ConditionId"] == f"{MACHINE}/Alerts/looseness bearing.B2"), "it is closed"
    assert operator.ask("refresh_item", item=4_000_000) == "BadMonitoredItemIdInvalid"


@pytest.mark.parametrize("role", [Role.VIEWER, Role.ANALYST])
def test_who_may_not_is_refused_by_every_method(served: ServedPlants, store: Database, folder: Path, role: Role) -> None:
    name = f"only-{role.name.lower()}"
    served.keys[name] = add_key(store, name, role, [KEY.plant])[1]
    with store.reading() as session:
        before = alerts.last_event(session, served.harbour.alert_id).id
    with second_stack(served.endpoint, folder, **served.client(name)) as client:
        event = read(client, f"{ALERT}/EventId")["value"]
        answers = {
            "acknowledge": client.ask("acknowledge", condition=ALERT, event=event, comment="no"),
            "confirm": client.ask("confirm", condition=ALERT, event=event, comment="no"),
            "reset": client.ask("call", object=ALERT, method=RESET),
            "timed": client.ask("call", object=SHELVING, method=TIMED_SHELVE, values=[["Double", 60_000.0]]),
            "one shot": client.ask("call", object=SHELVING, method=ONE_SHOT_SHELVE),
            "unshelve": client.ask("call", object=SHELVING, method=UNSHELVE),
        }
        assert set(answers.values()) == {"BadUserAccessDenied"}, answers
        switched = [client.ask("call", object=ALERT, method=one) for one in (ENABLE, DISABLE)]
        assert all(one.startswith("Bad") for one in switched), "alerts are not switched off"
        assert client.ask("refresh") == "Good"
        commented = client.ask("comment", condition=ALERT, event=event, comment="the pump is warm")
    assert commented == ("Good" if role is Role.ANALYST else "BadUserAccessDenied")
    with store.reading() as session:
        newer = [one.kind for one in alerts.history(session, served.harbour.alert_id) if one.id > before]
        noted = {
            one.operation for one in audit.newest(session, limit=50) if one.who.startswith(name) and one.outcome == "refused"
        }
    assert newer == (["commented"] if role is Role.ANALYST else [])
    assert {"acknowledge_alert", "reset_alert", "shelve_alert", "unshelve_alert"} <= noted


def test_a_client_whose_line_breaks_goes_on_and_misses_nothing_that_is_open(
    colleague: SecondStack, served: ServedPlants, store: Database, folder: Path
) -> None:
    """Its session outlives the line; what was told into it meanwhile is asked for again."""
    port = served.settings.opcua_address[1]
    with cut_line(port) as line:
        endpoint = f"opc.tcp://127.0.0.1:{line.port}"
        with second_stack(endpoint, folder, reconnects=True, **served.client("operator")) as client:
            assert client.ask("listen", node="i=2253") == "Good"
            number = found(store, served, element="bearing.B4")
            condition = f"{MACHINE}/Alerts/looseness bearing.B4"
            wait_until(lambda: client.heard(lambda one: one["ConditionId"] == condition))
            line.cut()
            with store.transaction() as session:
                transitions.acknowledge(session, alerts.get(session, number, to_change=True), Person("anna"))
            wait_until(lambda: read(colleague, f"{condition}/AckedState/Id")["value"] is True)
            line.mend()
            wait_until(lambda: any(one["told"] == "reconnected" for one in client.told), seconds=30.0)
            if not client.heard(lambda one: one["ConditionId"] == condition and one["AckedState.Id"]):
                assert client.ask("refresh") == "Good"
            wait_until(lambda: client.heard(lambda one: one["ConditionId"] == condition and one["AckedState.Id"]))
            event = read(client, f"{condition}/EventId")["value"]
            assert client.ask("comment", condition=condition, event=event, comment="back again") == "Good"


@pytest.mark.long
def test_a_client_goes_on_when_the_server_starts_again_under_its_subscription(
    served: ServedPlants, store: Database, folder: Path
) -> None:
    """Sessions and subscriptions end with the server; another stack makes them anew, and misses nothing that is so then."""
    with second_stack(served.endpoint, folder, reconnects=True, **served.client("operator")) as client:
        assert client.ask("watch", nodes=[STIFFNESS]) == ["Good"]
        assert client.ask("listen", node="i=2253") == "Good"
        wait_until(lambda: any(one["told"] == "value" for one in client.told))
        served.serving.stop()
        with store.transaction() as session:  # what happens meanwhile
            outcome = identification({"coupling.C1.kxx": 1.25})
            store_identification(session, outcome, run_id=501, measured_at=START + 50_000 * SECOND)
        client.told.clear()
        again = OpcUaServing(store, served.settings)
        again.start()
        served.serving = again
        try:
            wait_until(lambda: any(one["told"] == "reconnected" for one in client.told), seconds=30.0)
            wait_until(lambda: any(one.get("value") == pytest.approx(2.5e6) for one in client.told), seconds=20.0)
            began = time.time()
            found(store, served, element="bearing.B3")
            wait_until(lambda: client.heard(lambda one: one["ConditionId"] == f"{MACHINE}/Alerts/looseness bearing.B3"))
            assert time.time() - began < 5.0
            assert client.ask("refresh") == "Good"
        finally:
            again.stop()
