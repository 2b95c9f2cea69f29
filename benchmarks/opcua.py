"""OPC UA: values and alarms behind the database, 1,000 monitored items at once, and what a service without it pays.

A real server over SQLite in a process of its own, and the library's client in this one. Prints asked beside measured, and ends
with status 1 where one falls short.
"""

import argparse
import asyncio
import contextlib
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import psutil
from asyncua import Client, ua

from benchmarks import unconfigured_protocols
from service.alerts import transitions
from service.alerts.transitions import AlertFinding
from storage.alerts import alerts
from storage.database.engine import Database
from storage.machines import machines
from tests.plant import SECOND, START, identification, machine, store_identification
from tests.ports import free_port

MACHINES = 24
"""Of 43 parameters each: more than a thousand values."""
ITEMS = 1_000
ASKED_VALUES_S, ASKED_EVENT_S = 1.0, 1.0
PATIENCE_S = 60.0

SERVING = """
import sys, time
from service.configuration.settings import Settings
from service.opcua.serving import OPENING, OpcUaServing
from storage.database.engine import Database
serving = OpcUaServing(Database(sys.argv[1]), Settings(opcua_listen=sys.argv[2], opcua_allow_unencrypted=True))
serving.start()
while not serving.ready:
    assert serving.trouble in (None, OPENING), serving.trouble
    time.sleep(0.1)
print("ready", flush=True)
sys.stdin.read()
serving.stop()
"""


class Heard:
    """Arrivals of values and events at the client [s, wall clock]."""

    def __init__(self) -> None:
        self.values: list[tuple[str, float, float]] = []
        self.events: list[tuple[Any, float]] = []

    def datachange_notification(self, node: Any, value: Any, data: Any) -> None:
        """Note a value."""
        del data
        self.values.append((node.nodeid.Identifier, value, time.time()))

    def event_notification(self, event: Any) -> None:
        """Note an event."""
        self.events.append((event, time.time()))


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure, print, and end with status 1 where a figure falls short."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.opcua", description=__doc__)
    parser.add_argument("--rounds", type=int, default=20, help="runs identified of every watched machine, one after the other")
    rounds = parser.parse_args(arguments).rounds
    with tempfile.TemporaryDirectory() as folder:
        database = Database(f"sqlite:///{folder}/rundown.db")
        alert = fill(database)
        endpoint = f"opc.tcp://127.0.0.1:{free_port()}"
        with serving(database.url, endpoint) as process:
            values, at_once, acknowledged = asyncio.run(measure(endpoint, database, alert, rounds))
            memory = psutil.Process(process.pid).memory_info().rss / 2**20
        database.close()
    ok = report(values, at_once, acknowledged, memory)
    ok &= unconfigured_protocols.report(unconfigured_protocols.measured(rounds=2))
    if not ok:
        sys.exit(1)


def report(values: list[float], at_once: int, acknowledged: list[float], memory: float) -> bool:
    """Print asked beside measured; return whether all is within."""
    p99, slowest = float(np.quantile(values, 0.99)), max(acknowledged)
    rows = [
        ("value behind the database, p99 [s]", ASKED_VALUES_S, p99, p99 <= ASKED_VALUES_S),
        ("monitored items at once", ITEMS, at_once, at_once >= ITEMS),
        ("acknowledged by a client until its event, slowest [s]", ASKED_EVENT_S, slowest, slowest <= ASKED_EVENT_S),
    ]
    print(f"OPC UA: {MACHINES} machines, {len(values)} values told, {len(acknowledged)} acknowledgements")
    for what, asked, measured, within in rows:
        print(f"{what:56s} asked {asked:8g}  measured {measured:8.3f}  {'ok' if within else 'SHORT'}")
    print(f"acknowledgements, each [s]: {', '.join(f'{one:.2f}' for one in acknowledged)}")
    print(f"memory of the process with it: {memory:.0f} MB")
    return all(within for *_, within in rows)


def fill(database: Database) -> int:
    """Store machines with a run each, and an alert of the first; its id."""
    number = 0
    with database.transaction() as session:
        for place in range(MACHINES):
            document = machine(id=f"pump-{place:02d}")
            machines.create(session, document)
            row = store_identification(session, identification(), run_id=place + 1, machine_id=document.id)
            if place == 0:
                finding = AlertFinding({}, row.id, START)
                alert = transitions.raise_alert(session, document.id, rule="misfit", element="coupling.C1", finding=finding)
                number = alert.id
    return number


async def measure(endpoint: str, database: Database, alert: int, rounds: int) -> tuple[list[float], int, list[float]]:
    """Return delays of values [s], items that were watched at once, delays of acknowledgements' events [s]."""
    heard = Heard()
    async with Client(endpoint, timeout=60, watchdog_intervall=60) as client:
        nodes = (await watched(client))[:ITEMS]
        subscription = await client.create_subscription(100, heard)
        handles = await subscription.subscribe_data_change(nodes)
        at_once = sum(isinstance(one, int) for one in handles)
        await until(lambda: len(heard.values) >= at_once, "every item has told its first value")
        delays = []
        for number in range(rounds):
            delays += await told(database, heard, 1.0 + 0.01 * (number + 1), number)
        acknowledged = [await acknowledge(client, subscription, heard, database, alert) for _ in range(5)]
        return delays, at_once, acknowledged


async def watched(client: Client) -> list[Any]:
    """Return the variables of all parameters."""
    found = []
    for place in range(MACHINES):
        folder = client.get_node(f"ns=2;s=plant-1/pump-{place:02d}/Parameters")
        found += await folder.get_children()
    return found


async def told(database: Database, heard: Heard, factor: float, number: int) -> list[float]:
    """Identify a run of every machine, a few at once; return how long after its commit each value came."""
    delays: list[float] = []
    for first in range(0, MACHINES, 4):
        heard.values.clear()
        # Beside the client's event loop: it must not wait for the disk.
        committed = await asyncio.to_thread(identify, database, range(first, first + 4), factor, number)
        # Those of the last machine are beyond the watched thousand.
        wanted = {f"plant-1/pump-{place:02d}/Parameters/bearing.B1.kxx" for place in range(first, min(first + 4, 20))}
        await until(partial(have_come, heard, wanted), f"values of run {number} have come")
        delays += [at - committed for name, _, at in heard.values]
    return delays


def call_again(database: Database, alert: int) -> None:
    """Let an alert call again that somebody has acknowledged: what was shelved does."""
    with database.transaction() as session:
        row = alerts.get(session, alert, to_change=True)
        if row.condition == "acknowledged":
            person = transitions.Person("benchmark")
            transitions.shelve(session, row, person, until=time.time_ns() + 3_600 * SECOND)
            transitions.unshelve(session, row, person)


def identify(database: Database, places: Sequence[int], factor: float, number: int) -> float:
    """Store a run's identification of each of some machines; return when that was committed [s]."""
    with database.transaction() as session:
        for place in places:
            store_identification(
                session,
                identification({"coupling.C1.kxx": factor, "bearing.B1.kxx": factor}),
                run_id=1000 * (number + 1) + place,
                measured_at=START + (number + 1) * SECOND,
                machine_id=f"pump-{place:02d}",
            )
    return time.time()


def have_come(heard: Heard, wanted: set[str]) -> bool:
    """Return whether each of some nodes has told a value."""
    return wanted <= {name for name, *_ in heard.values}


async def acknowledge(client: Client, subscription: Any, heard: Heard, database: Database, alert: int) -> float:
    """Acknowledge as a client does; return the time until its event comes [s]."""
    condition = client.get_node("ns=2;s=plant-1/pump-00/Alerts/misfit coupling.C1")
    if not heard.events:
        await subscription.subscribe_events(
            ua.ObjectIds.Server, ua.ObjectIds.AlarmConditionType, where_clause_generation=False
        )
    await asyncio.to_thread(call_again, database, alert)
    acked = await condition.get_child(["0:AckedState", "0:Id"])
    while await acked.read_value():
        await asyncio.sleep(0.05)
    event = await (await condition.get_child("0:EventId")).read_value()
    before = len(heard.events)
    began = time.time()
    comment = ua.Variant(ua.LocalizedText("benchmark"), ua.VariantType.LocalizedText)
    method = client.get_node(ua.NodeId(ua.ObjectIds.AcknowledgeableConditionType_Acknowledge))
    await condition.call_method(method, ua.Variant(event, ua.VariantType.ByteString), comment)
    await until(
        lambda: any(getattr(one, "AckedState/Id", False) for one, _ in heard.events[before:]),
        "the acknowledgement's event came",
    )
    return next(at for one, at in heard.events[before:] if getattr(one, "AckedState/Id", False)) - began


async def until(holds: Any, what: str) -> None:
    """Wait until something holds. what: it, in words."""
    deadline = time.monotonic() + PATIENCE_S
    while not holds():
        if time.monotonic() > deadline:
            raise SystemExit(f"still not so after {PATIENCE_S:g} s: {what}")
        await asyncio.sleep(0.01)


@contextlib.contextmanager
def serving(url: str, endpoint: str) -> Iterator["subprocess.Popen[str]"]:
    """Yield the process of a server."""
    command = [sys.executable, "-c", SERVING, url, endpoint]
    process = subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, cwd=Path(__file__).parents[1]
    )
    assert process.stdout is not None
    try:
        if process.stdout.readline().strip() != "ready":
            raise SystemExit("the server did not start")
        yield process
    finally:
        process.terminate()
        process.wait()


if __name__ == "__main__":
    main()
