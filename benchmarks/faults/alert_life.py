"""Random lives of alerts with restarts and kills between the steps: no illegal state, each event written and queued once.

A restart is a new connection that knows nothing but the database; a kill rolls a step back in the middle. Each step is checked
against the rules of ISA-18.2 written out once more (`LEGAL`), and the whole history at the end.
"""

import argparse
import random
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from service.alerts import transitions
from service.alerts.lifecycle import Forbidden, Severity, Suppression
from service.alerts.transitions import AlertFinding, MomentRefused, Person
from storage.alerts import alerts, deliveries, suppressions
from storage.database.engine import Database
from storage.machines import machines
from storage.tables.alerting import AlertEventRow, AlertRow, DeliveryRow
from tests.plant import START, identification, machine, store_identification

MACHINE, RULE = "pump-7", "misalignment"
ELEMENTS = ("coupling.C1", "coupling.C2", "bearing.B1")
ANNA = Person("anna")
STEPS = 100_000
RESTART_PART = KILL_PART = 0.05
CALLING = ("unacknowledged", "acknowledged", "returned", "latched_unacknowledged", "latched_acknowledged")
QUIET = ("shelved", "suppressed_by_design", "out_of_service")
LEGAL: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "severity_changed": (("unacknowledged", "acknowledged", *QUIET), ("unacknowledged", "acknowledged", *QUIET)),
    "raised": (("normal", *CALLING, *QUIET), ("unacknowledged", *QUIET)),
    "cleared": (
        ("unacknowledged", "acknowledged", *QUIET),
        ("returned", "normal", "latched_unacknowledged", "latched_acknowledged", *QUIET),
    ),
    "acknowledged": (
        ("unacknowledged", "returned", "latched_unacknowledged"),
        ("acknowledged", "normal", "latched_acknowledged"),
    ),
    "reset": (("latched_acknowledged", *QUIET), ("normal", *QUIET)),
    "commented": ((*CALLING, *QUIET, "normal"), (*CALLING, *QUIET, "normal")),
    **dict.fromkeys(QUIET, ((*CALLING, *QUIET), QUIET)),
    **{f"{kind}_ended": (QUIET, (*CALLING, *QUIET)) for kind in QUIET},
}
"""Legal transitions of each kind of event: states before and states after."""


def step(session: Session, identification_id: int, rng: random.Random) -> None:
    """Apply an event to an alert. Raises Forbidden, and MomentRefused where the end of a shelving has passed meanwhile."""
    element = rng.choice(ELEMENTS)
    row = alerts.open_alert(session, MACHINE, rule=RULE, element=element)

    def raised() -> None:
        severity = rng.choice(list(Severity))
        finding = AlertFinding({}, identification_id, START, severity, latching=rng.random() < 0.3)
        transitions.raise_alert(session, MACHINE, rule=RULE, element=element, finding=finding)

    def suppressed() -> None:
        kind = rng.choice([Suppression.OUT_OF_SERVICE, Suppression.SUPPRESSED_BY_DESIGN])
        part = rng.choice([None, element])
        until = None if rng.random() < 0.5 else time.time_ns() + 1_000_000
        transitions.suppress(session, MACHINE, kind, ANNA, element=part, until=until)

    def released() -> None:
        held = [one for one in suppressions.in_force(session, MACHINE) if one.kind != Suppression.SHELVED]
        if held:
            transitions.release(session, rng.choice(held), ANNA)

    def expired() -> None:
        transitions.release_expired(session)

    def on_alert(act: Callable[[Session, AlertRow], None]) -> Callable[[], None]:
        return lambda: None if row is None else act(session, row)

    choices: list[Callable[[], None]] = [
        raised,
        raised,
        suppressed,
        released,
        released,
        expired,
        on_alert(transitions.clear_alert),
        on_alert(transitions.clear_alert),
        on_alert(lambda s, r: transitions.acknowledge(s, r, ANNA)),
        on_alert(lambda s, r: transitions.reset(s, r, ANNA)),
        on_alert(lambda s, r: transitions.comment(s, r, ANNA)),
        on_alert(lambda s, r: transitions.shelve(s, r, ANNA, until=time.time_ns() + 1_000_000)),
        on_alert(lambda s, r: transitions.unshelve(s, r, ANNA)),
    ]
    rng.choice(choices)()


def live(database: Database, *, steps: int, seed: int) -> Counter[str]:
    """Take so many random steps; returns what happened by kind. The database must know the machine of `tests.plant`."""
    rng = random.Random(seed)
    happened: Counter[str] = Counter()
    with database.transaction() as session:
        deliveries.subscribe(session, kind="webhook", name="historian", target="http://127.0.0.1/", secret=None)
        number = store_identification(session, identification(), run_id=1, measured_at=START).id
    for _ in range(steps):
        if rng.random() < RESTART_PART:
            database.engine.dispose()
            happened["restarts"] += 1
        killed = rng.random() < KILL_PART
        try:
            with database.transaction() as session:
                step(session, number, rng)
                if killed:
                    session.flush()
                    raise InterruptedError
        except Forbidden:
            happened["refused"] += 1
        except MomentRefused:
            happened["too late"] += 1
        except InterruptedError:
            happened["kills"] += 1
    return happened


def check(database: Database) -> Counter[str]:
    """Go through the whole history. Raises AssertionError at the first wrong thing; returns how many events of each kind."""
    kinds: Counter[str] = Counter()
    with database.reading() as session:
        before: dict[int, AlertEventRow] = {}
        for event in session.scalars(select(AlertEventRow).order_by(AlertEventRow.id)):
            kinds[event.kind] += 1
            sources, targets = LEGAL[event.kind]
            assert event.state_before in sources, (event.kind, event.state_before)
            assert event.state in targets, (event.kind, event.state)
            earlier = before.get(event.alert_id)
            assert event.number == (1 if earlier is None else earlier.number + 1), "a hole in an alert's events"
            expected = None if earlier is None else earlier.state
            assert expected is None or event.state_before == expected, "an event does not follow the one before it"
            before[event.alert_id] = event
        for row in session.scalars(select(AlertRow)):
            assert before[row.id].number == row.event_count
            assert before[row.id].state == row.state
            assert (row.closed_at is not None) == (row.condition == "normal")
        queued = session.scalar(select(func.count()).select_from(DeliveryRow)) or 0
        different = session.scalar(select(func.count(func.distinct(DeliveryRow.event_id)))) or 0
        assert queued == different == sum(kinds.values()), "an event is not queued exactly once"
    return kinds


def main(arguments: Sequence[str] | None = None) -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.faults.alert_life", description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--steps", type=int, default=STEPS)
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory() as folder:
        database = Database(f"sqlite:///{Path(folder) / 'alerts.db'}")
        with database.transaction() as session:
            machines.create(session, machine())
        begin = time.perf_counter()
        happened = live(database, steps=given.steps, seed=given.seed)
        kinds = check(database)
        print(f"{given.steps} steps, seed {given.seed}, {time.perf_counter() - begin:.0f} s: {dict(happened)}")
        print(
            f"{sum(kinds.values())} events, each legal, numbered without a hole and queued once: {dict(kinds.most_common())}"
        )
        database.close()


if __name__ == "__main__":
    main()
