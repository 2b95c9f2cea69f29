"""Alerts over zenoh: events as they happen, and the last state of each alert to whoever asks."""

import json
import time

import zenoh
from sqlalchemy import text

from service.alerts import transitions
from service.delivery.zenoh_channel import LastStates
from service.messaging.session import open_session
from storage.alerts import alerts
from storage.database.engine import Database
from storage.tables.findings import IdentificationRow
from tests.plant import machine, wait_until
from tests.service.delivery.dispatching import ANNA, Router, delivering, states
from tests.service.delivery.receivers import raise_one, subscribe


def test_the_network_hears_events_and_answers_with_the_last_state(
    plant: Database, found: IdentificationRow, network: Router
) -> None:
    session, endpoint = network
    subscription = subscribe(plant, "", name="network", kind="zenoh")
    states_of = LastStates(session, plant)
    with open_session(listen=[], connect=[endpoint]) as client:
        heard: list[zenoh.Sample] = []
        listener = client.declare_subscriber("rundown/v1/*/*/alerts/*", heard.append)
        time.sleep(0.3)  # the declaration is on its way to the router
        with delivering(plant, network):
            alert = raise_one(plant, found, machine())
            wait_until(lambda: states(plant, subscription) == ["delivered"])
            wait_until(lambda: len(heard) == 1)
        plant_name = machine().plant
        assert str(heard[0].key_expr) == f"rundown/v1/{plant_name}/pump-7/alerts/{alert}"
        assert json.loads(bytes(heard[0].payload))["kind"] == "raised"
        with plant.transaction() as reading:
            transitions.acknowledge(reading, alerts.get(reading, alert), ANNA)
        replies = [json.loads(bytes(one.ok.payload)) for one in client.get("rundown/v1/**/alerts/*", timeout=5.0) if one.ok]
        assert [(one["alert"], one["state"]) for one in replies] == [(alert, "acknowledged")]
        other = [one for one in client.get("rundown/v1/other/*/alerts/*", timeout=5.0) if one.ok]
        assert other == []
        listener.undeclare()
    states_of.close()


def test_an_alert_that_cannot_be_reported_keeps_no_other_from_being_answered(
    plant: Database, found: IdentificationRow, network: Router
) -> None:
    session = network[0]
    numbers = [raise_one(plant, found, machine(), element=f"coupling.C{number}") for number in range(3)]
    with plant.transaction() as writing:
        # There is no such severity.
        writing.execute(text(f"UPDATE alert_events SET severity = 9 WHERE alert_id = {numbers[1]}"))
    states_of = LastStates(session, plant)
    replies = [json.loads(bytes(one.ok.payload)) for one in session.get("rundown/v1/**/alerts/*", timeout=5.0) if one.ok]
    states_of.close()
    assert {one["alert"] for one in replies} == {numbers[0], numbers[2]}
