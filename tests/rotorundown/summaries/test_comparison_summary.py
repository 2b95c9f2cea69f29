"""Comparisons and diagnoses as text and as data frames."""

import numpy as np
import pytest

import rotorundown as rd
from estimator.alignment.alignment_comparison import AlignmentComparison
from estimator.alignment.load_change import LoadChange
from estimator.alignment.tolerance import ToleratedChange
from estimator.diagnosis.finding_kind import Cause, ChangeSize, SizePart
from estimator.identification.model_comparison import ModelComparison
from estimator.machine.document import Machine
from rotorundown.summaries.cause_sizes import COLUMNS, size_rows

SCREEN_COLUMNS = 100


@pytest.fixture(scope="module")
def compared(pump: Machine, result: rd.Result) -> rd.CouplingComparison:
    """Without a coupling's name, for there is only one."""
    return rd.compare(result, [rd.simulate(pump, scenario="misalignment", run_seed=9)])


def test_the_changed_coefficients_are_printed_beside_those_of_the_baseline(compared: rd.CouplingComparison) -> None:
    text = str(compared)
    assert "by the model 'changed coefficients': the later value, and the baseline's" in text
    before = compared.baseline["coupling.C1.kxx"].value
    assert any(f"before {before:+.4e}" in line for line in text.splitlines() if line.strip().startswith("coupling.C1.kxx"))
    assert max(map(len, text.splitlines())) <= SCREEN_COLUMNS
    assert compared._repr_html_().startswith("<pre>changed coefficients")


def test_changed_coefficients_are_a_table(compared: rd.CouplingComparison) -> None:
    frame = compared.to_frame()
    row = frame.loc["coupling.C1.kxx"]
    assert row["before"] == compared.baseline["coupling.C1.kxx"].value
    assert row["change"] == pytest.approx(row["value"] - row["before"])
    assert row["change_per_cent"] == pytest.approx(100.0 * row["change"] / row["before"])
    assert row["unit"] == "N/m"
    assert isinstance(compared.found, ModelComparison)
    assert {one.rpartition(".")[0] for one in frame.index} <= compared.found.elements
    assert "bearing.B2.kyy" in frame.index


def test_changes_on_films_are_a_table(result: rd.Result) -> None:
    offset = ToleratedChange("coupling.C1.offset_vertical", "m", 60e-6, 10e-6, 50e-6, 0.97)
    angle = ToleratedChange("coupling.C1.angle_vertical", "rad", None, 0.0, 3e-4, 0.0, "why")
    load = LoadChange("bearing.B2.load_vertical", -20.0, 2.0, 200.0, 200.0)
    found = AlignmentComparison("C1", (offset, angle), (load,))
    frame = rd.CouplingComparison(found, result).to_frame()
    assert list(frame["unit"]) == ["m", "rad", "N"]
    told = frame.loc["coupling.C1.offset_vertical"]
    assert (told["change"], told["lower"], told["upper"], told["allowed"]) == pytest.approx((60e-6, 50e-6, 70e-6, 50e-6))
    assert np.isnan(frame.loc["coupling.C1.angle_vertical", "change"])
    assert frame.loc["coupling.C1.angle_vertical", "reason"] == "why"
    assert frame.loc["bearing.B2.load_vertical", "change_per_cent"] == pytest.approx(-10.0)


def test_causes_are_a_table_of_their_figures(pump: Machine, result: rd.Result) -> None:
    baseline = [result, *(rd.identify(pump, rd.simulate(pump, run_seed=seed)) for seed in (2, 3))]
    found = rd.diagnose(baseline, [rd.identify(pump, rd.simulate(pump, scenario="misalignment", run_seed=9))])
    frame = found.to_frame()
    assert list(frame.columns) == list(COLUMNS)
    assert set(frame["element"]) == {one.element for one in found.causes} == {"coupling.C1"}
    assert len(frame) == sum(len(one.parts) for one in found.sizes)
    assert frame["per_cent"].iloc[0] == found.sizes[0].per_cent
    nothing = rd.diagnose(baseline[:2], baseline[2:])
    assert len(nothing.to_frame()) == 0
    assert list(nothing.to_frame().columns) == list(COLUMNS)


def test_a_cause_without_a_size_has_a_row() -> None:
    cause = Cause("rub", "shaft.motor", 12.0, (), np.zeros(0), np.zeros((0, 0)), 3.0, ())
    assert [row[:4] for row in size_rows(cause, ChangeSize(None))] == [["rub", "shaft.motor", 12.0, None]]
    part = SizePart("coupling.C1.offset_vertical", "um", 60.0, 50.0, 70.0, allowed=50.0)
    (row,) = size_rows(cause, ChangeSize(None, parts=(part,)))
    assert dict(zip(COLUMNS, row, strict=True))["allowed"] == 50.0
