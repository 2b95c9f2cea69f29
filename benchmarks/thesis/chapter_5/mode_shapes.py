"""Mode shapes of the rig of Chapter 5, aligned and misaligned (the content of Figure 5.23)."""

import math

import numpy as np

from benchmarks.thesis.chapter_5.rig import Rig
from benchmarks.thesis.plots import PlottedCurve, chart, save
from benchmarks.thesis.tables import table
from estimator.arrays import Floats
from estimator.modes.mode_shapes import ModeShape, mode_shapes

HIGHEST_HZ = 450.0
"""The impact tests look no further than the third pair of modes."""


def section(rig: Rig) -> str:
    """Return the first three modes of the x-z plane at standstill, in words and as a figure."""
    modes = plane_modes(rig)
    rows = [
        [f"{mode.frequency / (2 * math.pi):.1f}", str(number), str(nodes(mode)), *_largest(mode), _joint(mode)]
        for number, mode in enumerate(modes)
    ]
    place = save("chapter-5-mode-shapes", _figure(modes))
    return (
        "### Mode shapes: Figure 5.23\n\n"
        "At standstill, in the horizontal plane, the largest displacement of the train set to one. Of its own modes, on "
        "simple supports, the thesis says that the first has no node, the second one near the coupling, the third one on "
        "each shaft:\n\n"
        + table(["Hz", "nodes, printed", "nodes here", "rotor 1, largest", "rotor 2, largest", "kink in the coupling"], rows)
        + f"\n\n![mode shapes]({place})\n\n"
        "The kink is the difference of the two slopes in the coupling times the length of a shaft. This rig's coupling, "
        "chosen to meet the printed frequencies, leaves each mode to one rotor: what the other does there is a few per cent, "
        "and a node in it hangs on little. An impact on one rotor shows that rotor's modes only."
    )


def nodes(mode: ModeShape) -> int:
    """Return how often the displacement along the train changes its sign; bearings hold the shafts softly, so ends count."""
    shape = _along(mode)
    return int(np.count_nonzero(np.diff(np.sign(shape[np.abs(shape) > 1e-6])) != 0))


def plane_modes(rig: Rig) -> list[ModeShape]:
    """Return the first three modes at standstill that move mainly in the x-z plane."""
    found = mode_shapes(rig.machine, spin=0.0, highest_frequency=2 * math.pi * HIGHEST_HZ, coefficients=rig.coefficients)
    return [mode for mode in found if _size(mode, "x") > _size(mode, "y")][:3]


def _size(mode: ModeShape, axis: str) -> float:
    return float(np.linalg.norm(np.concatenate([getattr(shaft, axis) for shaft in mode.shafts])))


def _largest(mode: ModeShape) -> list[str]:
    whole = max(float(np.max(np.abs(shaft.x))) for shaft in mode.shafts)
    return [f"{float(np.max(np.abs(shaft.x))) / whole:.2f}" for shaft in mode.shafts]


def _joint(mode: ModeShape) -> str:
    driver, driven = mode.shafts[0], mode.shafts[1]
    whole = max(float(np.max(np.abs(shaft.x))) for shaft in mode.shafts)
    kink = abs(driver.theta_y[-1] - driven.theta_y[0]) * driver.station[-1] / whole
    return f"{kink:.2f}"


def _along(mode: ModeShape) -> Floats:
    """Return the displacement along both shafts at the instant when it is largest."""
    shape = np.concatenate([shaft.x for shaft in mode.shafts])
    turned = (shape * np.exp(-1j * np.angle(shape[np.argmax(np.abs(shape))]))).real
    return np.asarray(turned / np.max(np.abs(turned)))


def _figure(modes: list[ModeShape]) -> str:
    series = []
    for mode in modes:
        place = np.concatenate([mode.shafts[0].station, mode.shafts[0].station[-1] + mode.shafts[1].station])
        series.append(PlottedCurve(f"{mode.frequency / (2 * math.pi):.0f} Hz", place.tolist(), _along(mode).tolist()))
    title = "Mode shapes of the rig, x-z plane"
    return chart(title=title, x_label="along both shafts [m]", y_label="displacement", series=series)
