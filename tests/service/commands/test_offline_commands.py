"""The commands that work on recorded runs without a service, run in this process on data of the dense model."""

import csv
import json
import re
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

import rotorundown as rd
from estimator.calibration.calibration_runs import check_runs
from estimator.machine.document import parse_machine
from formats.files.document_files import read_machine
from formats.recordings.recorded_runs import read_calibration_runs
from formats.recordings.recording import read_recording, states_start
from rotorundown.environment.release import VERSION
from tests.estimator.trains import LATERAL, Complexes, Document, chapter_3_document, dense_response, noisy
from tests.service.commands.command_line import run
from tests.service.commands.recorded_run import write_run

DOCUMENT = "examples/thesis-chapter-3.yaml"
SCREEN_LINES = 24
SPEED = np.arange(300.0, 10.0, -4.0)


def recorded(folder: Path, name: str, phasor: Complexes, **sidecar: Any) -> str:
    """A run as CSV and sidecar; its path."""
    channels = [probe["id"] for probe in chapter_3_document()["probes"]]
    said = {"plant": "examples", "machine": "thesis-chapter-3", "interval_s": 1.0} | sidecar
    return write_run(folder / f"{name}.csv", SPEED, 1e6 * phasor, channels=channels, **said)


def of(document: Document, seed: int) -> Complexes:
    return noisy(dense_response(parse_machine(document), SPEED, direction=1), seed=seed)


def test_the_command_says_which_release_it_is() -> None:
    assert run("--version") == f"rundown {VERSION}\n"


@pytest.fixture
def healthy(tmp_path: Path) -> str:
    return recorded(tmp_path, "healthy", of(chapter_3_document(), seed=1))


def value(text: str, name: str) -> tuple[float, float]:
    """Value and standard error of a parameter in a printed identification."""
    words = next(line for line in text.splitlines() if line.startswith(name)).split()
    return float(words[1]), float(words[3])


def test_runs_with_and_without_a_trial_weight_are_fitted_together(healthy: str, tmp_path: Path) -> None:
    document = chapter_3_document()
    document["discs"][0]["unbalance"] = {"magnitude": 0.0135, "angle_deg": 36}
    heavier = recorded(
        tmp_path, "trial", of(document, seed=2), added_unbalance={"D1": {"magnitude": 0.0135 - 0.0095, "angle_deg": 36}}
    )
    text = run("identify", DOCUMENT, healthy, heavier, "--advice", "--all")
    assert text.startswith("accepted")
    assert f"{2 * SPEED.size} samples" in text
    advised = [float(one) for one in re.findall(r"one more sample at (\d+) r/min: by", text)]
    assert len(advised) == 3
    assert all(90 <= one <= 6000 for one in advised), "inside the document's range"
    found, error = value(text, "bearing.B1.kxx")
    assert abs(found - 250_000) < 4 * error
    found, error = value(text, "disc.D1.unbalance")
    assert abs(found - 9500.0) < 4 * error
    assert re.search(r"^disc\.D1\.unbalance +\S+ ± \S+ g mm at 3[56]\.\d ± 0\.\d°$", text, re.MULTILINE)
    assert "a probe on shaft" in text
    assert not re.search(r"e\+\d+ %|\d 1 \(", text), "no power of ten before a percent sign, and no unit of what has none"


@pytest.mark.long
def test_an_unmentioned_trial_weight_is_noticed(healthy: str, tmp_path: Path) -> None:
    document = chapter_3_document()
    document["discs"][0]["unbalance"] = {"magnitude": 0.0135, "angle_deg": 36}
    heavier = recorded(tmp_path, "trial", of(document, seed=2))
    assert "not" in run("identify", DOCUMENT, healthy, heavier, status=1).splitlines()[0]


def test_a_trial_weight_on_no_disc(tmp_path: Path) -> None:
    path = recorded(tmp_path, "run", of(chapter_3_document(), 1), added_unbalance={"D9": {"magnitude": 0.001, "angle_deg": 0}})
    assert "adds unbalance to D9; the discs are D1, D2, D3, D4" in run("identify", DOCUMENT, path, status=1)


def test_the_thesis_s_regression_is_selectable(healthy: str) -> None:
    text = run("identify", DOCUMENT, healthy, "--method", "regression", "--tikhonov", "L-curve", status=1)
    assert text.startswith("NOT TO BE USED: these values do not explain the run")
    assert "no intervals" in text
    assert "regularised with λ" in text
    assert sum(line.startswith("bearing.") for line in text.splitlines()) == 32


def test_what_the_updated_model_says(healthy: str) -> None:
    text = run("model", DOCUMENT, healthy, "--service-rpm", "2500", "--grade", "6.3")
    first = next(line for line in text.splitlines() if line.startswith("  ")).split()
    assert abs(float(first[0]) - 122.0 * 30 / np.pi) < 3  # the lowest critical speed, 122 rad/s
    for part in ("Response peaks", "load of the couplings at 2500 r/min", "ISO 21940-11 G 6.3", "Correction that leaves"):
        assert part in text
    assert "Impact test" not in text


def test_the_static_state_of_films_needs_no_run() -> None:
    text = run("model", "examples/motor-compressor.yaml")
    assert "at 700 r/min" in text
    loads = [float(line.split()[2]) for line in text.splitlines() if line.split()[:1] in (["B1"], ["B2"], ["B3"], ["B4"])]
    assert sum(loads[:4]) == pytest.approx(4733, abs=3)
    assert "The train would whirl from 509" in text


@pytest.mark.long
def test_tilting_pads_are_reported_as_other_films() -> None:
    text = run("model", "examples/turbine-on-tilting-pads.yaml", "--service-rpm", "6000")
    rows = [line.split() for line in text.splitlines() if line.split()[:1] in (["B1"], ["B2"], ["B3"], ["B4"])]
    assert sum(float(row[2]) for row in rows[:4]) == pytest.approx(8697, abs=3)
    assert all(abs(float(row[5])) < 0.1 for row in rows)  # the journals move straight down
    assert "Stability at 6000 r/min: least damped mode 31" in text
    assert "would not whirl" in text


def test_a_service_speed_outside_the_range_is_refused(healthy: str) -> None:
    for document, files in (("examples/motor-compressor.yaml", []), (DOCUMENT, [healthy])):
        said = run("model", document, *files, "--service-rpm", "50", status=1)
        assert "--service-rpm 50 lies outside the document's range, " in said
        assert said.strip().endswith(" r/min")


def test_without_runs_what_the_document_alone_gives_is_nominal(tmp_path: Path) -> None:
    text = run("model", DOCUMENT, "--service-rpm", "2500")
    assert text.startswith("No run is given: these are the document's nominal values, nothing of them is identified\n")
    heading = next(number for number, line in enumerate(text.splitlines()) if "r/min  ± standard error" in line)
    first = text.splitlines()[heading + 1].split()
    assert abs(float(first[0]) - rd.model(rd.read_machine(DOCUMENT)).critical_speeds()[0].speed_rpm) < 1.0
    assert first[1] == "-", "without an interval"
    assert "natural frequencies [cycles/min] over speeds" in text
    assert re.search(r"^ +2500 +1 +\d+ ", text, re.MULTILINE), "modes at the service speed"
    assert "asked for G 2.5" in text, "by the unbalances that the document states"
    said = rd.read_machine(DOCUMENT).model_dump(mode="json", exclude={"discs": {"__all__": {"unbalance"}}}, exclude_none=True)
    (tmp_path / "unknown.yaml").write_text(yaml.safe_dump(said))
    text = run("model", str(tmp_path / "unknown.yaml"), "--service-rpm", "2500")
    assert text.endswith("Unbalances are not known: response, loads of couplings and balance need a run\n")


def test_without_runs_a_calibration_gives_response_and_balance(tmp_path: Path) -> None:
    document = tmp_path / "kit.yaml"
    calibrate = ("calibrate", "examples/rk4-rotor-kit-four-probes.yaml", "examples/recordings/rk4_unbalance_1x.csv")
    run(*calibrate, "--output", str(document))
    text = run("model", str(document), "--service-rpm", "1000", "--grade", "6.3")
    assert text.startswith("No run is given: these are the values of the document's calibration, all others are nominal\n")
    for part in ("1× of the shaft at its probes", "asked for G 6.3", "unbalance to add for least vibration at 1000 r/min"):
        assert part in text
    assert "Nominal" not in text


def test_without_runs_an_impact_test_is_compared(tmp_path: Path) -> None:
    document = chapter_3_document()
    document["impact_test"] = {"frequencies_hz": [19.0, 60.0]}
    path = tmp_path / "tested.yaml"
    path.write_text(yaml.safe_dump(document))
    assert "Impact test: measured and model [Hz], deviation [%], in standard deviations" in run("model", str(path))


def test_an_impact_test_in_the_document_is_compared(healthy: str, tmp_path: Path) -> None:
    document = chapter_3_document()
    document["impact_test"] = {"frequencies_hz": [19.0, 60.0]}
    (tmp_path / "document.yaml").write_text(yaml.safe_dump(document))
    text = run("model", str(tmp_path / "document.yaml"), healthy)
    assert "Impact test" in text
    assert any(line.strip().startswith("19.00") for line in text.splitlines())


def test_bearings_follow_tables_in_files_beside_the_document(tmp_path: Path) -> None:
    document = chapter_3_document()
    speeds, columns = [90, 300, 600, 900, 1500, 3000], {}
    for bearing in document["bearings"]:
        nominal = {name: bearing.pop(name) for name in LATERAL}
        rows = {name: [one * (1 + 0.4 * rpm / 3000) for rpm in speeds] for name, one in nominal.items()}
        columns[bearing["id"]] = rows
        with (tmp_path / f"{bearing['id']}.csv").open("w", newline="") as file:
            csv.writer(file).writerows([["speed_rpm", *rows], *zip(speeds, *rows.values(), strict=True)])
        bearing["speed_dependence"] = {"form": "table", "csv": f"{bearing['id']}.csv", "scale_spread": 0.1}
    path = tmp_path / "document.yaml"
    path.write_text(yaml.safe_dump(document))
    machine = read_machine(path)

    def at(speed: float) -> Complexes:
        here = chapter_3_document()
        for bearing in here["bearings"]:
            bearing |= {n: np.interp(30 * speed / np.pi, speeds, column) for n, column in columns[bearing["id"]].items()}
        return dense_response(parse_machine(here), np.array([speed]), direction=1)

    path_of_run = recorded(tmp_path, "run", noisy(np.concatenate([at(speed) for speed in SPEED]), seed=4))
    text = run("identify", str(path), path_of_run, "--all")
    assert "warning: bearings[3].speed_dependence.speed_rpm: the table covers 90 to 3000 r/min" in text
    assert "\naccepted" in text
    for name in ("bearing.B1.kxx_scale", "bearing.B3.kyy_scale", "bearing.B2.cxx_scale"):
        found, error = value(text, name)
        assert abs(found - 1.0) < 4 * error < 0.4
    assert "load of the couplings" in run("model", str(path), path_of_run)
    assert json.loads("{" + run("document", str(path)).partition("{")[2]) == machine.model_dump(mode="json")


def test_a_file_may_give_a_table_over_the_load(tmp_path: Path) -> None:
    document = chapter_3_document()
    bearing = document["bearings"][0]
    rows: list[list[float | str]] = [["speed_rpm", "load_n", "kyy_n_per_m"]]
    del bearing["kyy"]
    for load in (1000, 2000, 4000):
        rows += [[rpm, load, 1e4 * load * (1 + rpm / 3000)] for rpm in (90, 300, 1500, 3000, 6000)]
    file = tmp_path / "B1.csv"
    file.write_text("\n".join(",".join(map(str, row)) for row in rows))
    bearing["speed_dependence"] = {"form": "table", "csv": "B1.csv", "load": 2000}
    path = tmp_path / "document.yaml"
    path.write_text(yaml.safe_dump(document))
    form = read_machine(path).bearings[0].speed_dependence
    assert form is not None
    assert form.nominal("kyy", 1500.0) == pytest.approx(1e4 * 2000 * 1.5)
    file.write_text("\n".join(",".join(map(str, row)) for row in rows[:-1]))
    assert "lines of 4000 N have other speeds than those of 1000 N" in run("document", str(path), status=1)


def test_views_of_misalignment_are_compared(healthy: str, tmp_path: Path) -> None:
    document = chapter_3_document()
    for part in (document["couplings"][0], document["bearings"][1], document["bearings"][2]):
        part["kxx"] *= 1.2
        part["kyy"] *= 1.2
    later = recorded(tmp_path, "later", of(document, seed=3))
    text = run("compare", DOCUMENT, healthy, later)  # there is only one coupling
    assert text.startswith("changed coefficients: better than")
    assert "Compared models, the likeliest first" in text
    assert "by the model 'changed coefficients': the later value, and the baseline's" in text
    found = re.search(r"coupling\.C1\.kxx +(\S+) ± .*; before (\S+)\n", text)
    assert found is not None
    assert float(found[1]) == pytest.approx(1.2 * float(found[2]), rel=0.1)
    assert "there are C1" in run("compare", DOCUMENT, healthy, later, "--coupling", "C7", status=1)


def test_a_later_run_without_a_sidecar_is_compared(healthy: str, tmp_path: Path) -> None:
    columns = {"speed_rpm": SPEED * 30.0 / np.pi}
    for probe, phasor in zip(chapter_3_document()["probes"], of(chapter_3_document(), seed=3).T, strict=True):
        columns[f"{probe['id']}_um_pp"] = 2e6 * np.abs(phasor)
        columns[f"{probe['id']}_lag_deg"] = -np.degrees(np.angle(phasor))
    later = tmp_path / "later.csv"
    np.savetxt(later, np.column_stack(list(columns.values())), delimiter=",", header=",".join(columns), comments="")
    text = run("compare", DOCUMENT, healthy, str(later), "--coupling", "C1")
    assert "later.csv: read as r/min, µm peak-to-peak, phase lag in degrees" in text
    assert "unchanged: better than" in text


def test_what_is_left_out_of_a_compared_run_is_said(healthy: str, tmp_path: Path) -> None:
    phasor = of(chapter_3_document(), seed=3)
    phasor[4, 0] = 1e3
    later = recorded(tmp_path, "later", phasor)
    text = run("compare", DOCUMENT, healthy, later, "--coupling", "C1")
    assert f"{later}, row 5" in text


def test_a_fit_that_is_refused_has_no_model(tmp_path: Path) -> None:
    document = chapter_3_document()
    document["discs"][1]["mass"] *= 1.5
    path = recorded(tmp_path, "other", of(document, seed=4))
    text = run("model", DOCUMENT, path, status=1)
    assert not text.startswith("accepted")
    assert "Critical speeds" not in text


def test_a_refused_run_tells_which_convention_is_wrong(tmp_path: Path) -> None:
    path = recorded(tmp_path, "lag", of(chapter_3_document(), seed=4).conj())
    text = run("identify", DOCUMENT, path, "--all", status=1)
    assert text.startswith(
        "NOT ACCEPTED, not to be used: the run fits over 1000 times better with the opposite sign of the phase"
    )
    assert text.index("Where the refused fit ended; these are no results") < text.index("bearing.B1.kxx  ")


def test_a_run_that_never_enters_the_speed_range_is_reported(tmp_path: Path) -> None:
    high = SPEED > 100.0
    phasor = 1e6 * of(chapter_3_document(), seed=4)[high]
    sent = 30.0 / np.pi * SPEED[high]
    channels = [probe["id"] for probe in chapter_3_document()["probes"]]
    fast = write_run(tmp_path / "fast.csv", sent, phasor, channels=channels, plant="examples", machine="thesis-chapter-3")
    said = run("identify", DOCUMENT, fast, status=1)
    assert "never enters the document's speed range, 90 to 6000 r/min: " in said
    assert "speeds in r/min that were sent as rad/s" in said


def test_a_run_of_another_machine(tmp_path: Path) -> None:
    path = recorded(tmp_path, "run", of(chapter_3_document(), 1), machine="pump-9")
    assert "is a recording of 'pump-9'" in run("identify", DOCUMENT, path, status=1)


def test_sampled_runs_try_the_commands(tmp_path: Path) -> None:
    document = "examples/motor-pump.yaml"
    healthy, later = str(tmp_path / "healthy.csv"), str(tmp_path / "later.csv")
    run("sample", document, healthy, "--samples", "120")
    run("sample", f"{document}:misalignment", later, "--samples", "120", "--run-seed", "2")
    told = run("identify", document, healthy)
    assert told.startswith("accepted")
    assert len(told.splitlines()) <= SCREEN_LINES
    for element in ("bearing.B1 ", "coupling.C1 ", "disc.core-1 "):
        assert any(line.startswith(element) for line in told.splitlines()), "each element has a line"
    assert "--all" in told, "and the rest is a word away"
    assert run("compare", document, healthy, later, "--coupling", "C1").startswith("changed coefficients: better than")


def test_a_run_is_sampled_with_trial_weights_that_its_sidecar_states(tmp_path: Path) -> None:
    without, file = tmp_path / "without.csv", tmp_path / "trial.csv"
    run("sample", DOCUMENT, str(without), "--samples", "20")
    said = run("sample", DOCUMENT, str(file), "--samples", "20", "--weight", "D1=2000,-90", "--json")
    assert yaml.safe_load(file.with_suffix(".yaml").read_text())["added_unbalance"] == {
        "D1": {"amount": 2000.0, "unit": "g mm", "angle_deg": -90.0}
    }
    assert json.loads(said)["weights"] == {"D1": {"amount_g_mm": 2000.0, "angle_deg": -90.0}}
    assert yaml.safe_load(without.with_suffix(".yaml").read_text())["added_unbalance"] == "none"
    assert file.read_text() != without.read_text()
    machine = read_machine(Path(DOCUMENT))
    assert check_runs(machine, read_calibration_runs(machine, [without, file])[0]), "remarks, and nothing against the runs"


@pytest.mark.parametrize(
    ("weight", "words"),
    [
        (["2000,90"], "'2000,90' is not written as --weight D1=50,90: g mm and °"),
        (["D1=2000"], "'D1=2000' is not written as --weight"),
        (["D11=2000,90"], "there is no disc 'D11' for a trial weight; did you mean"),
        (["D1=0,90"], "an amount above 0 g mm"),
        (["D1=nan,90"], "an amount above 0 g mm"),
        (["D1=1,90", "D1=1,0"], "--weight D1 is given twice"),
    ],
)
def test_a_wrong_trial_weight_is_one_line(tmp_path: Path, weight: list[str], words: str) -> None:
    given = [part for one in weight for part in ("--weight", one)]
    said = run("sample", DOCUMENT, str(tmp_path / "trial.csv"), *given, status=1)
    assert words in said
    assert len(said.splitlines()) == 1


def test_the_same_seeds_sample_the_same_run(tmp_path: Path) -> None:
    for name in ("one", "two"):
        run("sample", DOCUMENT, str(tmp_path / f"{name}.csv"), "--samples", "20")
    run("sample", DOCUMENT, str(tmp_path / "other.csv"), "--samples", "20", "--run-seed", "2")
    one, two, other = ((tmp_path / f"{name}.csv").read_text() for name in ("one", "two", "other"))
    assert one == two != other


def test_runs_sampled_one_after_the_other_are_a_day_apart_and_the_same_again_elsewhere(tmp_path: Path) -> None:
    starts: list[list[int]] = []
    for folder in (tmp_path / "here", tmp_path / "there"):
        folder.mkdir()
        files = [folder / f"{name}.csv" for name in ("one", "two", "three", "four")]
        for file in files[:2]:
            run("sample", DOCUMENT, str(file), "--samples", "20")
        run("sample", DOCUMENT, str(files[2]), "--samples", "20", "--start", "2026-11-21T12:00:00")
        run("sample", DOCUMENT, str(files[3]), "--samples", "20")
        starts.append([read_recording(file).time_ns[0] // 10**9 for file in files])
        assert all(states_start(file) for file in files)
    stated = int(datetime(2026, 11, 21, 12, tzinfo=UTC).timestamp())
    first = int(datetime(2000, 1, 2, tzinfo=UTC).timestamp())
    assert starts == [[first, first + 86_400, stated, stated + 86_400]] * 2


def test_options_that_do_not_go_together(healthy: str) -> None:
    assert "--tikhonov goes with" in run("identify", DOCUMENT, healthy, "--tikhonov", "L-curve", status=1)
    assert "--advice goes with" in run("identify", DOCUMENT, healthy, "--method", "regression", "--advice", status=1)


def test_files_that_are_not_there_or_something_else(healthy: str, tmp_path: Path) -> None:
    assert "none.csv: no such file" in run("identify", DOCUMENT, str(tmp_path / "none.csv"), status=1)
    assert "is neither YAML nor JSON" in run("identify", "README.md", healthy, status=1)


@pytest.mark.long
def test_a_machine_with_seals_bows_and_loads_is_sampled_and_identified(tmp_path: Path) -> None:
    path = str(tmp_path / "run.csv")
    run("sample", "examples/sealed-pump.yaml", path)
    text = run("identify", "examples/sealed-pump.yaml", path, "--all")
    assert text.startswith("accepted")
    for name in ("seal.N1.mxx", "shaft.pump.bow", "coupling.C1.force_x", "coupling.C1.kx_phiy"):
        assert any(line.startswith(name) for line in text.splitlines()), name
