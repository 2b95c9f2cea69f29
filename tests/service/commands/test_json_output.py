"""`--json`: each command that prints results prints them for programs, too, and nothing else on the standard output."""

import json
from datetime import UTC, datetime
from enum import Enum
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import typer.main
import yaml
from typer.testing import CliRunner

import rotorundown as rd
from formats.recordings.written_recording import write_recording
from service.commands.app import app
from service.commands.json_output import json_value
from service.commands.terminal import working
from storage.backup.transfer import move
from storage.database.engine import Database
from storage.machines import machines
from tests.paths import EXAMPLES
from tests.plant import machine
from tests.service.commands.command_line import run

PUMP = str(EXAMPLES / "motor-pump.yaml")
WITHOUT_RESULT = {"serve", "worker", "router", "simulate", "replay", "edge", "init", "document"}
"""Commands that print no result: they work until they are ended, or write a file to edit; `document` prints JSON anyway."""


def printed(*arguments: str, status: int = 0) -> Any:
    """Return the decoded JSON that a command prints with --json on its standard output."""
    ended = CliRunner().invoke(app, [*arguments, "--json"])
    assert ended.exit_code == status, ended.output
    return json.loads(ended.stdout)


@pytest.fixture(scope="module")
def recordings(tmp_path_factory: pytest.TempPathFactory) -> tuple[str, str]:
    """A healthy and a misaligned run-down of the pump, as files."""
    pump, folder = rd.read_machine(PUMP), tmp_path_factory.mktemp("runs")
    files = folder / "healthy.csv", folder / "later.csv"
    for seed, (file, scenario) in enumerate(zip(files, ("healthy", "misalignment"), strict=True), 1):
        run = rd.simulate(pump, scenario=scenario, run_seed=seed, samples=100)  # type: ignore[arg-type]
        write_recording(file, pump, speed_rpm=run.speed_rpm, phasor=run.recorded.phasor, interval_s=run.interval_s)
    return str(files[0]), str(files[1])


def test_every_command_that_prints_results_has_it() -> None:
    group: Any = typer.main.get_command(app)
    commands = {name: one for name, one in group.commands.items() if not hasattr(one, "commands")}
    for name, one in group.commands.items():
        commands |= {f"{name} {inner}": each for inner, each in getattr(one, "commands", {}).items()}
    lacking = {name for name, one in commands.items() if not any("--json" in option.opts for option in one.params)}
    assert lacking == WITHOUT_RESULT


FAILING: dict[str, tuple[tuple[str, ...], str]] = {
    "no such file": (("check", "nowhere.yaml"), "nowhere.yaml"),
    "no such run": (("identify", PUMP, "nowhere.csv"), "nowhere.csv: no such file"),
    "no such database": (("key", "list", "--database", "sqlite:///nowhere.db"), "there is no database file"),
    "nothing to ask": (("retention", "confirm"), "--json asks nobody"),
}


@pytest.mark.parametrize("name", FAILING)
def test_what_fails_is_an_error_in_json(name: str) -> None:
    arguments, words = FAILING[name]
    found = printed(*arguments, status=1)
    assert list(found) == ["error"]
    assert words in found["error"]


def test_a_result_that_ends_in_a_failure_is_printed_once() -> None:
    assert printed("check", PUMP, "nowhere.csv", status=1)["machine"] == "motor-pump"
    assert CliRunner().invoke(app, ["check", "nowhere.yaml"]).stdout == ""


def test_an_identification(recordings: tuple[str, str]) -> None:
    found = printed("identify", PUMP, recordings[0], "--advice")
    speeds = [one["speed_rpm"] for one in found["advice"] if "speed_rpm" in one]
    probes = [one["probe"]["shaft"] for one in found["advice"] if "probe" in one]
    assert (len(speeds), set(probes) <= {"motor", "pump"}, bool(probes)) == (3, True, True)
    assert all(300.0 <= one <= 3600.0 for one in speeds)
    assert all(0.0 < one["shrinkage"] < 1.0 for one in found["advice"])
    assert (found["machine"], found["accepted"]) == ("motor-pump", True)
    estimates = {one["name"]: one for one in found["estimates"]}
    kxx = estimates["coupling.C1.kxx"]
    assert kxx["lower"] < kxx["value"] < kxx["upper"]
    disc = next(one for one in estimates.values() if one["quantity"] == "unbalance")
    assert disc["g_mm"] == pytest.approx(1e6 * abs(complex(disc["value"], disc["imaginary"])))
    assert 0.0 <= disc["angle_deg"] < 360.0
    assert found["runs"][0]["run"] == "healthy.csv"


def test_a_model(recordings: tuple[str, str]) -> None:
    found = printed("model", PUMP, recordings[0], "--service-rpm", "1450")
    assert found["critical_speeds"][0]["rpm"] > 0.0
    load = found["coupling_loads"][0]
    assert load["lower"] <= load["amplitude"] <= load["upper"]
    assert (load["coupling"], load["load"], load["unit"]) == ("C1", "force_x", "N")
    assert {one["bearing"] for one in found["residual_unbalance"]} == {"B1", "B2", "B3", "B4"}
    assert found["correction_at_service_speed"][0]["g_mm"] > 0.0
    peaks = found["response_peaks"]
    assert {one["channel"] for one in peaks} <= set(rd.read_machine(PUMP).channels)
    printed_peaks = [line.split() for line in run("model", PUMP, recordings[0], "--service-rpm", "1450").splitlines()]
    for one in peaks:
        assert [one["channel"], f"{one['rpm']:.0f}"] in [line[:2] for line in printed_peaks]
    assert {one["met"] for one in peaks} <= {True, False, None}


def test_an_impact_test_beside_the_model(tmp_path: Path) -> None:
    document = yaml.safe_load(Path(PUMP).read_text())
    document["impact_test"] = {"frequencies_hz": [5.0, 34.0]}
    path = tmp_path / "tested.yaml"
    path.write_text(yaml.safe_dump(document))
    found = printed("model", str(path))["impact_test"]
    assert [one["measured_hz"] for one in found["compared"]] == [34.0]
    assert found["unmatched_hz"] == [5.0]
    (compared,) = found["compared"]
    assert compared["deviation"] == pytest.approx(compared["model_hz"] / 34.0 - 1.0)


def test_a_model_of_the_document_alone() -> None:
    found = printed("model", PUMP, "--service-rpm", "1450")
    assert (found["machine"], found["nominal"], found["service_rpm"]) == ("motor-pump", True, 1450.0)
    assert "nominal values" in found["origin"]
    speeds = [one["rpm"] for one in found["critical_speeds"]]
    assert speeds == pytest.approx([one.speed_rpm for one in rd.model(rd.read_machine(PUMP)).critical_speeds()])
    curves = found["campbell"]
    assert len(curves["speed_rpm"]) == len(curves["modes"][0]["frequency_cpm"])
    assert found["modes"][0]["speed_rpm"] == 1450.0
    assert found["coupling_loads"], "by the unbalances that the document states"
    response = rd.model(rd.read_machine(PUMP)).response(1450)
    assert [one["um_pp"] for one in found["response"]] == pytest.approx(list(response.amplitude_um_pp[0]))


def test_a_comparison_and_slow_roll(recordings: tuple[str, str]) -> None:
    found = printed("compare", PUMP, *recordings, "--coupling", "C1")
    assert found["preferred"] == "changed coefficients"
    assert found["estimates"]
    assert printed("slow-roll", PUMP, recordings[0], "300:400")["channels"]


def test_a_look_at_document_and_runs(recordings: tuple[str, str], tmp_path: Path) -> None:
    (tmp_path / "wrong.csv").write_text("speed\n")
    found = printed("check", PUMP, recordings[0], str(tmp_path / "wrong.csv"), status=1)
    assert (found["shaft"], found["coupling"], found["warnings"]) == (2, 1, [])
    first, second = found["runs"]
    assert first["samples"] == 100
    assert "no rows below a header line" in second["wrong"]


def test_stores_and_keys(tmp_path: Path) -> None:
    url = f"sqlite:///{tmp_path / 'rundown.db'}"
    database = Database(url)
    with database.transaction() as session:
        machines.create(session, machine())
    database.close()
    CliRunner().invoke(app, ["key", "create", "historian", "--role", "viewer", "--database", url])
    (key,) = printed("key", "list", "--database", url)
    assert (key["name"], key["state"], key["plants"]) == ("historian", "valid", None)
    assert printed("audit", "verify", "--database", url)["wrong"] == []
    made = printed("backup", str(tmp_path / "monday.db"), "--database", url)
    assert made["rows"]["machines"] == 1
    assert len(made["sha256"]) == 64
    assert printed("export", machine().id, str(tmp_path / "out"), "--database", url)["machine"] == machine().id
    moved = printed("move", url, f"sqlite:///{tmp_path / 'new.db'}")
    assert moved["rows"]["machines"] == 1


def test_the_life_of_a_key(database: Database) -> None:
    made = printed("key", "create", "historian", "--role", "viewer", "--plant", "north", "--database", database.url)
    assert made["key"].startswith(f"rundown_{made['prefix']}")
    assert (made["name"], made["role"], made["plants"], made["state"]) == ("historian", "viewer", ["north"], "valid")
    new = printed("key", "rotate", made["prefix"], "--database", database.url)
    assert (new["replaces"], new["overlap_days"], new["name"]) == (made["prefix"], 7.0, "historian")
    assert new["key"].startswith(f"rundown_{new['prefix']}")
    assert printed("key", "confirm", "--all", "--database", database.url) == {"confirmed": []}
    assert printed("key", "revoke", new["prefix"], "--database", database.url) == {"revoked": new["prefix"]}
    states = {one["prefix"]: one["state"] for one in printed("key", "list", "--database", database.url)}
    assert states == {made["prefix"]: "valid", new["prefix"]: "revoked"}


def test_a_report(plant: Database, tmp_path: Path) -> None:
    file = tmp_path / "report.pdf"
    told = printed("report", machine().id, "--output", str(file), "--database", plant.url)
    assert told == {"machine": machine().id, "file": str(file), "bytes": file.stat().st_size, "open_alerts": 0}


def test_a_restore(tmp_path: Path) -> None:
    url = f"sqlite:///{tmp_path / 'rundown.db'}"
    database = Database(url)
    with database.transaction() as session:
        machines.create(session, machine())
    database.close()
    printed("backup", str(tmp_path / "monday.db"), "--database", url)
    found = printed(
        "restore", str(tmp_path / "monday.db"), "--database", f"sqlite:///{tmp_path / 'other.db'}", "--without-keys"
    )
    assert found["rows"]["machines"] == 1
    assert found["access"]["waiting"] == []


@pytest.mark.long
def test_a_static_state_on_oil_films() -> None:
    found = printed("model", str(EXAMPLES / "motor-compressor.yaml"))
    (state,) = next(one["equilibria"] for one in found["states"] if one["speed_rpm"] == found["service_rpm"])
    assert [one["bearing"] for one in state] == ["B1", "B2", "B3", "B4"]
    assert all(0.0 < one["eccentricity"] < 1.0 and one["load_y"] > 0.0 for one in state)
    assert found["log_decrement"] > 0.0


def test_a_sample_says_what_it_wrote(tmp_path: Path) -> None:
    found = printed("sample", f"{PUMP}:unbalance", str(tmp_path / "run.csv"), "--samples", "30")
    assert (found["machine"], found["scenario"], found["samples"]) == ("motor-pump", "unbalance", 30)
    assert found["truth"]["coupling.C1.kxx"] > 0.0
    told = CliRunner().invoke(app, ["sample", PUMP, str(tmp_path / "other.csv"), "--samples", "30"])
    assert "other.csv is written with 30 samples of 'motor-pump', healthy" in told.stdout


def test_a_sample_replaces_no_recording(tmp_path: Path) -> None:
    measured = tmp_path / "run.csv"
    measured.write_text("speed\n3000\n")
    ended = CliRunner().invoke(app, ["sample", PUMP, str(measured)])
    assert ended.exit_code == 1
    assert f"{measured} is there already: name another file, or delete it first" in ended.stderr
    assert measured.read_text() == "speed\n3000\n"


def test_what_could_be_reached() -> None:
    ended = CliRunner().invoke(app, ["doctor", "--exposed", "--json"])
    found = json.loads(ended.stdout)
    assert {"level", "what", "address", "reach"} <= found["endpoints"][0].keys()
    assert isinstance(found["tried"], list)


def test_values_become_what_json_has() -> None:
    class Colour(Enum):
        RED = 1

    value = {"a": np.array([1.0, np.nan]), "b": 1 + 2j, "c": Path("x"), "d": Colour.RED, "e": {2, 1}, "f": (np.int64(3), None)}
    assert json_value(value) == {
        "a": [1.0, None],
        "b": {"real": 1.0, "imaginary": 2.0},
        "c": "x",
        "d": "RED",
        "e": [1, 2],
        "f": [3, None],
    }
    assert json_value(datetime(2026, 1, 2, tzinfo=UTC)) == "2026-01-02 00:00:00+00:00"


def test_work_is_shown_only_to_people(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    with working("identifying"):
        pass
    assert capsys.readouterr() == ("", "")
    monkeypatch.setattr("sys.stderr.isatty", lambda: True, raising=False)
    with working("identifying [r/min]"):
        pass
    shown = capsys.readouterr()
    assert shown.out == ""
    assert "identifying [r/min]" in shown.err


def test_work_of_a_known_size_is_shown_as_a_part(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.stderr.isatty", lambda: True, raising=False)
    with working("moving") as report:
        report(3, 12)
    assert "25%" in capsys.readouterr().err


def test_moving_tells_how_far_it_is(tmp_path: Path) -> None:
    database = Database(url := f"sqlite:///{tmp_path / 'rundown.db'}")
    with database.transaction() as session:
        machines.create(session, machine())
    database.close()
    told: list[tuple[int, int]] = []
    move(url, f"sqlite:///{tmp_path / 'new.db'}", lambda done, total: told.append((done, total)))
    assert told[-1][0] == told[-1][1] > 0
    assert told == sorted(told)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("identify", "--json"), "Missing argument 'machine'"),
        (("check", "pump.yaml", "--jsn", "--json"), "No such option: --jsn"),
    ],
)
def test_a_wrong_command_line_is_json_too_where_that_is_asked_for(arguments: tuple[str, ...], words: str) -> None:
    ended = CliRunner().invoke(app, list(arguments))
    assert ended.exit_code == 2
    assert json.loads(ended.stdout)["error"].startswith(words)
    assert CliRunner().invoke(app, [one for one in arguments if one != "--json"]).stdout == ""
