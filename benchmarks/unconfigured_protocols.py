"""Memory of a service in which neither OPC UA nor MQTT is configured, beside one that has never heard of them.

Each is `rundown serve` on an empty SQLite store, measured once it is ready: as it is, and with an empty module in the place of
`service.opcua.serving`, the only module of both rooms that it imports unasked. Memory is what the process has to itself (USS).
Prints asked beside measured, and which modules of both rooms and their libraries were loaded at its end.

    python -m benchmarks.unconfigured_protocols [--rounds 3]

The status is 1 where it falls short.
"""

import argparse
import json
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path

import psutil

from tests.end_to_end.processes import Service, python

ASKED_MEMORY_MB = 2.0
"""More than a service without them has, at most."""
LIBRARIES = ("asyncua", "aiomqtt", "paho")
ROOMS = ("service.opcua", "service.mqtt")
UNASKED = {"service.opcua", "service.opcua.serving"}
"""Modules of both rooms that a service imports in any case."""
LOOK_S, ALIKE, ALIKE_MB, PATIENCE_S = 1.0, 6, 0.3, 120.0
"""Memory is settled when so many looks in a row are alike: what a service loads once it is ready takes its time."""

SERVE = f"""
import atexit, json, runpy, sys
def loaded():
    found = [one for one in sys.modules if one.split(".")[0] in {LIBRARIES} or one.startswith({ROOMS})]
    print("loaded", json.dumps(sorted(found)), flush=True)
atexit.register(loaded)
runpy.run_module("service", run_name="__main__", alter_sys=True)
"""
WITHOUT = """
import sys, types
stand_in = types.ModuleType("service.opcua.serving")
stand_in.OpcUaServing = None
sys.modules["service.opcua.serving"] = stand_in
"""


@dataclass(frozen=True)
class ProtocolMemory:
    """Memory of a service as it is and of one without the protocols [MB], and what the former loaded of them."""

    as_it_is: float
    without: float
    loaded: tuple[str, ...]

    @property
    def extra(self) -> float:
        """Return what they cost where none is configured [MB]."""
        return self.as_it_is - self.without

    @property
    def holds(self) -> bool:
        """Return whether it is as before: no library, no module but the one that looks at the settings, hardly any memory."""
        return self.extra <= ASKED_MEMORY_MB and set(self.loaded) <= UNASKED


class ProgramService(Service):
    """A service that is started by a program of ours, which says at its end what it has loaded."""

    def __init__(self, folder: Path, program: str) -> None:
        super().__init__(folder)
        self._program = program

    def started(self) -> AbstractContextManager["subprocess.Popen[bytes]"]:
        """Return the service, on its way to be ready."""
        flags = ["--database", self.database, "--port", str(self.port), self._network, self.endpoint]
        return python(self.log, "-c", self._program, "serve", *flags, **self._environment)


def measured(*, rounds: int) -> ProtocolMemory:
    """Start a service with and without the protocols in turns; return the median of each."""
    memory: dict[str, list[float]] = {"": [], WITHOUT: []}
    loaded: set[str] = set()
    for _ in range(rounds):
        for before in memory:
            with tempfile.TemporaryDirectory() as folder:
                service = ProgramService(Path(folder), before + SERVE)
                with service.running() as process:
                    memory[before].append(_settled(psutil.Process(process.pid)))
                service.client.close()
                if not before:
                    loaded |= _loaded(service.log)
    return ProtocolMemory(statistics.median(memory[""]), statistics.median(memory[WITHOUT]), tuple(sorted(loaded)))


def _settled(process: psutil.Process) -> float:
    """Return the memory that a process has to itself, once that stays as it is [MB]."""
    looks: list[float] = []
    deadline = time.monotonic() + PATIENCE_S
    while len(looks) < ALIKE or max(looks[-ALIKE:]) - min(looks[-ALIKE:]) > ALIKE_MB:
        if time.monotonic() > deadline:
            raise SystemExit(f"the memory of the service has not settled within {PATIENCE_S:g} s")
        time.sleep(LOOK_S)
        looks.append(process.memory_full_info().uss / 2**20)
    return looks[-1]


def _loaded(log: Path) -> set[str]:
    lines = [one for one in log.read_text().splitlines() if one.startswith("loaded ")]
    if not lines:
        raise SystemExit("the service did not say what it has loaded")
    return set(json.loads(lines[-1].removeprefix("loaded ")))


def report(found: ProtocolMemory) -> bool:
    """Print asked beside measured; return whether it holds."""
    word = "ok" if found.holds else "SHORT"
    print("a service in which neither OPC UA nor MQTT is configured")
    print(f"  {'memory, more than without both [MB]':<52}{f'<= {ASKED_MEMORY_MB:g}':>14}{found.extra:>14.2f}  {word}")
    print(f"  {'memory [MB]; without both [MB]':<52}{'':>14}{found.as_it_is:>14.1f}{found.without:>8.1f}")
    print(f"  {'loaded of both and their libraries':<52}{'':>14}  {', '.join(found.loaded) or 'nothing'}")
    return found.holds


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure, print, and end with status 1 where it falls short."""
    described = (__doc__ or "").split("\n")[0]
    parser = argparse.ArgumentParser(prog="python -m benchmarks.unconfigured_protocols", description=described)
    parser.add_argument("--rounds", type=int, default=3)
    if not report(measured(rounds=parser.parse_args(arguments).rounds)):
        sys.exit(1)


if __name__ == "__main__":
    main()
