"""Conformance of the API to its own OpenAPI document for any request: schemathesis against a service process with data.

Each operation is asked with the limits of its schema and with generated values, right ones and wrong ones; then operations
follow one another, each with what earlier answers held, along the links that schemathesis infers from the document.

    python -m benchmarks.faults.contract [--examples 500] [--sequences 500] [--seed 0] [--only list_alerts,…]
"""

import argparse
import tempfile
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import schemathesis
from schemathesis.engine import Status, events, from_schema

from formats.wire import JSON, encode_body
from service.alerts import transitions
from service.alerts.transitions import AlertFinding, Person
from service.monitoring import baseline_changes
from storage.alerts import deliveries, suppressions
from storage.database.engine import Database
from storage.encoding.sample_blocks import Samples
from storage.machines import machines as machine_store
from storage.measurements import runs
from tests.end_to_end.processes import Service
from tests.plant import (
    KEY,
    SECOND,
    START,
    batch,
    identification,
    machine,
    samples,
    sqlite_url,
    store_identification,
    sweep_rpm,
)

ASKED = 500
"""Examples of each operation."""
RUNS = 7
RUN_SAMPLES = 40
LONGEST_WORDS = 1500
"""Largest part of a failure that is printed [characters]."""
STREAM_S = 0.3
"""Time for which an endless stream is read [s]."""
CHECKS = (
    "not_a_server_error",
    "status_code_conformance",
    "content_type_conformance",
    "response_headers_conformance",
    "response_schema_conformance",
    "negative_data_rejection",
    "unsupported_method",
    "allow_header_conformance",
    "missing_required_header",
)
"""Left out is positive_data_acceptance: that ends come in order or a cursor is one of this list, no schema says."""
ANSWERS: dict[str, dict[str, Any]] = {"missing_required_header": {"expected-statuses": ["400", "415", "422", "428"]}}
"""Configuration of the checks: a change without If-Match is answered 428 (RFC 6585)."""
KNOWN: dict[str, list[Any]] = {
    "path.machine_id": [KEY.machine, "fan-2"],
    "path.alert_id": [1, 2],
    "path.identification_id": list(range(1, RUNS + 1)),
    "query.first": [1, 2],
    "query.second": [2, 3],
    "path.run_id": list(range(1, RUNS + 1)),
    "path.subscription_id": [1, 2],
    "path.delivery_id": [1, 2],
    "path.suppression_id": [1, 2],
    "query.parameter": ["coupling.C1.kxx", "disc.D1.unbalance", "bearing.B1.kxy"],
    "query.units": ["mil_pp,hz,deg_lead", "rad_s", "m_p"],
    "query.rpm": [500, 1000, 2000],
    "header.if-match": ["*"],
}
"""Values that lead further than generated ones, which are half of what is asked."""


@dataclass
class ContractFindings:
    """Counts of requests, and the deviations from the document. asked: requests by phase and operation."""

    asked: dict[str, Counter[str]] = field(default_factory=dict)
    answered: Counter[int] = field(default_factory=Counter)
    failures: dict[tuple[str, str, str], str] = field(default_factory=dict)
    """Response and reproduction by operation, check and title."""
    errors: list[str] = field(default_factory=list)
    """Errors of schemathesis itself."""

    def generated(self, operation: str) -> int:
        """Return the number of requests with generated values."""
        return self.asked.get("fuzzing", Counter())[operation]


def fill(file: Path) -> None:
    """Fill a store in which every operation finds something."""
    database = Database(sqlite_url(file))
    anna = Person("anna", "looked at it")
    with database.transaction() as session:
        for one in (machine(), machine(id="fan-2", name="Fan 2")):
            machine_store.create(session, one)
        deliveries.subscribe(session, kind="zenoh", name="plant", target="", secret=None)
        deliveries.subscribe(session, kind="zenoh", name="shift", target="", secret=None)
        for number in range(RUNS):
            begin = START + number * 3600 * SECOND
            run = runs.open_run(session, KEY.machine, revision=1, kind="run-down", direction=1, time_first=begin)
            runs.close(run, samples=_sweep(begin), state=runs.CLOSED, reason="the speed left the speed range")
            outcome = identification({"coupling.C1.kxx": 1.0 + 0.01 * number})
            row = store_identification(session, outcome, run_id=run.id, measured_at=begin + RUN_SAMPLES * SECOND)
        for element in ("coupling.C1", "bearing.B2"):
            finding = AlertFinding({"sigma": 6.1}, row.id, START, latching=True)
            transitions.raise_alert(session, KEY.machine, rule="misalignment", element=element, finding=finding)
        for rule in ("unbalance", "misfit"):
            suppressions.add(
                session,
                KEY.machine,
                kind="out_of_service",
                rule=rule,
                element=None,
                until=None,
                by=anna.name,
                comment=anna.comment,
            )
        baseline_changes.note(session, KEY.machine, at=START, kind="note", text="looked", by=anna.name)
    database.close()


def _sweep(begin: int) -> Samples:
    return samples(RUN_SAMPLES, start=begin, rpm=sweep_rpm(2900.0, 400.0, RUN_SAMPLES))


def configuration(*, examples: int, sequences: int, seed: int, limits: bool, only: Sequence[str] = ()) -> dict[str, Any]:
    """Return schemathesis's configuration. limits: whether each schema's limits are tested one by one. only: these
    operations."""
    names = {name: name.replace(".", "_").replace("-", "_") for name in KNOWN}
    return {
        "seed": seed,
        "continue-on-failure": True,
        "request-timeout": 60.0,
        "generation": {"max-examples": examples, "no-shrink": True},
        "checks": {"enabled": False} | {name: {"enabled": True} | ANSWERS.get(name, {}) for name in CHECKS},
        "phases": {"coverage": {"enabled": limits}, "stateful": {"generation": {"max-examples": sequences}}},
        "dictionaries": {names[name]: {"values": values} for name, values in KNOWN.items()},
        "parameters": {name: {"dictionary": names[name], "probability": 0.5} for name in KNOWN},
        "operations": [
            {"include-operation-id": "stream_alert_events", "request-timeout": STREAM_S},
            *([{"exclude-operation-id": list(only), "enabled": False}] if only else []),
        ],
    }


def ask(url: str, *, only: Sequence[str] = (), told: bool = False, **how: Any) -> ContractFindings:
    """Ask a service everything that its document offers. told: each operation is printed when it has been asked."""
    configured = schemathesis.Config.from_dict(configuration(only=only, **how))
    schema = schemathesis.openapi.from_url(f"{url}/api/v1/openapi.json", config=configured)
    outcome = ContractFindings()
    for event in from_schema(schema).execute():
        if isinstance(event, events.ScenarioFinished):
            _count(outcome, event)
            if told and event.label is not None:
                print(f"  {event.phase.value}: {event.label}: {len(event.recorder.cases)}", flush=True)
        elif isinstance(event, events.NonFatalError):
            outcome.errors.append(f"{event.label}: {event.value}")
        elif isinstance(event, events.FatalError):
            outcome.errors.append(f"{type(event.exception).__name__}: {event.exception}")
    return outcome


def _count(outcome: ContractFindings, event: events.ScenarioFinished) -> None:
    recorder = event.recorder
    asked = outcome.asked.setdefault(event.phase.value, Counter())
    for node in recorder.cases.values():
        asked[node.value.operation.label] += 1
    for interaction in recorder.interactions.values():
        if interaction.response is not None:
            outcome.answered[interaction.response.status_code] += 1
    for case, checks in recorder.checks.items():
        for one in checks:
            if one.status is Status.FAILURE and one.failure_info is not None:
                failure = one.failure_info.failure
                key = recorder.cases[case].value.operation.label, one.name, failure.title
                if key not in outcome.failures:
                    outcome.failures[key] = f"{failure.message}\n{one.failure_info.code_sample}"
                    print(": ".join(key), outcome.failures[key][:LONGEST_WORDS], "", sep="\n", flush=True)


def against_service(folder: Path, **how: Any) -> ContractFindings:
    """Ask a service process over a filled store, to which samples came as well."""
    fill(folder / "rundown.db")
    service = Service(folder, RUNDOWN_WORKERS="1")
    with service.running():
        body = encode_body(batch(sweep_rpm(2900.0, 400.0)), JSON)
        answer = service.client.post(f"/machines/{KEY.machine}/samples", content=body, headers={"content-type": JSON})
        assert answer.status_code == 200, answer.text
        outcome = ask(f"http://127.0.0.1:{service.port}", **how)
    service.client.close()
    return outcome


def report(outcome: ContractFindings, *, examples: int, seconds: float) -> None:
    """Print what was asked and what came."""
    names = sorted({name for asked in outcome.asked.values() for name in asked})
    for phase, asked in outcome.asked.items():
        print(f"  {phase:12s} {asked.total():7d} requests to {len(asked)} operations")
    few = [name for name in names if outcome.generated(name) < examples]
    print(f"  {len(names) - len(few)} of {len(names)} operations were asked {examples} times or more with generated values")
    for name in few:
        print(
            f"    {name}: {outcome.generated(name)}: it has no more to vary" if outcome.generated(name) else f"    {name}: 0"
        )
    codes = ", ".join(f"{code}: {count}" for code, count in sorted(outcome.answered.items()))
    print(f"  answers by status: {codes}")
    print(f"  asked for: no 5xx, no answer beside the document; found: {len(outcome.failures)}, in {seconds:.0f} s")
    for key in sorted(outcome.failures):
        print("    " + ": ".join(key))
    for error in outcome.errors:
        print(f"not done: {error[:1000]}")


def main(arguments: Sequence[str] | None = None) -> None:
    """Print what was found; status 1 where anything was."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--examples", type=int, default=ASKED, help="generated requests of each operation")
    parser.add_argument("--sequences", type=int, default=ASKED, help="chains of operations that follow one another")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--without-limits", action="store_true", help="only generated values, not the schemas' limits")
    parser.add_argument("--only", default="", help="operation ids, with commas between")
    options = parser.parse_args(arguments)
    how = {"examples": options.examples, "sequences": options.sequences, "seed": options.seed}
    how["limits"] = not options.without_limits
    print(f"The API against its document: {options.examples} examples of each operation, seed {options.seed}")
    began = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        only = [one for one in options.only.split(",") if one]
        outcome = against_service(Path(folder), only=only, told=True, **how)
    report(outcome, examples=options.examples, seconds=time.monotonic() - began)
    if outcome.failures or outcome.errors:
        raise SystemExit(1)


if __name__ == "__main__":
    main()
