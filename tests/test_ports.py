"""Tests that no two processes of tests hand out the same ports, even those of two runs beside each other."""

import os
import subprocess
import sys

PROCESSES = 4
HAND_OUT = "import sys; from tests.ports import free_port; print(free_port(), flush=True); sys.stdin.read()"


def test_each_process_has_ports_of_its_own() -> None:
    same = os.environ | {"PYTEST_XDIST_TESTRUNUID": "00000000", "PYTEST_XDIST_WORKER": "gw0"}
    command = [sys.executable, "-c", HAND_OUT]
    started = [
        subprocess.Popen(command, env=same, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) for _ in range(PROCESSES)
    ]
    ports = [int(one.stdout.readline()) for one in started if one.stdout is not None]
    for one in started:
        one.communicate()
    assert len({port // 1_000 for port in ports}) == PROCESSES, ports
