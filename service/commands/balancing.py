"""The command `rundown balance`: from an initial run and trial runs to a correction, and its check run."""

import math
from collections.abc import Callable
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import typer

from estimator.balancing.criterion import Criterion
from service.commands.exit import fail, words_of
from service.commands.file_arguments import MachineFile, named_file, named_files
from service.commands.find_language import find_language
from service.commands.json_output import JsonOption, print_json
from service.commands.terminal import print_line, print_text, working

if TYPE_CHECKING:
    from estimator.balancing.balancing_check import BalancingCheck
    from estimator.balancing.field_balancing import BalancingOptions, BalancingRun, FieldBalancing, ModelInfluence
    from estimator.balancing.weight_places import WeightPlaces
    from estimator.machine.disc_scale import DiscScale
    from estimator.machine.document import Machine
    from service.balancing.correction_rows import PlaneWeight

GRAM = 1e-3
MILLIMETRE = 1e-3
InitialFile = Annotated[Path, typer.Argument(help="recorded run before any trial weight", callback=named_file)]
TrialFiles = Annotated[
    list[Path], typer.Argument(help="recorded runs with the trial weights that their sidecars state", callback=named_files)
]


def balance_machine(
    machine: MachineFile,
    initial: InitialFile,
    trials: TrialFiles,
    check: Annotated[Path | None, typer.Option(help="run after the correction; its sidecar says which weights are on")] = None,
    plane: Annotated[list[str] | None, typer.Option(help="disc to correct in; by default all that had a trial weight")] = None,
    criterion: Annotated[
        Criterion, typer.Option(help="least squares of the vibration, or the least largest")
    ] = "least-squares",
    limit: Annotated[list[str] | None, typer.Option(help="largest correction of a disc, such as D1=50 [g mm]")] = None,
    holes: Annotated[
        list[str] | None,
        typer.Option(help="places of a disc, as DISC=COUNT,RADIUS[,FIRST[,LARGEST[,STEP]]] in mm, ° and g: D1=16,30,0,5,0.1"),
    ] = None,
    rpm: Annotated[list[float] | None, typer.Option(help="speed to balance at; by default all that the runs share")] = None,
    grade: Annotated[float, typer.Option(min=1e-3, help="balance quality grade G asked for [mm/s]")] = 2.5,
    service_rpm: Annotated[float | None, typer.Option(min=1e-3, help="service speed; by default the range's end")] = None,
    use_model: Annotated[
        bool, typer.Option("--model", help="identify the machine from the same runs, and use its model if it predicts better")
    ] = False,
    page: Annotated[Path | None, typer.Option(help="HTML file for one printed page with vector plots")] = None,
    locale: Annotated[str, typer.Option(help="language of the page, en or de")] = "en",
    as_json: JsonOption = False,
) -> None:
    """Compute correction weights from an initial run and trial runs, without a service, and judge a check run.

    Prints the correction with 95 % intervals, the vibration and the residual unbalance that it will leave (ISO 21940-11,
    and the document's vibration limit). With --check ends with status 1 where the run shows more than was promised.
    """
    import threadpoolctl

    from estimator.balancing.balancing_check import check_balancing
    from estimator.balancing.field_balancing import balance_from_trials
    from formats.files.document_files import UnreadableFile, read_machine
    from formats.wire import Rejected
    from service.balancing.correction_rows import effect_rows
    from service.balancing.printed_page import printed_page
    from service.commands.document_warnings import print_warnings

    language = find_language(locale)
    try:
        described = read_machine(machine)
        print_warnings(described)
        scale = _scale_of([initial, *trials, *([] if check is None else [check])])
        turned = partial(scale.angle, direction=described.direction)
        options = _options(plane, criterion, limit or [], _places(holes or [], turned), rpm, grade, service_rpm)
        groups = [run for file in (initial, *trials) for run in _balancing_runs(described, file, required=file != initial)]
        unloaded = [run for run in groups if run.added is not None and not np.any(run.added)]
        loaded = [run for run in groups if run.added is None or np.any(run.added)]
        model = _model(machine, [initial, *trials]) if use_model else None
        with threadpoolctl.threadpool_limits(1), working("balancing"):
            found = balance_from_trials(described, unloaded, loaded, options=options, model=model)
            checked = None if check is None else check_balancing(found, _check_run(described, check))
        _print(found, checked, scale, as_json=as_json)
        if page is not None:
            page.write_text(printed_page(found, checked, language, scale), encoding="utf-8")
    except (UnreadableFile, Rejected, ValueError, OSError) as error:
        fail(words_of(error))
    if checked is not None and not all(one.held for one in effect_rows(found, checked) if one.held is not None):
        raise typer.Exit(1)


def _print(found: "FieldBalancing", checked: "BalancingCheck | None", scale: "DiscScale", *, as_json: bool) -> None:
    from estimator.units import rad_per_s_to_rpm
    from service.balancing.balancing_text import balancing_text
    from service.balancing.correction_rows import effect_rows, plane_weights
    from service.balancing.rendering import on_scale

    if not as_json:
        print_text(balancing_text(found, checked, scale=scale))
        return
    effects = effect_rows(found, checked)
    print_json(
        {
            "machine": found.machine.id,
            "speeds_rpm": [rad_per_s_to_rpm(one) for one in found.speed],
            "runs": found.runs.names,
            "influence": found.choice.words,
            "notes": found.notes,
            "criterion": found.correction.criterion,
            "disc_scale": scale,
            "correction": on_scale([_plane_content(one) for one in plane_weights(found)], scale, found.machine.direction),
            "largest_vibration_um_pp": effects,
            "held": None if checked is None else all(one.held for one in effects if one.held is not None),
        }
    )


def _plane_content(one: "PlaneWeight") -> dict[str, Any]:
    return asdict(one) | {"masses": [{"angle_deg": angle, "grams": grams} for angle, grams in one.masses]}


def _balancing_runs(machine: "Machine", file: Path, *, required: bool) -> "list[BalancingRun]":
    """Return the runs of a file: rows with the same weights and of the same mounting are one.

    required: whether the file must state its weights. A run that states none is taken to have had none.
    """
    from estimator.balancing.field_balancing import BalancingRun
    from formats.files.document_files import UnreadableFile
    from formats.recordings.recorded_runs import read_runs
    from formats.recordings.recording import read_circumstances

    ((_, measurement),), left_out = read_runs(machine, [file])
    for line in left_out:
        print_line(line, err=True)
    circumstances = read_circumstances(file)
    if required and not circumstances.stated:
        raise UnreadableFile(
            f"{file} states no trial weight: its sidecar needs `added_unbalance` with disc, amount, unit and angle, or `none`"
        )
    rows = measurement.speed.size
    added = np.zeros((rows, len(machine.discs)), dtype=complex) if measurement.added is None else measurement.added
    mounting = circumstances.mounting
    if len(set(mounting)) <= 1:
        mounting = [""] * rows
    if len(mounting) != rows:
        raise UnreadableFile(f"{file}: rows that cannot be used must be taken out of a file with several runs, see above")
    keys = [(mounted, *row.tolist()) for mounted, row in zip(mounting, added, strict=True)]
    distinct = list(dict.fromkeys(keys))
    runs = []
    for number, key in enumerate(distinct, 1):
        which = np.array([one == key for one in keys])
        own = measurement.pick(which)
        name = file.stem if len(distinct) == 1 else f"{file.stem} {key[0] or number}"
        runs.append(BalancingRun(name, own.with_trial_weight(added[which][0])))
    return runs


def _check_run(machine: "Machine", file: Path) -> "BalancingRun":
    """Return a check run; where it states no weights, those of the correction are taken to be on."""
    from estimator.balancing.field_balancing import BalancingRun
    from formats.files.document_files import UnreadableFile
    from formats.recordings.recorded_runs import read_runs

    runs = _balancing_runs(machine, file, required=False)
    if len(runs) > 1:
        raise UnreadableFile(f"{file} holds {len(runs)} runs with different weights; a check run is one")
    ((_, measurement),), _ = read_runs(machine, [file])
    return BalancingRun(file.stem, measurement)


def trial_weights(texts: list[str]) -> dict[str, tuple[float, float]]:
    """Return trial weights by disc, [g mm] and [°], as a person gives them: D1=50,90. Raises ValueError."""
    weights = {}
    for text in texts:
        disc, (amount, angle) = _numbers(text, "--weight D1=50,90: g mm and °", 2, 2, signed=True)
        if disc in weights:
            raise ValueError(f"--weight {disc} is given twice: a disc's weights together are one amount at one angle")
        weights[disc] = (amount, angle)
    return weights


def _options(
    planes: list[str] | None,
    criterion: Criterion,
    limits: list[str],
    places: "dict[str, WeightPlaces]",
    rpm: list[float] | None,
    grade: float,
    service_rpm: float | None,
) -> "BalancingOptions":
    from estimator.balancing.balance_quality import GRAM_MILLIMETRE
    from estimator.balancing.field_balancing import BalancingOptions
    from estimator.units import rpm_to_rad_per_s

    bounds = dict(_numbers(text, "--limit D1=50: g mm", 1, 1) for text in limits)
    return BalancingOptions(
        planes=None if planes is None else tuple(planes),
        criterion=criterion,
        limit={disc: numbers[0] * GRAM_MILLIMETRE for disc, numbers in bounds.items()},
        places=places,
        grade=grade,
        service_speed=None if service_rpm is None else rpm_to_rad_per_s(service_rpm),
        speed=None if rpm is None else np.array([rpm_to_rad_per_s(one) for one in rpm]),
    )


def _places(holes: list[str], turned: Callable[[float], float]) -> "dict[str, WeightPlaces]":
    """Return the places of discs. turned: function that makes an angle on the scale [°] one from +x towards +y [rad]."""
    from estimator.balancing.weight_places import WeightPlaces

    places = {}
    for text in holes:
        disc, numbers = _numbers(text, "--holes D1=16,30,0,5,0.1: count, radius [mm], first [°], largest and step [g]", 2, 5)
        count, radius, first, largest, step = [*numbers, *(0.0, np.inf, 0.0)[len(numbers) - 2 :]]
        places[disc] = WeightPlaces.evenly(
            int(count),
            radius=radius * MILLIMETRE,
            first_deg=math.degrees(turned(first)),
            largest=largest * GRAM,
            step=step * GRAM,
        )
    return places


def _scale_of(files: list[Path]) -> "DiscScale":
    """Return the scale of angles that all sidecars state. Raises UnreadableFile where they differ."""
    from estimator.machine.disc_scale import DiscScale
    from formats.files.document_files import UnreadableFile
    from formats.recordings.recording import read_circumstances

    told = {file: read_circumstances(file) for file in files}
    scales = {file: one.scale for file, one in told.items() if one.added or one.scale != DiscScale()}
    first = next(iter(scales), None)
    other = next((file for file, scale in scales.items() if scale != scales[first or file]), None)
    if first is not None and other is not None:
        raise UnreadableFile(f"{first} and {other} state different scales of the discs (`disc_scale`): one machine has one")
    return DiscScale() if first is None else scales[first]


def _numbers(text: str, example: str, fewest: int, most: int, *, signed: bool = False) -> tuple[str, list[float]]:
    disc, _, rest = text.partition("=")
    try:
        numbers = [float(one) for one in rest.split(",")]
    except ValueError:
        numbers = []
    if not disc or not fewest <= len(numbers) <= most or (min(numbers) < 0.0 and not signed):
        raise ValueError(f"'{text}' is not written as {example}")
    return disc, numbers


def _model(machine: Path, files: list[Path]) -> "ModelInfluence":
    """Return the influence coefficients of the model that the same runs identify, with a word where the fit is refused."""
    from estimator.balancing.model_influence import measured_model_influence
    from estimator.fit.omitted_errors.open_errors import beside_its_errors
    from estimator.updated_model.model import updated_model
    from formats.recordings.recording import read_circumstances
    from service.commands.analysis import identified

    described, _, result = identified(machine, files, None)
    mountings = {(file, one) for file in files for one in read_circumstances(file).mounting}
    if len(mountings) > len(files):
        print_line(
            f"the model is identified from {len(mountings)} mountings as if all had one unbalance: the less they differ "
            "the better it is; `rundown calibrate` tells them apart",
            err=True,
        )
    if not result.accepted:
        print_line(f"the model is only used where it predicts runs left out better: {result.verdict}", err=True)
    coordinates, point, _ = beside_its_errors(
        result.coordinates, result.point, result.covariance, result.channel_effects, channels=described.channels
    )
    return measured_model_influence(updated_model(described, result), described, coordinates, point)
