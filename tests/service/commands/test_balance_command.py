"""The command `rundown balance`, on runs of the dense model of the Chapter 3 train."""

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from estimator.machine.document import parse_machine
from tests.estimator.trains import chapter_3_document, dense_response, noisy
from tests.service.commands.command_line import run
from tests.service.commands.recorded_run import write_run

SPEED = np.linspace(160.0, 100.0, 40)
TRIALS = {"D1": (100.0, 0.0), "D2": (100.0, 90.0), "D3": (100.0, 180.0), "D4": (100.0, 270.0)}
"""Trial weights [g mm, °]."""


def balanced_document() -> dict[str, Any]:
    found = chapter_3_document()
    for disc in found["discs"]:
        disc["unbalance"]["magnitude"] *= 0.02
    found["operation"] = {"vibration_limit": 2e-5}
    return found


def recorded(folder: Path, name: str, weights: dict[str, tuple[float, float]], *, seed: int, **sidecar: Any) -> str:
    """A run with weights on [g mm, °], whose sidecar says so."""
    said = balanced_document()
    for disc in said["discs"]:
        size, angle = weights.get(disc["id"], (0.0, 0.0))
        own = disc["unbalance"]
        total = own["magnitude"] * np.exp(1j * np.radians(own["angle_deg"])) + 1e-6 * size * np.exp(1j * np.radians(angle))
        disc["unbalance"] = {"magnitude": float(abs(total)), "angle_deg": float(np.degrees(np.angle(total)))}
    machine = parse_machine(said)
    phasor = noisy(dense_response(machine, SPEED, direction=1), seed=seed)
    described = {"plant": "examples", "machine": "thesis-chapter-3", "interval_s": 1.0}
    if weights:
        described["added_unbalance"] = {
            disc: {"amount": size, "unit": "g mm", "angle_deg": angle} for disc, (size, angle) in weights.items()
        }
    return write_run(folder / f"{name}.csv", SPEED, 1e6 * phasor, channels=machine.channels, **(described | sidecar))


@pytest.fixture
def runs(tmp_path: Path) -> list[str]:
    """The document, the initial run and the trial runs."""
    document = tmp_path / "machine.yaml"
    document.write_text(yaml.safe_dump(balanced_document()))
    trials = [recorded(tmp_path, f"trial-{disc}", {disc: said}, seed=at) for at, (disc, said) in enumerate(TRIALS.items(), 2)]
    return [str(document), recorded(tmp_path, "initial", {}, seed=1), *trials]


def correction(text: str) -> dict[str, tuple[float, float]]:
    """Planes, unbalances [g mm] and angles [°] of a printed correction."""
    found = re.findall(r"^  (D\d) +([\d.]+) \(.*\) at +(?:any angle|([\d.]+) ±)", text, re.MULTILINE)
    return {plane: (float(size), float(angle or 0.0)) for plane, size, angle in found}


def test_initial_run_trials_correction_and_check_run(runs: list[str], tmp_path: Path) -> None:
    text = run("balance", *runs)
    assert re.match(r"Balancing of Two-shaft train .* \(thesis-chapter-3\) at 10 speeds from 955 to 15\d\d r/min\n", text)
    found = correction(text)
    for disc in balanced_document()["discs"]:
        own = disc["unbalance"]
        left = own["magnitude"] * 1e6 * np.exp(1j * np.radians(own["angle_deg"]))
        size, angle = found[disc["id"]]
        assert abs(left + size * np.exp(1j * np.radians(angle))) < 0.15 * 0.0112 * 0.02 * 1e6
    check = recorded(tmp_path, "check", found, seed=20)
    page = tmp_path / "page.html"
    checked = run("balance", *runs, "--check", check, "--page", str(page), "--grade", "6.3")
    assert "MORE THAN PROMISED" not in checked
    assert "other weights" not in checked
    assert not re.search(r"\de\+\d", checked), "amounts in g mm have no power of ten"
    assert re.search(r"Check run check: \d+ of 80 points within the prediction", checked)
    assert "against ISO 21940-11 G 6.3 at 6000 r/min" in checked
    assert re.search(r"limit of the document 40 µm pp: (met|open)", checked)
    assert "limit of the document: met" in checked, "by the check run itself"
    drawn = page.read_text(encoding="utf-8")
    assert drawn.count("<svg") == 8
    assert "Balancing of Two-shaft train" in drawn
    assert "http" not in drawn, "it needs nothing beside it"
    run("balance", *runs, "--check", check, "--page", str(page), "--grade", "6.3", "--locale", "de")
    german = re.sub(
        r"<[^>]+>|Two-shaft train of the thesis, Chapter 3", " ", page.read_text(encoding="utf-8").partition("<body>")[2]
    )
    assert "Auswuchten von" in german
    assert "G 6,3 bei 6000 1/min" in german
    assert re.findall(r"\b(?:the|of|is|at|with|from|and|by|run|as)\b", german) == []
    assert re.search(r"\d \(\d[\d,]* bis \d[\d,]*\) bei", german)
    assert "there is no language 'fr'" in run("balance", *runs, "--page", str(page), "--locale", "fr", status=1)


def test_a_check_run_that_shows_more_than_promised_ends_with_status_1(runs: list[str], tmp_path: Path) -> None:
    check = recorded(tmp_path, "check", {}, seed=20)
    text = run("balance", *runs, "--check", check, status=1)
    assert "MORE THAN PROMISED" in text, "it says nothing of weights: the correction's are taken to be on"


def test_a_check_run_with_other_weights_is_not_said_to_keep_the_promise(runs: list[str], tmp_path: Path) -> None:
    weights = {"D1": (40.0, 90.0), "D2": (10.0, 0.0)}
    text = run("balance", *runs, "--check", recorded(tmp_path, "check", weights, seed=20))
    assert "no more than predicted for the weights that were on" in text
    assert "as promised" not in text
    assert "other weights than the correction's were on (D1 40 g mm, 90°; D2 10 g mm, 0°)" in text


def test_a_check_run_in_another_unit_or_that_came_before_is_refused(runs: list[str], tmp_path: Path) -> None:
    heavy = {"D1": {"amount": 100.0, "unit": "kg m", "angle_deg": 0.0}}
    check = recorded(tmp_path, "check", {}, seed=20, added_unbalance=heavy)
    assert "100 kg m on disc D1 (2 kg) would move its centre of mass" in run("balance", *runs, "--check", check, status=1)
    told = run("balance", *runs, "--check", runs[2], status=1)
    assert "trial-D1 holds the same vectors as trial-D1: a check run is a run of its own" in told
    assert "initial holds the same vectors as initial" in run("balance", *runs, "--check", runs[1], status=1)


def test_limits_holes_and_min_max(runs: list[str]) -> None:
    asked = ("--limit", "D2=30", "--holes", "D1=12,50,0,100,0.1", "--criterion", "min-max", "--plane", "D1", "--plane", "D2")
    text = run("balance", *runs, *asked)
    assert set(correction(text)) == {"D1", "D2"}
    assert correction(text)["D2"][0] <= 30.0 + 1e-6
    masses = [float(one) for one in re.findall(r"([\d.]+) g at the place at", text)]
    assert masses
    assert all(abs(10 * one - round(10 * one)) < 1e-6 for one in masses)
    assert "is not written as --limit D1=50" in run("balance", *runs, "--limit", "D1", status=1)
    assert "D9: no such disc" in run("balance", *runs, "--limit", "D9=1", status=1)


def test_angles_are_reported_on_the_scale_of_the_discs_that_the_sidecars_state(runs: list[str], tmp_path: Path) -> None:
    """A scale that grows against the rotation from 90° on: what is at an angle a reads 90° - a."""
    scale = {"counted": "against-rotation", "zero_deg": 90.0}
    told = correction(run("balance", *runs))
    turned = []
    for at, (disc, (size, angle)) in enumerate(TRIALS.items(), 2):
        weight = {disc: {"amount": size, "unit": "g mm", "angle_deg": 90.0 - angle}}
        told_so = {"added_unbalance": weight, "disc_scale": scale}
        turned.append(recorded(tmp_path, f"turned-{disc}", {disc: (size, angle)}, seed=at, **told_so))
    page = tmp_path / "page.html"
    text = run("balance", *runs[:2], *turned, "--page", str(page), "--holes", "D1=8,30,90")
    assert "angle [°] on the discs' scale, against the rotation" in text
    assert "on the discs&#x27; scale, against the rotation" in page.read_text()
    found = correction(text)
    for disc in ("D2", "D3", "D4"):
        assert found[disc][1] == pytest.approx((90.0 - told[disc][1]) % 360.0, abs=0.2)
    content = json.loads(run("balance", *runs[:2], *turned, "--holes", "D1=8,30,90", "--json"))
    one = content["correction"][0]
    assert content["disc_scale"] == scale
    assert one["scale_deg"] == pytest.approx((90.0 - one["angle_deg"]) % 360.0)
    assert {round(mass["scale_deg"]) % 45 for mass in one["masses"]} == {0}
    mixed = run("balance", *runs[:3], *turned[1:], status=1)
    assert "state different scales of the discs (`disc_scale`): one machine has one" in mixed


def test_runs_whose_weights_are_missing_or_copied_are_named(runs: list[str], tmp_path: Path) -> None:
    unsaid = recorded(tmp_path, "unsaid", {}, seed=3)
    assert "unsaid.csv states no trial weight: its sidecar needs `added_unbalance`" in run("balance", *runs, unsaid, status=1)
    copy = recorded(tmp_path, "copy", {"D1": (200.0, 45.0)}, seed=2)
    for ending in (".csv",):
        (tmp_path / f"copy{ending}").write_text((tmp_path / f"trial-D1{ending}").read_text())
    assert "hold the same vectors: one is a copy" in run("balance", *runs, copy, status=1)
    heavy = recorded(tmp_path, "heavy", {"D1": (100.0, 0.0)}, seed=5)
    (tmp_path / "heavy.yaml").write_text((tmp_path / "heavy.yaml").read_text().replace("unit: g mm", "unit: kg m"))
    told = run("balance", runs[0], runs[1], heavy, status=1)
    assert "100 kg m on disc D1 (2 kg) would move its centre of mass" in told
    assert "100 g mm is likely, so `unit: g mm`" in told
    assert "1 of 4 planes" not in run("balance", *runs[:3]), "one trial is enough for one plane"


def test_the_model_of_the_same_runs_is_compared_with_the_trials(runs: list[str], tmp_path: Path) -> None:
    again = [recorded(tmp_path, f"again-{disc}", {disc: (80.0, 120.0)}, seed=at) for at, disc in enumerate(TRIALS, 30)]
    text = run("balance", *runs, *again, "--model")
    assert re.search(r"Influence: .* taken, (which predicts best|no model predicts clearly better): .*model [\d.]+ %", text)


def test_planes_that_cannot_be_told_apart_are_named(runs: list[str], tmp_path: Path) -> None:
    """A weight on D1 whose sidecar says D2 does what D1 does: as in Darlow's second case one of them is left out."""
    beside = recorded(tmp_path, "beside", {"D1": (90.0, 0.0)}, seed=7)
    (tmp_path / "beside.yaml").write_text((tmp_path / "beside.yaml").read_text().replace("D1", "D2"))
    text = run("balance", *runs[:3], beside)
    assert len(correction(text)) == 1
    assert re.search(r"Note: D\d cannot be told apart from D\d: only \d+ % of what it does at the measuring points", text)


def test_a_file_that_is_given_twice_is_no_repeat(runs: list[str]) -> None:
    assert "hold the same vectors: one is a copy" in run("balance", *runs, runs[2], status=1)


def test_residual_unbalance_of_a_rotor_with_an_untried_disc_is_not_told(runs: list[str], tmp_path: Path) -> None:
    page = tmp_path / "page.html"
    text = run("balance", *runs[:3], *runs[4:], "--grade", "40", "--page", str(page), "--locale", "de")
    residual = text.partition("Residual unbalance")[2]
    assert residual.count("cannot be told: plane D2 had no trial run") == 2
    assert ", met" not in residual
    assert "lässt sich nicht angeben: Ebene D2 hatte keinen Testlauf" in page.read_text(encoding="utf-8")


def test_several_mountings_in_one_file_are_told_where_the_model_takes_them_for_one(runs: list[str], tmp_path: Path) -> None:
    again = [recorded(tmp_path, f"again-{disc}", {disc: (80.0, 120.0)}, seed=at) for at, disc in enumerate(TRIALS, 30)]
    file = Path(runs[1])
    lines = file.read_text(encoding="utf-8").splitlines()
    rows = [f"{line},{'mounting' if not at else 'A' if at < 20 else 'B'}" for at, line in enumerate(lines)]
    file.write_text("\n".join(rows) + "\n", encoding="utf-8")
    sidecar = file.with_suffix(".yaml")
    sidecar.write_text(sidecar.read_text(encoding="utf-8") + "mounting: mounting\n", encoding="utf-8")
    assert "mountings as if all had one unbalance" in run("balance", *runs, *again, "--model")


def test_a_check_run_with_a_weight_on_an_untried_disc_is_told_as_far_as_it_can_be(runs: list[str], tmp_path: Path) -> None:
    tried = [*runs[:3], *runs[4:]]
    check = recorded(tmp_path, "check", {"D1": (190.0, 216.0), "D2": (120.0, 288.0)}, seed=20)
    page = tmp_path / "page.html"
    text = run("balance", *tried, "--check", check, "--page", str(page), "--locale", "de")
    assert "Check run check: nothing is predicted for it, as D2 had weights and no trial run" in text
    assert "D2 120 g mm, 288°" in text
    assert "further correction, with what this run adds" in text
    assert "für ihn ist nichts vorausgesagt, denn D2 hatte Massen und keinen Testlauf" in page.read_text(encoding="utf-8")


def test_a_check_run_as_promised_is_told_to_need_no_trim(runs: list[str], tmp_path: Path) -> None:
    own = {
        disc["id"]: (1e6 * disc["unbalance"]["magnitude"], disc["unbalance"]["angle_deg"] + 180.0)
        for disc in balanced_document()["discs"]
    }
    text = run("balance", *runs, "--check", recorded(tmp_path, "check", own, seed=20))
    assert text.rstrip().endswith("nothing to trim that can be told from noise")


def test_intervals_do_not_go_beyond_the_limit_of_a_disc(runs: list[str]) -> None:
    content = json.loads(run("balance", *runs, "--limit", "D2=60", "--json"))
    (one,) = [plane for plane in content["correction"] if plane["plane"] == "D2"]
    assert one["g_mm"] == pytest.approx(60.0, rel=1e-4)
    assert one["lower_g_mm"] < one["g_mm"] <= one["upper_g_mm"] <= 60.0 * (1 + 1e-6)
