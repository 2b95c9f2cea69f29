"""`rundown backup`, `restore`, `move` and `export`, run as commands on a database with a run and its identification."""

import csv
import errno
import json
import os
import stat
from pathlib import Path

import numpy as np
import pytest
from arro3.io import read_parquet
from sqlalchemy import select

from service.alerts.transitions import AlertFinding, raise_alert
from storage.alerts import suppressions
from storage.clock import to_datetime
from storage.database.engine import Database
from storage.encoding.sample_blocks import Samples
from storage.machines import balancings, calibrations, limits, machines, model_calibrations
from storage.measurements import runs
from storage.tables.alerting import SuppressionRow
from storage.tables.base import Base
from storage.tables.findings import DiagnosisRow
from storage.tables.machines import (
    BalancingRow,
    BaselineRow,
    CalibrationRow,
    LimitsRow,
    ModelCalibrationRow,
    SlowRollRow,
    TimelineRow,
)
from storage.tables.measurements import MachineStateRow
from tests.databases import Databases
from tests.end_to_end.processes import EXAMPLES
from tests.plant import CHANNELS, KEY, SECOND, START, identification, machine, samples, sqlite_url, store_identification
from tests.service.commands.command_line import run

COUNT = 1234
SAID: dict[str, type[Base]] = {
    "diagnoses": DiagnosisRow,
    "baselines": BaselineRow,
    "timeline": TimelineRow,
    "suppressions": SuppressionRow,
    "limits": LimitsRow,
    "calibrations": CalibrationRow,
    "model_calibrations": ModelCalibrationRow,
    "balancings": BalancingRow,
    "slow_roll_vectors": SlowRollRow,
    "states": MachineStateRow,
}
"""Files of what was said of a machine and done with it, and what they are read from."""


@pytest.fixture
def held() -> Samples:
    return samples(COUNT, rpm=np.linspace(2900.0, 400.0, COUNT).tolist())


@pytest.fixture
def told(plant: Database, held: Samples) -> Database:
    with plant.transaction() as session:
        machines.create(session, machine(id="other"))
        machines.revise(session, machine(conditions=[{"name": "load", "unit": "kW"}]))
        row = runs.open_run(session, KEY.machine, revision=1, kind="run-down", direction=1, time_first=START)
        runs.close(row, samples=held, state=runs.CLOSED, reason="the speed left the speed range")
        found = store_identification(session, identification(unknown=["coupling.C1.kxx"]), run_id=row.id)
        store_identification(session, identification(), run_id=99, machine_id="other")
        raise_alert(
            session,
            KEY.machine,
            rule="misalignment",
            element="coupling.C1",
            finding=AlertFinding({}, found.id, START),
        )
    return plant


def test_backed_up_restored_and_moved(told: Database, databases: Databases, tmp_path: Path) -> None:
    said = run("backup", str(tmp_path / "nightly"), "--database", told.url)
    assert "SHA-256" in said
    assert "exists already" in run("backup", str(tmp_path / "nightly"), "--database", told.url, status=1)
    there = databases.new(tmp_path / "there.db")
    assert "restored" in run("restore", str(tmp_path / "nightly"), "--database", there)
    assert "--overwrite" in run("restore", str(tmp_path / "nightly"), "--database", there, status=1)
    run("restore", str(tmp_path / "nightly"), "--database", there, "--overwrite")
    away = sqlite_url(tmp_path / "away.db")
    said = run("move", there, away)
    assert "the same on both sides" in said
    assert "holds" in run("move", there, away, status=1)
    moved = Database(away)
    with moved.reading() as session:
        assert [row.id for row in machines.list_all(session)] == ["other", "pump-7"]
    moved.close()
    databases.drop(there)


def test_a_machine_s_history_is_exported(told: Database, held: Samples, tmp_path: Path) -> None:
    said = run("export", KEY.machine, str(tmp_path / "pump"), "--database", told.url)
    assert f"samples-1 {COUNT:27d}".split() == next(line for line in said.splitlines() if line.startswith("samples-1")).split()
    columns = json.loads((tmp_path / "pump" / "columns.json").read_text())["files"]
    for name, described in columns.items():
        with (tmp_path / "pump" / f"{name}.csv").open() as file:
            header, *rows = csv.reader(file)
        table = read_parquet(tmp_path / "pump" / f"{name}.parquet").read_all()
        assert header == table.column_names == [one["name"] for one in described]
        assert all(one["meaning"] for one in described)
        assert len(rows) == table.num_rows
        for i, one in enumerate(described):
            for text, value in zip([row[i] for row in rows], table.column(i).to_pylist(), strict=True):
                assert same(text, value, one["kind"]), (name, one["name"], text, value)
    assert {
        "identifications",
        "trends",
        "derived",
        "alerts",
        "alert_events",
        "runs",
        "samples-1",
        "samples-2",
        *SAID,
    } == columns.keys()
    comparable = {"revision", "run_kind", "slow_roll_version", "load_balance"}
    assert comparable <= {one["name"] for one in columns["identifications"]}, "what tells which may be compared"
    check_samples(tmp_path / "pump", held)
    assert json.loads((tmp_path / "pump" / "machine-2.json").read_text())["conditions"][0]["name"] == "load"
    assert columns["samples-2"][-1]["unit"] == "kW"


def same(text: str, value: object, kind: str) -> bool:
    if value is None:
        return text == ""
    if kind == "number":
        return float(text) == value
    if kind == "integer":
        return int(text) == value
    if kind == "truth":
        return text == str(value).lower()
    return kind == "time" or text == value


def check_samples(folder: Path, held: Samples) -> None:
    """Exact, in both formats."""
    table = read_parquet(folder / "samples-1.parquet").read_all()
    assert np.array_equal(table["speed"].to_numpy(), held.speed)
    with (folder / "samples-1.csv").open() as file:
        rows = list(csv.DictReader(file))
    for number, channel in enumerate(CHANNELS):
        good = np.isfinite(held.phasor[:, number])
        parts = [[float(row[f"{channel}.{part}"] or "nan") for row in rows] for part in ("real", "imaginary")]
        assert np.array_equal(np.array(parts[0])[good], held.phasor.real[good, number])
        assert np.array_equal(np.array(parts[1])[good], held.phasor.imag[good, number])
        assert np.all(np.isnan(np.array(parts[0])[~good]))
    assert rows[0]["time"] == to_datetime(START).strftime("%Y-%m-%dT%H:%M:%S.000000000Z")


def test_a_run_that_cannot_be_read_is_left_out_of_an_export(
    told: Database, held: Samples, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    with told.transaction() as session:
        damaged = runs.open_run(session, KEY.machine, revision=1, kind="run-up", direction=1, time_first=START - SECOND)
        runs.close(damaged, samples=held, state=runs.CLOSED, reason="")
        assert damaged.data is not None
        damaged.data = damaged.data[:-1]
        number = damaged.id
    said = run("export", KEY.machine, str(tmp_path / "pump"), "--database", told.url)
    assert f"samples-1 {COUNT}".split() in [line.split() for line in said.splitlines()]
    assert f"left out: the samples of run {number} cannot be read: sample block is damaged" in caplog.text


def test_an_export_is_its_owners_only(told: Database, tmp_path: Path) -> None:
    before = os.umask(0)
    try:
        run("export", KEY.machine, str(tmp_path / "pump"), "--database", told.url)
        run("sample", str(EXAMPLES / "motor-pump.yaml"), str(tmp_path / "run.csv"), "--samples", "20")
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "pump").stat().st_mode) == 0o700
    files = [*(tmp_path / "pump").iterdir(), tmp_path / "run.csv", tmp_path / "run.yaml"]
    assert {one.suffix for one in files} == {".csv", ".parquet", ".json", ".yaml"}
    assert {stat.S_IMODE(one.stat().st_mode) for one in files} == {0o600}


def test_what_cannot_be_exported_is_said(told: Database, tmp_path: Path) -> None:
    misspelt = run("export", "pomp-7", str(tmp_path / "x"), "--database", told.url, status=1)
    assert misspelt == f"rundown: no machine 'pomp-7' is known; did you mean '{KEY.machine}'?\n"
    (tmp_path / "y").mkdir()
    (tmp_path / "y" / "letter.txt").touch()
    assert "is not empty" in run("export", KEY.machine, str(tmp_path / "y"), "--database", told.url, status=1)


def test_a_backup_that_cannot_be_written_or_read_ends_with_a_line(told: Database, tmp_path: Path) -> None:
    (tmp_path / "letter").touch()
    for name in ("letter/nightly", "n" * 251):
        for command in ("backup", "restore"):
            (line,) = run(command, str(tmp_path / name), "--database", told.url, status=1).splitlines()
            assert line.startswith("rundown: ")


def test_a_folder_that_may_not_be_looked_into_ends_with_a_line(told: Database, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of which root, who may run the tests, knows nothing."""

    def forbidden(path: Path) -> bool:
        raise PermissionError(errno.EACCES, "Permission denied", str(path))

    monkeypatch.setattr(Path, "exists", forbidden)
    monkeypatch.setattr(Path, "is_file", forbidden)
    secret = sqlite_url(Path("/secret/rundown.db"))
    for arguments in (
        ("backup", "/secret/nightly", "--database", told.url),
        ("move", secret, told.url),
        ("export", "pump-7", "/secret/pump", "--database", secret),
        ("key", "list", "--database", secret),
    ):
        (line,) = run(*arguments, status=1).splitlines()
        assert "Permission denied" in line


def test_a_move_from_nowhere_ends_with_a_line(tmp_path: Path) -> None:
    said = run("move", sqlite_url(tmp_path / "nope.db"), sqlite_url(tmp_path / "nope2.db"), status=1)
    assert "there is no database file" in said
    assert list(tmp_path.iterdir()) == []


def test_a_move_says_where_nul_was_escaped(databases: Databases, tmp_path: Path) -> None:
    source = Database(sqlite_url(tmp_path / "source.db"))
    with source.transaction() as session:
        machines.create(session, machine())
        session.add(TimelineRow(machine_id=KEY.machine, at=START, kind="note", text="a\0b", by="x", created_at=START))
    source.close()
    target = databases.new(tmp_path / "nul_target.db")
    said = run("move", source.url, target)
    assert ("timeline.text: NUL in 1 texts, which PostgreSQL cannot hold, is \\x00 there" in said) == ("postgresql" in target)
    databases.drop(target)


def test_what_was_said_of_a_machine_is_exported_and_nothing_of_others(told: Database, tmp_path: Path) -> None:
    with told.transaction() as session:
        for of, number in ((KEY.machine, 1), ("other", 2)):
            session.add(
                BaselineRow(machine_id=of, since=START, identification_ids=[1], reason="new", by="x", created_at=START)
            )
            session.add(TimelineRow(machine_id=of, at=START, kind="note", text="a, b\nö", by="x", created_at=START))
            suppressions.add(session, of, kind="shelved", rule="misalignment", element=None, until=None, by="x", comment="why")
            limits.add(session, of, document={"deep": [1.5]}, by="x", comment="")
            calibrations.add(session, of, channel="DE-x", at=START, certificate="no. 7", by="x")
            balancings.add(session, of, revision=1, initial=[1], by="x", comment="")
            model_calibrations.add(session, of, revision=1, asked={"runs": [], "seed": 0}, by="x", comment="")
            vectors = {"DE-x": {"refused": "none"}}
            kept = SlowRollRow(machine_id=of, version=1, created_at=START, origin="given", direction=1, vectors=vectors)
            kept.comment = ""
            session.add(kept)
            session.add(MachineStateRow(machine_id=of, since=START, mode="stopped", speed=None))
            session.add(
                DiagnosisRow(
                    identification_id=number,
                    machine_id=of,
                    measured_at=START,
                    made_at=START,
                    baseline=[1],
                    runs=1,
                    causes=[{"cause": "wear"}],
                )
            )
    run("export", KEY.machine, str(tmp_path / "pump"), "--database", told.url)
    described = json.loads((tmp_path / "pump" / "columns.json").read_text())["files"]
    for name, table in SAID.items():
        with (tmp_path / "pump" / f"{name}.csv").open(newline="") as file:
            (row,) = csv.DictReader(file)
        with told.reading() as session:
            stored = session.scalars(select(table).where(table.__table__.c.machine_id == KEY.machine)).one()
            for column in described[name]:
                value = getattr(stored, "identification_id" if column["name"] == "identification" else column["name"])
                if column["kind"] == "text":
                    value = value if value is None or isinstance(value, str) else json.dumps(value, ensure_ascii=False)
                assert same(row[column["name"]], value, column["kind"]), (name, column)
                assert (row[column["name"]] == "") == (value in (None, "")), (name, column)
        left_out = {one.name for one in table.__table__.columns} - {one["name"] for one in described[name]}
        assert left_out <= {"id", "machine_id", "identification_id", "job_id"}, name
