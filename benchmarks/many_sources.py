"""Many sources, each with a session and a log of its own, on many machines, and a service that is killed -9 meanwhile.

Each source publishes single samples at a steady rate. In the end the service must have stored every sample of every source
once and in order, with the times at which they were taken. The latency of samples that were taken while the service was dead
includes its absence.

    python -m benchmarks.many_sources [--sources 500] [--rate 2] [--seconds 60] [--kills 2]
"""

import argparse
import contextlib
import subprocess
import time
from pathlib import Path

import msgspec
import numpy as np
import psutil

from benchmarks.chain import (
    PLANT,
    Ledger,
    StoredSamples,
    Usage,
    create_machines,
    patiently,
    percentiles,
    publish_or_measure,
    publishing,
    received,
)
from benchmarks.throughput import template
from formats.wire import Key
from service.messaging.session import session, wait_connected
from service.sources.publisher import Source
from tests.end_to_end.processes import Service, until

PROCESSES = 4
AWAY_S = 3.0
"""Pause of the service after each kill, besides its start."""
LINGER_S = 300.0
"""Time for which sources answer replay queries after their last sample."""
PATIENCE_S = 240.0
"""Longest time that the last samples may take to be stored."""


def publishing_process(options: argparse.Namespace) -> None:
    """Publish from some of the sources, each with a session of its own, in one thread that takes them in turn."""
    machines = options.publish.split(",")
    sessions = [session(listen=[], connect=[options.connect]) for _ in machines]
    streams = [one.__enter__() for one in sessions]
    for stream in streams:
        wait_connected(stream, [options.connect], give_up=patiently)
    sources = [Source(stream, Key(PLANT, name), name="edge") for stream, name in zip(streams, machines, strict=True)]
    batches = [template(name, 1, 8) for name in machines]
    count = round(options.seconds * options.rate)
    times: list[list[int]] = [[] for _ in machines]
    Path(options.truth + ".ready").touch()
    while not Path(options.begin).exists():
        time.sleep(0.05)
    start = time.time() + 0.5
    for number in range(count):
        for place, (source, batch) in enumerate(zip(sources, batches, strict=True)):
            time.sleep(max(0.0, start + (number + place / len(machines)) / options.rate - time.time()))
            batch.time_ns = [time.time_ns()]
            source.publish(batch)
            times[place] += batch.time_ns
    Path(options.truth).write_bytes(msgspec.json.encode(dict(zip(machines, times, strict=True))))
    time.sleep(LINGER_S)
    for source in sources:
        source.close()
    for one in sessions:
        one.__exit__(None, None, None)


def measure(folder: Path, options: argparse.Namespace) -> bool:
    """Run the sources and kill the service; print the figures; return whether the samples are stored exactly."""
    service = Service(folder)
    each = round(options.seconds * options.rate)
    total = each * options.sources
    ledger = Ledger(service.database)
    truths = [folder / f"truth-{i}.json" for i in range(PROCESSES)]
    common = ["-m", "benchmarks.many_sources", "--connect", service.endpoint]
    begin = folder / "begin"
    common += ["--begin", str(begin), "--rate", str(options.rate), "--seconds", str(options.seconds)]
    with contextlib.ExitStack() as around:
        with service.running() as serving:
            began = time.perf_counter()
            machines = create_machines(service, options.sources)
            print(f"{options.sources} machines created in {time.perf_counter() - began:.1f} s")
            around.enter_context(ledger.watching())
            for i, truth in enumerate(truths):
                part = ",".join(machines[i::PROCESSES])
                around.enter_context(publishing(*common, "--publish", part, "--truth", str(truth)))
            ready = [Path(f"{truth}.ready") for truth in truths]
            until(lambda: all(path.exists() for path in ready), within_s=120, what="all sources are connected")
            begin.touch()
            stretch(service, serving, options)
            serving.kill()
        for kill in range(options.kills):
            time.sleep(AWAY_S)
            with service.running() as serving:
                stretch(service, serving, options)
                if kill < options.kills - 1:
                    serving.kill()
                    continue
                ended = time.perf_counter()
                until(lambda: received(service) >= total, within_s=PATIENCE_S, what=f"{total} samples stored")
                print(f"the last samples were stored {time.perf_counter() - ended:.1f} s after the end of publishing")
                time.sleep(0.5)
    service.client.close()
    samples = StoredSamples.read(service.database, ledger)
    taken: dict[str, list[int]] = {}
    for path in truths:
        taken |= msgspec.json.decode(path.read_bytes(), type=dict[str, list[int]])
    lost, twice = samples.faults(machines, samples=each)
    wrong = sum(not np.array_equal(samples.times.get(name, np.empty(0)), np.array(taken[name])) for name in machines)
    print(f"{options.sources} sources at {options.rate:g} samples/s for {options.seconds:.0f} s, {options.kills} kills")
    print(f"  published {total}, stored {samples.latency.size}")
    print(f"  lost {lost}, twice or out of order {twice}, machines with other samples than measured {wrong}; asked: 0")
    print(f"  sample taken to durable, the service's absence in it: {percentiles(samples.latency)}")
    return lost == twice == wrong == 0


def stretch(service: Service, serving: "subprocess.Popen[bytes]", options: argparse.Namespace) -> None:
    """Let it run for its part of the time and say what it used."""
    usage = Usage({"service": psutil.Process(serving.pid)})
    usage.begin()
    before, began = received(service), time.perf_counter()
    time.sleep(options.seconds / (options.kills + 1))
    rate = (received(service) - before) / (time.perf_counter() - began)
    print(f"{usage.text()}, {rate:.0f} samples/s stored")


def main() -> None:
    """Print the figures; status 1 when the samples are not stored exactly."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--sources", type=int, default=500)
    parser.add_argument("--rate", type=float, default=2.0)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--kills", type=int, choices=range(1, 10), default=2)
    for name in ("--publish", "--connect", "--truth", "--begin"):
        parser.add_argument(name, help=argparse.SUPPRESS)
    options = parser.parse_args()
    publish_or_measure(options, publishing_process, measure)


if __name__ == "__main__":
    main()
