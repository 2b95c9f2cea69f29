"""Wrong input for the library: tables of runs changed as people have them, and errors of one line."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rotorundown as rd
from tests.paths import EXAMPLES

PUMP = EXAMPLES / "motor-pump.yaml"


def one_line(raised: pytest.ExceptionInfo[Any]) -> str:
    """The message of an error, which is one line."""
    assert "\n" not in str(raised.value)
    return str(raised.value)


def untimed(run: rd.MachineRun) -> Any:
    """A run as a data frame without times, as an instrument's export often is."""
    return run.to_frame().drop(columns="time_s")


def doubled(frame: Any) -> Any:
    return frame.set_axis([*frame.columns[:-1], frame.columns[-2]], axis=1)


def written(file: Path, frame: Any) -> str:
    """A table as a file without a sidecar."""
    frame.to_csv(file, index=False)
    return str(file)


def in_radians(frame: Any) -> Any:
    return frame.apply(lambda one: np.radians(one) if one.name.endswith("_lag_deg") else one)
