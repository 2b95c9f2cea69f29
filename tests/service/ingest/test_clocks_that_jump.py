"""Clocks that are set back or forward: nothing is shelved for ever, nothing is delivered late, no wrong date rules a trend."""

import time
from dataclasses import dataclass

import httpx
import pytest
import zenoh
from sqlalchemy.orm import Session

from benchmarks.serving import served
from service.alerts import transitions
from service.alerts.lifecycle import Suppression
from service.alerts.transitions import AlertFinding, Person
from service.delivery.dispatcher import Dispatcher
from service.monitoring import baseline_changes
from service.runs.collection_state import state_of
from service.runs.collector import Collector
from storage.alerts import alerts, deliveries
from storage.clock import to_datetime
from storage.database.engine import Database
from storage.machines import machines
from storage.measurements import runs, samples
from storage.tables.alerting import AlertRow
from storage.tables.measurements import RunRow, SourceRow
from tests.api_in_process import Api
from tests.assessment import judge
from tests.plant import (
    KEY,
    SECOND,
    START,
    arrived,
    batch,
    identification,
    machine,
    store_identification,
    sweep_rpm,
    wait_until,
)
from tests.prompt_writer import PromptWriter
from tests.service.delivery.receivers import receiver, settings, subscribe

ANNA = Person("anna")
HOUR = 3600 * SECOND
WEEK = 7 * 24 * HOUR
STIFFER = {
    **{f"coupling.C1.{name}": 1.6 for name in ("kxx", "kyy")},
    **{f"bearing.{bearing}.{name}": 1.3 for bearing in ("B2", "B3") for name in ("kxx", "kyy")},
}


def raised(session: Session) -> AlertRow:
    found = store_identification(session, identification(), run_id=1, measured_at=START)
    finding = AlertFinding({}, found.id, START)
    return transitions.raise_alert(session, "pump-7", rule="misalignment", element="coupling.C1", finding=finding)


def test_a_shelving_ends_when_the_clock_is_set_back_before_it_began(plant: Database, off: list[int]) -> None:
    """It would last a day longer than anybody wanted."""
    with plant.transaction() as session:
        alert = raised(session)
        transitions.shelve(session, alert, ANNA, until=time.time_ns() + HOUR)
        off[0] = -10 * SECOND  # as clocks are set every day
        assert transitions.release_expired(session) == 0
        off[0] = -24 * HOUR
        assert transitions.any_expired(session)
        assert transitions.release_expired(session) == 1
        assert alert.state == "unacknowledged"
        transitions.shelve(session, alert, ANNA, until=time.time_ns() + HOUR)
        assert transitions.release_expired(session) == 0


def test_a_shelving_ends_when_the_clock_jumps_past_its_end(plant: Database, off: list[int]) -> None:
    with plant.transaction() as session:
        alert = raised(session)
        transitions.shelve(session, alert, ANNA, until=time.time_ns() + HOUR)
        off[0] = 2 * HOUR
        assert transitions.release_expired(session) == 1
        off[0] = 0
        assert (transitions.release_expired(session), alert.state) == (0, "unacknowledged")


def test_what_a_person_must_end_outlasts_any_clock(plant: Database, off: list[int]) -> None:
    with plant.transaction() as session:
        alert = raised(session)
        transitions.suppress(session, "pump-7", Suppression.OUT_OF_SERVICE, ANNA)
        for off[0] in (-WEEK, 1000 * WEEK):
            assert transitions.release_expired(session) == 0
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
        baseline_changes.note(session, "pump-7", at=moment, kind="maintenance", text="stiffer coupling", by="anna")
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


# --- a clock that was ahead for seconds ---------------------------------------------------------------------------------


YEAR = 365 * 24 * HOUR


@dataclass
class JumpingSource:
    """One that sends a sample a second, by a clock that is off like the service's."""

    writer: PromptWriter
    by: list[int]
    sequence: int = 0

    def send(self, rpm: list[float], *, at: int) -> None:
        """at: time of the first sample by a right clock [ns]."""
        one = batch(rpm, sequence=self.sequence, start=at + self.by[0])
        self.writer.store([arrived(one, received_at=time.time_ns())], [])
        self.sequence += len(rpm)


def ahead_for_seconds(plant: Database, off: list[int]) -> tuple[JumpingSource, int]:
    """A source that was at speed before its clock and the service's were a year ahead for eight samples; and now."""
    moment = time.time_ns()
    source = JumpingSource(PromptWriter(plant, Collector(late_s=0.0)), off)
    source.send([1000.0] * 150, at=moment - 1000 * SECOND)
    off[0] = YEAR
    source.send([1480.0] * 8, at=moment)
    off[0] = 0
    return source, moment


def seen(plant: Database, moment: int) -> tuple[str, bool, bool]:
    """Return what a machine does, as its state, the overview and the list of states say; whether its times are of the
    present."""
    api = Api(plant)  # another one may be half a second behind
    state, (row,) = api.value("/machines/pump-7/state"), api.value("/fleet")["machines"]
    newest = api.value("/machines/pump-7/states")[0]
    assert state["state"] == row["state"] == newest["state"]
    assert (state["newest_sample_at"], state["since"]) == (row["newest_sample_at"], row["state_since"])
    present = to_datetime(moment + HOUR).isoformat()
    return state["state"], state["newest_sample_at"] < present, (state["since"] or "") < present


@pytest.mark.parametrize("restarted", [False, True])
def test_a_clock_that_was_ahead_does_not_freeze_what_a_machine_does(plant: Database, off: list[int], restarted: bool) -> None:
    source, moment = ahead_for_seconds(plant, off)
    if restarted:
        source.writer = PromptWriter(plant, Collector(late_s=0.0))
    source.send([700.0] * 10, at=moment + 8 * SECOND)
    assert seen(plant, moment) == ("at speed", True, True)
    assert Api(plant).value("/machines/pump-7/state")["speed_rpm"] == pytest.approx(700.0)
    assert Api(plant).value("/machines/pump-7/state")["late_samples_waiting"] == 0
    moment -= 300 * SECOND  # and none of what follows is of the future
    source.send(sweep_rpm(700.0, 2900.0, 60), at=moment + 320 * SECOND)
    assert seen(plant, moment)[0] == "run-up"
    assert Api(plant).value("/fleet")["machines"][0]["open_run"]["kind"] == "run-up"
    source.send([*sweep_rpm(2900.0, 0.0, 60), *[0.0] * 5], at=moment + 380 * SECOND)
    assert seen(plant, moment) == ("stopped", True, True)
    kinds = [run["kind"] for run in Api(plant).value("/machines/pump-7/runs") if run["state"] == "closed"]
    assert kinds == ["run-down", "run-up"]
    assert Api(plant).value("/fleet")["machines"][0]["last_run"]["kind"] == "run-down"


def test_a_run_of_the_future_ends_and_hides_none_of_the_present(plant: Database, off: list[int]) -> None:
    """It was open when the clock was set right."""
    moment = time.time_ns()
    source = JumpingSource(PromptWriter(plant, Collector(late_s=0.0)), off)
    off[0] = YEAR
    source.send([1000.0] * 5 + sweep_rpm(1000.0, 2000.0, 40), at=moment - 100 * SECOND)
    api = Api(plant)
    assert api.value("/machines/pump-7/state")["run"] is not None
    off[0] = 0
    source.send([900.0] * 10, at=moment)
    assert seen(plant, moment) == ("at speed", True, True)
    assert api.value("/machines/pump-7/state")["run"] is None
    (run,) = api.value("/machines/pump-7/runs")
    assert run["reason"].startswith("the clock was set back")
    assert Api(plant).value("/fleet")["machines"][0]["last_run"] is None


def test_a_machine_that_falls_silent_is_not_frozen_either(plant: Database, off: list[int]) -> None:
    source, moment = ahead_for_seconds(plant, off)
    source.writer = PromptWriter(plant, Collector(late_s=0.0))
    source.writer.settle(silence_s=0.0)
    api = Api(plant)
    state = api.value("/machines/pump-7/state")
    assert (state["state"], state["since"]) == ("unknown", None)
    assert state["newest_sample_at"] == api.value("/fleet")["machines"][0]["newest_sample_at"]
    assert state["newest_sample_at"] < to_datetime(moment).isoformat()
    source.send([900.0] * 10, at=moment + 10 * SECOND)
    assert seen(plant, moment) == ("at speed", True, True)


def test_rolling_collection_goes_on_in_the_present(plant: Database, off: list[int]) -> None:
    rules = {"interval_s": 60, "coverage": 0.2, "recency_s": 3600}
    with plant.transaction() as session:
        machines.revise(session, machine(collection={"runs": "rolling", "rolling": rules}))
    moment = time.time_ns()
    source = JumpingSource(PromptWriter(plant, Collector()), off)
    sweep = [*sweep_rpm(400.0, 2900.0, 90), *sweep_rpm(2900.0, 400.0, 90)]
    off[0] = YEAR
    source.send(sweep, at=moment - 400 * SECOND)
    off[0] = 0
    source.send(sweep, at=moment - 200 * SECOND)
    assert {run.time_first > moment for run in rows_of_runs(plant)} == {False, True}


def rows_of_runs(plant: Database) -> list[RunRow]:
    with plant.reading() as session:
        return list(runs.of_machine(session, KEY.machine))


def test_the_age_of_the_newest_sample_is_of_the_present(plant: Database, off: list[int]) -> None:
    """Nobody would hear of a machine that is silent for a year."""
    ahead_for_seconds(plant, off)
    with plant.transaction() as session:
        (row,) = samples.sources(session)
        session.add(
            SourceRow(**{c.name: getattr(row, c.name) for c in SourceRow.__table__.columns} | {"epoch": 0, "last_time": START})
        )
    text = Api(plant).ask("GET", "/metrics").text
    (line,) = [one for one in text.splitlines() if one.startswith("rundown_newest_sample_age_seconds{")]
    assert float(line.split()[1]) == pytest.approx((time.time_ns() - START) / 1e9, rel=1e-3)


@pytest.mark.parametrize("hours", [-3, 3])
def test_late_samples_stay_late_where_no_clock_was_wrong(plant: Database, off: list[int], hours: int) -> None:
    """Also where the service's own clock is behind: what is a little older is late, and the newest sample is what it was."""
    moment = time.time_ns()
    source = JumpingSource(PromptWriter(plant, Collector(late_s=0.0)), off)
    source.send([1000.0] * 10, at=moment)
    with plant.reading() as session:
        before = state_of(session, KEY.machine)
    off[0] = hours * HOUR
    one = batch([900.0] * 10, sequence=source.sequence, start=moment - 24 * HOUR, source="other")
    source.writer.store([arrived(one, received_at=moment)], [])
    with plant.reading() as session:
        after = state_of(session, KEY.machine)
    assert before is not None
    assert after is not None
    assert (after.seen, after.operating) == (before.seen, before.operating)
    assert after.late
