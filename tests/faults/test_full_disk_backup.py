"""A disk that is full while a backup is made: the backup fails with words and leaves nothing; the service goes on."""

import os
import resource
import subprocess
import sys
from pathlib import Path

import pytest

from formats.wire import JSON, encode_body
from storage.backup import backup_file
from tests.end_to_end.processes import Service
from tests.faults.measured import measured
from tests.plant import document

MACHINE = "pump-8"
FULL_AT = 64 * 1024
"""Size at which a file can grow no more [B]."""


def test_a_backup_to_a_full_disk_fails_with_words_and_the_service_goes_on(tmp_path: Path) -> None:
    service = Service(tmp_path)
    target = tmp_path / "backups"
    target.mkdir()
    with service.client, service.running():
        assert service.client.post("/machines", json=document(id=MACHINE)).status_code == 201
        store(service, 0)
        done = back_up(service, target / "monday", limit=FULL_AT)
        assert done.returncode == 1, done.stderr
        assert "monday" in done.stderr
        assert "cannot be written" in done.stderr
        assert "Traceback" not in done.stderr
        assert not [one.name for one in target.iterdir()], "nothing that could be taken for a backup"
        store(service, 20)
        done = back_up(service, target / "monday", limit=resource.RLIM_INFINITY)
        assert done.returncode == 0, done.stderr
        assert backup_file.read(target / "monday").rows["machines"] == 1
        (row,) = service.get("/sources")
        assert (row["received"], row["lost"]) == (40, 0)


def store(service: Service, first: int) -> None:
    body = encode_body(measured(first, 20, machine=MACHINE), JSON)
    answer = service.client.post(f"/machines/{MACHINE}/samples", content=body, headers={"content-type": JSON})
    assert answer.status_code == 200, answer.text


def back_up(service: Service, file: Path, *, limit: int) -> "subprocess.CompletedProcess[str]":
    """`rundown backup` where no file that it writes grows beyond a limit [B], as on a disk that is full."""
    hard = resource.getrlimit(resource.RLIMIT_FSIZE)[1]
    if hard != resource.RLIM_INFINITY:
        pytest.skip("files are limited here already")
    code = (
        f"import resource, runpy, sys; resource.setrlimit(resource.RLIMIT_FSIZE, ({limit}, -1)); "
        "sys.argv[0] = 'rundown'; runpy.run_module('service', run_name='__main__')"
    )
    command = [sys.executable, "-c", code, "backup", str(file), "--database", service.database]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, check=False, env=dict(os.environ))
