"""The demonstration: in real processes, a service, a simulated plant of three machines, and a summary."""

import contextlib
import json
import math
import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from datetime import datetime
from pathlib import Path
from types import FrameType
from typing import Any, TextIO

import httpx
import numpy as np

from estimator.machine.parameter_description import describe
from formats.files.document_files import UnreadableFile, read_yaml
from rotorundown.environment.example_machines import examples_folder
from service.commands.json_output import print_json
from storage.clock import from_datetime

EXAMPLES = examples_folder()
SCENARIOS = {
    "turbine-compressor-generator": "healthy",
    "motor-pump": "misalignment",
    "thesis-chapter-3": "unbalance",
}
ALERTS = {
    "healthy": [],
    "misalignment": ["misalignment of coupling.C1"],
    "unbalance": ["unbalance of disc.D1"],
}
"""Alerts that each scenario should lead to, and no others."""
CYCLES = 12
SAMPLES = 160
RATE = 120.0
SEED = 7
START_TIMEOUT_S = 60.0
SCENARIO_TIMEOUT_S = 300.0
STOP_TIMEOUT_S = 20.0
SILENCE_S = 5.0
SOUND_ERRORS = (0.7, 1.3)
"""Range in which the rms of estimate minus truth, in standard errors, must lie."""


class DemoFailed(RuntimeError):
    """The demonstration could not be completed."""


@dataclass(frozen=True)
class ScenarioOutcome:
    """Results of one machine's scenario."""

    machine: str
    scenario: str
    identifications: int
    accepted: int
    rms: float
    stiffness_percent: float
    coupling_percent: float
    unbalance_percent: float
    alerts: list[str]

    @property
    def right(self) -> bool:
        """Return whether the service found the simulated scenario."""
        wanted = ALERTS[self.scenario]
        sound = SOUND_ERRORS[0] <= self.rms <= SOUND_ERRORS[1]
        return sound and self.accepted == self.identifications > 0 and self.alerts == wanted


def run(*, leave: bool, port: int, as_json: bool = False) -> bool:
    """Run the demonstration; returns whether every machine came out as simulated. Raises DemoFailed.

    as_json: prints the summary for programs, and how it goes on the standard error output.
    """
    course = sys.stderr if as_json else sys.stdout
    folder = Path(tempfile.mkdtemp(prefix="rundown-demo-"))
    right = False
    try:
        with _interrupted_by_signals(), _service(folder, port, course) as (client, endpoint):
            began = time.monotonic()
            outcomes = _run_scenario(folder, client, endpoint, course)
            right = all(outcome.right for outcome in outcomes)
            seconds = time.monotonic() - began
            if as_json:
                print_json(
                    {"right": right, "seconds": seconds, "machines": [{"right": one.right, **asdict(one)} for one in outcomes]}
                )
            else:
                _print_summary(outcomes, seconds)
            if not leave:
                if not as_json:
                    _print_addresses(str(client.base_url))
                print("\nServing until Ctrl-C.", file=course, flush=True)
                signal.pause()
    except KeyboardInterrupt:
        print("\nStopped.", file=course, flush=True)
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    return right


def _run_scenario(folder: Path, client: httpx.Client, endpoint: str, course: TextIO) -> list[ScenarioOutcome]:
    began = time.monotonic()
    _create_machines(client)
    truth = folder / "truth.jsonl"
    arguments = [f"{EXAMPLES / name}.yaml:{scenario}" for name, scenario in SCENARIOS.items()]
    options = {"cycles": CYCLES, "samples": SAMPLES, "rate": RATE, "seed": SEED, "truth": truth, "connect": endpoint}
    flags = [str(part) for name, value in options.items() for part in (f"--{name}", value)]
    with _process(folder / "simulate.log", ["simulate", *arguments, *flags]) as simulator:
        _follow(client, simulator, folder, began, course)
    return [_outcome(client, name, scenario, truth) for name, scenario in SCENARIOS.items()]


@contextlib.contextmanager
def _service(folder: Path, port: int, course: TextIO) -> Iterator[tuple[httpx.Client, str]]:
    port = port or _free_port()
    endpoint = f"tcp/127.0.0.1:{_free_port()}"
    flags = ["--database", f"sqlite:///{folder / 'rundown.db'}", "--port", str(port), "--zenoh-listen", endpoint]
    print(f"Starting the service on http://127.0.0.1:{port}, its files in {folder} …", file=course, flush=True)
    with (
        _process(folder / "serve.log", ["serve", *flags], RUNDOWN_SILENCE_S=str(SILENCE_S)) as process,
        httpx.Client(base_url=f"http://127.0.0.1:{port}/api/v1", timeout=30.0) as client,
    ):
        _wait_ready(client, process, folder / "serve.log")
        yield client, endpoint


@contextlib.contextmanager
def _process(log: Path, arguments: list[str], **environment: str) -> Iterator[subprocess.Popen[bytes]]:
    """Run a rundown command as a process of its own, ended on exit. Ctrl-C in the terminal reaches only this process."""
    with log.open("wb") as output:
        process = subprocess.Popen(
            [sys.executable, "-m", "service", *arguments],
            stdout=output,
            stderr=subprocess.STDOUT,
            stdin=subprocess.DEVNULL,
            env=os.environ | environment,
            start_new_session=True,
        )
        try:
            yield process
        finally:
            process.terminate()
            try:
                process.wait(STOP_TIMEOUT_S)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


@contextlib.contextmanager
def _interrupted_by_signals() -> Iterator[None]:
    """Let SIGTERM end the demonstration as Ctrl-C does, even where it was started in the background with signals ignored."""

    def interrupt(_number: int, _frame: FrameType | None) -> None:
        raise KeyboardInterrupt

    before = {number: signal.signal(number, interrupt) for number in (signal.SIGTERM, signal.SIGINT)}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def _wait_ready(client: httpx.Client, process: subprocess.Popen[bytes], log: Path) -> None:
    deadline = time.monotonic() + START_TIMEOUT_S
    while time.monotonic() < deadline:
        if process.poll() is not None:
            break
        with contextlib.suppress(httpx.TransportError):
            if client.get("/ready").status_code == 200:
                return
        time.sleep(0.1)
    raise DemoFailed(f"the service did not become ready:\n{log.read_text(errors='replace')[-2000:]}")


def _create_machines(client: httpx.Client) -> None:
    for name in SCENARIOS:
        try:
            answer = client.post("/machines", json=read_yaml(EXAMPLES / f"{name}.yaml"))
        except UnreadableFile as error:
            raise DemoFailed(f"the demonstration needs the example machines: {error}") from error
        if answer.status_code != 201:
            raise DemoFailed(f"machine {name} was not created: {answer.text}")


def _follow(client: httpx.Client, simulator: subprocess.Popen[bytes], folder: Path, began: float, course: TextIO) -> None:
    """Show progress until the simulator has ended and everything is identified."""
    deadline = began + SCENARIO_TIMEOUT_S
    shown = 0.0
    done = False
    while not done:
        if time.monotonic() > deadline:
            raise DemoFailed(f"not finished after {SCENARIO_TIMEOUT_S:.0f} s; see the logs:\n{_tail(folder / 'serve.log')}")
        if simulator.poll() not in (None, 0):
            raise DemoFailed(f"the simulator ended:\n{_tail(folder / 'simulate.log')}")
        counts = client.get("/health").json()["jobs"]
        left = counts.get("queued", 0) + counts.get("running", 0)
        runs = [run for name in SCENARIOS for run in client.get(f"/machines/{name}/runs").json()]
        open_runs = sum(run["state"] == "open" for run in runs)
        done = simulator.poll() == 0 and not left and not open_runs
        if done or time.monotonic() - shown >= (0.5 if course.isatty() else 5.0):
            shown = time.monotonic()
            _print_progress(client, len(runs) - open_runs, counts, time.monotonic() - began, course)
        time.sleep(0.2)
    if course.isatty():
        print(file=course, flush=True)


def _print_progress(client: httpx.Client, runs: int, counts: dict[str, int], seconds: float, course: TextIO) -> None:
    total = 2 * CYCLES * len(SCENARIOS)
    received = sum(source["received"] for source in client.get("/sources").json())
    alerts = len(client.get("/alerts").json())
    finished = counts.get("done", 0) + counts.get("failed", 0)
    bar = "#" * (30 * finished // total)
    line = (
        f"[{bar:<30}] {seconds:4.0f} s  {received} samples, {runs} of {total} runs, {finished} identified, {alerts} alert(s)"
    )
    shown = course.isatty()
    print(f"\r{line}" if shown else line, end="" if shown else "\n", file=course, flush=True)


def _tail(log: Path) -> str:
    return log.read_text(errors="replace")[-2000:]


def _outcome(client: httpx.Client, name: str, scenario: str, truth_path: Path) -> ScenarioOutcome:
    truths = [line for line in map(json.loads, truth_path.read_text().splitlines()) if line["machine"] == name]
    identifications = client.get(f"/machines/{name}/identifications").json()
    errors: list[float] = []
    relative: dict[str, list[float]] = {"stiffness": [], "coupling": [], "unbalance": []}
    for identification in identifications:
        truth = _truth_of(identification, truths)
        for estimate in client.get(f"/identifications/{identification['id']}").json()["estimates"]:
            if estimate["value"] is not None:
                _compare(estimate, truth, errors, relative)
    alerts = client.get(f"/machines/{name}/alerts", params={"open": True}).json()
    return ScenarioOutcome(
        machine=name,
        scenario=scenario,
        identifications=len(identifications),
        accepted=sum(one["accepted"] for one in identifications),
        rms=math.sqrt(float(np.mean(np.square(errors)))) if errors else math.nan,
        stiffness_percent=_median_percent(relative["stiffness"]),
        coupling_percent=_median_percent(relative["coupling"]),
        unbalance_percent=_median_percent(relative["unbalance"]),
        alerts=[f"{alert['rule']} of {alert['element']}" for alert in alerts],
    )


def _truth_of(identification: dict[str, Any], truths: list[dict[str, Any]]) -> dict[str, Any]:
    measured = from_datetime(datetime.fromisoformat(identification["measured_at"]))
    same_kind = [line for line in truths if line["kind"] == identification["run_kind"]]
    return min(same_kind, key=lambda line: abs(int(line["last_time"]) - measured))


def _compare(estimate: dict[str, Any], truth: dict[str, Any], errors: list[float], relative: dict[str, list[float]]) -> None:
    name, value, error = estimate["parameter"], estimate["value"], estimate["standard_error"]
    if estimate["quantity"] == "unbalance":
        real, imaginary = truth["unbalances"][name]
        errors += [(value - real) / error, (estimate["imaginary"] - imaginary) / estimate["imaginary_standard_error"]]
        relative["unbalance"].append(math.hypot(value - real, estimate["imaginary"] - imaginary) / math.hypot(real, imaginary))
        return
    true = truth["parameters"][name]
    said = describe(name)
    if said.positive and said.term is not None and said.term.quantity == "stiffness":
        relative["coupling" if said.element_kind == "coupling" else "stiffness"].append(abs(value / true - 1.0))
    # The errors of direct terms are errors of their logarithms.
    errors.append(math.log(value / true) / (error / value) if said.positive else (value - true) / error)


def _median_percent(values: list[float]) -> float:
    return 100.0 * float(np.median(values)) if values else math.nan


def _print_summary(outcomes: list[ScenarioOutcome], seconds: float) -> None:
    print(f"\nIdentified against the simulator's truth, after {seconds:.0f} s (medians over all runs):\n")
    columns = ("machine", "scenario", "runs", "accepted", "bearing k", "coupling k", "unbalance", "rms error/SE", "alert")
    rows = [
        (
            one.machine,
            one.scenario,
            str(one.identifications),
            str(one.accepted),
            f"{one.stiffness_percent:.2g} %",
            f"{one.coupling_percent:.2g} %",
            f"{one.unbalance_percent:.2g} %",
            f"{one.rms:.2f}",
            ", ".join(one.alerts) or "none",
        )
        for one in outcomes
    ]
    widths = [max(len(row[i]) for row in [columns, *rows]) for i in range(len(columns))]
    for row in [columns, *rows]:
        print("  " + "  ".join(f"{cell:<{width}}" for cell, width in zip(row, widths, strict=True)).rstrip())
    right = all(outcome.right for outcome in outcomes)
    print("\nEvery machine came out as simulated." if right else "\nNOT every machine came out as simulated.")
    sys.stdout.flush()


def _print_addresses(base: str) -> None:
    drifting = next(name for name, scenario in SCENARIOS.items() if scenario == "misalignment")
    page = base.split("/api/", 1)[0]
    print(f"\nTo look at, in a browser:\n  {page}/\n  {page}/#/machines/{drifting}\n\nAnd through the API:")
    for path in (
        "/docs",
        "/machines",
        "/alerts",
        f"/machines/{drifting}/runs",
        f"/machines/{drifting}/trends?parameter=coupling.C1.kxx&parameter=coupling.C1.kyy",
        "/health",
    ):
        print(f"  {base.rstrip('/')}{path}")
    sys.stdout.flush()
