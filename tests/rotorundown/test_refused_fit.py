"""A fit that is not accepted: nothing follows from it, and its table and plots say so."""

import pytest

import rotorundown as rd
from rotorundown.result import NotAccepted


@pytest.fixture(scope="module")
def refused(pump: rd.Machine, run: rd.MachineRun) -> rd.Result:
    table = run.to_frame()
    for channel in run.channels:
        table[f"{channel}_lag_deg"] = -table[f"{channel}_lag_deg"]
    found = rd.identify(pump, rd.read_run(table, machine=pump))
    assert not found.accepted
    return found


def test_no_model_follows_from_it(refused: rd.Result) -> None:
    for asked in (lambda: rd.model(refused), lambda: refused.model, refused.plot_campbell):
        with pytest.raises(NotAccepted, match="motor-pump: nothing follows from a fit that is not accepted: ") as raised:
            asked()
        assert "\n" not in str(raised.value)
    assert issubclass(NotAccepted, rd.Invalid)


def test_its_table_says_whether_it_is_to_be_used(refused: rd.Result, result: rd.Result) -> None:
    assert refused.to_frame().attrs["accepted"] is False
    assert result.to_frame().attrs["accepted"] is True


def test_its_plots_call_it_so(refused: rd.Result, result: rd.Result) -> None:
    (legend,) = refused.plot_bode("B1L").legends
    assert "fit, NOT ACCEPTED" in [text.get_text() for text in legend.get_texts()]
    assert refused.plot_polar("B1L").get_suptitle() == "fit, NOT ACCEPTED"
    assert result.plot_polar("B1L").get_suptitle() == ""
    assert "fit, NOT ACCEPTED" in refused.plot_orbit(2980).get_suptitle()
    assert "NOT" not in result.plot_orbit(2980).get_suptitle()
