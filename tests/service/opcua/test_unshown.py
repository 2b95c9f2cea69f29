"""Names of what cannot be shown to clients, or only without its text: they stand until it is right."""

import asyncio
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import pytest

from service.alerts import transitions
from service.alerts.transitions import Person
from service.configuration.settings import Settings
from service.opcua.machine_reading import PARAMETERS
from service.opcua.plant_reader import PlantChanges
from service.opcua.server import PlantServer
from service.opcua.unshown import MOST_NAMED, Unshown
from storage.alerts import alerts
from storage.database.engine import Database
from tests.plant import KEY
from tests.ports import free_port
from tests.service.security.two_plants import Ids, fill


@pytest.fixture
def ids(database: Database) -> Ids:
    """Objects of a plant."""
    return fill(database)[0]


@pytest.fixture
def runner() -> Iterator[asyncio.Runner]:
    """The event loop of a server."""
    with asyncio.Runner() as one:
        yield one


@pytest.fixture
def server(runner: asyncio.Runner, database: Database, ids: Ids) -> Iterator[PlantServer]:
    """A server of two plants."""
    del ids
    one = PlantServer(database, Settings(opcua_listen=f"opc.tcp://127.0.0.1:{free_port()}", opcua_allow_unencrypted=True))
    runner.run(one.start())
    try:
        yield one
    finally:
        runner.run(one.close())


def commented(database: Database, alert: int, *, evidence: Any = None) -> None:
    """Let somebody comment an alert. evidence: what the event then holds of it."""
    with database.transaction() as session:
        transitions.comment(session, alerts.get(session, alert), Person("anna", "looked at"))
        if evidence is not None:
            alerts.last_event(session, alert).evidence = evidence


def shown(server: PlantServer, *place: str) -> Any:
    """Value that clients read of something of the machine."""
    assert server._machines is not None
    node = server._machines.node_of(KEY.machine, *place)
    return server._core.aspace[node].attributes[13].value.Value.Value


def test_an_alert_without_its_text_is_shown_and_named_until_it_has_one(
    runner: asyncio.Runner, server: PlantServer, database: Database, ids: Ids
) -> None:
    assert server.trouble is None
    commented(database, ids.alert_id, evidence=["of another release"])
    runner.run(server.update())
    assert f"the text of alert {ids.alert_id}:" in str(server.trouble)
    assert server._conditions is not None
    (told,) = (one for one in server._conditions._conditions.values() if one.id == ids.alert_id)
    assert (told.is_open, told.comment, told.has_text) == (True, "looked at", False)
    commented(database, ids.alert_id)
    runner.run(server.update())
    assert server.trouble is None


def test_a_server_that_starts_shows_it_as_well(runner: asyncio.Runner, database: Database, ids: Ids) -> None:
    commented(database, ids.alert_id, evidence={"measured_at": "yesterday"})
    settings = Settings(opcua_listen=f"opc.tcp://127.0.0.1:{free_port()}", opcua_allow_unencrypted=True)
    server = PlantServer(database, settings)
    runner.run(server.start())
    try:
        assert f"the text of alert {ids.alert_id}:" in str(server.trouble)
        assert server._conditions is not None
        assert ids.alert_id in {one.id for one in server._conditions._conditions.values() if one.is_open}
    finally:
        runner.run(server.close())


def test_a_machine_of_which_one_value_cannot_be_shown_is_shown_again(runner: asyncio.Runner, server: PlantServer) -> None:
    """The value before it had been added by then: that is no reason to refuse the machine ever after."""
    server._reader._mark = None
    server._reader._glances.clear()
    (reading,) = (one for one in server._reader.read_changes().machines if one.id == KEY.machine)
    first = replace(reading.values[0], folder=PARAMETERS, name="coupling.C9.kxx", value=1.0)
    odd = replace(first, name="coupling.C9.kyy", quality="of another release")
    runner.run(server._show(PlantChanges(machines=[replace(reading, values=(first, odd))])))
    assert f"machine '{KEY.machine}':" in str(server.trouble)
    right = (replace(first, value=2.0), replace(odd, quality=first.quality, value=3.0))
    runner.run(server._show(PlantChanges(machines=[replace(reading, values=right)])))
    assert server.trouble is None
    assert [shown(server, PARAMETERS, one.name) for one in right] == [2.0, 3.0]


def test_an_alert_is_shown_as_soon_as_its_machine_is(runner: asyncio.Runner, server: PlantServer, ids: Ids) -> None:
    assert server._machines is not None
    assert server._conditions is not None
    plant = server._machines._plants.pop(KEY.machine)
    (alert,) = (one for one in server._conditions._conditions.values() if one.id == ids.alert_id)
    changed = replace(alert, comment="while its machine cannot be read")
    runner.run(server._show(PlantChanges(alerts=[changed])))
    assert f"alert {ids.alert_id}:" in str(server.trouble)
    server._machines._plants[KEY.machine] = plant
    server._reader._mark = None
    server._reader._glances.clear()
    runner.run(server.update())
    assert server.trouble is None
    assert changed in server._conditions._conditions.values()


def test_of_many_some_are_named_and_the_others_counted() -> None:
    unshown = Unshown()
    for number in range(MOST_NAMED + 2):
        unshown.note(f"alert {number}")
    assert f"alert {MOST_NAMED - 1} and 2 more:" in str(unshown.trouble)
