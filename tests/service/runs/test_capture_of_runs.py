"""Tests what belongs to a run: samples before its trigger, by change of speed and time, of one sense of rotation; and bad
input."""

from typing import Any

import numpy as np
import pytest
from sqlalchemy import select

from estimator.runs.sample_selection import LARGEST_COUNT
from service.runs import run_samples
from service.runs.collector import Collector
from storage.database.engine import Database
from storage.encoding.sample_blocks import Samples
from storage.findings import jobs
from storage.machines import machines
from storage.measurements import runs
from storage.tables.measurements import CollectorRow, QuarantineRow, RunRow
from tests.plant import KEY, SECOND, START, arrived, batch, machine, sweep_rpm
from tests.prompt_writer import PromptWriter

DOWN, UP = sweep_rpm(2990.0, 310.0, 80), sweep_rpm(310.0, 2990.0, 80)
STANDSTILL = [250.0] * 3


def send(writer: PromptWriter, rpm: list[float], *, first: int = 0, step: int = SECOND, **changes: Any) -> int:
    """Samples numbered from `first`, a step apart, in messages of 500; the number of the next one."""
    for i in range(0, len(rpm), 500):
        piece = rpm[i : i + 500]
        writer.store([arrived(batch(piece, sequence=first + i, start=START + (first + i) * step, step=step, **changes))], [])
    return first + len(rpm)


def revise(database: Database, **changes: Any) -> None:
    with database.transaction() as session:
        machines.revise(session, machine(**changes))


def found(database: Database) -> list[tuple[RunRow, Samples | None]]:
    """Runs with their samples, oldest first."""
    with database.reading() as session:
        return [(row, runs.samples(session, row.id)) for row in reversed(runs.of_machine(session, KEY.machine))]


def only(database: Database) -> tuple[RunRow, Samples]:
    ((row, held),) = found(database)
    assert held is not None
    return row, held


def reasons(database: Database) -> set[str]:
    with database.reading() as session:
        return set(session.scalars(select(QuarantineRow.reason)))


# --- pre-trigger ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("seconds", [0, 5, 12])
def test_samples_shortly_before_the_trigger_belong_to_the_run(plant: Database, writer: PromptWriter, seconds: int) -> None:
    revise(plant, collection={"pre_trigger_s": seconds})
    send(writer, [*[2990.0] * 30, *DOWN, *STANDSTILL])
    row, held = only(plant)
    assert row.time_first == START + 30 * SECOND
    assert int(held.time[0]) == row.time_first - seconds * SECOND
    assert len(held) == 80 + seconds


def test_what_lies_below_the_speed_range_does_not(plant: Database, writer: PromptWriter) -> None:
    send(writer, [*[250.0] * 30, *UP, *[2990.0] * 200])
    row, held = only(plant)
    assert row.time_first == int(held.time[0]) == START + 30 * SECOND


def test_nor_does_what_belongs_to_the_run_before(plant: Database, writer: PromptWriter) -> None:
    revise(plant, collection={"pre_trigger_s": 60})
    send(writer, [*UP, *DOWN, *STANDSTILL])
    (up, up_held), (down, down_held) = found(plant)
    assert (up.kind, down.kind) == ("run-up", "run-down")
    assert up_held is not None
    assert down_held is not None
    assert up_held.time[-1] <= down_held.time[0]


# --- sweeps of all sorts --------------------------------------------------------------------------------------------


def test_up_and_down_and_up_again_are_three_runs(plant: Database, writer: PromptWriter) -> None:
    send(writer, [*UP, *DOWN[:60], *sweep_rpm(1000.0, 2990.0, 60), *[2990.0] * 200])
    assert [(row.kind, row.state) for row, _ in found(plant)] == [
        ("run-up", runs.CLOSED),
        ("run-down", runs.CLOSED),
        ("run-up", runs.CLOSED),
    ]


def test_a_run_up_that_turns_back_early_is_kept_and_not_identified(plant: Database, writer: PromptWriter) -> None:
    send(writer, [*sweep_rpm(310.0, 700.0, 30), *sweep_rpm(690.0, 310.0, 30), *STANDSTILL])
    for row, _ in found(plant):
        assert row.state == runs.DISCARDED
        assert row.reason is not None
        assert "it covers 14 % of the speed range" in row.reason
    with plant.reading() as session:
        assert jobs.of_machine(session, KEY.machine, limit=10) == []


def test_a_run_against_the_usual_sense_is_a_run_too(plant: Database, writer: PromptWriter) -> None:
    send(writer, [*DOWN, *STANDSTILL], direction="negative")
    row, held = only(plant)
    assert (row.direction, row.state) == (-1, runs.CLOSED)
    assert set(held.direction.tolist()) == {-1}


def test_a_heat_soak_is_part_of_a_run_up(plant: Database, writer: PromptWriter) -> None:
    send(writer, [*sweep_rpm(310.0, 1500.0, 60), *[1500.0] * 900, *sweep_rpm(1510.0, 2990.0, 60), *[2990.0] * 200])
    row, held = only(plant)
    assert (row.kind, row.state) == ("run-up", runs.CLOSED)
    assert len(held) <= LARGEST_COUNT
    assert row.coverage is not None
    assert row.coverage["largest_hole_rpm"] < 50


# --- by change of speed and time ------------------------------------------------------------------------------------


def test_a_run_keeps_samples_by_change_of_speed_and_time(plant: Database, writer: PromptWriter) -> None:
    revise(plant, collection={"delta_rpm": 100.0, "delta_s": 20.0})
    send(writer, [*sweep_rpm(2990.0, 1500.0, 80), *[1500.0] * 60, *sweep_rpm(1490.0, 310.0, 80), *STANDSTILL])
    _, held = only(plant)
    rpm, seconds = held.speed * 30 / np.pi, np.diff(held.time) / SECOND
    changed = np.abs(np.diff(rpm)) >= 100.0 - 1e-6
    assert np.all(changed | (seconds >= 20.0))
    assert 20 <= len(held) <= 35


def test_far_too_many_samples_are_thinned_and_all_stay_in_the_store(plant: Database, writer: PromptWriter) -> None:
    count = send(writer, [*sweep_rpm(2990.0, 310.0, 6000), *STANDSTILL], step=SECOND // 50)
    _, held = only(plant)
    assert LARGEST_COUNT * 0.98 < len(held) <= LARGEST_COUNT
    assert np.max(-np.diff(held.speed)) * 30 / np.pi < 4 * 2680 / LARGEST_COUNT
    with plant.reading() as session:
        assert sum(session.execute(select(QuarantineRow.id)).scalars()) == 0
        stored = session.connection().exec_driver_sql("SELECT SUM(count) FROM sample_blocks").scalar()
    assert stored == count


def test_a_run_too_long_to_read_is_read_in_steps(
    plant: Database, writer: PromptWriter, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(run_samples, "LARGEST_READ", 500 * 4)
    send(writer, [*sweep_rpm(2990.0, 310.0, 2000), *STANDSTILL])
    _, held = only(plant)
    assert 400 <= len(held) <= 500
    assert np.all(np.diff(held.time) == 4 * SECOND)


# --- bad input ------------------------------------------------------------------------------------------------------


def test_time_that_runs_backwards_is_kept_apart_with_its_reason(plant: Database, writer: PromptWriter) -> None:
    send(writer, DOWN)
    backwards = batch(UP, sequence=80, time_ns=[START + (79 - i) * SECOND for i in range(80)])
    writer.store([arrived(backwards)], [])
    assert reasons(plant) == {"time_out_of_order"}
    writer.settle(silence_s=0.0)
    row, held = only(plant)
    assert (row.state, row.reason, len(held)) == (runs.CLOSED, "the source fell silent", 80)


def test_a_speed_that_jumps_there_and_back_breaks_nothing(plant: Database, writer: PromptWriter) -> None:
    jumping = list(DOWN)
    jumping[20], jumping[40], jumping[60] = 0.0, 3800.0, 2990.0
    send(writer, [*jumping, *STANDSTILL])
    row, _ = only(plant)
    assert (row.kind, row.state) == ("run-down", runs.CLOSED)
    assert row.reason == "the speed left the speed range"


def test_a_run_without_samples_of_its_own_is_discarded(plant: Database, writer: PromptWriter) -> None:
    """Its samples may be gone when it closes."""
    send(writer, DOWN)
    with plant.transaction() as session:
        session.connection().exec_driver_sql("DELETE FROM sample_blocks")
    writer.settle(silence_s=0.0)
    ((row, held),) = found(plant)
    assert (row.state, row.count, row.coverage) == (runs.DISCARDED, 0, None)
    assert held is not None
    assert len(held) == 0


def test_a_run_that_an_older_release_had_open_goes_on(plant: Database, writer: PromptWriter) -> None:
    send(writer, DOWN[:40])
    with plant.transaction() as session:
        row = session.get(CollectorRow, KEY.machine)
        assert row is not None
        sweep = {key: row.state["operating"]["sweep"][key] for key in ("sweep", "direction", "last_time", "run_start")}
        sweep |= {key: row.state["operating"]["sweep"][key] for key in ("low_speed", "low_time", "high_speed", "high_time")}
        row.state = {"sweep": sweep, "revision": 1, "seen": row.state["seen"]}
    send(PromptWriter(plant, Collector()), [*DOWN[40:], *STANDSTILL], first=40)
    run, held = only(plant)
    assert (run.kind, run.state, len(held)) == ("run-down", runs.CLOSED, 80)
