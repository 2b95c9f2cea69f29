"""Latency of the REST API beside that of another checkout, such as the last release's, on the same machine at the same time.

Both services run, each over a store that its own `benchmarks.api_latency` filled, and are asked in turns, a figure at a time:
a machine that changes its speed makes no ratio. Prints medians of both and of the ratios; status 1 where the median latency or
the processor time of a figure is more than a tenth worse.

    python -m benchmarks.api_against CHECKOUT [--rounds 12] [--requests 400] [--clients 8]
"""

import argparse
import contextlib
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import httpx
import numpy as np
import psutil

from benchmarks.api_latency import figures
from benchmarks.chain import processor_s
from benchmarks.closed_loop import latencies
from tests.end_to_end.processes import until
from tests.ports import free_port

HERE = Path(__file__).parent.parent
WORSE = 1.1
"""Largest ratio of a median latency, and of a processor time, to the other checkout's [-]."""
FILL = """
import sys
from pathlib import Path
from benchmarks.api_latency import fill
fill(Path(sys.argv[1]), seed=int(sys.argv[2]))
"""


@dataclass(frozen=True)
class RunningCheckout:
    """A service that runs from a checkout. base: address of its API."""

    process: psutil.Process
    base: str

    def measured(self, paths: list[str], *, clients: int, requests: int) -> tuple[float, float, float]:
        """Return the median and the p99 of the latency and the processor time of a request, all in ms."""
        before = processor_s(self.process)
        found = latencies(self.base, paths, clients=clients, requests=requests)
        processor = (processor_s(self.process) - before) / len(found)
        return 1e3 * float(np.median(found)), 1e3 * float(np.percentile(found, 99)), 1e3 * processor


@contextlib.contextmanager
def running(checkout: Path, *, seed: int) -> Iterator[RunningCheckout]:
    """Run the service of a checkout over a store that it fills. Raises subprocess.CalledProcessError, AssertionError."""
    environment = os.environ | {"PYTHONPATH": str(checkout)}
    with tempfile.TemporaryDirectory() as folder:
        store = Path(folder) / "rundown.db"
        subprocess.run([sys.executable, "-c", FILL, str(store), str(seed)], check=True, cwd=folder, env=environment)
        port = free_port()
        given = ["--database", f"sqlite:///{store}", "--port", str(port), "--zenoh-listen", f"tcp/127.0.0.1:{free_port()}"]
        with (Path(folder) / "serve.log").open("w") as log:
            started = subprocess.Popen(
                [sys.executable, "-m", "service", "serve", *given], cwd=folder, env=environment, stdout=log, stderr=log
            )
            try:
                base = f"http://127.0.0.1:{port}/api/v1"
                until(lambda: _ready(base), within_s=60, what=f"the service of {checkout} is ready")
                yield RunningCheckout(psutil.Process(started.pid), base)
            finally:
                started.terminate()
                started.wait(30)


def _ready(base: str) -> bool:
    try:
        return httpx.get(f"{base}/ready", timeout=5).is_success
    except httpx.TransportError:
        return False


def compare(other: RunningCheckout, this: RunningCheckout, options: argparse.Namespace) -> bool:
    """Ask both in turns and print the figures; return whether none is worse than allowed."""
    kept = True
    print(f"{options.clients} clients, {options.requests} requests, medians of {options.rounds} rounds, seed {options.seed}")
    print(f"  {'':46}{'p50 there, here [ms]':>22}{'processor [ms]':>18}   here over there: p50, p99, processor")
    for figure in figures(options.requests):
        found = []
        for number in range(options.rounds):
            pair = [other, this][:: 1 if number % 2 else -1]
            asked = {id(one): one.measured(figure.paths, clients=options.clients, requests=options.requests) for one in pair}
            found.append([asked[id(other)], asked[id(this)]])
        rounds = np.array(found)
        (there, _, work_there), (here, _, work_here) = np.median(rounds, axis=0)
        p50, p99, work = np.median(rounds[:, 1] / rounds[:, 0], axis=0)
        good = max(p50, work) <= WORSE
        kept &= good
        row = f"  {figure.name:46}{there:11.2f}{here:11.2f}{work_there:9.2f}{work_here:9.2f}"
        print(f"{row}   {p50:17.2f}{p99:5.2f}{work:6.2f}{'' if good else '  WORSE'}", flush=True)
    return kept


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the figures; status 1 where one is more than a tenth worse than the other checkout's."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.api_against", description=(__doc__ or "").split("\n")[0])
    parser.add_argument("checkout", type=Path, help="folder of the other checkout")
    parser.add_argument("--rounds", type=int, default=12)
    parser.add_argument("--requests", type=int, default=400)
    parser.add_argument("--clients", type=int, default=8)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args(arguments)
    with running(options.checkout.resolve(), seed=options.seed) as other, running(HERE, seed=options.seed) as this:
        if not compare(other, this, options):
            raise SystemExit(1)


if __name__ == "__main__":
    main()
