"""The long form of `tests/faults`: real processes killed in every order, frozen, cut off and fed with damaged messages.

Every line is one scenario after which the store was compared with what was measured, sample by sample, to the bit; of alerts,
what was told with what happened, event by event.

    python -m benchmarks.faults [--rounds 1] [--kills 200] [--only killed]
"""

import argparse
import tempfile
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

from storage.database.engine import Database
from storage.machines import machines
from tests import postgresql
from tests.faults import alert_deliveries, clocks, disorder, gaps, network_partitions, roles, scenarios, storage_faults
from tests.faults.chain import PARTS, every_order
from tests.plant import machine

KILLS = 200
ROUTER_RESTARTS = 20
CLOCKS = 100
PARTITIONS, PARTITION_S = 5, 30.0


def every_scenario(rounds: int, kills: int) -> Iterator[tuple[str, Callable[[Path], object]]]:
    """Yield the name of each scenario, and the function that runs it."""
    for order in every_order():
        name = "killed " + ", ".join(order)
        yield name, partial(scenarios.killed_in_turn, order=order, samples=1000)
    for part in PARTS:
        name = f"frozen for 15 s: {part}"
        yield name, partial(scenarios.frozen, part=part, seconds=15.0, samples=2500)
    yield "wire held for 15 s, then broken", partial(scenarios.parted, seconds=15.0, samples=2500)
    for seed in range(CLOCKS * rounds):
        yield f"clock that wanders, seed {seed}", partial(_wandering_clock, seed=seed)
    yield "store locked for 30 s, read-only for 30 s", _file_in_the_way
    yield "store on a full disk for 30 s", _full_disk
    yield "store's server stopped for 60 s", _server_away
    yield (
        f"router started again {ROUTER_RESTARTS} times",
        partial(network_partitions.router_restarted, times=ROUTER_RESTARTS, seed=0),
    )
    yield f"parted for {PARTITION_S:.0f} s", partial(network_partitions.parted, times=PARTITIONS, seconds=PARTITION_S)
    hour = partial(
        network_partitions.plant_parted_from_centre, samples=network_partitions.HOUR_SAMPLES, seconds=network_partitions.HOUR_S
    )
    yield "plant parted from centre for an hour", hour
    for seed in range(rounds):
        name = f"parted in the middle of runs, seed {seed}"
        yield name, partial(gaps.runs_with_gaps, gaps=6, seconds=1.5, seed=seed)
        name = f"disorder, seed {seed}"
        yield name, partial(disorder.spoiled_stream, rate=10.0, sweeps=4, seed=seed)
        name = f"roles killed on PostgreSQL, seed {seed}"
        yield name, partial(roles_on_postgresql, seed=seed, kills=kills)
        name = f"roles killed, one process, seed {seed}"
        yield name, partial(_alone_on_sqlite, seed=seed, kills=kills)
        name = f"killed at random eight times, seed {seed}"
        yield name, partial(scenarios.killed_at_random, seed=seed, kills=8, samples=3000)
        name = f"mangled, with a log, seed {seed}"
        yield name, partial(scenarios.mangled_with_log, seed=seed, samples=10_000)
        name = f"mangled, without a log, seed {seed}"
        yield name, partial(scenarios.mangled_without_log, seed=seed, samples=10_000)
        name = f"alerts told through 20 kills, seed {seed}"
        yield name, partial(alert_deliveries.deliveries_through_kills, seed=seed, kills=20)


def _wandering_clock(folder: Path, *, seed: int) -> clocks.Wandered:
    database = Database(f"sqlite:///{folder / 'rundown.db'}")
    with database.transaction() as session:
        machines.create(session, machine())
    try:
        return clocks.wandering(database, seed=seed)
    finally:
        database.close()


def _file_in_the_way(folder: Path) -> str:
    hindrances: dict[str, storage_faults.Hindrance] = {"locked": storage_faults.locked, "read-only": storage_faults.read_only}
    return _recovered(storage_faults.hindered(folder, hindrances, seconds=30.0, samples=9000))


def _full_disk(folder: Path) -> str:
    with storage_faults.own_disk(folder / "disk") as disk:
        database = f"sqlite:///{disk / 'rundown.db'}"
        full: dict[str, storage_faults.Hindrance] = {"full": storage_faults.full}
        return _recovered(storage_faults.hindered(folder, full, seconds=30.0, samples=5000, database=database))


def _server_away(folder: Path) -> str:
    with storage_faults.own_server() as (server, database):
        away = {"stopped": storage_faults.stopped(server)}
        return _recovered(storage_faults.hindered(folder, away, seconds=60.0, samples=8000, database=database))


def _recovered(after_s: dict[str, float]) -> str:
    return ", ".join(f"well again {seconds:.1f} s after {name}" for name, seconds in after_s.items())


def _alone_on_sqlite(folder: Path, *, seed: int, kills: int) -> roles.Killed:
    database = f"sqlite:///{folder / 'rundown.db'}"
    return roles.killed_at_random(folder, database=database, names=roles.ALONE, seed=seed, kills=kills)


def roles_on_postgresql(folder: Path, *, seed: int, kills: int) -> roles.Killed:
    """Run the scenario of roles on a PostgreSQL server of its own."""
    with postgresql.server() as server:
        return roles.killed_at_random(folder, database=server.url, names=roles.ROLES, seed=seed, kills=kills)


def main() -> None:
    """Print a line a scenario; status 1 when a store was not exact."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.faults")
    parser.add_argument("--rounds", type=int, default=1, help="seeds of the random ones")
    parser.add_argument("--only", default="", help="scenarios whose name contains this")
    parser.add_argument("--kills", type=int, default=KILLS, help="of replicas")
    options = parser.parse_args()
    wrong = 0
    for name, act in every_scenario(options.rounds, options.kills):
        if options.only not in name:
            continue
        began = time.perf_counter()
        with tempfile.TemporaryDirectory() as folder:
            try:
                said = act(Path(folder))
                outcome = "exact" if said is None else f"exact; {said}"
            except AssertionError as error:
                outcome, wrong = f"NOT exact: {str(error)[:300]}", wrong + 1
        print(f"{name:42s} {time.perf_counter() - began:5.1f} s  {outcome}", flush=True)
    if wrong:
        raise SystemExit(1)


if __name__ == "__main__":
    main()
