"""Identifications that a service computes in an hour while it ingests a thousand samples a second, and where the time goes.

The jobs are there at the start: run-downs of 100 samples of 8 channels of the thesis's Chapter 3 train, 40 parameters each.
The service, its SQLite file, its two worker processes and the source share this machine's processors.

    python -m benchmarks.identifications_per_hour [--minutes 2] [--jobs 600] [--rate 1000]
"""

import argparse
import tempfile
import time
from pathlib import Path

import numpy as np
import psutil

from benchmarks.chain import Usage, create_machines, publishing, received
from estimator.fit.identification import Options
from estimator.identification.quality_gate import identify_gated
from estimator.updated_model.derived_quantities import derived_quantities
from service.configuration.settings import Settings
from storage.database.engine import Database
from storage.findings import identifications
from storage.machines import machines
from storage.measurements import runs
from storage.tables.findings import JobRow
from tests.end_to_end.processes import Service, until
from tests.identification import chapter_3, close_run, counts

ASKED = 10_000
MACHINES = 10
WARM_UP_JOBS = 5


def measure(folder: Path, options: argparse.Namespace) -> bool:
    """Print the figures; return whether as many came out as asked."""
    service = Service(folder)
    database = Database(service.database)
    train = chapter_3()
    with database.transaction() as session:
        machines.create(session, train)
    for number in range(options.jobs):
        close_run(database, train, seed=number, start_s=1_700_000_000 + 3600 * number)
    with service.running() as serving:
        names = create_machines(service, MACHINES)
        arguments = ["-m", "benchmarks.throughput", "--publish", ",".join(names), "--connect", service.endpoint]
        arguments += ["--folder", str(folder), "--rate", str(options.rate), "--channels", "8"]
        arguments += ["--seconds", str(60 * options.minutes + 120)]
        with publishing(*arguments) as source:
            until(lambda: received(service) > options.rate, within_s=60, what="samples come")
            until(lambda: counts(database).get("done", 0) >= WARM_UP_JOBS, within_s=120, what="identifications are computed")
            processes = {"service": psutil.Process(serving.pid), "source": psutil.Process(source.pid)}
            workers = [one for one in processes["service"].children(recursive=True) if "spawn_main" in " ".join(one.cmdline())]
            usage = Usage(processes | {f"worker {number}": one for number, one in enumerate(workers, start=1)})
            usage.begin()
            began, done, samples = time.perf_counter(), counts(database)["done"], received(service)
            while time.perf_counter() - began < 60 * options.minutes and counts(database).get("queued", 0):
                time.sleep(0.5)
            elapsed = time.perf_counter() - began
            finished, stored = counts(database)["done"] - done, received(service) - samples
            print(usage.text())
    service.client.close()
    rate = 3600 * finished / elapsed
    beside = f"beside {stored / elapsed:.0f} samples/s"
    print(f"{finished} identifications in {elapsed:.0f} s {beside}: {rate:.0f} an hour; asked: {ASKED}")
    parts(database)
    database.close()
    return rate >= ASKED


def parts(database: Database, *, most: int = 10) -> None:
    """Compute some of the jobs again, here and alone, and say what of it takes how long."""
    train = chapter_3()
    fitting, deriving, starts = [], [], []
    with database.reading() as session:
        first = identifications.first_of(session, train.id, revision=1, slow_roll_version=None)
        beginning = None if first is None or first.point is None else np.frombuffer(first.point, "<f8")
        for row in session.query(JobRow).filter_by(state="done").order_by(JobRow.id).limit(most):
            held = runs.samples(session, row.run_ids[0])
            assert held is not None
            began = time.process_time()
            run, rules = held.recorded(train.channels), train.quality
            one = identify_gated(train, [run], [held.measurement()], options=Options(), rules=rules, beginning=beginning)
            fitting.append(time.process_time() - began)
            assert one.identification is not None
            starts.append(one.identification.starts)
            began = time.process_time()
            derived_quantities(train, one.identification, [], direction=1)
            deriving.append(time.process_time() - began)
        stored = len(identifications.of_machine(session, train.id))
    count = len(fitting)
    print(
        f"  of {stored} stored, {count} again alone: judged and fitted in {sum(fitting) / count:.2f} s of processor time "
        f"({sum(starts) / count:.1f} starts), what follows derived in {sum(deriving) / count:.2f} s; "
        f"{Settings().workers} workers"
    )


def main() -> None:
    """Print the figures; status 1 when fewer came out than asked."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--minutes", type=float, default=2.0)
    parser.add_argument("--jobs", type=int, default=600)
    parser.add_argument("--rate", type=float, default=1000.0, help="samples per second of all machines together")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        if not measure(Path(folder), options):
            raise SystemExit(1)


if __name__ == "__main__":
    main()
