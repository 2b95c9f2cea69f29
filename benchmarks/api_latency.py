"""Latency of the REST API of a service process, one worker, asked by eight clients at once, each as soon as it is answered.

The store holds a thousand machines, each with a run that is being collected, one with an identification a week for five years,
one with 2,000, and two thousand alerts.

Each figure is the median of some rounds: a p99 is made by few requests, and one of the machine's hiccups makes all of them.
In each round the same is asked without and then with samples coming in, so that a machine that changes its speed over minutes
makes no ratio. Judged is each p99 over that of `/alive` in the same round: what slows the whole machine slows both. Figures
judged so are asked five times as often, as a p99 of twenty requests is their luck. The service's own processor time of a
request says what it costs, whatever else the machine does.

    python -m benchmarks.api_latency [--requests 2000] [--clients 8] [--rounds 5] [--rate 2000]
"""

import argparse
import contextlib
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
import psutil

from benchmarks.chain import create_machines, processor_s, publishing, received
from benchmarks.closed_loop import latencies
from service.runs.collection_state import CollectionState
from storage.alerts import alerts
from storage.database.engine import Database
from storage.machines import machines
from storage.measurements import runs
from storage.tables.measurements import CollectorRow
from tests.end_to_end.processes import Service, until
from tests.plant import KEY, SECOND, START, identification, machine, sqlite_url, store_identification

WEEK = 7 * 86_400 * SECOND
FIVE_YEARS = 260
LONG = 2000
MACHINES = 1000
ALIVE = "alive: what no answer is quicker than"
ALERTS = 2000
PARAMETERS = ("coupling.C1.kxx", "coupling.C1.kyy", "bearing.B2.kxx", "bearing.B3.kxx")
AT_MOST_TWICE = 2.0
"""Largest p99 over that of `/alive` while samples are stored, over the same before [-]."""
OVER_ALIVE = 2.5
"""Largest p99 of trends, lists of alerts and the list of machines over that of `/alive` in the same round [-]."""
OFTEN = 5
"""Factor on the requests of each figure that is judged by its ratio to `/alive` [-]."""


@dataclass(frozen=True)
class LatencyFigure:
    """A measured figure: requests of addresses, one after the other, with the p99 of their latency [s], all clients at once.

    asked_s: required latency; None without a requirement: harder requests, whose responses cannot be cached.
    over_alive: whether it is judged by how much longer it takes than `/alive`, too.
    """

    name: str
    paths: list[str]
    asked_s: float | None
    over_alive: bool = False


def several(count: int) -> str:
    """Return the query parameters for the first `count` parameters."""
    return "&".join(f"parameter={name}" for name in PARAMETERS[:count])


def starts(count: int) -> list[str]:
    """Return requests that are each sent once, so that none can be answered from a cache."""
    begin = datetime.fromtimestamp(START / SECOND, UTC)
    return [f"&from={(begin + timedelta(seconds=second)).strftime('%Y-%m-%dT%H:%M:%SZ')}" for second in range(count)]


def figures(requests: int) -> tuple[LatencyFigure, ...]:
    """Return the figures that are measured."""
    weekly, long = f"/machines/weekly/trends?{several(4)}", f"/machines/{KEY.machine}/trends?{several(1)}"
    one_weekly = f"/machines/weekly/trends?{several(1)}"
    limits = [f"/alerts?limit={number}" for number in range(50, 151)]
    return (
        LatencyFigure(ALIVE, ["/alive"], None),
        LatencyFigure("trend of five years, weekly, 1 parameter", [one_weekly], 0.050, over_alive=True),
        LatencyFigure("trend of five years, weekly, 4 parameters", [weekly], 0.050, over_alive=True),
        LatencyFigure("  each from another time on", [weekly + one for one in starts(requests)], None),
        LatencyFigure("trend of 2,000 points", [long], 0.050, over_alive=True),
        LatencyFigure("  each from another time on", [long + one for one in starts(requests)], None),
        LatencyFigure("list of 100 alerts of 2,000", ["/alerts"], 0.030, over_alive=True),
        LatencyFigure("  50 to 150 of them", limits, None),
        LatencyFigure("list of the open alerts", ["/alerts?open=true"], 0.030, over_alive=True),
        LatencyFigure("list of 1,000 machines", ["/machines"], 0.100, over_alive=True),
        LatencyFigure("overview of 1,000 machines", ["/fleet"], 0.100),
    )


def fill(file: Path, *, seed: int) -> None:
    """Fill a store as a plant has it after years."""
    rng = np.random.default_rng(seed)
    database = Database(sqlite_url(file))
    with database.transaction() as session:
        machines.create(session, machine())
        for number in range(MACHINES - 1):
            name = "weekly" if number == 0 else f"m{number:04d}"
            machines.create(session, machine(id=name, name=f"Machine {number}"))
            runs.open_run(session, name, revision=1, kind="run-up", direction=1, time_first=START + number)
            session.add(CollectorRow(machine_id=name, state=CollectionState(revision=1, seen=START + WEEK).stored()))
        for number in range(LONG):
            outcome = identification({name: 1.0 + 0.01 * rng.standard_normal() for name in PARAMETERS})
            row = store_identification(session, outcome, run_id=number, measured_at=START + number * WEEK // 20)
        for number in range(FIVE_YEARS):
            outcome = identification({name: 1.0 + 0.01 * rng.standard_normal() for name in PARAMETERS})
            moment = START + number * WEEK
            store_identification(session, outcome, machine_id="weekly", run_id=LONG + number, measured_at=moment)
        for number in range(ALERTS):
            one = alerts.add(
                session,
                f"m{1 + number % (MACHINES - 2):04d}",
                rule="misalignment",
                element=f"coupling.C{number // (MACHINES - 2)}",
                evidence={"coupling": "C1", "shift": 0.12, "names": list(PARAMETERS)},
                identification_id=row.id,
                measured_at=START,
                latching=False,
            )
            one.state = one.condition = "unacknowledged"
            one.opened_at += number
            if number % 10:
                one.state, one.closed_at = "normal", one.opened_at
    database.close()


@dataclass(frozen=True)
class Round:
    """Latencies [s], figures in rows: of each first question alone, and of all clients at once.

    processor: the service's processor time of a request [s] by figure, with all that it does beside.
    """

    firsts: np.ndarray
    at_once: list[np.ndarray]
    processor: np.ndarray

    @property
    def p99(self) -> np.ndarray:
        """Return the p99 of each figure."""
        return np.array([np.percentile(one, 99) for one in self.at_once])

    def together(self, asked: list[bool]) -> float:
        """Return the p99 of all requests of these figures."""
        requests = [one for one, wanted in zip(self.at_once, asked, strict=True) if wanted]
        return float(np.percentile(np.concatenate(requests), 99))


def one_round(base: str, process: psutil.Process, options: argparse.Namespace) -> Round:
    """Measure each figure once."""
    firsts, at_once, processor = [], [], []
    for figure in figures(options.requests):
        firsts.append(latencies(base, figure.paths, clients=1, requests=1)[0])
        before = processor_s(process)
        requests = options.requests * (OFTEN if figure.over_alive or figure.name == ALIVE else 1)
        at_once.append(latencies(base, figure.paths, clients=options.clients, requests=requests))
        processor.append((processor_s(process) - before) / len(at_once[-1]))
    return Round(np.array(firsts), at_once, np.array(processor))


def show(rounds: list[Round], options: argparse.Namespace) -> np.ndarray:
    """Print medians over rounds. Returns the p99 of each figure."""
    firsts = np.median([one.firsts for one in rounds], axis=0)
    p50 = np.median([[np.percentile(figure, 50) for figure in one.at_once] for one in rounds], axis=0)
    p99 = np.median([one.p99 for one in rounds], axis=0)
    processor = np.median([one.processor for one in rounds], axis=0)
    print(f"  {'ms':42s} {'first':>7s} {'p50':>7s} {'p99':>7s} {'asked':>7s} {'processor':>9s}")
    for place, figure in enumerate(figures(options.requests)):
        values = (firsts[place], p50[place], p99[place], figure.asked_s or np.nan)
        row = "  ".join(f"{1e3 * value:5.1f}" for value in values).replace("nan", "  -") + f"  {1e3 * processor[place]:9.2f}"
        print(f"  {figure.name:42s}   {row}", flush=True)
    return np.asarray(p99)


def measure(folder: Path, options: argparse.Namespace) -> bool:
    """Run the service and print its figures; return whether each is within its limit."""
    fill(folder / "rundown.db", seed=options.seed)
    service = Service(folder)
    quiet, busy = [], []
    with service.running() as started:
        process = psutil.Process(started.pid)
        base = f"http://127.0.0.1:{service.port}/api/v1"
        names = create_machines(service, 4)
        for _ in range(options.rounds):
            quiet.append(one_round(base, process, options))
            with _ingest(service, names, folder, options):
                busy.append(one_round(base, process, options))
        stored = received(service)
    service.client.close()
    print(f"{options.clients} clients at once, {options.requests} requests each figure, seed {options.seed}")
    p99 = show(quiet, options)
    print(f"While {options.rate:.0f} samples/s of 8 channels are stored")
    show(busy, options)
    print(f"  samples stored meanwhile: {stored}")
    limits = [figure.asked_s for figure in figures(options.requests)]
    within = all(found <= limit for found, limit in zip(p99, limits, strict=True) if limit is not None)
    compare(quiet, busy, [limit is not None for limit in limits])
    return beside_alive(quiet, busy, options.requests) and within


def beside_alive(quiet: list[Round], busy: list[Round], requests: int) -> bool:
    """Print each p99 over that of `/alive` in the same round, before and while samples are stored.

    Whatever else slows the machine slows `/alive`, too: this is the figure that is judged.

    Returns whether all are within the limit, and at most doubled while samples are stored.
    """
    judged = [place for place, one in enumerate(figures(requests)) if one.over_alive]
    before, while_storing = over_alive(quiet, requests)[judged], over_alive(busy, requests)[judged]
    print(f"p99 over that of /alive in the same round, median of {len(quiet)}; asked: {OVER_ALIVE:g} at most,")
    print(f"and {AT_MOST_TWICE:g} times that at most while samples are stored")
    print(f"  {'':42s} before  storing  times")
    for place, quick, slow in zip(judged, before, while_storing, strict=True):
        short = quick > OVER_ALIVE or slow > AT_MOST_TWICE * quick
        row = f"{quick:6.2f} {slow:8.2f} {slow / quick:6.2f}{'  MORE THAN ASKED' if short else ''}"
        print(f"  {figures(requests)[place].name:42s} {row}")
    return bool(before.max() <= OVER_ALIVE and (while_storing / before).max() <= AT_MOST_TWICE)


def over_alive(rounds: list[Round], requests: int) -> np.ndarray:
    """Return each figure's p99 over that of `/alive`, the median of the rounds."""
    at = [one.name for one in figures(requests)].index(ALIVE)
    return np.asarray(np.median([one.p99 / one.p99[at] for one in rounds], axis=0))


def compare(quiet: list[Round], busy: list[Round], asked: list[bool]) -> None:
    """Print each p99 while samples are stored over that before: sources and store take their part of the cores, too."""
    pairs = list(zip(quiet, busy, strict=True))
    times = np.median([after.p99 / before.p99 for before, after in pairs], axis=0)[asked]
    together = float(np.median([after.together(asked) / before.together(asked) for before, after in pairs]))
    print(f"p99 while samples are stored over p99 just before, whatever slows both: median of {len(pairs)} pairs; not judged")
    print(f"  all asked together {together:.2f} times; one by one: median {np.median(times):.2f}, largest {times.max():.2f}")


@contextlib.contextmanager
def _ingest(service: Service, names: list[str], folder: Path, options: argparse.Namespace) -> Iterator[None]:
    """Run sources that publish until the block ends."""
    arguments = ["-m", "benchmarks.throughput", "--publish", ",".join(names), "--connect", service.endpoint]
    arguments += ["--folder", str(folder), "--rate", str(options.rate), "--channels", "8", "--seconds", "600"]
    before = received(service)
    with publishing(*arguments) as sources:
        until(lambda: received(service) > before + options.rate, within_s=60, what="samples are stored")
        yield
        sources.kill()


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the figures; status 1 when one is not as asked."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--requests", type=int, default=2000)
    parser.add_argument("--clients", type=int, default=8)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--rate", type=float, default=2000.0, help="samples per second of all machines together")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory() as folder:
        if not measure(Path(folder), options):
            raise SystemExit(1)


if __name__ == "__main__":
    main()
