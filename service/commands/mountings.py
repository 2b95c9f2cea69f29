"""Identification of each mounting by itself: a calibrated machine's file may hold runs between which it was taken apart."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from service.commands.exit import fail
from service.commands.json_output import print_json
from service.commands.terminal import print_line, print_text, working

if TYPE_CHECKING:
    from estimator.machine.disc_scale import DiscScale
    from estimator.machine.document import Machine
    from rotorundown.runs import MachineRun


def mounted_runs(
    machine: "Machine", files: Sequence[Path], sidecar: Path | None
) -> "tuple[dict[str, list[MachineRun]], list[str]]":
    """Return the runs of each mounting and what was left out, of a calibrated machine whose sidecar tells several apart.

    Else there are none.

    Each mounting has an unbalance of its own, which one fit of all of them would take for the same. Raises UnreadableFile,
    Rejected.
    """
    from formats.recordings.recorded_runs import read_mountings
    from formats.recordings.sidecar_place import sidecar_of
    from rotorundown.runs import MachineRun

    described = all((sidecar or sidecar_of(file)).is_file() for file in files)
    if machine.calibration is None or not described:
        return {}, []
    found: dict[str, list[MachineRun]] = {}
    left_out: list[str] = []
    for file in files:
        parts, faults = read_mountings(machine, file, sidecar)
        left_out += faults
        for name, recorded, measurement in parts:
            found.setdefault(name, []).append(MachineRun(name, machine.channels, recorded, measurement))
    return (found, left_out) if len(found) > len(files) else ({}, [])


def stated_scale(machine: "Machine", file: Path, sidecar: Path | None) -> "tuple[DiscScale, int]":
    """Return the scale of the discs that a file's sidecar states, and the sense of rotation; of a plain table the usual."""
    from estimator.machine.disc_scale import DiscScale
    from formats.recordings.recording import read_circumstances
    from formats.recordings.sidecar_place import sidecar_of

    if not (sidecar or sidecar_of(file)).is_file():
        return DiscScale(), machine.direction
    told = read_circumstances(file, sidecar)
    return told.scale, told.direction


def print_mountings(
    machine: "Machine",
    mountings: "dict[str, list[MachineRun]]",
    file: Path,
    sidecar: Path | None,
    *,
    gate: bool,
    as_json: bool,
) -> None:
    """Identify each mounting and print what each disc has gained in it; status 1 where one is refused."""
    from estimator.calibration.unbalance_since import unbalance_since
    from estimator.phasors.measurement import joined
    from rotorundown.identification import identify_behind_gate
    from service.commands.results.identification_report import beyond_stated_weights, since_text, verdict_text
    from service.commands.results.result_content import since_content

    scale, direction = stated_scale(machine, file, sidecar)
    accepted, content = True, []
    print_line(f"{len(mountings)} mountings, each identified by itself: its unbalance is its own", err=as_json)
    for name, runs in mountings.items():
        try:
            with working(f"identifying {name}"):
                gated = identify_behind_gate(machine, runs, gate=gate)
        except ValueError as error:
            fail(f"{name}: {error}")
        found = gated.identification
        verdict = gated.error or "there is nothing to identify from" if found is None else found.verdict
        since = None if found is None else unbalance_since(machine, found)
        accepted &= found is not None and found.accepted
        rows = None if since is None else since_content(since, scale, direction=direction)
        content.append(
            {
                "mounting": name,
                "accepted": found is not None and found.accepted,
                "verdict": verdict,
                "unbalance_since_calibration": rows,
            }
        )
        if not as_json:
            text = ""
            if found is not None and since is not None:
                beyond = beyond_stated_weights(machine, joined([run.measurement for run in runs]), scale, direction=direction)
                text = since_text(since, scale, direction=direction, beyond=beyond, accepted=found.accepted)
            print_text(f"\n{name}: {verdict if found is None else verdict_text(found)}{text}")
    if as_json:
        print_json({"machine": machine.id, "mountings": content})
    if not accepted:
        raise typer.Exit(1)
