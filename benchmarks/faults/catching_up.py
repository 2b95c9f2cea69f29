"""A service that was away: every source has gone on, and holds in its log what was never received. Memory, time, nothing lost.

python -m benchmarks.faults.catching_up [--sources 200] [--batches 500] [--size 10] [--channels 16]
"""

import argparse
import threading
import time
from pathlib import Path

import psutil

from benchmarks.chain import PLANT, StoredSamples, create_machines, patiently, publish_or_measure, publishing, received
from benchmarks.throughput import template
from formats.wire import Key
from service.messaging.session import session, wait_connected
from service.sources.publisher import Source
from tests.end_to_end.processes import Service, until

LARGEST_MEMORY_MB = 1024.0
STEP_NS = 100_000_000
"""Between samples: 10 a second."""
FILLED_WITHIN_S = 300.0
LINGER_S = 3600.0


def publishing_process(options: argparse.Namespace) -> None:
    """Publish from all sources on one session, their logs filled before anybody listens."""
    with session(listen=[], connect=[options.connect]) as stream:
        start = time.time_ns() - options.batches * options.size * STEP_NS
        sources = [Source(stream, Key(PLANT, name), name="edge") for name in options.publish.split(",")]
        for source in sources:
            batch = template(source.key.machine, options.size, options.channels)
            for number in range(options.batches):
                first = start + number * options.size * STEP_NS
                batch.time_ns = list(range(first, first + options.size * STEP_NS, STEP_NS))
                source.publish(batch)
        Path(options.ready).touch()
        wait_connected(stream, [options.connect], give_up=patiently)
        time.sleep(LINGER_S)  # to answer replay queries


def measure(folder: Path, options: argparse.Namespace) -> bool:
    """Print the figures; return whether they are as asked."""
    service = Service(folder)
    with service.running():
        machines = create_machines(service, options.sources, channels=options.channels)
    each = options.batches * options.size
    total, ready = each * options.sources, folder / "ready"
    arguments = ["-m", "benchmarks.faults.catching_up", "--publish", ",".join(machines), "--connect", service.endpoint]
    arguments += ["--ready", str(ready), "--batches", str(options.batches), "--size", str(options.size)]
    with publishing(*arguments, "--channels", str(options.channels)):
        until(ready.exists, within_s=FILLED_WITHIN_S, what="the logs are filled")
        with service.running() as serving:
            began, over = time.perf_counter(), threading.Event()
            process, largest = psutil.Process(serving.pid), [0.0]

            def watch() -> None:
                while not over.wait(0.2):
                    largest[0] = max(largest[0], process.memory_info().rss / 2**20)

            watching = threading.Thread(target=watch)
            watching.start()
            until(lambda: received(service) >= total, within_s=30.0 + total / 1000.0, what=f"{total} samples are stored")
            lasted = time.perf_counter() - began
            over.set()
            watching.join()
    service.client.close()
    lost, twice = StoredSamples.read(service.database).faults(machines, samples=each)
    print(f"{options.sources} sources, each with {options.batches} messages of {options.size} samples in its log")
    print(f"  {total} samples of {options.channels} channels stored in {lasted:.0f} s, {total / lasted:.0f} a second")
    print(f"  lost {lost}, twice or out of order {twice}; asked: 0 and 0")
    print(f"  memory of the service, at most: {largest[0]:.0f} MiB; asked: {LARGEST_MEMORY_MB:.0f} MiB")
    return lost == twice == 0 and largest[0] < LARGEST_MEMORY_MB


def main() -> None:
    """Print the figures; status 1 when one is not as asked."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--sources", type=int, default=200)
    parser.add_argument("--batches", type=int, default=500, help="in each log")
    parser.add_argument("--size", type=int, default=10, help="samples in a message")
    parser.add_argument("--channels", type=int, choices=(8, 16), default=16)
    for name in ("--publish", "--connect", "--ready"):
        parser.add_argument(name, help=argparse.SUPPRESS)
    options = parser.parse_args()
    publish_or_measure(options, publishing_process, measure)


if __name__ == "__main__":
    main()
