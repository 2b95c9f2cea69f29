"""A run as people bring it from elsewhere: a CSV file with its sidecar."""

import csv
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from estimator.arrays import Complexes, Floats


def write_run(file: Path, speed: Floats, phasor: Complexes, *, channels: Sequence[str], **sidecar: Any) -> str:
    """Write amplitudes and phases over speed [rad/s], in micrometres peak and phase lead unless the sidecar says otherwise.

    phasor: in the amplitude's unit, of shape (speeds, channels). Returns the file's path.
    """
    described = {
        "interval_s": 10.0,
        "speed": "speed",
        "speed_unit": "rad/s",
        "amplitude_unit": "um",
        "amplitude_kind": "peak",
        "phase_convention": "lead",
        "phase_unit": "deg",
        "channels": [{"channel": one, "amplitude": f"{one}_a", "phase": f"{one}_p"} for one in channels],
        **sidecar,
    }
    size = 2.0 if described["amplitude_kind"] == "peak-to-peak" else 1.0
    sign = -1.0 if described["phase_convention"] == "lag" else 1.0
    with file.open("w", newline="") as opened:
        writer = csv.writer(opened)
        writer.writerow(["speed", *(f"{channel}_{part}" for channel in channels for part in ("a", "p"))])
        for at, row in zip(speed, phasor, strict=True):
            writer.writerow([at, *(value for one in row for value in (size * abs(one), sign * np.degrees(np.angle(one))))])
    file.with_suffix(".yaml").write_text(yaml.safe_dump(described))
    return str(file)
