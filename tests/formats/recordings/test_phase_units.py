"""Phases whose unit is doubted: small ones of a single channel may be degrees, those of several are radians."""

from pathlib import Path

import numpy as np
import pytest
import yaml

from formats.files.document_files import UnreadableFile
from formats.recordings.recorded_runs import read_measurement
from tests.plant import CHANNELS, KEY, machine

ROWS = 60


def recorded(folder: Path, channels: tuple[str, ...]) -> Path:
    """A run whose phases pass through a turn in radians, with a sidecar that calls them degrees."""
    phase = np.linspace(0.1, 6.1, ROWS)
    rows = [
        ",".join([f"{rpm:.1f}", *(f"100,{one:.4f}" for _ in channels)])
        for rpm, one in zip(np.linspace(400, 2800, ROWS), phase, strict=True)
    ]
    header = ",".join(["speed", *(f"{one}_a,{one}_p" for one in channels)])
    (folder / "run.csv").write_text("\n".join([header, *rows]), encoding="utf-8")
    described = {
        "plant": KEY.plant,
        "machine": KEY.machine,
        "interval_s": 1.0,
        "speed": "speed",
        "speed_unit": "rpm",
        "channels": [{"channel": one, "amplitude": f"{one}_a", "phase": f"{one}_p"} for one in channels],
        "amplitude_unit": "um",
        "amplitude_kind": "peak-to-peak",
        "phase_convention": "lag",
        "phase_unit": "deg",
    }
    (folder / "run.yaml").write_text(yaml.safe_dump(described), encoding="utf-8")
    return folder / "run.csv"


def test_small_phases_of_one_channel_are_taken_as_the_sidecar_says_and_doubted(tmp_path: Path) -> None:
    found, doubts = read_measurement(machine(), [recorded(tmp_path, CHANNELS[:1])])
    assert np.nanmax(np.abs(np.angle(found.phasor[:, 0]))) == pytest.approx(np.radians(6.1), rel=1e-3)
    assert doubts[-1].endswith("which looks like radians, and is taken as the degrees that its sidecar says")


def test_small_phases_of_several_channels_are_refused(tmp_path: Path) -> None:
    with pytest.raises(UnreadableFile, match="looks like radians: its sidecar should say phase_unit: rad"):
        read_measurement(machine(), [recorded(tmp_path, CHANNELS)])
