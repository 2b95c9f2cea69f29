"""Commands that identify machines from recorded runs, without a service.

Each imports what it computes with by itself: that takes a second, which other commands should not spend.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from estimator.errors import Invalid
from estimator.thesis.parameter_rules import RegularisationRule
from service.commands.exit import fail
from service.commands.file_arguments import MachineFile, RunFiles, named_file, named_files, require_another
from service.commands.json_output import JsonOption, print_json
from service.commands.terminal import print_line, print_text, working

if TYPE_CHECKING:
    from estimator.fit.identification import Identification
    from estimator.identification.experiment_design import Benefit
    from estimator.identification.quality_gate import GatedIdentification
    from estimator.machine.document import Machine
    from estimator.phasors.measurement import Measurement
    from estimator.phasors.quality import Quality
    from estimator.phasors.recorded_run import RecordedRun

AnalysisMethod = Literal["likelihood", "regression"]
OtherSidecar = Annotated[Path | None, typer.Option(help="another sidecar, for a single run")]


def identify_offline(
    machine: MachineFile,
    files: RunFiles,
    sidecar: OtherSidecar = None,
    method: Annotated[
        AnalysisMethod, typer.Option(help="maximum likelihood, or the thesis's regression of Chapter 4")
    ] = "likelihood",
    tikhonov: Annotated[
        RegularisationRule | None, typer.Option(help="regularise the regression, its parameter chosen by this rule")
    ] = None,
    advice: Annotated[bool, typer.Option(help="say which further speeds and probes would help most")] = False,
    gate: Annotated[bool, typer.Option("--gate/--no-gate", help="leave out points of bad quality")] = True,
    half_power: Annotated[
        bool | None, typer.Option(help="leave out what lies within half-power points, as in thesis §2.3")
    ] = None,
    accepted_rpm: Annotated[tuple[float, float] | None, typer.Option(help="the only speeds that count [r/min]")] = None,
    slow_roll: Annotated[
        str | None, typer.Option(help="subtract the run's own slow-roll vectors of this band, such as 200:400 [r/min]")
    ] = None,
    every: Annotated[
        bool, typer.Option("--all", help="print every parameter, with the reason where the data do not determine it")
    ] = False,
    as_json: JsonOption = False,
) -> None:
    """Identify a machine from recorded runs, without a service, and print estimates ± standard errors, a line per element.

    Ends with status 1 when the fit is not accepted.
    """
    from service.commands.results.identification_report import advice_text, find_helpful, quality_text

    if method == "regression" and advice:
        fail("--advice goes with the likelihood: the regression has no information to read it from")
    if method == "likelihood" and tikhonov is not None:
        fail("--tikhonov goes with --method regression: the likelihood has its own prior")
    if method == "regression":
        _regress(machine, files, sidecar, tikhonov, slow_roll, as_json=as_json)
        return
    if slow_roll is None and _printed_by_mounting(machine, files, sidecar, gate=gate, as_json=as_json):
        return
    described, measurement, found = _gated(
        machine, files, sidecar, half_power=half_power, accepted_rpm=accepted_rpm, gate=gate, slow_roll=slow_roll
    )
    text = quality_text([file.name for file in files], found.qualities, gate=gate)
    if found.identification is None:
        fail("\n".join([found.error or "", text]).strip())
    result = found.identification
    helpful = None
    if advice:
        with working("looking for what would help"):
            helpful = find_helpful(described, result, measurement)
    if as_json:
        _print_json(described, result, files, sidecar, found.qualities, helpful)
    else:
        _print(described, result, measurement, files[0], sidecar, every=every)
        for told in (text and f"\n{text}", "" if helpful is None else advice_text(helpful)):
            if told:
                print_text(told)
    if not result.accepted:
        raise typer.Exit(1)


def _printed_by_mounting(machine: Path, files: list[Path], sidecar: Path | None, *, gate: bool, as_json: bool) -> bool:
    """Print what each mounting of a calibrated machine has gained, where the files hold several; return whether they do."""
    from formats.files.document_files import UnreadableFile, read_machine
    from formats.wire import Rejected
    from service.commands.mountings import mounted_runs, print_mountings

    try:
        described = read_machine(machine)
        mountings, left_out = mounted_runs(described, files, sidecar)
    except (UnreadableFile, Rejected, ValueError):
        return False  # told when they are read as one
    if mountings:
        _print_left_out(left_out)
        print_mountings(described, mountings, files[0], sidecar, gate=gate, as_json=as_json)
    return bool(mountings)


def _print(
    machine: "Machine",
    result: "Identification",
    measurement: "Measurement",
    file: Path,
    sidecar: Path | None,
    *,
    every: bool,
) -> None:
    """Print estimates, and what a calibrated machine has gained and how couplings are aligned."""
    from estimator.calibration.unbalance_since import unbalance_since
    from estimator.updated_model.derived_quantities import alignment_quantities
    from estimator.updated_model.model import updated_model
    from service.commands.mountings import stated_scale
    from service.commands.results.alignment_report import alignment_text
    from service.commands.results.identification_report import beyond_stated_weights, identification_text, since_text

    print_text(identification_text(machine, result, every=every))
    since = unbalance_since(machine, result)
    if since is not None:
        scale, direction = stated_scale(machine, file, sidecar)
        beyond = beyond_stated_weights(machine, measurement, scale, direction=direction)
        print_text(since_text(since, scale, direction=direction, beyond=beyond, accepted=result.accepted))
    alignment = alignment_text(alignment_quantities(updated_model(machine, result))) if result.accepted else ""
    if alignment:
        print_text(alignment)


def _print_json(
    machine: "Machine",
    result: "Identification",
    files: list[Path],
    sidecar: Path | None,
    qualities: "Sequence[Quality]",
    helpful: "list[Benefit] | None",
) -> None:
    from estimator.calibration.unbalance_since import unbalance_since
    from estimator.updated_model.derived_quantities import alignment_quantities
    from estimator.updated_model.model import updated_model
    from service.commands.mountings import stated_scale
    from service.commands.results.result_content import advice_content, identification_content, quality_content, since_content

    since = unbalance_since(machine, result)
    alignment = alignment_quantities(updated_model(machine, result)) if result.accepted else ()
    gained = {}
    if since is not None:
        scale, direction = stated_scale(machine, files[0], sidecar)
        gained = {"unbalance_since_calibration": since_content(since, scale, direction=direction)}
    rest = {"alignment": alignment, "runs": quality_content([file.name for file in files], qualities)}
    advice = {} if helpful is None else {"advice": advice_content(helpful)}
    print_json(identification_content(machine, result) | gained | rest | advice)


def model(
    machine: MachineFile,
    files: Annotated[
        list[Path] | None,
        typer.Argument(help="recorded runs, as for replay; without any, what the document alone gives", callback=named_files),
    ] = None,
    sidecar: OtherSidecar = None,
    service_rpm: Annotated[
        float | None, typer.Option(min=1e-3, help="speed at which it works; by default the range's end")
    ] = None,
    grade: Annotated[float, typer.Option(min=1e-3, help="balance quality grade G asked for [mm/s]")] = 2.5,
    as_json: JsonOption = False,
) -> None:
    """Identify a machine from recorded runs and print the results of the updated model.

    Critical speeds, amplification factors and separation margins, coupling loads, balance and corrections, impact test. Where
    the document gives the film of each bearing, the static state comes first: loads, specific pressures, eccentricities,
    positions, Sommerfeld numbers and the speed from which on the train would whirl. Without any run what the document alone
    gives is printed: critical speeds and natural frequencies are nominal then, or by its calibration. Ends with status 1 when
    the fit is not accepted. With --json and runs the static state is left out.
    """
    import threadpoolctl

    from estimator.updated_model.model import updated_model
    from rotorundown.machine_model import Model
    from service.commands.results.model_report import model_text
    from service.commands.results.result_content import model_content

    if not files:
        _print_nominal(machine, service_rpm, grade=grade, as_json=as_json)
        return
    if not as_json:
        _print_films(machine, service_rpm)
    described, _, result = identified(machine, files, sidecar)
    speed = _service_speed(described, service_rpm)
    print_line(result.verdict, err=as_json)
    if not result.accepted:
        raise typer.Exit(1)
    try:
        model = Model(updated_model(described, result))
        with threadpoolctl.threadpool_limits(1), working("computing the model's results"):
            if as_json:
                content = model_content(model, service_rpm=speed, grade=grade)
            else:
                text = model_text(model, service_rpm=speed, grade=grade)
    except ValueError as error:
        fail(str(error))
    if as_json:
        print_json(content)
    else:
        print_text(text)


def _service_speed(machine: "Machine", given: float | None) -> float:
    """Return the service speed [r/min], by default the end of the document's range; end the command for one outside it."""
    limits = machine.speed_range
    if given is not None and not limits.minimum_rpm <= given <= limits.maximum_rpm:
        fail(
            f"--service-rpm {given:g} lies outside the document's range, "
            f"{limits.minimum_rpm:g} to {limits.maximum_rpm:g} r/min"
        )
    return limits.maximum_rpm if given is None else given


def _print_films(machine: Path, service_rpm: float | None) -> None:
    """Print the static state on oil films of a document that describes them."""
    from formats.files.document_files import UnreadableFile, read_machine
    from service.commands.results.film_report import film_text, has_films

    try:
        described = read_machine(machine)
        if has_films(described):
            print_text(film_text(described, service_rpm=_service_speed(described, service_rpm)))
    except (UnreadableFile, Invalid) as error:
        fail(str(error))


def _print_nominal(machine: Path, service_rpm: float | None, *, grade: float, as_json: bool) -> None:
    """Print what a document alone gives: the static state on its oil films, critical speeds and natural frequencies."""
    import threadpoolctl

    from formats.files.document_files import UnreadableFile, read_machine
    from rotorundown.updated_models import model as model_of
    from service.commands.results.film_report import film_content, has_films
    from service.commands.results.nominal_report import nominal_content, nominal_text

    if not as_json:
        _print_films(machine, service_rpm)
    try:
        described = read_machine(machine)
        speed = _service_speed(described, service_rpm)
        films = film_content(described, service_rpm=speed) if as_json and has_films(described) else {}
        with threadpoolctl.threadpool_limits(1), working("computing the model's results"):
            model = model_of(described)
            if as_json:
                content = films | nominal_content(model, service_rpm=speed, grade=grade)
            else:
                text = nominal_text(model, service_rpm=speed, grade=grade)
    except (UnreadableFile, ValueError) as error:
        fail(str(error))
    if as_json:
        print_json(content)
    else:
        print_text(f"\n{text}" if has_films(described) else text)


def compare(
    machine: MachineFile,
    baseline: Annotated[Path, typer.Argument(help="a recorded run of the healthy machine", callback=named_file)],
    files: RunFiles,
    coupling: Annotated[
        str | None, typer.Option(help="id of the coupling that may be misaligned; by default the train's only one")
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Tell whether later runs show changed coefficients at a coupling, an equivalent load in it, or no change.

    Where the bearings are described by their oil films: by how much the coupling's alignment and their loads have changed.
    """
    import threadpoolctl

    from estimator.identification.model_comparison import compare_misalignment
    from estimator.machine.film_speeds import follows_films
    from estimator.phasors.measurement import joined
    from formats.files.document_files import UnreadableFile
    from formats.wire import Rejected
    from rotorundown.comparison import NotComparable, compared_coupling
    from rotorundown.summaries.comparison_summary import comparison_text
    from service.commands.results.result_content import comparison_content

    require_another(baseline, files)
    described, _, healthy = identified(machine, [baseline], None)
    if not healthy.accepted:
        fail(f"{baseline}: {healthy.verdict}")
    try:
        compared = compared_coupling(described, coupling)
    except NotComparable as error:
        fail(str(error))
    if follows_films(described):
        _compare_alignment(machine, healthy, files, compared, as_json=as_json)
        return
    try:
        measurement = joined([measured for _, measured in _recorded(described, files, None)])
        with threadpoolctl.threadpool_limits(1), working("comparing models"):
            found = compare_misalignment(described, measurement, baseline=healthy, coupling=compared)
    except (UnreadableFile, Rejected, ValueError) as error:
        fail(str(error))
    if as_json:
        print_json(comparison_content(found))
    else:
        print_text(comparison_text(found, healthy))


def _compare_alignment(machine: Path, healthy: "Identification", files: list[Path], coupling: str, *, as_json: bool) -> None:
    """Print by how much a coupling's alignment, and the loads on all films, have changed."""
    from estimator.diagnosis.compared_identifications import compared_identifications
    from service.commands.results.alignment_report import alignment_comparison_content

    described, _, later = identified(machine, files, None)
    if not later.accepted:
        fail(f"{', '.join(map(str, files))}: {later.verdict}")
    try:
        found = compared_identifications(described, healthy, later, coupling)
    except ValueError as error:
        fail(str(error))
    if as_json:
        print_json(alignment_comparison_content(found))
    else:
        print_text("\n".join([found.verdict, "", *found.lines()]))


def show_slow_roll(
    machine: MachineFile,
    file: Annotated[Path, typer.Argument(help="recorded run, as for replay", callback=named_file)],
    band: Annotated[str, typer.Argument(help="lowest and highest speed, such as 200:400 [r/min]")],
    sidecar: OtherSidecar = None,
    as_json: JsonOption = False,
) -> None:
    """Print the slow-roll vectors of a recorded run. Ends with status 1 when no channel shows one."""
    from estimator.phasors.measurement import joined
    from formats.files.document_files import UnreadableFile
    from formats.recordings.recorded_runs import captured_slow_roll
    from formats.wire import Rejected
    from service.commands.results.identification_report import slow_roll_text
    from service.commands.results.result_content import slow_roll_content

    try:
        described, runs = _runs(machine, [file], sidecar)
        found = captured_slow_roll(described, joined([measured for _, measured in runs]), band)
    except (UnreadableFile, Rejected, ValueError) as error:
        fail(str(error))
    if as_json:
        print_json(slow_roll_content(described, found))
    else:
        print_text(slow_roll_text(described, found))


def _regress(
    machine: Path,
    files: list[Path],
    sidecar: Path | None,
    tikhonov: RegularisationRule | None,
    slow_roll: str | None,
    *,
    as_json: bool,
) -> None:
    import threadpoolctl

    from estimator.phasors.measurement import joined
    from estimator.thesis.machine_regression import regress
    from formats.files.document_files import UnreadableFile
    from formats.wire import Rejected
    from service.commands.results.identification_report import EXPLAINED, regression_text
    from service.commands.results.result_content import regression_content

    try:
        described, runs = _runs(machine, files, sidecar, slow_roll)
        measurement = joined([measured for _, measured in runs])
        with threadpoolctl.threadpool_limits(1), working("solving the regression"):
            found = regress(described, measurement, tikhonov=tikhonov)
        accepted = not (found.reduced_chi_square > EXPLAINED or found.impossible)
        if as_json:
            print_json(regression_content(described, found, accepted=accepted))
        else:
            print_text(regression_text(found))
        if not accepted:
            raise typer.Exit(1)
    except (UnreadableFile, Rejected, ValueError) as error:
        fail(str(error))


def _print_left_out(lines: Sequence[str]) -> None:
    """Print what was left out of runs, and what is doubted of them, beside a command's results."""
    for line in lines:
        print_line(line, err=True)


def _runs(
    machine: Path, files: list[Path], sidecar: Path | None, slow_roll: str | None = None
) -> "tuple[Machine, list[tuple[RecordedRun, Measurement]]]":
    """Read a document and its recorded runs, without the slow roll of a band where one is given."""
    from formats.files.document_files import read_machine
    from formats.recordings.recorded_runs import without_slow_roll
    from service.commands.document_warnings import print_warnings
    from service.commands.results.identification_report import slow_roll_text

    described = read_machine(machine)
    print_warnings(described)
    runs = _recorded(described, files, sidecar)
    if slow_roll is None:
        return described, runs
    corrected, rest, found = without_slow_roll(described, runs, slow_roll)
    print_text(slow_roll_text(described, found), err=True)
    return corrected, rest


def _recorded(described: "Machine", files: Sequence[Path], sidecar: Path | None) -> "list[tuple[RecordedRun, Measurement]]":
    """Read recorded runs of a machine, and print what was left out of them.

    Tables without a sidecar are read as the library reads them, and it is said in which units.
    """
    from formats.recordings.recorded_runs import read_runs
    from formats.recordings.sidecar_place import is_plain_table
    from rotorundown.runs import read_run

    if sidecar is None and any(one.is_file() and is_plain_table(one) for one in files):
        read = [read_run(file, machine=described) for file in files]
        runs = [(one.recorded, one.measurement) for one in read]
        left_out = [f"{one.name}: read {one.units}" for one in read] + [line for one in read for line in one.left_out]
    else:
        runs, left_out = read_runs(described, files, sidecar)
    _print_left_out(left_out)
    return runs


def identified(machine: Path, files: list[Path], sidecar: Path | None) -> "tuple[Machine, Measurement, Identification]":
    """Return a document, its runs and their identification; end the command where there is none."""
    described, measurement, found = _gated(machine, files, sidecar)
    if found.identification is None:
        fail(found.error or "there is nothing to identify from")
    return described, measurement, found.identification


def _gated(
    machine: Path,
    files: list[Path],
    sidecar: Path | None,
    *,
    half_power: bool | None = None,
    accepted_rpm: tuple[float, float] | None = None,
    gate: bool = True,
    slow_roll: str | None = None,
) -> "tuple[Machine, Measurement, GatedIdentification]":
    from estimator.phasors.measurement import joined
    from formats.files.document_files import UnreadableFile
    from formats.wire import Rejected
    from rotorundown.identification import identify_behind_gate
    from rotorundown.runs import MachineRun

    try:
        described, runs = _runs(machine, files, sidecar, slow_roll)
        named = [MachineRun(file.name, described.channels, *run) for file, run in zip(files, runs, strict=True)]
        with working("identifying"):
            found = identify_behind_gate(described, named, gate=gate, half_power=half_power, accepted_rpm=accepted_rpm)
        return described, joined([run.measurement for run in named]), found
    except (UnreadableFile, Rejected, ValueError) as error:
        fail(str(error))
