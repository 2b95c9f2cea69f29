"""`rundown demo`: every machine comes out as simulated, it serves until Ctrl-C, and leaves nothing running."""

import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx
import psutil
import pytest
from typer.testing import CliRunner

from service.commands import demo
from service.commands.app import app
from tests.contradictions import contradictions
from tests.end_to_end.processes import until


@contextmanager
def demonstration(log: Path) -> Iterator[psutil.Popen]:
    """The demo as a process; killed with its children should a test fail."""
    with log.open("wb") as output:
        process = psutil.Popen([sys.executable, "-m", "service", "demo"], stdout=output, stderr=subprocess.STDOUT)
        try:
            yield process
        finally:
            for left in [*process.children(recursive=True), process] if process.is_running() else []:
                left.kill()
            process.wait()


def interrupted(process: psutil.Popen) -> list[psutil.Process]:
    """Press Ctrl-C; returns what is still alive of its children afterwards."""
    children = process.children(recursive=True)
    assert children
    process.send_signal(signal.SIGINT)
    assert process.wait(30) == 0
    return list(psutil.wait_procs(children, timeout=5)[1])


@pytest.mark.long
def test_scenario_comes_out_right_and_ctrl_c_leaves_nothing(tmp_path: Path) -> None:
    log = tmp_path / "demo.log"
    with demonstration(log) as process:
        until(lambda: "Serving until Ctrl-C" in log.read_text(), within_s=240, what=f"the summary:\n{log.read_text()}")
        summary = log.read_text()
        assert "Every machine came out as simulated." in summary
        lines = {
            line.split()[0]: line
            for line in summary.splitlines()
            if line.startswith("  ") and line.split()[0] in demo.SCENARIOS
        }
        assert lines["motor-pump"].endswith("misalignment of coupling.C1")
        assert lines["thesis-chapter-3"].endswith("unbalance of disc.D1")
        assert lines["turbine-compressor-generator"].endswith("none")
        for url in re.findall(r"^  (http\S+)$", summary, flags=re.MULTILINE):
            assert httpx.get(url).status_code == 200
        base = re.findall(r"^  (http\S+/api/v1)/machines$", summary, flags=re.MULTILINE)[0]
        for machine in demo.SCENARIOS:
            wrong, compared = contradictions(lambda path: httpx.get(base + path, timeout=30.0).json(), machine)
            assert wrong == []
            assert compared > 20 or demo.SCENARIOS[machine] == "healthy"
        assert interrupted(process) == []


@pytest.mark.long
def test_ctrl_c_in_the_middle_leaves_nothing(tmp_path: Path) -> None:
    log = tmp_path / "demo.log"
    with demonstration(log) as process:
        until(lambda: re.search(r"\d{3} samples", log.read_text()), within_s=60, what="the scenario has begun")
        assert interrupted(process) == []
    folder = re.search(r"its files in (\S+)", log.read_text())
    assert folder is not None
    assert not Path(folder[1]).exists()


@pytest.mark.parametrize(("right", "status"), [(True, 0), (False, 1)])
def test_exit_status_tells_whether_the_scenario_came_out_right(
    monkeypatch: pytest.MonkeyPatch, right: bool, status: int
) -> None:
    monkeypatch.setattr(demo, "run", lambda *, leave, port, as_json: right and leave and port == 0 and not as_json)
    assert CliRunner().invoke(app, ["demo", "--exit"]).exit_code == status


@pytest.mark.parametrize(
    "change",
    [
        {"rms": 1.6},
        {"rms": 0.4},
        {"rms": float("nan")},
        {"accepted": 23},
        {"alerts": []},
        {"identifications": 0, "accepted": 0},
    ],
)
def test_a_scenario_told_wrong_is_not_right(change: dict[str, object]) -> None:
    good: dict[str, Any] = {
        "machine": "motor-pump",
        "scenario": "misalignment",
        "identifications": 24,
        "accepted": 24,
        "rms": 1.0,
        "stiffness_percent": 0.3,
        "coupling_percent": 1.5,
        "unbalance_percent": 0.6,
        "alerts": ["misalignment of coupling.C1"],
    }
    assert demo.ScenarioOutcome(**good).right
    assert not demo.ScenarioOutcome(**(good | change)).right
    assert not demo.ScenarioOutcome(**(good | {"scenario": "healthy"})).right
