"""Alerts as they are listed."""

from service.alerts.transitions import Person, acknowledge, clear_alert
from storage.tables.alerting import AlertRow
from tests.api_in_process import Api


def test_alerts_of_all_machines_and_of_one(filled: Api) -> None:
    (one,) = filled.value("/alerts")
    assert (one["machine"], one["rule"], one["element"], one["state"]) == (
        "pump-7",
        "misalignment",
        "coupling.C1",
        "unacknowledged",
    )
    assert one["closed_at"] is None
    assert one["identification"] == filled.value("/machines/pump-7/identifications")[0]["id"]
    assert filled.value("/machines/pump-7/alerts") == [one]
    assert filled.value(f"/alerts/{one['id']}") == one


def test_only_open_alerts_when_asked_for(changing: Api) -> None:
    with changing.database.transaction() as session:
        row = session.get(AlertRow, changing.value("/alerts")[0]["id"])
        assert row is not None
        acknowledge(session, row, Person("anna"))
        clear_alert(session, row)
    for path in ("/alerts", "/machines/pump-7/alerts"):
        assert changing.value(path, open=True) == []
        (one,) = changing.value(path)
        assert one["state"] == "normal"
        assert one["closed_at"] is not None


def test_a_number_that_is_none_is_null_in_the_evidence_too(filled: Api) -> None:
    assert filled.value("/alerts")[0]["evidence"]["shift"] is None
