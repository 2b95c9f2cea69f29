"""A store with two plants that have the same of everything; what is of the second is named so that a leak shows."""

from dataclasses import dataclass
from typing import Any

from service.alerts import transitions
from service.alerts.transitions import AlertFinding
from service.monitoring import baseline_changes
from storage.alerts import deliveries, suppressions
from storage.database.engine import Database
from storage.encoding.source_key import SourceKey
from storage.machines import balancings, calibrations, machines, model_calibrations
from storage.measurements import quarantine, runs, samples
from storage.measurements.quarantine import Rejection
from tests.plant import SECOND, START, identification, machine, store_identification, sweep_rpm
from tests.plant import samples as some_samples

HIDDEN_PLANT, HIDDEN = "orchard", "quince-9"
MARKS = ("orchard", "quince")
"""In whatever is of the second plant, and in nothing else."""
POINTS = 40
RUNS = 6


@dataclass(frozen=True)
class Ids:
    """Objects of a plant, by the names of the paths' parameters."""

    machine_id: str
    run_id: int
    identification_id: int
    alert_id: int
    suppression_id: int
    subscription_id: int
    delivery_id: int
    job_id: int
    balancing_id: int
    calibration_id: int

    def path(self, template: str) -> str:
        """A path with its parameters."""
        return template.format(**vars(self), name="icon.svg", path="swagger-ui.css")


def fill(database: Database) -> tuple[Ids, Ids]:
    """Write the store; what the plants have."""
    hidden = machine(id=HIDDEN, plant=HIDDEN_PLANT, name="Quince nine")
    made = [_plant(database, machine(), "harbour"), _plant(database, hidden, "orchard")]
    return made[0], made[1]


def _plant(database: Database, document: Any, word: str) -> Ids:
    with database.transaction() as session:
        machines.create(session, document)
        subscription = deliveries.subscribe(
            session, kind="zenoh", name=f"{word} network", target="", secret=None, plants=[document.plant]
        )
        samples.source(session, SourceKey(document.id, f"{word}-monitor", 1)).received = RUNS * POINTS
        for number in range(RUNS):
            begin = START + number * 3600 * SECOND
            held = some_samples(POINTS, start=begin, rpm=sweep_rpm(2900.0, 400.0, POINTS))
            key = SourceKey(document.id, f"{word}-monitor", 1)
            samples.add_block(session, key, revision=1, first_sequence=number * POINTS, samples=held)
            run = runs.open_run(session, document.id, revision=1, kind="run-down", direction=1, time_first=begin)
            runs.close(run, samples=held, state=runs.CLOSED, reason=f"as {word} does")
            row = store_identification(
                session,
                identification({"coupling.C1.kxx": 1.0 + 0.01 * number}),
                run_id=run.id,
                measured_at=begin + POINTS * SECOND,
                machine_id=document.id,
            )
        finding = AlertFinding({"sigma": 6.1}, row.id, START, latching=True)
        alert = transitions.raise_alert(session, document.id, rule="misalignment", element="coupling.C1", finding=finding)
        suppression = suppressions.add(
            session, document.id, kind="out_of_service", rule="misfit", element=None, until=None, by=word, comment=word
        )
        baseline_changes.note(session, document.id, at=START, kind="note", text=f"{word} was looked at", by=word)
        reject = Rejection(START, f"rundown/v1/{document.plant}/{document.id}/samples", document.id, "undecodable", word, b"?")
        quarantine.add(session, [reject])
        session.flush()
        delivery = deliveries.of_subscription(session, subscription.id, limit=1)[0]
        calibrations.add(session, document.id, channel=document.channels[0], at=START, certificate=word, by=word)
        balancing = balancings.add(session, document.id, revision=1, initial=[run.id], by=word, comment=word)
        asked = {"runs": [{"run": run.id, "weights": [], "mounting": word, "steady": False}], "seed": 0}
        calibration = model_calibrations.add(session, document.id, revision=1, asked=asked, by=word, comment=word)
        return Ids(
            document.id,
            run.id,
            row.id,
            alert.id,
            suppression.id,
            subscription.id,
            delivery.id,
            row.job_id,
            balancing.id,
            calibration.id,
        )


def leaks(text: str, but: tuple[str, ...] = ()) -> bool:
    """Return whether an answer has something of the second plant in it, beyond what was asked for by name."""
    for known in but:
        text = text.replace(known, "")
    return any(mark in text.lower() for mark in MARKS)
