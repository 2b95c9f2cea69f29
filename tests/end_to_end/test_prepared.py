"""Processes that were forked are commands as others are: their own arguments, environment, log and end."""

import signal
import subprocess
import sys
from pathlib import Path

import psutil
import pytest

from tests.end_to_end.prepared import PreparedProcess
from tests.end_to_end.processes import EXAMPLES, process, python, rundown, until
from tests.ports import free_port


def test_a_forked_command_says_and_returns_what_a_started_one_does(tmp_path: Path) -> None:
    told = []
    for begin, before in ((process, ()), (python, ("-m", "service"))):
        log = tmp_path / f"{begin.__name__}.log"
        with begin(log, *before, "serve", "--host", "nobody.invalid", RUNDOWN_WORKERS="many") as one:
            told.append((one.wait(60.0), log.read_text()))
    assert told[0] == told[1]
    assert told[0][0] != 0
    assert "workers" in told[0][1]


@pytest.mark.parametrize("document", [str(EXAMPLES / "motor-pump.yaml"), "nothing.yaml"])
def test_what_it_prints_and_its_errors_are_apart_as_of_a_started_one(document: str) -> None:
    command = [sys.executable, "-m", "service", "check", document]
    started = subprocess.run(command, capture_output=True, text=True, timeout=60.0, check=False)
    forked = rundown("check", document)
    assert (forked.returncode, forked.stdout, forked.stderr) == (started.returncode, started.stdout, started.stderr)
    assert (started.stderr == "") == (started.returncode == 0)


def test_a_command_that_takes_too_long_is_ended() -> None:
    with pytest.raises(subprocess.TimeoutExpired):
        rundown("router", "--listen", f"tcp/127.0.0.1:{free_port()}", timeout=0.5)


def test_how_it_was_ended_is_reported(tmp_path: Path) -> None:
    log = tmp_path / "router.log"
    with process(log, "router", "--listen", f"tcp/127.0.0.1:{free_port()}") as one:
        until(lambda: "routing on" in log.read_text(), within_s=30, what="it runs")
        assert one.poll() is None
        with pytest.raises(subprocess.TimeoutExpired):
            one.wait(0.01)
        one.kill()
        assert one.wait(10.0) == one.poll() == -signal.SIGKILL
        assert not psutil.pid_exists(one.pid)


def test_several_run_side_by_side_and_share_nothing_that_is_open(tmp_path: Path) -> None:
    with (tmp_path / "log").open("ab") as log:
        around = {"PATH": "/usr/bin"}
        first, second = (
            PreparedProcess(["router", "--listen", f"tcp/127.0.0.1:{free_port()}"], log, around) for _ in range(2)
        )
    try:
        assert first.pid != second.pid
        assert {Path(one.path) for one in psutil.Process(second.pid).open_files()} <= {tmp_path / "log"}
    finally:
        for one in (first, second):
            one.kill()
    assert [one.wait(30.0) for one in (first, second)] == [-signal.SIGKILL] * 2
