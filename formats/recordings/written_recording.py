"""Write runs as recordings: a CSV file, and the sidecar that describes its columns."""

import cmath
import math
from collections.abc import Mapping
from datetime import datetime
from pathlib import Path

import numpy as np
import yaml

from estimator.arrays import Complexes, Floats
from estimator.machine.document import Machine
from formats.files.csv_cells import CsvWriter, cell
from formats.files.document_files import UnreadableFile
from formats.recordings.sidecar import RecordedChannel, Sidecar, read_sidecar
from storage.files.private_files import prepare


def write_recording(
    path: Path,
    machine: Machine,
    *,
    speed_rpm: Floats,
    phasor: Complexes,
    interval_s: float,
    gap_um: Floats | None = None,
    weights: Mapping[str, tuple[float, float]] | None = None,
    start: datetime | None = None,
) -> None:
    """Write a run as CSV with its sidecar, readable by their owner only, for `read_recording`.

    speed_rpm: (S,) [r/min]. phasor: (S, m) at the machine's probes, 0-to-peak [m]; written in µm peak-to-peak, phase lag.
    gap_um: (S, m) gaps as the probes' document says that they grow [µm]; NaN for probes without.
    weights: trial weights that were on, by disc: what each adds [g mm], and its angle from +x towards +y [°]; None where
    nobody says. start: time of the first row; None where nobody says.

    Raises UnreadableFile where another file, such as the machine's document, stands where the sidecar would.
    """
    _require_room(path)
    channels = machine.channels
    gap = np.full(phasor.shape, np.nan) if gap_um is None else gap_um
    told = np.flatnonzero(np.isfinite(gap).all(axis=0))
    gaps = {channels[place]: cell(f"{channels[place]}_gap_um") for place in told}
    prepare(path)
    prepare(path.with_suffix(".yaml"))
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = CsvWriter(file)
        parts = (f"{channel}_{part}" for channel in channels for part in ("um_pp", "lag_deg"))
        writer.row(["speed_rpm", *parts, *gaps.values()])
        for speed, row, behind in zip(speed_rpm, phasor, gap[:, told], strict=True):
            values = [value for one in row for value in (2e6 * abs(one), -math.degrees(cmath.phase(one)))]
            writer.row([f"{speed:.4f}", *(f"{value:.6g}" for value in (*values, *behind))])
    sidecar = Sidecar(
        plant=machine.plant,
        machine=machine.id,
        direction=machine.rotation,
        interval_s=interval_s,
        speed="speed_rpm",
        speed_unit="rpm",
        channels=[
            RecordedChannel(channel=c, amplitude=cell(f"{c}_um_pp"), phase=cell(f"{c}_lag_deg"), gap=gaps.get(c))
            for c in channels
        ],
        amplitude_unit="um",
        amplitude_kind="peak-to-peak",
        phase_convention="lag",
        phase_unit="deg",
        gap_unit="um" if gaps else None,
        **({} if start is None else {"start": start}),
    )
    left_out = {"kind", "added_unbalance", "disc_scale", "conditions"} | ({"start"} if start is None else set())
    described = sidecar.model_dump(mode="json", exclude_none=True, exclude=left_out)
    if weights is not None:
        described["added_unbalance"] = {
            disc: {"amount": amount, "unit": "g mm", "angle_deg": angle} for disc, (amount, angle) in weights.items()
        } or "none"
    path.with_suffix(".yaml").write_text(yaml.safe_dump(described, sort_keys=False), encoding="utf-8")


def _require_room(path: Path) -> None:
    """Raise UnreadableFile where a recording's sidecar would take the place of a file that is none."""
    beside = path.with_suffix(".yaml")
    if beside == path:
        raise UnreadableFile(f"{path}: a recording is a CSV file; its sidecar takes the name that ends in .yaml")
    if not beside.exists():
        return
    try:
        read_sidecar(beside)
    except UnreadableFile:
        raise UnreadableFile(
            f"{beside} is no sidecar of a recording, and that of {path.name} would take its place: give the CSV another name"
        ) from None
