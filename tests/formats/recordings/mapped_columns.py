"""One run in columns, mapped for all files of a folder, and its comparison with what is read."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from formats.recordings.recording import read_recording

RPM = np.linspace(600.0, 3000.0, 25)
AMPLITUDE = 20.0 + 0.01 * RPM
PHASE = np.linspace(10.0, 170.0, 25)
SAID = {
    "plant": "examples",
    "machine": "pump",
    "interval_s": 1.0,
    "speed": "Speed",
    "speed_unit": "rpm",
    "amplitude_unit": "um",
    "amplitude_kind": "peak-to-peak",
    "phase_convention": "lag",
    "phase_unit": "deg",
    "channels": [{"channel": "B1X", "amplitude": "A", "phase": "P"}],
}


def mapped(folder: Path, **changes: Any) -> None:
    """Save the mapping of the columns for all recordings of a folder."""
    (folder / "columns.yaml").write_text(yaml.safe_dump(SAID | changes))


def assert_read(path: Path) -> None:
    batch = read_recording(path)
    assert batch.speed == pytest.approx(list(RPM), rel=1e-5)
    assert [row[0] for row in batch.amplitude] == pytest.approx(list(AMPLITUDE), rel=1e-5)
    assert [row[0] for row in batch.phase] == pytest.approx(list(PHASE), rel=1e-5)
