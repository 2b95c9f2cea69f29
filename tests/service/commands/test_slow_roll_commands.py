"""Slow roll on the command line: vectors of a recording in volts, printed and subtracted."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from estimator.machine.document import parse_machine
from tests.estimator.trains import Complexes, chapter_3_document, dense_response, noisy
from tests.service.commands.command_line import run
from tests.service.commands.recorded_run import write_run

SLOW, SWEEP = np.linspace(10.0, 30.0, 40) * np.pi / 30, np.arange(300.0, 10.0, -4.0)
SPEED = np.concatenate([SWEEP, SLOW[::-1]])
RUN_OUT = 2.5e-4 * np.exp(1j * np.arange(8.0))
"""Of each channel, 0-to-peak [m]: 500 µm peak-to-peak."""
SENSITIVITY = 7000.0 + 500.0 * np.arange(8)
"""Of each probe [V/m]: no two alike."""


def in_volts(folder: Path) -> str:
    """The Chapter 3 document whose probes give volts; its path."""
    document = chapter_3_document()
    for probe, sensitivity in zip(document["probes"], SENSITIVITY, strict=True):
        probe["sensitivity"] = float(sensitivity)
    (folder / "train.yaml").write_text(yaml.safe_dump(document))
    return str(folder / "train.yaml")


def recorded(folder: Path, phasor: Complexes, **sidecar: Any) -> str:
    """A run-down to standstill in volts; its path."""
    channels = [probe["id"] for probe in chapter_3_document()["probes"]]
    said = {"plant": "examples", "machine": "thesis-chapter-3", "amplitude_unit": "V"}
    said |= {"amplitude_kind": "peak-to-peak", "phase_convention": "lag", **sidecar}
    return write_run(folder / "run.csv", SPEED, phasor * SENSITIVITY, channels=channels, **said)


@pytest.fixture
def files(tmp_path: Path) -> tuple[str, str]:
    """Document and recording."""
    clean = dense_response(parse_machine(chapter_3_document()), SPEED, direction=1)
    return in_volts(tmp_path), recorded(tmp_path, noisy(clean + RUN_OUT, seed=3))


def test_vectors_are_printed(files: tuple[str, str]) -> None:
    text = run("slow-roll", *files, "10:30")
    lines = text.splitlines()
    assert lines[0] == "Slow-roll vectors ± standard error from 40 samples, 10 to 30 r/min"
    assert len(lines) == 9
    for line, vector in zip(lines[1:], RUN_OUT, strict=True):
        words = line.replace(",", "").replace("°", "").split()
        size, error, lag = float(words[1]), float(words[3]), float(words[-1])
        assert abs(size - 2e6 * abs(vector)) < 4 * error + 3.0  # a little of the response is in it, and in the error
        assert abs((lag + np.degrees(np.angle(vector)) + 180) % 360 - 180) < 2.0


def test_the_runs_own_slow_roll_is_subtracted(files: tuple[str, str]) -> None:
    text = run("identify", *files, "--slow-roll", "10:30", "--all")
    verdict = next(line for line in text.splitlines() if "χ²/dof" in line)
    assert verdict.startswith("accepted")
    assert f"{SWEEP.size} samples" in text
    words = next(line for line in text.splitlines() if line.startswith("bearing.B1.kxx")).split()
    assert abs(float(words[1]) - 250_000) < 4 * float(words[3])
    assert any(line.startswith("probe.B1X.run_out") for line in text.splitlines())


@pytest.mark.parametrize(
    ("band", "words"),
    [
        ("10-30", "is no speed band; one is written as 200:400"),
        ("30:10", "the lower one first"),
        ("nan:30", "the lower one first"),
        ("1:2:3", "is no speed band"),
        ("31:80", "0 good samples in the band"),
        ("100:700", "this is vibration"),
    ],
)
def test_bands_without_slow_roll(files: tuple[str, str], band: str, words: str) -> None:
    assert words in run("slow-roll", *files, band, status=1)
    assert words in run("identify", *files, "--slow-roll", band, status=1)
