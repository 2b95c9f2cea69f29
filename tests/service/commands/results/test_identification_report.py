"""Estimates in a table: no power of ten before a percent sign, and no unit of what has none."""

import pytest
from msgspec.structs import replace

import rotorundown as rd
from estimator.fit.estimates import Estimate
from estimator.machine.document import parse_machine
from rotorundown.summaries.estimate_summary import sample_words
from service.commands.results.identification_report import identification_text
from tests.paths import EXAMPLES


@pytest.fixture(scope="module")
def result() -> rd.Result:
    pump = rd.read_machine(EXAMPLES / "motor-pump.yaml")
    return rd.identify(pump, rd.simulate(pump, samples=60))


@pytest.mark.parametrize(
    ("unit", "value", "error", "words"),
    [
        ("1", 0.9985, 4.8e-3, "+9.9850e-01 ± 4.8e-03 (0.48 %)"),
        ("N/m", -2e6, 2.1e6, "-2.0000e+06 ± 2.1e+06 N/m (105 %)"),
        ("N/m", 1e5, 99.4e3, "+1.0000e+05 ± 9.9e+04 N/m (99 %)"),
        ("N/m", 1e3, 9.9e4, "+1.0000e+03 ± 9.9e+04 N/m (over 1000 %)"),
        ("N/m", 0.0, 1.0, "+0.0000e+00 ± 1.0e+00 N/m (over 1000 %)"),
    ],
)
def test_an_estimate_is_a_line_that_a_person_reads(
    result: rd.Result, unit: str, value: float, error: float, words: str
) -> None:
    first = result.identification.estimates[0]
    changed = replace(first, name="it", unit=unit, quantity="stiffness", value=value, standard_error=error, imaginary=None)
    text = identification_text(result.machine, replace(result.identification, estimates=(changed,)), every=True)
    assert text.splitlines()[-1] == f"it  {words}"


def test_terms_that_are_tied_or_kept_are_told_so_and_not_as_left_open(result: rd.Result) -> None:
    first = result.identification.estimates[0]

    open_one = replace(first, element="pedestal.P2", value=None, standard_error=None, imaginary=None)

    def without(name: str, reason: str) -> Estimate:
        return replace(open_one, name=f"pedestal.P2.{name}", reason=reason)

    estimates = (
        without("kxx", "tied to pedestal.P1.kxx"),
        without("kyy", "tied to pedestal.P1.kyy"),
        without("mxx", "kept at its nominal value 600 kg"),
        without("cxx", "as the document gives it over speed, which is taken as exact"),
        without("cyy", "the data leave it open"),
    )
    held = replace(result.identification, estimates=estimates)
    (line,) = [
        one for one in identification_text(result.machine, held, every=False).splitlines() if one.startswith("pedestal.P2")
    ]
    assert line == "pedestal.P2  2 kept, 2 tied to pedestal.P1, 1 not estimable"
    said = identification_text(result.machine, held, every=True)
    assert "pedestal.P2.kxx  tied to pedestal.P1.kxx" in said
    assert said.count("not estimable: ") == 1


def test_the_speed_from_which_films_hold_stands_beside_the_speeds_that_were_fitted(result: rd.Result) -> None:
    fitted = "60 samples, 285 to 3596 r/min"
    assert sample_words(result.identification, result.machine) == fitted
    train = rd.read_machine(EXAMPLES / "motor-compressor.yaml")
    document = train.model_dump(mode="json")
    document["bearings"][1]["film"]["valid_above_rpm"] = 1200.0
    assert sample_words(result.identification, parse_machine(document)) == f"{fitted} (films hold from 1200 r/min on)"


@pytest.mark.parametrize("every", [False, True])
def test_estimates_have_one_heading(result: rd.Result, *, every: bool) -> None:
    assert identification_text(result.machine, result.identification, every=every).count("Values ± standard error") == 1
