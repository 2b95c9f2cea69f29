"""Latency of `/alive` while the service is attacked: each attack that the tests make on a service of its own.

Attacks whose tests need no running service (a revoked key restored, rows without bound, a damaged page) are held by those
tests; here are the ones beside which a supervisor asks whether the service is alive. One line each: whether the attack was
held, and how long answers took. Status 1 where a test failed or the bound is not kept.

    python -m benchmarks.faults.attacks [--long]
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from tests.end_to_end.alive import FOLDER
from tests.end_to_end.processes import ROOT

ALIVE_P99_S = 0.25
ATTACKS = {
    "documents as large as are let in": ["tests/faults/test_worst_documents.py"],
    "documents with thousands of problems": ["tests/faults/test_wrong_documents.py"],
    "own clock a year ahead and a year behind": ["tests/faults/test_service_clock.py"],
    "one impatient person: jobs and reads without end": ["tests/faults/test_one_impatient_person.py"],
    "one impatient person: valid requests that are dear": ["tests/faults/test_expensive_requests.py"],
    "two alike on one database: one frozen, one killed, a key revoked": ["tests/distribution/test_two_alike.py"],
    "more jobs than are taken, and workers stopped": ["tests/end_to_end/test_stopped_workers.py"],
    "the write-ahead log deleted or damaged, the file overwritten": ["tests/faults/test_deleted_logs.py"],
    "a database that does not answer": ["tests/faults/test_database_that_hangs.py"],
    "connections without end, half-open handshakes": ["tests/service/http/test_connections.py"],
    "messages of 64 MB": ["tests/faults/test_fuzz.py"],
    "bodies, files and settings that are wrong": ["tests/end_to_end/test_bad_input.py"],
    "clients that take nothing": ["tests/faults/test_stream_clients.py"],
}


def attacked(tests: list[str], *, long: bool) -> tuple[bool, list[float]]:
    """Run the tests of one attack; returns whether they passed, and how long `/alive` took beside them [s]."""
    with tempfile.TemporaryDirectory() as folder:
        chosen = [] if long else ["-m", "not long"]
        command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *chosen, *tests]
        done = subprocess.run(
            command, cwd=ROOT, env=os.environ | {FOLDER: folder}, capture_output=True, text=True, check=False
        )
        if done.returncode not in (0, 5):  # 5: all of its tests are long ones
            print(done.stdout)
        times = [one for file in Path(folder).glob("*.json") for one in json.loads(file.read_text())]
        return done.returncode in (0, 5), times


def main() -> None:
    """Print a line for each attack; status 1 when one is not held."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.faults.attacks", description=__doc__)
    parser.add_argument("--long", action="store_true", help="the tests that take minutes, too")
    long = parser.parse_args().long
    kept = True
    for attack, tests in ATTACKS.items():
        held, times = attacked(tests, long=long)
        if not times:
            print(f"{attack}: {'held' if held else 'NOT HELD'}; no running service was asked (--long?)")
            kept &= held
            continue
        alive = np.array(times)
        p99 = float(np.percentile(alive, 99))
        print(
            f"{attack}: {'held' if held else 'NOT HELD'}; /alive, {alive.size} times: median {1e3 * np.median(alive):.1f} ms, "
            f"p99 {1e3 * p99:.0f} ms, largest {1e3 * alive.max():.0f} ms; asked: p99 {1e3 * ALIVE_P99_S:.0f} ms",
            flush=True,
        )
        kept &= held and p99 <= ALIVE_P99_S
    if not kept:
        raise SystemExit(1)


if __name__ == "__main__":
    main()
