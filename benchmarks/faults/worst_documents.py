"""Fifty machines of the ten worst kinds of documents that are let in run down at once: does anybody's storing wait for them?

Each machine's samples come over HTTP, a batch a second. What is told of each is acknowledged samples that are not stored, the
longest transaction and the longest cycle of ingest, as the service's own metrics say it, and how long `/alive` took, asked
twenty times a second by a process of its own, while they run down, until all runs are closed, and for a while longer.

    python -m benchmarks.faults.worst_documents [--each 5] [--settle 125] [--linger 60] [--seed 0] [--repeats 3]
        [--database postgresql]

A machine does other things as well, and the longest of some thousand transactions is one of a kind: what is judged is the
median of the repeats, each with a service of its own. Samples may not be lost in any.
"""

import argparse
import contextlib
import os
import tempfile
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

import httpx
import numpy as np

from benchmarks.chain import received
from benchmarks.faults.large_documents import KINDS, largest
from estimator.machine.document import Machine, parse_machine
from formats.wire import JSON, SampleBatch, encode_body
from tests.databases import PostgresqlDatabases
from tests.end_to_end.alive import probing
from tests.end_to_end.processes import Service, until
from tests.postgresql import server

LONGEST_TRANSACTION_S, LONGEST_CYCLE_S, ALIVE_S = 0.1, 0.25, 0.25
BATCH = 10
"""Samples in a batch, a tenth of a second apart."""
SPEEDS = [*[3500.0] * 10, *np.linspace(3500.0, 310.0, 190).tolist(), *[250.0] * 20]
FIGURES = ("rundown_longest_transaction_seconds", "rundown_ingest_longest_cycle_seconds")
CLOSED_WITHIN_S = 120.0
CLIENT_NICENESS = 5
BEGAN_S = time.time()
"""Time of each machine's first sample."""


class Watch(threading.Thread):
    """The largest of the service's own figures, read each second."""

    def __init__(self, service: Service) -> None:
        super().__init__(daemon=True)
        self._url = f"http://127.0.0.1:{service.port}/metrics"
        self._over = threading.Event()
        self.largest = dict.fromkeys(FIGURES, 0.0)

    def run(self) -> None:
        """Read until stopped."""
        with httpx.Client(timeout=30.0) as client:
            while not self._over.wait(1.0):
                for line in client.get(self._url).text.splitlines():
                    name, _, value = line.partition(" ")
                    if name in self.largest:
                        self.largest[name] = max(self.largest[name], float(value))

    def stop(self) -> None:
        """Read no more."""
        self._over.set()
        self.join()


def send(url: str, machine: Machine, *, seed: int, pace_s: float = 1.0, batches: slice = slice(None)) -> int:
    """Run a machine down, a batch every pace_s [s]; returns how many samples were acknowledged. batches: not all of them."""
    # Clients are on other machines: here they come behind the service. Each thread of Linux has a priority of its own.
    os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), CLIENT_NICENESS)
    rng = np.random.default_rng(seed)
    channels = list(machine.channels)
    start, acknowledged = time.time(), 0
    with httpx.Client(timeout=60.0) as client:
        for number, first in enumerate(range(0, len(SPEEDS), BATCH)[batches]):
            speeds = SPEEDS[first : first + BATCH]
            shape = (len(speeds), len(channels))
            batch = SampleBatch(
                schema=1,
                plant=machine.plant,
                machine=machine.id,
                source="monitor",
                epoch=1,
                sequence=first,
                time_ns=[round(1e9 * (BEGAN_S + 0.1 * (first + place))) for place in range(len(speeds))],
                speed=speeds,
                speed_unit="rpm",
                direction="positive",
                channels=channels,
                amplitude_unit="um",
                amplitude_kind="peak-to-peak",
                phase_unit="deg",
                phase_convention="lag",
                amplitude=rng.uniform(5.0, 40.0, shape).tolist(),
                phase=rng.uniform(0.0, 360.0, shape).tolist(),
            )
            body = encode_body(batch, JSON)
            while True:
                answer = client.post(f"{url}/machines/{machine.id}/samples", content=body, headers={"content-type": JSON})
                if answer.status_code == 200:
                    acknowledged += answer.json()["received"] + answer.json()["duplicates"]
                    break
                if answer.status_code not in (429, 503):
                    raise RuntimeError(answer.text)
                time.sleep(0.2)
            time.sleep(max(0.0, start + pace_s * (number + 1) - time.time()))
    return acknowledged


@dataclass(frozen=True)
class Figures:
    """Measured figures of one service.

    Attributes:
        lost: Acknowledged samples that are not stored, of all that were acknowledged.
        acknowledged: Samples that were acknowledged.
        transaction_s: Longest transaction.
        cycle_s: Longest stretch in which ingest takes no message.
        alive_s: Largest of 99 % of the times that `/alive` took.
    """

    lost: int
    acknowledged: int
    transaction_s: float
    cycle_s: float
    alive_s: float


def measure(service: Service, options: argparse.Namespace) -> Figures:
    """Print and return the figures of one service."""
    documents = [largest(kind) | {"id": f"m{k}-{n}"} for k, kind in enumerate(KINDS) for n in range(options.each)]
    url = f"http://127.0.0.1:{service.port}/api/v1"
    with service.running():
        for document in documents:
            answer = service.client.post("/machines", json=document)
            assert answer.status_code == 201, answer.text
        # As machines do, they have run at speed before; what the service says of its longest is of the last two minutes.
        acknowledged = send_all(url, documents, seed=options.seed, batches=slice(None, 1))
        time.sleep(options.settle)
        watch = Watch(service)
        watch.start()
        with probing(url) as took:
            acknowledged += send_all(url, documents, seed=options.seed, batches=slice(1, None))
            began = time.monotonic()
            until(lambda: closed(service) >= len(documents), within_s=CLOSED_WITHIN_S, what="all runs are closed")
            closed_after = time.monotonic() - began
            time.sleep(options.linger)
        watch.stop()
        stored = received(service)
        states = service.get("/health")["jobs"]
    alive = np.array(took)
    transaction, cycle = (watch.largest[name] for name in FIGURES)
    figures = Figures(acknowledged - stored, acknowledged, transaction, cycle, float(np.percentile(alive, 99)))
    print(f"  acknowledged samples lost: {figures.lost} of {acknowledged}")
    print(f"  longest transaction: {1e3 * transaction:.0f} ms; longest stretch without a message: {1e3 * cycle:.0f} ms")
    print(
        f"  /alive, {alive.size} times: median {1e3 * np.median(alive):.1f} ms, p99 {1e3 * figures.alive_s:.0f} ms, "
        f"largest {1e3 * alive.max():.0f} ms"
    )
    print(f"  all runs closed {closed_after:.1f} s after the last sample; jobs meanwhile: {states}", flush=True)
    return figures


def judge(found: list[Figures]) -> bool:
    """Print the medians beside what is asked; return whether they are as asked."""
    lost = sum(one.lost for one in found)
    transaction = median(one.transaction_s for one in found)
    cycle = median(one.cycle_s for one in found)
    alive = median(one.alive_s for one in found)
    print(f"median of {len(found)}")
    print(f"  acknowledged samples lost, all together: {lost}; asked: 0")
    print(f"  longest transaction: {1e3 * transaction:.0f} ms; asked: {1e3 * LONGEST_TRANSACTION_S:.0f} ms")
    print(f"  longest stretch in which ingest takes no message: {1e3 * cycle:.0f} ms; asked: {1e3 * LONGEST_CYCLE_S:.0f} ms")
    print(f"  /alive, p99: {1e3 * alive:.0f} ms; asked: {1e3 * ALIVE_S:.0f} ms")
    return lost == 0 and transaction <= LONGEST_TRANSACTION_S and cycle <= LONGEST_CYCLE_S and alive <= ALIVE_S


def send_all(url: str, documents: list[dict[str, Any]], *, seed: int, **how: Any) -> int:
    """Run all machines down at once, as `send` does; returns how many samples were acknowledged."""
    machines = [parse_machine(document) for document in documents]
    with ThreadPoolExecutor(len(machines)) as pool:
        return sum(pool.map(lambda place: send(url, machines[place], seed=seed + place, **how), range(len(machines))))


def closed(service: Service) -> int:
    """Return the number of machines with a closed run."""
    found = 0
    for machine in service.get("/machines", limit=1000):
        states = [run["state"] for run in service.get(f"/machines/{machine['id']}/runs")]
        found += any(state in ("closed", "discarded") for state in states)
    return found


def main() -> None:
    """Print the figures; status 1 when one is not as asked."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.faults.worst_documents", description=__doc__)
    parser.add_argument("--each", type=int, default=5, help="machines of each kind")
    parser.add_argument("--linger", type=float, default=60.0, help="how long it is looked at after all runs are closed [s]")
    parser.add_argument("--settle", type=float, default=125.0, help="how long the machines are at speed before [s]")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--database", choices=["sqlite", "postgresql"], default="sqlite")
    options = parser.parse_args()
    print(f"{len(KINDS) * options.each} machines, {options.each} each of: {', '.join(KINDS)}; seed {options.seed}")
    found = []
    for _ in range(options.repeats):
        with tempfile.TemporaryDirectory() as folder, contextlib.ExitStack() as until_then:
            url = None
            if options.database == "postgresql":
                url = PostgresqlDatabases(until_then.enter_context(server())).new(Path(folder) / "worst")
            found.append(measure(Service(Path(folder), database=url, RUNDOWN_REQUESTS_PER_S="10000"), options))
    if not judge(found):
        raise SystemExit(1)


if __name__ == "__main__":
    main()
