"""Trial weights of a recording's sidecar: units, angles of the disc's scale, columns, and what is refused."""

import cmath
import math
from pathlib import Path
from typing import Any

import pytest
import yaml

from formats.files.document_files import UnreadableFile
from formats.recordings.recording import RecordedCircumstances, read_circumstances, read_recording
from formats.recordings.trial_weights import TrialWeight

HEADER = "rpm,re,im,weight,at,mount,spread"
ROWS = ("1000,3,4,0,0,A,0.1", "1200,0,1,48,90,B,0.2")
SIDECAR: dict[str, Any] = {
    "plant": "p",
    "machine": "m",
    "kind": "dwells",
    "speed": "rpm",
    "speed_unit": "rpm",
    "channels": [{"channel": "X", "real": "re", "imaginary": "im", "scatter": "spread"}],
    "amplitude_unit": "mil",
    "amplitude_kind": "peak",
    "phase_convention": "lag",
    "phase_unit": "deg",
}


def write(folder: Path, **changes: Any) -> Path:
    (folder / "run.csv").write_text("\n".join([HEADER, *ROWS]) + "\n", encoding="utf-8")
    (folder / "run.yaml").write_text(yaml.safe_dump(SIDECAR | changes), encoding="utf-8")
    return folder / "run.csv"


def weights(folder: Path, **changes: Any) -> RecordedCircumstances:
    return read_circumstances(write(folder, **changes))


def refused(folder: Path, **changes: Any) -> str:
    with pytest.raises(UnreadableFile) as caught:
        weights(folder, **changes)
    return str(caught.value)


@pytest.mark.parametrize(
    ("weight", "kilogram_metres"),
    [
        ({"magnitude": 4.8e-5}, 4.8e-5),
        ({"amount": 48, "unit": "g mm"}, 4.8e-5),
        ({"amount": 2, "unit": "g in"}, 5.08e-5),
        ({"amount": 1, "unit": "oz in"}, 7.200779e-4),
        ({"amount": 1.6, "unit": "g", "radius": 30}, 4.8e-5),
        ({"amount": 0.5, "unit": "oz", "radius": 2, "radius_unit": "in"}, 7.200779e-4),
    ],
)
def test_units(tmp_path: Path, weight: dict[str, Any], kilogram_metres: float) -> None:
    found = weights(tmp_path, added_unbalance={"D1": {**weight, "angle_deg": 30}})
    assert found.added["D1"] == pytest.approx([cmath.rect(kilogram_metres, math.radians(30))] * 2, rel=1e-6)


@pytest.mark.parametrize(
    ("scale", "direction", "degrees"),
    [
        ({}, "positive", 30),
        ({"counted": "with-rotation"}, "positive", 30),
        ({"counted": "with-rotation"}, "negative", -30),
        ({"counted": "against-rotation", "zero_deg": 90}, "positive", 60),
        ({"counted": "against-rotation"}, "negative", 30),
    ],
)
def test_angles_of_the_scale(tmp_path: Path, scale: dict[str, Any], direction: str, degrees: float) -> None:
    weight = {"D1": {"amount": 1, "unit": "kg m", "angle_deg": 30}}
    found = weights(tmp_path, added_unbalance=weight, disc_scale=scale, direction=direction)
    assert math.degrees(cmath.phase(found.added["D1"][0])) == pytest.approx(degrees)


def test_columns_hold_a_weight_and_a_mounting_for_each_row(tmp_path: Path) -> None:
    weight = {"D1": {"amount": "weight", "unit": "g mm", "angle_deg": "at"}}
    found = weights(tmp_path, added_unbalance=weight, mounting="mount")
    assert found.added["D1"] == pytest.approx([0.0, 4.8e-5j])
    assert (found.kind, found.stated, found.mounting) == ("dwells", True, ["A", "B"])
    assert weights(tmp_path).mounting == ["run", "run"]


def test_no_weight_may_be_stated_or_left_unsaid(tmp_path: Path) -> None:
    assert weights(tmp_path, added_unbalance="none").stated
    assert not weights(tmp_path).stated


def test_a_vector_may_come_in_parts_with_its_scatter(tmp_path: Path) -> None:
    one = read_recording(write(tmp_path))
    assert one.amplitude == [[pytest.approx(5.0)], [pytest.approx(1.0)]]
    assert one.phase == [[pytest.approx(53.1301)], [pytest.approx(90.0)]]
    assert one.scatter == [[0.1], [0.2]]


@pytest.mark.parametrize(
    ("weight", "words"),
    [
        ({"amount": 0, "unit": "g mm"}, "a trial weight of zero is none"),
        ({"amount": 3}, "amount and unit go together; the unit is one of kg m, kg mm, g mm"),
        ({"amount": 3, "unit": "g"}, "a mass (g, oz, kg) needs the radius"),
        ({"amount": 3, "unit": "g mm", "radius": 30}, "an unbalance (g mm, g in, oz in, kg m) has none"),
        ({"amount": 3, "unit": "g mm", "magnitude": 1e-6}, "give either magnitude [kg m], or amount"),
        ({}, "give either magnitude [kg m], or amount"),
        ({"amount": "mass", "unit": "g mm"}, "has no column 'mass'"),
        (
            {"amount": -48, "unit": "g mm"},
            "amount is -48: a weight is above zero; on the opposite side its angle differs by 180°",
        ),
    ],
)
def test_wrong_weights_are_named(tmp_path: Path, weight: dict[str, Any], words: str) -> None:
    said = refused(tmp_path, added_unbalance={"D1": {**weight, "angle_deg": 0}})
    assert words in said
    assert "dict[" not in said, "the field's own name, not the validator's"
    assert "'none'" not in said, "the alternative was not meant"
    assert "valid string" not in said, "nor was a column"


@pytest.mark.parametrize("weight", [48, "48 g mm", None, [48, 90]])
def test_a_weight_that_is_no_list_of_fields_is_answered_with_one_that_is(tmp_path: Path, weight: object) -> None:
    said = refused(tmp_path, added_unbalance={"D1": weight})
    assert "added_unbalance.D1: what was on a disc is given with its unit and angle, as in {amount: 48, unit: g mm" in said
    assert "\n" not in said, "one line"


@pytest.mark.parametrize("weights", ["48 g mm on D1", 48, [48, 90]])
def test_weights_that_are_not_listed_by_disc_are_answered_with_such(tmp_path: Path, weights: object) -> None:
    said = refused(tmp_path, added_unbalance=weights)
    assert "trial weights are `none`, or listed by disc, as in {D1: {amount: 48, unit: g mm, angle_deg: 90}}" in said
    assert "\n" not in said, "one line"


def test_a_channel_has_one_pair_of_columns(tmp_path: Path) -> None:
    assert "amplitude and phase, or of real and imaginary" in refused(tmp_path, channels=[{"channel": "X", "real": "re"}])


def test_a_probe_is_listed_once(tmp_path: Path) -> None:
    twice = [{"channel": "X", "real": "re", "imaginary": "im"}, {"channel": "X", "real": "weight", "imaginary": "at"}]
    assert "channel X is listed twice: each probe of the document has one entry" in refused(tmp_path, channels=twice)


@pytest.mark.parametrize("radius", [0.03, 1.2, 30000.0])
def test_a_radius_that_is_no_number_of_mm_needs_its_unit(radius: float) -> None:
    """It was taken in mm without a word: 0.03, meant in m, made a weight a thousand times too small."""
    said = {"amount": 1.6, "unit": "g", "radius": radius, "angle_deg": 0.0}
    with pytest.raises(ValueError, match="without radius_unit is taken in mm, which is no place for a weight"):
        TrialWeight.model_validate(said)
    assert TrialWeight.model_validate(said | {"radius_unit": "mm"}).radius == radius
    assert TrialWeight.model_validate(said | {"radius": 30}).radius_unit == "mm"


def in_columns(folder: Path, *weights: tuple[float, float]) -> RecordedCircumstances:
    path = write(folder, added_unbalance={"D1": {"amount": "weight", "unit": "g mm", "angle_deg": "at"}})
    rows = [f"1000,3,4,{amount},{angle},A,0.1" for amount, angle in weights]
    path.write_text("\n".join([HEADER, *rows]) + "\n", encoding="utf-8")
    return read_circumstances(path)


def test_a_column_with_a_weight_below_zero_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UnreadableFile, match="column 'weight' is -48 in row 2: a weight is not below zero"):
        in_columns(tmp_path, (48, 0), (-48, 90))


@pytest.mark.parametrize("angles", [(0, 1.5708), (0, 1.5708, 3.1416, 4.7124), (0.52, 2.31, 4.05, 6.1), (-1.571, 1.571)])
def test_a_column_of_angles_in_radians_is_refused(tmp_path: Path, angles: tuple[float, ...]) -> None:
    with pytest.raises(
        UnreadableFile, match=r"column 'at' holds angles such as .*, as radians are: `angle_deg` is in degrees"
    ):
        in_columns(tmp_path, *((48, angle) for angle in angles))


@pytest.mark.parametrize("angles", [(0, 0), (0, 5), (1, 2, 3, 4), (0, 1.5708, 90), (1.2, 2.4), (30.5, 120.25)])
def test_a_column_of_angles_in_degrees_is_taken(tmp_path: Path, angles: tuple[float, ...]) -> None:
    found = in_columns(tmp_path, *((48, angle) for angle in angles), (0, 0.26))
    assert len(found.added["D1"]) == len(angles) + 1
