"""Routers that start again and networks that part: what was missed is fetched, and no alert comes of a gap."""

import contextlib
import random
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

from tests.end_to_end.processes import Service, process, python, until
from tests.faults.chain import Chain
from tests.faults.measured import expected, stored
from tests.faults.network import Wire
from tests.plant import assert_same_samples, document
from tests.ports import free_port

RATE = 100.0
SETTLING_S = 2.0
"""Between two partitions."""
HOUR_SAMPLES = 36_000
"""Of an hour at 10 samples a second …"""
HOUR_S = 20.0
"""… and what it is compressed to."""


def router_restarted(folder: Path, *, times: int, seed: int) -> str:
    """The router between source and service is killed and started again so many times."""
    rng = random.Random(seed)
    with Chain(folder, samples=round(RATE * 3.0 * times), rate=RATE) as chain:
        chain.wait_received(50)
        for _ in range(times):
            time.sleep(rng.uniform(0.5, 2.0))
            chain.kill("router")
            time.sleep(rng.uniform(0.0, 1.0))
            chain.start("router")
        chain.check_exact()
        _require_no_alert(chain.service)
    return f"router started again {times} times"


def parted(folder: Path, *, times: int, seconds: float) -> str:
    """The wire between router and service holds everything back for so long, then breaks; several times."""
    with Chain(folder, samples=round(RATE * times * (seconds + SETTLING_S)), rate=RATE, wired=True) as chain:
        assert chain.wire is not None
        for _ in range(times):
            chain.wait_received(50)
            time.sleep(SETTLING_S)
            chain.wire.hold()
            time.sleep(seconds)
            chain.wire.release()
        chain.check_exact()
        _require_no_alert(chain.service)
    return f"{times} partitions of {seconds:.0f} s"


def plant_parted_from_centre(folder: Path, *, samples: int, seconds: float) -> str:
    """A plant's router and source go on alone for an hour, `seconds` long here; the centre then fetches what it missed."""
    with plant_and_centre(folder) as (plant, wire, service):
        rate = samples / seconds
        before = round(rate * 3.0)
        arguments = [plant, str(folder / "edge.db"), str(before + samples), str(rate)]
        with python(folder / "edge.log", "-m", "tests.faults.edge", *arguments):
            until(lambda: _received(service) >= 50, within_s=30, what="samples reach the centre")
            wire.hold()
            time.sleep(seconds)
            missed = before + samples - _received(service)
            began = time.monotonic()
            wire.release()
            until(lambda: _received(service) >= before + samples, within_s=120, what="the centre has caught up")
            caught_up_s = time.monotonic() - began
            (row,) = service.get("/sources")
            assert (row["received"], row["next_sequence"], row["lost"]) == (before + samples, before + samples, 0)
        _require_no_alert(service)
    numbers, held = stored(folder / "rundown.db")
    assert numbers == list(range(before + samples))
    assert_same_samples(held, expected(before + samples))
    return f"{missed} samples missed, caught up in {caught_up_s:.1f} s"


@contextlib.contextmanager
def plant_and_centre(folder: Path) -> Iterator[tuple[str, Wire, Service]]:
    """Yield where the plant's router listens, the wire to it, and the centre's service behind a router of its own; all
    running."""
    port, centre = free_port(), f"tcp/127.0.0.1:{free_port()}"
    plant = f"tcp/127.0.0.1:{port}"
    service = Service(folder, router=centre)
    with (
        _router(folder / "plant.log", "--listen", plant),
        Wire(port) as wire,
        _router(folder / "centre.log", "--listen", centre, "--connect", wire.endpoint),
        service.running(),
    ):
        answer = service.client.post("/machines", json=document())
        assert answer.status_code == 201, answer.text
        yield plant, wire, service
        service.client.close()


@contextlib.contextmanager
def _router(log: Path, *arguments: str) -> Iterator["subprocess.Popen[bytes]"]:
    with process(log, "router", *arguments) as started:
        until(lambda: "routing on" in log.read_text(), within_s=30, what="the router listens")
        yield started


def _received(service: Service) -> int:
    return sum(int(row["received"]) for row in service.get("/sources"))


def _require_no_alert(service: Service) -> None:
    assert service.get("/alerts") == []
