"""Results: estimates by name, text, tables, models, comparison and diagnosis."""

import math

import numpy as np
import pytest

import rotorundown as rd
from estimator.identification.quality_gate import identify_gated
from estimator.machine.document import Machine
from rotorundown.comparison import NotComparable
from rotorundown.diagnosis import NotDiagnosable
from rotorundown.identification import NothingToIdentify
from tests.paths import EXAMPLES, ROOT

SCREEN_LINES, SCREEN_COLUMNS = 40, 100


def test_the_result_is_that_of_the_gated_fit(pump: Machine, run: rd.MachineRun, result: rd.Result) -> None:
    gated = identify_gated(pump, [run.recorded], [run.measurement]).identification
    assert gated is not None
    assert result.accepted
    assert result["coupling.C1.kxx"] == gated.estimate("coupling.C1.kxx")
    assert list(result) == [one.name for one in gated.estimates]


def test_a_wrong_name_gets_its_close_matches(result: rd.Result) -> None:
    with pytest.raises(KeyError, match=r"'coupling\.C1\.kx' is not estimated; did you mean 'coupling\.C1\.k"):
        result["coupling.C1.kx"]
    with pytest.raises(KeyError, match=r"'C1\.kxx' is not estimated; did you mean 'coupling\.C1\.kxx'"):
        result["C1.kxx"]
    assert "coupling.C1.kxx" in result
    assert "coupling.C1.kx" not in result


@pytest.mark.parametrize("name", ["motor-pump", "thesis-chapter-3", "turbine-compressor-generator", "motor-compressor"])
def test_the_text_fits_a_screen(name: str) -> None:
    machine = rd.read_machine(ROOT / f"examples/{name}.yaml")
    lines = str(rd.identify(machine, rd.simulate(machine))).splitlines()
    assert len(lines) <= SCREEN_LINES
    assert max(map(len, lines)) <= SCREEN_COLUMNS


def test_the_text_gives_unbalances_as_people_say_them(result: rd.Result) -> None:
    one = result["disc.core-1.unbalance"]
    assert one.value is not None
    assert one.imaginary is not None
    size, angle = math.hypot(one.value, one.imaginary) * 1e6, math.degrees(math.atan2(one.imaginary, one.value)) % 360
    line = next(line for line in str(result).splitlines() if line.startswith("disc.core-1"))
    assert f"{float(f'{size:.3g}'):.0f} ±" in line
    assert f"g mm at {angle:.0f}°" in line


def test_html_escapes_what_a_document_says(pump: Machine, run: rd.MachineRun) -> None:
    named = rd.MachineRun("<script>", run.channels, run.recorded, run.measurement)
    for shown in (rd.identify(pump, named)._repr_html_(), named._repr_html_()):
        assert "<script>" not in shown
        assert "&lt;script&gt;" in shown


def test_a_table_holds_every_estimate(result: rd.Result) -> None:
    frame = result.to_frame()
    assert list(frame.index) == list(result)
    assert frame.loc["bearing.B1.kxx", "value"] == result["bearing.B1.kxx"].value
    assert frame.loc["bearing.B1.kxx", "unit"] == "N/m"


def test_too_little_data_is_named(pump: Machine) -> None:
    with pytest.raises(NothingToIdentify, match="no run is given"):
        rd.identify(pump, [])
    few = rd.simulate(pump, samples=10)
    with pytest.raises(NothingToIdentify, match=r"\d"):
        rd.identify(pump, few, accepted_rpm=(3500.0, 3600.0))
    with pytest.raises(NothingToIdentify):
        rd.identify(pump, few, accepted_rpm=(3600.0, 3500.0))


def test_a_misaligned_coupling_is_compared_and_diagnosed(pump: Machine) -> None:
    healthy = [rd.identify(pump, rd.simulate(pump, run_seed=seed)) for seed in range(1, 4)]
    later = rd.simulate(pump, scenario="misalignment", run_seed=9)
    compared = rd.compare(healthy[0], later, coupling="C1")
    assert compared.verdict.startswith("changed coefficients")
    assert compared.verdict in str(compared)
    found = rd.diagnose(healthy, [rd.identify(pump, later)])
    assert [(one.kind, one.element) for one in found.causes] == [("misalignment", "coupling.C1")]
    assert "misalignment at coupling.C1" in str(found)
    assert rd.diagnose(healthy[:2], healthy[2:]).causes == ()


def test_what_cannot_be_compared_is_named(run: rd.MachineRun, result: rd.Result) -> None:
    with pytest.raises(NotComparable, match="'C2' is no coupling of 'motor-pump'; there are C1; did you mean 'C1'"):
        rd.compare(result, run, coupling="C2")
    with pytest.raises(NotDiagnosable, match="needs results"):
        rd.diagnose([], [result])
    other = rd.read_machine(ROOT / "examples/motor-compressor.yaml")
    with pytest.raises(NotDiagnosable, match="several machines"):
        rd.diagnose([result], [rd.identify(other, rd.simulate(other))])


def test_a_simulated_run_is_a_sweep_that_its_times_believe() -> None:
    """Of a train that rings on after its resonances: what that adds is found again, and no clock is doubted."""
    train = rd.read_machine(EXAMPLES / "thesis-chapter-3.yaml")
    said = " ".join(str(rd.identify(train, rd.simulate(train))).split())
    assert ": accepted:" in said
    assert "the model predicts deviations from the steady state" in said
    assert "the times are not those" not in said


def test_amplitudes_in_a_larger_unit_than_is_said_are_doubted(pump: Machine, run: rd.MachineRun) -> None:
    frame = run.to_frame()
    amplitudes = [name for name in frame if name.endswith("_um_pp")]
    frame[amplitudes] /= 25.4  # mil that are said to be µm
    found = rd.identify(pump, rd.read_run(frame, machine=pump))
    assert "times less than stated: are the noise and the unit of amplitudes right?" in found.verdict
    assert "times less than stated" not in rd.identify(pump, run).verdict


def test_a_vector_lies_within_its_interval(result: rd.Result) -> None:
    pytest.importorskip("pandas")
    frame = result.to_frame()
    vector, scalar = frame.loc["disc.core-1.unbalance"], frame.loc["coupling.C1.kxx"]
    assert vector["lower"] < vector["magnitude"] < vector["upper"]
    turned = vector["magnitude"] * np.exp(1j * np.radians(vector["angle_deg"]))
    assert turned == pytest.approx(complex(vector["value"], vector["imaginary"]))
    assert np.isnan([scalar["magnitude"], scalar["angle_deg"]]).all()
