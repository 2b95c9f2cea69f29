"""Clocks that are set back or forward: nothing is shelved for ever, nothing is delivered late, no wrong date rules a trend."""

import time

import httpx
import pytest
import zenoh
from sqlalchemy.orm import Session

from benchmarks.serving import served
from service import alerting, baselining
from service.alert_life import Suppression
from service.alerting import Finding, Person
from service.delivery.dispatcher import Dispatcher
from storage import alerts, deliveries
from storage.database import Database
from storage.tables import AlertRow
from tests.judging import judge
from tests.plant import SECOND, START, identification, store_identification, wait_until
from tests.service.delivery.receivers import receiver, settings, subscribe

ANNA = Person("anna")
HOUR = 3600 * SECOND
WEEK = 7 * 24 * HOUR
STIFFER = {
    **{f"coupling.C1.{name}": 1.6 for name in ("kxx", "kyy")},
    **{f"bearing.{bearing}.{name}": 1.3 for bearing in ("B2", "B3") for name in ("kxx", "kyy")},
}


@pytest.fixture
def off(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """How far this machine's clock is off [ns]; what a test puts there holds at once."""
    by, right = [0], time.time_ns
    monkeypatch.setattr(time, "time_ns", lambda: right() + by[0])
    return by


def raised(session: Session) -> AlertRow:
    found = store_identification(session, identification(), run_id=1, measured_at=START)
    finding = Finding("Coupling C1 is going out of alignment", {}, found.id, START)
    return alerting.raise_alert(session, "pump-7", rule="misalignment", element="coupling.C1", finding=finding)


def test_a_shelving_ends_when_the_clock_is_set_back_before_it_began(plant: Database, off: list[int]) -> None:
    """It would last a day longer than anybody wanted."""
    with plant.transaction() as session:
        alert = raised(session)
        alerting.shelve(session, alert, ANNA, until=time.time_ns() + HOUR)
        off[0] = -10 * SECOND  # as clocks are set every day
        assert alerting.release_over(session) == 0
        off[0] = -24 * HOUR
        assert alerting.any_over(session)
        assert alerting.release_over(session) == 1
        assert alert.state == "unacknowledged"
        alerting.shelve(session, alert, ANNA, until=time.time_ns() + HOUR)
        assert alerting.release_over(session) == 0


def test_a_shelving_ends_when_the_clock_jumps_past_its_end(plant: Database, off: list[int]) -> None:
    with plant.transaction() as session:
        alert = raised(session)
        alerting.shelve(session, alert, ANNA, until=time.time_ns() + HOUR)
        off[0] = 2 * HOUR
        assert alerting.release_over(session) == 1
        off[0] = 0
        assert (alerting.release_over(session), alert.state) == (0, "unacknowledged")


def test_what_a_person_must_end_outlasts_any_clock(plant: Database, off: list[int]) -> None:
    with plant.transaction() as session:
        alert = raised(session)
        alerting.suppress(session, "pump-7", Suppression.OUT_OF_SERVICE, ANNA)
        for off[0] in (-WEEK, 1000 * WEEK):
            assert alerting.release_over(session) == 0
        assert alert.state == "out_of_service"


@pytest.mark.parametrize("tried", [False, True], ids=["before its first try", "between two tries"])
def test_a_delivery_does_not_wait_for_a_clock_that_was_set_back(
    plant: Database, router: zenoh.Session, off: list[int], tried: bool
) -> None:
    with receiver() as http:
        subscription = subscribe(plant, http.url("/flaky"), name="historian")
        one = Dispatcher(plant, router, settings())

        def attempts() -> int:
            with plant.reading() as session:
                return deliveries.of_subscription(session, subscription, limit=1)[0].attempts

        with plant.transaction() as session:
            raised(session)
        if not tried:
            off[0] = -24 * HOUR
            http.well.set()
        one.start()
        try:
            if tried:
                wait_until(lambda: attempts() == 1)
                http.well.set()
                off[0] = -24 * HOUR
            wait_until(lambda: attempts() == 1 + tried, seconds=4.0)
        finally:
            one.stop()
    with plant.reading() as session:
        assert [row.state for row in deliveries.of_subscription(session, subscription, limit=10)] == ["delivered"]


def test_a_run_dated_in_the_future_does_not_blind_what_follows(plant: Database) -> None:
    """Its clock was wrong by ten years; until then it would be the newest."""
    with plant.transaction() as session:

        def file(number: int, moment: int, factors: dict[str, float] | None = None) -> int:
            row = store_identification(session, identification(factors), run_id=number, measured_at=moment)
            judge(session, row, baseline_runs=5)
            return row.id

        for number in range(1, 6):
            file(number, START + number * WEEK)
        wrong = file(6, time.time_ns() + 520 * WEEK)
        for number in range(7, 9):
            file(number, START + number * WEEK, STIFFER)
        assert [row.element for row in alerts.open_alerts(session, "pump-7")] == ["coupling.C1"]
    with served(plant) as url, httpx.Client(base_url=f"{url}/machines/pump-7", trust_env=False, timeout=10.0) as client:
        assert client.get("/deviations").json()["identification"] == 8
        found = client.get("/deviations", params={"identification": wrong}).json()
    assert found["missing"].startswith(f"identification {wrong} does not count: ")
    assert "dated in the future" in found["missing"]


def test_a_late_run_of_before_a_maintenance_raises_nothing(plant: Database) -> None:
    """It belongs to the machine as it was; the newer runs belong to the machine as it is, and are compared with that."""
    with plant.transaction() as session:

        def file(number: int, week: int, factors: dict[str, float] | None = None) -> None:
            row = store_identification(session, identification(factors), run_id=number, measured_at=START + week * WEEK)
            judge(session, row, baseline_runs=5)

        for week in range(1, 7):
            file(week, week)
        moment = START + 7 * WEEK + WEEK // 2
        baselining.note(session, "pump-7", at=moment, kind="maintenance", text="stiffer coupling", by="anna")
        for week in range(8, 16):
            file(week, week, STIFFER)
        assert alerts.open_alerts(session, "pump-7") == []
        file(16, 7)
        assert alerts.open_alerts(session, "pump-7") == []


def test_a_late_run_of_before_a_change_takes_no_alert_back(plant: Database) -> None:
    """Three healthy weeks come in late, while the newest runs still show what the alert says."""
    with plant.transaction() as session:

        def file(number: int, week: int, factors: dict[str, float] | None = None) -> None:
            row = store_identification(session, identification(factors), run_id=number, measured_at=START + week * WEEK)
            judge(session, row, baseline_runs=5)

        for week in range(1, 6):
            file(week, week)
        for week in range(10, 13):
            file(week, week, STIFFER)
        for week in range(6, 9):
            file(week, week)
            assert [row.state for row in alerts.open_alerts(session, "pump-7")] == ["unacknowledged"]
        file(13, 13, STIFFER)
        assert [row.state for row in alerts.open_alerts(session, "pump-7")] == ["unacknowledged"]
