"""Faults, each as one function that checks that the store is exact in the end."""

import random
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from formats.wire import MESSAGEPACK, encode_batch
from service.messaging.session import session, wait_connected
from service.sources.replay_log import LogEntry
from tests.end_to_end.processes import Service, until
from tests.faults.chain import PARTS, Chain, ChainPart
from tests.faults.mangling import MangledSource, Mangler
from tests.faults.measured import SIZE, expected, measured, stored
from tests.plant import assert_same_samples, document

RATE = 100.0
PACE_S = 0.002
"""Between two mangled messages."""


def frozen_parted_killed(folder: Path, *, samples: int) -> None:
    """One chain for all: the service frozen for twelve seconds, then cut off, then every part killed and started again."""
    with Chain(folder, samples=samples, rate=RATE, wired=True) as chain:
        chain.wait_received(50)
        chain.freeze("service", 12.0)
        assert chain.wire is not None
        chain.wire.hold()
        time.sleep(2.0)
        chain.wire.release()
        for part in ("service", "edge", "router"):
            chain.kill(part)
            time.sleep(0.3)
        again: tuple[ChainPart, ...] = ("edge", "service", "router")
        for part in again:
            chain.start(part)
        chain.check_exact()


def killed_in_turn(folder: Path, order: Sequence[ChainPart], *, samples: int) -> None:
    """Every part is killed, one after the other, then all are started again in that order."""
    with Chain(folder, samples=samples, rate=RATE) as chain:
        chain.wait_received(50)
        for part in order:
            chain.kill(part)
            time.sleep(0.3)
        for part in order:
            chain.start(part)
        chain.check_exact()


def killed_at_random(folder: Path, *, seed: int, kills: int, samples: int) -> None:
    """One part after the other is killed at a random moment and started again a moment later, whatever the others do."""
    rng = random.Random(seed)
    with Chain(folder, samples=samples, rate=RATE) as chain:
        for _ in range(kills):
            time.sleep(rng.uniform(0.0, 4.0))
            part = rng.choice(PARTS)
            chain.kill(part)
            time.sleep(rng.uniform(0.0, 1.0))
            chain.start(part)
        chain.check_exact()


def frozen(folder: Path, part: ChainPart, *, seconds: float, samples: int) -> None:
    """A part does nothing for a while, its connections open: zenoh closes them at the other end after ten seconds."""
    with Chain(folder, samples=samples, rate=RATE) as chain:
        chain.wait_received(50)
        chain.freeze(part, seconds)
        chain.check_exact()


def parted(folder: Path, *, seconds: float, samples: int) -> None:
    """The wire between router and service holds everything back for a while, then breaks."""
    with Chain(folder, samples=samples, rate=RATE, wired=True) as chain:
        chain.wait_received(50)
        assert chain.wire is not None
        chain.wire.hold()
        time.sleep(seconds)
        chain.wire.release()
        chain.check_exact()


def mangled_with_log(folder: Path, *, seed: int, samples: int) -> Mangler:
    """Messages come twice, in another order, damaged or not at all; the source's log heals it."""
    service = Service(folder)
    with service.running(), session(listen=[], connect=[service.endpoint]) as stream:
        assert service.client.post("/machines", json=document()).status_code == 201
        assert wait_connected(stream, [service.endpoint], give_up=_patiently)
        mangler = Mangler(stream, seed=seed)
        with MangledSource(stream, mangler) as source:
            while source.sequence < samples:
                source.publish(measured(source.sequence, min(SIZE, samples - source.sequence)))
                time.sleep(PACE_S)
            until(lambda: _received(service) >= samples, within_s=60, what=f"{samples} samples stored")
        (row,) = service.get("/sources")
        assert (row["received"], row["next_sequence"], row["lost"]) == (samples, samples, 0)
        assert 0 < sum(service.get("/quarantine")["counts"].values()) <= mangler.flipped
        mangler.close()
    service.client.close()
    numbers, held = stored(folder / "rundown.db")
    assert numbers == list(range(samples))
    assert_same_samples(held, expected(samples))
    return mangler


def mangled_without_log(folder: Path, *, seed: int, samples: int) -> Mangler:
    """The same without a log: all of which a message came whole is stored, once; all others are counted as lost."""
    service = Service(folder)
    with service.running(), session(listen=[], connect=[service.endpoint]) as stream:
        assert service.client.post("/machines", json=document()).status_code == 201
        assert wait_connected(stream, [service.endpoint], give_up=_patiently)
        mangler = Mangler(stream, seed=seed)
        until(lambda: mangler.heard, within_s=20, what="the service listens")
        for first in range(0, samples, SIZE):
            entry = LogEntry(first, SIZE, encode_batch(measured(first, source="edge", epoch=1)), MESSAGEPACK)
            (mangler.send if first + SIZE < samples else mangler.finish)(entry)
            time.sleep(PACE_S)
        gone = samples - len(mangler.intact)
        until(lambda: _counted(service) == (samples - gone, gone), within_s=60, what=f"{gone} of {samples} samples lost")
        mangler.close()
    service.client.close()
    numbers, held = stored(folder / "rundown.db")
    assert len(numbers) == len(set(numbers))
    assert set(numbers) == mangler.intact
    assert_same_samples(held, expected(samples).pick(np.array(numbers, dtype=np.intp)))
    return mangler


def _patiently(seconds: float) -> bool:
    time.sleep(seconds)
    return False


def _received(service: Service) -> int:
    return sum(int(row["received"]) for row in service.get("/sources"))


def _counted(service: Service) -> tuple[int, int]:
    rows = service.get("/sources")
    return sum(int(row["received"]) for row in rows), sum(int(row["lost"]) for row in rows)
