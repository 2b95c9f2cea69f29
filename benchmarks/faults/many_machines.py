"""Ten thousand machines registered, two hundred of them running down at once at 10 samples a second: memory, and nothing lost.

python -m benchmarks.faults.many_machines [--machines 10000] [--running 200] [--seconds 60] [--rate 10]
"""

import argparse
import threading
import time
from pathlib import Path

import numpy as np
import psutil

from benchmarks.chain import Ledger, StoredSamples, Usage, patiently, percentiles, publish_or_measure, publishing, received
from estimator.machine.document import parse_machine
from formats.wire import Key
from service.messaging.session import session, wait_connected
from service.sources.publisher import Source
from storage.database.engine import Database
from storage.machines import machines
from storage.measurements import runs
from storage.tables.measurements import RunRow
from tests.end_to_end.processes import Service, example, until
from tests.end_to_end.test_real_input import ross_batch

NAME = "thesis-chapter-3"
PLANT = "examples"
SIZE = 5
"""Samples in a message."""
LARGEST_MEMORY_MB = 1024.0
LINGER_S = 30.0


def publishing_process(options: argparse.Namespace) -> None:
    """Publish from all sources on one session, each with a log, in one thread; every machine runs down over the whole time."""
    names = [f"m{number:05d}" for number in range(options.running)]
    count = round(options.seconds * options.rate) // SIZE * SIZE
    speeds = np.linspace(5900.0, 200.0, count)
    with session(listen=[], connect=[options.connect]) as stream:
        wait_connected(stream, [options.connect], give_up=patiently)
        sources = [Source(stream, Key(PLANT, name), name="edge") for name in names]
        batches = [ross_batch(seed=0, start_s=0) for _ in names]
        for batch, name in zip(batches, names, strict=True):
            batch.machine, batch.speed_unit = name, "rpm"
            batch.amplitude, batch.phase = batch.amplitude[:SIZE], batch.phase[:SIZE]
        start = time.time() + 1.0
        for first in range(0, count, SIZE):
            for place, (source, batch) in enumerate(zip(sources, batches, strict=True)):
                due = start + (first + SIZE * (1 + place / len(names))) / options.rate
                time.sleep(max(0.0, due - time.time()))
                batch.time_ns = [int(1e9 * (due + (k - SIZE) / options.rate)) for k in range(1, SIZE + 1)]
                batch.speed = speeds[first : first + SIZE].tolist()
                source.publish(batch)
        time.sleep(LINGER_S)  # to answer replay queries
        for source in sources:
            source.close()


def measure(folder: Path, options: argparse.Namespace) -> bool:
    """Print the figures; return whether they are as asked."""
    service = Service(folder, RUNDOWN_SILENCE_S="60")
    database = Database(service.database)
    body = example(NAME)
    with database.transaction() as opened:
        for number in range(options.machines):
            machines.create(opened, parse_machine(body | {"id": f"m{number:05d}"}))
    count = round(options.seconds * options.rate) // SIZE * SIZE
    total = count * options.running
    ledger = Ledger(service.database)
    began = time.perf_counter()
    with service.running() as serving, ledger.watching():
        print(f"ready after {time.perf_counter() - began:.1f} s with {options.machines} machines")
        process = psutil.Process(serving.pid)
        largest, most, over = [0.0], [0], threading.Event()

        def watch() -> None:
            while not over.wait(1.0):
                family = [process, *process.children(recursive=True)]
                largest[0] = max(largest[0], sum(one.memory_info().rss for one in family) / 2**20)
                with database.reading() as reading:
                    most[0] = max(most[0], reading.query(RunRow).filter_by(state=runs.OPEN).count())

        watching = threading.Thread(target=watch)
        watching.start()
        arguments = ["-m", "benchmarks.faults.many_machines", "--publish", "--connect", service.endpoint]
        arguments += ["--running", str(options.running), "--rate", str(options.rate), "--seconds", str(options.seconds)]
        with publishing(*arguments) as source:
            usage = Usage({"service": process, "source": psutil.Process(source.pid)})
            usage.begin()
            time.sleep(options.seconds)
            used = usage.text()
            until(lambda: received(service) >= total, within_s=LINGER_S + 90.0, what=f"{total} samples stored")
        over.set()
        watching.join()
        time.sleep(0.5)
    service.client.close()
    database.close()
    samples = StoredSamples.read(service.database, ledger)
    lost, twice = samples.faults([f"m{number:05d}" for number in range(options.running)], samples=count)
    print(f"{options.running} machines running down at {options.rate:g} samples/s of 8 channels for {options.seconds:.0f} s")
    print(f"  runs open at once, at most: {most[0]}; lost {lost}, twice or out of order {twice}; asked: 0 and 0")
    print(f"  sample taken to durable: {percentiles(samples.latency)}")
    print(f"  memory of the service and its workers, at most: {largest[0]:.0f} MiB; asked: {LARGEST_MEMORY_MB:.0f} MiB")
    print(used)
    return lost == twice == 0 and largest[0] < LARGEST_MEMORY_MB and most[0] >= options.running


def main() -> None:
    """Print the figures; status 1 when one is not as asked."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--machines", type=int, default=10_000)
    parser.add_argument("--running", type=int, default=200)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--rate", type=float, default=10.0, help="samples per second of each machine")
    parser.add_argument("--publish", action="store_true", help=argparse.SUPPRESS)
    parser.add_argument("--connect", help=argparse.SUPPRESS)
    options = parser.parse_args()
    publish_or_measure(options, publishing_process, measure)


if __name__ == "__main__":
    main()
