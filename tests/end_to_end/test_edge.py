"""The edge agent and the service as processes of their own, killed at any time: what is stored is what was measured."""

import subprocess
import sys
import time
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest
import pyuff
import yaml
from asammdf import MDF, Signal
from sqlalchemy import select

from estimator.arrays import Floats
from storage.database.engine import Database
from storage.encoding.sample_blocks import Samples
from storage.measurements import samples
from storage.tables.measurements import SampleBlockRow
from tests.end_to_end.processes import Service, process, until
from tests.plant import KEY, assert_same_samples, document
from tests.waveforms import RATE, START_NS, edge_document, recorded, true_phasors

SECONDS = 45.0
BLOCKS = 90


def write_configuration(folder: Path, service: Service, machine: str, **changes: object) -> Path:
    path = folder / f"{machine}.yaml"
    log = {"path": f"{machine}.log"}
    path.write_text(yaml.safe_dump(edge_document(machine=machine, connect=[service.endpoint], log=log, **changes)))
    return path


def stored(service: Service, machine: str) -> Samples:
    """Read from the service's database, in the order of the source's numbers."""
    database = Database(service.database)
    try:
        with database.reading() as session:
            query = select(SampleBlockRow.first_sequence).where(SampleBlockRow.machine_id == machine)
            firsts = list(session.scalars(query.order_by(SampleBlockRow.first_sequence)))
            assert len(firsts) == len(set(firsts))
            return samples.between(session, machine, revision=1, first=0, last=2**62)
    finally:
        database.close()


def received(service: Service, machine: str) -> int:
    return sum(one["received"] for one in service.get("/sources") if one["machine"] == machine)


def create(service: Service, machine: str) -> None:
    answer = service.client.post("/machines", json=document(id=machine))
    assert answer.status_code == 201, answer.text


def kill(one: "subprocess.Popen[bytes]") -> None:
    one.kill()
    one.wait()


@pytest.mark.long
def test_edge_and_service_killed_the_store_is_that_of_an_undisturbed_run(service: Service, tmp_path: Path) -> None:
    """The same file for two machines: for one nothing happens, for the other edge, service and edge again are killed."""
    waveforms = recorded(SECONDS, rpm=600.0, ramp=10.0, noise=0.02)  # too short a sweep to be identified
    np.savez(tmp_path / "run.npz", **dict(zip("KAB", waveforms, strict=True)))
    quiet, hit = "pump-8", KEY.machine
    disturbed = write_configuration(tmp_path, service, hit)
    arguments = ["edge", str(disturbed), "--speedup", "12"]
    log = tmp_path / "edge.log.txt"
    with service.running() as serving:
        create(service, quiet)
        create(service, hit)
        with process(tmp_path / "quiet.txt", "edge", str(write_configuration(tmp_path, service, quiet))):
            until(lambda: received(service, quiet) == BLOCKS, within_s=100, what="the undisturbed file is stored")
        with process(log, *arguments) as first:
            until(lambda: received(service, hit) > 15, within_s=100, what="a beginning is stored")
            kill(first)
        with process(log, *arguments) as second:
            until(lambda: received(service, hit) > 40, within_s=100, what="more is stored")
            kill(serving)
            time.sleep(0.7)
            kill(second)
    with process(log, *arguments), service.running():
        until(lambda: received(service, hit) == BLOCKS, within_s=100, what="all is stored")
        sources = [one for one in service.get("/sources") if one["machine"] == hit]
    assert [(one["next_sequence"], one["received"], one["lost"]) for one in sources] == [(BLOCKS, BLOCKS, 0)]
    assert "Traceback" not in log.read_text()
    found = stored(service, hit)
    assert_same_samples(found, stored(service, quiet))
    assert len(found) == BLOCKS
    assert (np.diff(found.time) > 0).all()


def _write_uff58(path: Path, named: dict[str, Floats]) -> None:
    """Write waveforms as the reference writer does: one dataset of type 58 for each, of time."""
    file = pyuff.UFF(str(path))
    for name, values in named.items():
        said = {"type": 58, "binary": 0, "func_type": 1, "id1": name, "abscissa_spec_data_type": 17}
        places = {"rsp_node": 1, "rsp_dir": 1, "ref_node": 1, "ref_dir": 1}
        kinds = {"ordinate_spec_data_type": 8, "orddenom_spec_data_type": 0}
        file.write_sets(said | places | kinds | {"data": values, "x": np.arange(values.size) / RATE}, mode="add")


def _write_mdf4(path: Path, named: dict[str, Floats]) -> None:
    """Write waveforms as the reference writer does: one group, which says when it begins."""
    with MDF(version="4.10") as file:
        times = np.arange(next(iter(named.values())).size) / RATE
        file.append([Signal(values, times, name=name) for name, values in named.items()])
        file.header.start_time = datetime.fromtimestamp(START_NS / 1e9, UTC)
        file.save(path, overwrite=True)


def _through_agent(service: Service, folder: Path, kind: str) -> Samples:
    """Return what the service has stored of a file that an agent read; only MDF4 says itself when it begins."""
    machine = f"pump-{kind}"
    create(service, machine)
    start = {} if kind == "mf4" else {"start": "2023-11-14T22:13:20Z"}
    waveforms = {"files": [{"path": f"run.{kind}"} | start], "sampling_rate": RATE}
    configuration = write_configuration(folder, service, machine, waveforms=waveforms)
    with process(folder / f"{kind}.txt", "edge", str(configuration)):
        until(lambda: received(service, machine) == BLOCKS, within_s=60, what=f"{kind} is stored")
    (run,) = service.get(f"/machines/{machine}/runs")
    assert run["kind"] == "run-up"
    return stored(service, machine)


@pytest.mark.long
def test_waveforms_of_vendors_files_become_the_same_samples(service: Service, tmp_path: Path) -> None:
    """A run-up as UFF58 and as MDF4, each through an agent into the service; beside them the same numbers as NPZ."""
    named = dict(zip("KAB", recorded(SECONDS, rpm=600.0, ramp=20.0, noise=0.02), strict=True))
    np.savez(tmp_path / "run.npz", **named)
    _write_uff58(tmp_path / "run.uff", named)
    _write_mdf4(tmp_path / "run.mf4", named)
    with service.running():
        found = {kind: _through_agent(service, tmp_path, kind) for kind in ("npz", "uff", "mf4")}
    for kind in ("uff", "mf4"):
        np.testing.assert_allclose(found[kind].phasor, found["npz"].phasor, rtol=1e-4, atol=1e-9)
        np.testing.assert_allclose(found[kind].speed, found["npz"].speed, rtol=1e-6)
        assert found[kind].time.tolist() == found["npz"].time.tolist()
    first, _ = true_phasors(2)
    assert np.abs(found["uff"].phasor[:, :2]) == pytest.approx(
        np.tile(np.abs(first) / [8000.0, 4000.0], (BLOCKS, 1)), rel=0.02
    )


PEAK = """
import resource, sys
from pathlib import Path
from service.edge.blocks import BlockStream
from service.edge.agent import block_settings
from service.edge.condition import Conditions
from service.edge.configuration import read_configuration
from service.edge.files import read_chunks

used = read_configuration(Path(sys.argv[1]))
stream, blocks = BlockStream(block_settings(used)), 0
def peak():
    # getrusage would tell the peak of the process that started this one, where that is larger
    return int(Path("/proc/self/status").read_text().partition("VmHWM:")[2].split()[0])

before = peak()
for chunk in read_chunks(used.waveforms.files[0], used.waveforms, used.columns, Conditions()):
    blocks += sum(1 for _ in stream.feed(chunk))
print(blocks, peak() - before)
"""


def test_a_long_file_takes_no_more_memory_than_a_short_one(service: Service, tmp_path: Path) -> None:
    """60 MB of waveforms; what is read at a time, and the block, are a twentieth of that."""
    whole = np.tile(recorded(100.0, rpm=1500.0), 12)
    path = tmp_path / "run.npz"
    np.savez(path, K=whole[0], A=whole[1], B=whole[2])
    configuration = write_configuration(tmp_path, service, KEY.machine, block={"seconds": 10})
    command = [sys.executable, "-c", PEAK, str(configuration)]
    answer = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True)
    blocks, kilobytes = (int(word) for word in answer.stdout.split())
    assert path.stat().st_size > 55e6
    assert blocks >= 119
    assert kilobytes < 25_000
