"""Plots hold the numbers that they claim to show, and say what is missing."""

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.text import Annotation

import rotorundown as rd
from estimator.machine.document import Machine
from rotorundown.environment.optional_packages import PackageMissing
from rotorundown.plots.centreline import NoFilms
from tests.paths import ROOT


def curve(figure: Figure, axes: int, line: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the points of a line of a figure."""
    x, y = figure.axes[axes].lines[line].get_data()
    return np.asarray(x, dtype=float), np.asarray(y, dtype=float)


def test_bode_shows_the_run_and_the_fit(run: rd.MachineRun, result: rd.Result) -> None:
    figure = result.plot_bode(["B1L", "B2L"])
    assert [one.get_title() for one in figure.axes] == ["B1L", "B2L", "", ""]
    speed, amplitude = curve(figure, 0, 0)
    np.testing.assert_allclose(speed, run.speed_rpm)
    np.testing.assert_allclose(amplitude, run.amplitude_um_pp[:, 0])
    fit_speed, fit = curve(figure, 0, 1)
    measured = np.interp(fit_speed, run.speed_rpm[::-1], run.amplitude_um_pp[::-1, 0])
    np.testing.assert_allclose(fit, measured, rtol=0.1, atol=0.5)


def test_bode_of_many_channels_stands_in_rows_of_at_most_four(run: rd.MachineRun, result: rd.Result) -> None:
    channels = result.machine.channels
    for wanted, across in ((channels, 4), (channels[:5], 3), (channels[:1], 1)):
        figure = result.plot_bode(list(wanted))
        titles = [one.get_title() for one in figure.axes if one.get_title()]
        assert titles == list(wanted)
        places = [one.get_subplotspec() for one in figure.axes if one.get_title()]
        assert [(one.rowspan.start, one.colspan.start) for one in places if one] == [
            (2 * (place // across), place % across) for place in range(len(wanted))
        ]
        assert len(figure.axes) == 2 * len(wanted)
        assert figure.get_figwidth() / across >= 3.5
    _, lag = curve(result.plot_bode(), -1, 0)
    np.testing.assert_allclose(lag, run.phase_lag_deg[:, -1])


def test_an_unknown_channel_is_named(result: rd.Result) -> None:
    with pytest.raises(KeyError, match=r"'B1' is no channel; there are B1L.*did you mean"):
        result.plot_bode(["B1"])
    with pytest.raises(KeyError, match="no channel is named; there are B1L"):
        result.plot_bode([])


def test_polar_shows_the_vectors(run: rd.MachineRun, result: rd.Result) -> None:
    angle, size = curve(result.plot_polar(["B1R"]), 0, 0)
    np.testing.assert_allclose(size * np.exp(-1j * angle) / 2e6, run.recorded.phasor[:, 1], atol=1e-12)


def test_polar_plots_stand_in_rows_and_their_speeds_apart(result: rd.Result) -> None:
    figure = result.plot_polar(["B1L", "B1R", "B2L", "B2R", "B3L"])
    assert [one.get_title() for one in figure.axes] == ["B1L", "B1R", "B2L", "B2R", "B3L"]
    assert figure.get_figheight() == pytest.approx(6.0)
    for plot in figure.axes:
        assert 2 <= len(plot.get_yticks()) <= 4
        angle, size = (
            np.asarray(one) for one in zip(*[one.xy for one in plot.texts if isinstance(one, Annotation)], strict=True)
        )
        vectors = size * np.exp(1j * angle)
        apart = np.abs(vectors[:, None] - vectors)[np.triu_indices(vectors.size, 1)]
        assert apart.size
        assert apart.min() >= 0.19 * np.abs(vectors).max()


def test_orbits_are_as_large_as_the_probes_say(run: rd.MachineRun, result: rd.Result) -> None:
    figure = result.plot_orbit(2000.0)
    assert len(figure.axes) == 4
    x, y = curve(figure, 0, 0)
    probes = result.machine.probes[:2]
    for number, probe in enumerate(probes):
        along = x * np.cos(np.radians(probe.angle_deg)) + y * np.sin(np.radians(probe.angle_deg))
        measured = np.interp(2000.0, run.speed_rpm[::-1], run.amplitude_um_pp[::-1, number])
        assert np.ptp(along) == pytest.approx(measured, rel=0.1)


def test_campbell_marks_the_critical_speeds(result: rd.Result) -> None:
    figure = result.plot_campbell()
    marks, _ = curve(figure, 0, -1)
    np.testing.assert_allclose(marks, result.model.campbell().critical_speed_rpm, rtol=1e-6)


def test_a_machine_has_a_campbell_diagram_before_anything_is_measured(pump: Machine) -> None:
    model = rd.model(pump)
    marks, _ = curve(model.plot_campbell(), 0, -1)
    np.testing.assert_allclose(marks, [one.speed_rpm for one in model.critical_speeds()], rtol=1e-6)


def test_the_train_shows_every_part(pump: Machine, result: rd.Result) -> None:
    words = {text.get_text() for text in result.plot_train().axes[0].texts}
    named = [one.id for one in pump.discs] + [one.id for one in pump.bearings] + [one.id for one in pump.couplings]
    assert words == set(named)


def test_a_trend_shows_values_and_leaves_gaps(result: rd.Result) -> None:
    figure = rd.plot_trend([result, result], "coupling.C1.kxx", when=[2024, 2025])
    when, value = curve(figure, 0, 0)
    np.testing.assert_allclose(when, [2024, 2025])
    assert value.tolist() == [result["coupling.C1.kxx"].value] * 2
    with pytest.raises(ValueError, match="1 times for 2 results"):
        rd.plot_trend([result, result], "coupling.C1.kxx", when=[1])
    column: Any = np.empty(2, dtype=object)
    column[:] = [result, result]
    assert rd.plot_trend(column, "coupling.C1.kxx").axes


def test_the_centreline_stays_within_the_clearance(result: rd.Result) -> None:
    machine = rd.read_machine(ROOT / "examples/motor-compressor.yaml")
    figure = rd.identify(machine, rd.simulate(machine)).plot_centreline()
    for number in range(len(machine.bearings)):
        circle, place = curve(figure, number, 0), curve(figure, number, 1)
        assert np.max(np.hypot(*place)) < np.max(np.hypot(*circle))
    with pytest.raises(NoFilms, match="say nothing of their films"):
        result.plot_centreline()


def test_a_missing_package_is_named(result: rd.Result, run: rd.MachineRun, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib.pyplot", None)
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(PackageMissing, match=r"^plots need matplotlib: pip install 'rotorundown\[plots\]'$"):
        result.plot_bode()
    with pytest.raises(PackageMissing, match=r"^data frames need pandas: pip install 'rotorundown\[frames\]'$"):
        run.to_frame()


CELLS = """
import sys
from IPython.core.interactiveshell import InteractiveShell
from IPython.utils.capture import capture_output
shell = InteractiveShell.instance()
shell.run_cell("from rotorundown.plots.canvas import figure\\ndef plot(): return figure(1, 1)[0]")
for cell in ("plot()", "plot(); plot()", "kept = plot()", "kept", "for _ in range(3): plot()"):
    with capture_output() as captured:
        shell.run_cell(cell).raise_error()
    print(sum("image/png" in one.data for one in captured.outputs), captured.stderr)
"""


def test_a_notebook_shows_each_plot_once(tmp_path: Path) -> None:
    inline = os.environ | {"MPLBACKEND": "module://matplotlib_inline.backend_inline", "IPYTHONDIR": str(tmp_path)}
    done = subprocess.run(
        [sys.executable, "-c", CELLS], env=inline, cwd=ROOT, capture_output=True, text=True, check=True, timeout=120
    )
    assert [line for line in done.stdout.split() if line.isdigit()] == ["1", "2", "1", "1", "3"]


def test_a_script_finds_the_figure_in_pyplot(result: rd.Result) -> None:
    from matplotlib import pyplot

    drawn = result.plot_bode(["B1L"])
    assert pyplot.gcf() is drawn
    pyplot.close(drawn)
