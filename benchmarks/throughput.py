"""Samples of 16 channels from a source with a durable log by way of a router process to a service process and its database.

Every sample carries the moment at which it was taken, a batch is published when its last sample was taken, and a sample is
durable when another connection to the database sees it committed: the latency holds the batch's own filling, the
source's log, the router, the queue, the transaction and the reader's polling.

    python -m benchmarks.throughput [--seconds 60] [--rate 5000] [--machines 10] [--batch-ms 100]
        [--channels 16] [--database postgresql]
"""

import argparse
import contextlib
import tempfile
import threading
import time
from pathlib import Path

import msgspec
import numpy as np
import psutil
from sqlalchemy import make_url

from benchmarks.chain import (
    PLANT,
    Ledger,
    StoredSamples,
    Usage,
    create_machines,
    further,
    patiently,
    percentiles,
    publishing,
    received,
    router,
)
from formats.wire import ENCODINGS, Key, SampleBatch
from service.messaging.session import session, wait_connected
from service.sources.publisher import Source
from service.sources.sqlite_replay_log import SqliteReplayLog
from tests.end_to_end.processes import Service, until
from tests.end_to_end.test_real_input import ross_batch
from tests.faults.storage_faults import own_server
from tests.ports import free_port

P99_ASKED_S = 1.0
LONGEST_BATCH_MS = 100.0


def template(machine: str, size: int, channels: int) -> SampleBatch:
    """Return a batch of so many samples near one speed, in the units that monitors use, still without its times."""
    one = ross_batch(seed=0, start_s=0)
    rows = np.arange(size) % 300
    return msgspec.structs.replace(
        one,
        machine=machine,
        channels=[*one.channels, *map(further, one.channels)][:channels],
        amplitude_unit="um",
        phase_unit="deg",
        speed_unit="rpm",
        time_ns=[],
        speed=(3000.0 + 0.2 * np.sin(np.arange(size))).tolist(),
        amplitude=np.tile(1e6 * np.array(one.amplitude)[rows], 2)[:, :channels].tolist(),
        phase=np.tile(np.degrees(np.array(one.phase)[rows]), 2)[:, :channels].tolist(),
    )


def publish(
    source: Source, machine: str, *, rate: float, size: int, channels: int, batches: int, start: float, seed: int
) -> None:
    """Publish batches of `size` samples, each when its last sample was taken; the sources' phases are spread over a batch's
    time."""
    batch = template(machine, size, channels)
    begin = start + np.random.default_rng(seed).uniform(0.0, size / rate)
    for number in range(batches):
        first = begin + number * size / rate
        time.sleep(max(0.0, first + size / rate - time.time()))
        batch.time_ns = [int(1e9 * (first + i / rate)) for i in range(1, size + 1)]
        source.publish(batch)


def publishing_process(options: argparse.Namespace) -> None:
    """Publish from the sources, one thread each, in a process of their own."""
    with session(listen=[], connect=[options.connect]) as stream:
        wait_connected(stream, [options.connect], give_up=patiently)
        machines = options.publish.split(",")
        rate = options.rate / len(machines)
        size = max(1, round(rate * options.batch_ms / 1e3))
        batches = round(options.seconds * rate / size)
        start = time.time() + 1.0
        sources, threads = [], []
        for seed, machine in enumerate(machines):
            log = SqliteReplayLog(Path(options.folder) / f"{machine}.log", source=machine)
            source = Source(stream, Key(PLANT, machine), name="benchmark", encoding=options.encoding, log=log)
            how = {"rate": rate, "size": size, "batches": batches, "start": start, "seed": seed, "channels": options.channels}
            sources.append(source)
            threads.append(threading.Thread(target=publish, args=(source, machine), kwargs=how))
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        time.sleep(5.0)  # to answer replay queries
        for source in sources:
            source.close()


def measure(folder: Path, database: str, options: argparse.Namespace) -> bool:
    """Run the chain and print its figures; return whether all that was asked came out."""
    endpoint = f"tcp/127.0.0.1:{free_port()}"
    service = Service(folder, router=endpoint, database=database)
    rate = options.rate / options.machines
    size = max(1, round(rate * options.batch_ms / 1e3))
    each = size * round(options.seconds * rate / size)
    ledger = Ledger(database)
    with router(folder, endpoint) as routing, service.running() as serving:
        machines = create_machines(service, options.machines, channels=options.channels)
        arguments = ["-m", "benchmarks.throughput", "--publish", ",".join(machines), "--connect", endpoint]
        arguments += ["--folder", str(folder), "--rate", str(options.rate), "--seconds", str(options.seconds)]
        arguments += ["--batch-ms", str(options.batch_ms), "--encoding", options.encoding, "--channels", str(options.channels)]
        with ledger.watching(), publishing(*arguments) as sources:
            pids = {"source": sources.pid, "router": routing.pid, "service": serving.pid}
            usage = Usage({name: psutil.Process(pid) for name, pid in pids.items()})
            usage.begin()
            total = each * options.machines

            time.sleep(options.seconds)
            used = usage.text()
            until(
                lambda: received(service) >= total or sources.poll() is not None, within_s=60, what=f"{total} samples stored"
            )
            time.sleep(0.5)
        told = service.get("/sources")
        rejected = service.get("/quarantine")
        assert rejected["counts"] == {}, rejected["entries"][0]
    service.client.close()
    samples = StoredSamples.read(database, ledger)
    lost, twice = samples.faults(machines, samples=each)
    p99 = float(np.percentile(samples.latency, 99))
    print(
        f"{options.rate:.0f} samples/s of {options.channels} channels to {make_url(database).get_backend_name()} "
        f"for {options.seconds:.0f} s: {options.machines} machines, "
        f"batches of {size} samples ({1e3 * size / rate:.0f} ms), {options.encoding}"
    )
    print(f"  published {total}, stored {samples.latency.size}; asked: all")
    print(f"  lost {lost}, twice or out of order {twice}; asked: 0 and 0")
    print(f"  came again and were not stored again: {sum(one['duplicates'] for one in told)}")
    print(f"  sample taken to durable: {percentiles(samples.latency)}; asked: p99 below {P99_ASKED_S} s")
    print(used)
    return lost == twice == 0 and samples.latency.size == total and p99 < P99_ASKED_S


def main() -> None:
    """Print the figures; status 1 when one is not as asked."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--rate", type=float, default=5000.0, help="samples per second of all machines together")
    parser.add_argument("--machines", type=int, default=10)
    parser.add_argument("--batch-ms", type=float, default=LONGEST_BATCH_MS)
    parser.add_argument("--encoding", choices=ENCODINGS, default=ENCODINGS[0])
    parser.add_argument("--channels", type=int, choices=(8, 16), default=16)
    parser.add_argument(
        "--database", default="sqlite", help="sqlite, postgresql (a server of its own), or the URL of an empty one"
    )
    parser.add_argument("--publish", help=argparse.SUPPRESS)
    parser.add_argument("--connect", help=argparse.SUPPRESS)
    parser.add_argument("--folder", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.batch_ms > LONGEST_BATCH_MS:
        parser.error(f"a batch may fill for {LONGEST_BATCH_MS:.0f} ms at most")
    if options.publish:
        publishing_process(options)
        return
    with contextlib.ExitStack() as around:
        folder = Path(around.enter_context(tempfile.TemporaryDirectory()))
        database = options.database
        if database == "sqlite":
            database = f"sqlite:///{folder / 'rundown.db'}"
        elif database == "postgresql":
            _, database = around.enter_context(own_server())
        if not measure(folder, database, options):
            raise SystemExit(1)


if __name__ == "__main__":
    main()
