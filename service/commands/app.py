"""The command `rundown` with its subcommands.

Each imports what it needs by itself: web server, database and estimator take a second or two, which others should not spend.
"""

import gc
import json
import logging
import os
import re
import signal
import threading
import time
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, get_args

import typer

from estimator.close_matches import did_you_mean
from estimator.simulation.scenarios import Scenario
from rotorundown.environment.example_machines import found_example
from rotorundown.environment.release import VERSION
from service.commands.analysis import compare, identify_offline, model, show_slow_roll
from service.commands.balancing import balance_machine, trial_weights
from service.commands.calibration import calibrate
from service.commands.exit import fail, words_of
from service.commands.file_arguments import MachineFile, named_file
from service.commands.first_steps import check, init
from service.commands.help_panels import PanelledGroup
from service.commands.json_output import JsonOption, print_json
from service.commands.keys import audit_app, key_app
from service.commands.report import report
from service.commands.retention import retention_app
from service.commands.storage import backup, export, move, restore
from service.commands.terminal import print_line, print_text, working
from service.configuration.log_format import log_to_terminal
from service.configuration.settings import DEFAULT_ZENOH_ENDPOINT, ProcessRole, Settings, SettingsWrong, settings_of
from service.configuration.settings_file import VARIABLE as CONFIG_VARIABLE

if TYPE_CHECKING:
    from estimator.machine.document import Machine

# Markdown leaves units in brackets alone; the other markup takes them for styles and prints nothing.
app = typer.Typer(no_args_is_help=True, cls=PanelledGroup, rich_markup_mode="markdown")
app.add_typer(key_app, name="key")
app.add_typer(audit_app, name="audit")
app.add_typer(retention_app, name="retention")

Connect = Annotated[list[str], typer.Option(help="zenoh endpoint of the service or of a router; may be given again")]
for command in (backup, restore, move, export, report):
    app.command()(command)

LINGER_S = 5.0


def _print_version(asked: bool) -> None:
    if asked:
        print_line(f"rundown {VERSION}")
        raise typer.Exit


@app.callback()
def main(
    asked: Annotated[
        bool, typer.Option("--version", is_eager=True, callback=_print_version, help="which release this is")
    ] = False,
) -> None:
    """Monitor the condition of coupled rotor trains."""


@app.command()
def serve(
    database: Annotated[str | None, typer.Option(help="SQLAlchemy URL")] = None,
    host: Annotated[str | None, typer.Option(help="address of the REST API")] = None,
    port: Annotated[int | None, typer.Option(help="port of the REST API; 0 takes a free one")] = None,
    zenoh_listen: Annotated[list[str] | None, typer.Option(help="endpoint on which to be a zenoh router")] = None,
    zenoh_connect: Annotated[list[str] | None, typer.Option(help="zenoh router to connect to")] = None,
    workers: Annotated[int | None, typer.Option(help="identification processes")] = None,
    role: Annotated[
        ProcessRole | None, typer.Option(help="what this process does, beside others on one PostgreSQL database")
    ] = None,
    allow_no_authentication: Annotated[
        bool | None, typer.Option("--allow-no-authentication", help="the first of two settings; see docs/security.md")
    ] = None,
    config: Annotated[
        Path | None, typer.Option(envvar=CONFIG_VARIABLE, help="TOML file of settings, each by its name")
    ] = None,
) -> None:
    """Run the service. Every setting can also come from the environment as RUNDOWN_NAME, or from a TOML file.

    Options go before the environment, which goes before the file; see docs/operators.md.
    """
    if config is not None:
        os.environ[CONFIG_VARIABLE] = str(config)  # for all that asks for settings later, in its processes too
    given: dict[str, Any] = {
        "database": database,
        "host": host,
        "port": port,
        "zenoh_listen": zenoh_listen,
        "zenoh_connect": zenoh_connect,
        "workers": workers,
        "role": role,
        "allow_no_authentication": allow_no_authentication,
    }
    if zenoh_connect and not zenoh_listen:
        given["zenoh_listen"] = []
    settings = _settings({name: value for name, value in given.items() if value is not None})
    from service.resilience.heap_trim import share_one_heap

    share_one_heap()  # while there is little in it
    # Only now: wrong settings are told at once. Of what is loaded nothing is garbage, as in `service.__main__`.
    gc.disable()
    from service.commands.serve import serve as run_service
    from service.http.listening_socket import PortUnusable
    from service.messaging.access_control import AccessUnusable
    from service.messaging.session import StreamUnusable
    from service.security.exposure import Exposed
    from service.wording.finding_texts import TextsWrong
    from storage.database.claim import DatabaseUnusable

    gc.freeze()
    gc.enable()

    log_to_terminal(settings.log_level, settings.log_format)
    try:
        run_service(settings)
    except (DatabaseUnusable, PortUnusable, StreamUnusable, AccessUnusable, Exposed, TextsWrong) as error:
        fail(str(error))


@app.command()
def doctor(
    url: Annotated[str | None, typer.Option(help="where the API answers; by default as the settings say")] = None,
    api_key_file: Annotated[Path | None, typer.Option(help="file with an API key, if one is needed")] = None,
    exposed: Annotated[
        bool, typer.Option("--exposed", help="list instead what somebody on the network could reach, and why")
    ] = False,
    as_json: JsonOption = False,
) -> None:
    """Check a deployment, with the settings of its service: database, room, certificates, API, zenoh, ingest.

    Prints a line for each check, and ends with status 1 when one fails. It changes nothing.
    """
    from service.commands.exposed import report
    from service.doctor.checks import examine
    from service.secrets.files import read_secret

    settings = _settings({})
    if exposed:
        report(settings, url=url, as_json=as_json)
        return
    key = None if api_key_file is None else read_secret(str(api_key_file))
    found = []
    for finding in examine(settings, url=url, api_key=key):
        found.append(finding)
        if not as_json:
            print_line(f"{finding.level:8s} {finding.what}: {finding.words}")
    if as_json:
        print_json([{"level": one.level, "what": one.what, "words": one.words} for one in found])
    wrong = sum(one.level == "wrong" for one in found)
    if wrong:
        fail(f"{wrong} wrong; docs/runbook.md says what to do")


@app.command()
def worker(
    scheduler: Annotated[str, typer.Argument(help="address of the Dask scheduler, such as tcp://10.0.0.5:8786")],
    processes: Annotated[int, typer.Option(min=1, max=64, help="identifications at once")] = 2,
    memory_mb: Annotated[int, typer.Option(min=256, help="memory that each process may hold of its own [MiB]")] = 2048,
) -> None:
    """Compute identifications for services that use a Dask cluster (`RUNDOWN_DASK_SCHEDULER`)."""
    if not re.fullmatch(r"\w+://[^/\s]+:\d+", scheduler):
        fail(f"'{scheduler}' is no scheduler's address: write protocol, host and port, such as tcp://10.0.0.5:8786")
    from service.identification.worker_tasks import TASKS
    from service.workers.dask_worker import work

    _log_as_set()
    work(scheduler, processes=processes, memory_bytes=memory_mb * 2**20, tasks=TASKS, stop=_stop_on_signal())


@app.command()
def router(
    listen: Annotated[list[str], typer.Option(help="endpoint to listen on; may be given again")] = [  # noqa: B006
        DEFAULT_ZENOH_ENDPOINT
    ],
    connect: Annotated[list[str], typer.Option(help="another router to connect to; may be given again")] = [],  # noqa: B006
) -> None:
    """Run a zenoh router between sources and the service, in a process of its own: it stores nothing, and may be killed.

    Beyond loopback it needs certificates and access rules, as `serve` does (RUNDOWN_ZENOH_…; docs/security.md).
    """
    from service.messaging.access_control import AccessUnusable, from_environment
    from service.messaging.session import StreamUnusable
    from service.messaging.session import session as zenoh_session
    from service.security.exposure import Exposed, require_guarded

    settings = _log_as_set()
    try:
        for door in require_guarded(settings, listen):
            logging.getLogger(__name__).warning("open to everybody: %s", door)
    except Exposed as error:
        fail(str(error))
    stop = _stop_on_signal()
    try:
        with zenoh_session(listen=listen, connect=connect, security=from_environment()):
            logging.getLogger(__name__).info("routing on %s", ", ".join(listen))
            stop.wait()
    except (StreamUnusable, AccessUnusable) as error:
        fail(str(error))


@app.command()
def simulate(
    machines: Annotated[list[str], typer.Argument(help="FILE or FILE:SCENARIO; " + ", ".join(get_args(Scenario)))],
    connect: Connect = [DEFAULT_ZENOH_ENDPOINT],  # noqa: B006 - typer copies it
    cycles: Annotated[int, typer.Option(min=1, help="run-ups and run-downs of each machine")] = 12,
    interval_days: Annotated[float, typer.Option(min=0.01, help="between them, in the machines' time")] = 7.0,
    samples: Annotated[int, typer.Option(min=10, help="in each run-up and run-down")] = 200,
    rate: Annotated[float | None, typer.Option(min=0.1, help="samples/s per machine; real time without it")] = None,
    seed: Annotated[int, typer.Option(min=0)] = 1,
    truth: Annotated[Path | None, typer.Option(help="file for the true parameters of each run")] = None,
) -> None:
    """Simulate machines in a process of their own, publishing over zenoh as real sources do."""
    from formats.files.document_files import UnreadableFile
    from service.messaging.access_control import from_environment
    from service.messaging.session import StreamUnusable, wait_connected
    from service.messaging.session import session as zenoh_session
    from service.sources.simulator import SimulationPlan
    from service.sources.simulator import simulate as run_simulation

    log_to_terminal("INFO")
    plan = SimulationPlan(cycles, interval_days * 86_400.0, samples, rate, seed, LINGER_S)
    stop = _stop_on_signal()
    try:
        parsed = [_machine_and_scenario(text) for text in machines]
        with zenoh_session(listen=[], connect=connect, security=from_environment()) as session:
            if wait_connected(session, connect, give_up=stop.wait):
                run_simulation(session, parsed, plan, truth, stop)
    except (UnreadableFile, StreamUnusable, ValueError, OSError) as error:
        fail(words_of(error))


@app.command()
def replay(
    file: Annotated[
        Path,
        typer.Argument(
            help="CSV, UFF58, TDMS, MDF4 or MAT file; FILE.yaml beside it says what its columns mean", callback=named_file
        ),
    ],
    sidecar: Annotated[Path | None, typer.Option(help="another sidecar")] = None,
    connect: Connect = [DEFAULT_ZENOH_ENDPOINT],  # noqa: B006 - typer copies it
    speedup: Annotated[float, typer.Option(min=0.001, help="how much faster than it was recorded")] = 1.0,
) -> None:
    """Publish a recorded run over zenoh, in real or compressed time; dwells without waiting between them."""
    from formats.files.document_files import UnreadableFile
    from formats.recordings.recording import read_recording, split, states_start
    from formats.recordings.replayed_dwells import dwells_text, replayed_dwells
    from formats.recordings.sidecar import UNSTATED_START
    from formats.wire import Key
    from service.messaging.access_control import AccessUnusable, from_environment
    from service.messaging.session import StreamUnusable, wait_connected
    from service.messaging.session import session as zenoh_session
    from service.sources.publisher import Source
    from service.sources.simulator import BATCH_SAMPLES

    log_to_terminal("INFO")
    stop = _stop_on_signal()
    try:
        batch, dwells = replayed_dwells(read_recording(file, sidecar), file, sidecar)
        if not states_start(file, sidecar):
            print_line(
                f"{file}: its sidecar does not say when it was taken, so it is put at {UNSTATED_START:%Y-%m-%d}; every other "
                "such recording falls on the same time, and a service takes two for one. Say it, as in `start: "
                "2026-11-21T12:00:00Z`",
                err=True,
            )
        with zenoh_session(listen=[], connect=connect, security=from_environment()) as session:
            if not wait_connected(session, connect, give_up=stop.wait):
                return
            with Source(session, Key(batch.plant, batch.machine), name=batch.source) as source:
                began, first = time.monotonic(), batch.time_ns[0]
                with working(f"publishing {file.name}") as report:
                    for piece in split(batch, BATCH_SAMPLES):
                        due = began + (0.0 if dwells else (piece.time_ns[-1] - first) / 1e9 / speedup)
                        if stop.wait(max(0.0, due - time.monotonic())):
                            return
                        source.publish(piece)
                        report(source.sequence, len(batch.time_ns))
                logging.getLogger(__name__).info("%d samples published", source.sequence)
                if dwells:
                    print_text(dwells_text(batch.machine, dwells))
                stop.wait(LINGER_S)  # to answer replay queries
    except (UnreadableFile, StreamUnusable, AccessUnusable) as error:
        fail(str(error))


@app.command()
def edge(
    configuration: Annotated[Path, typer.Argument(help="what is measured, YAML or JSON; see docs/edge.md")],
    leave: Annotated[bool, typer.Option("--exit", help="exit after the last file instead of answering replays")] = False,
    speedup: Annotated[float | None, typer.Option(min=0.001, help="pace of files over real time; as fast as it goes")] = None,
) -> None:
    """Run the edge agent: raw probe waveforms with a keyphasor in, samples of phasors out, through a durable log."""
    from formats.files.document_files import UnreadableFile
    from service.commands.edge import run_edge
    from service.messaging.access_control import AccessUnusable
    from service.messaging.session import StreamUnusable
    from service.sources.replay_log import LogError

    _log_as_set()
    try:
        run_edge(configuration, _stop_on_signal(), leave=leave, speedup=speedup)
    except (UnreadableFile, StreamUnusable, AccessUnusable, LogError) as error:
        fail(str(error))


@app.command()
def document(machine: MachineFile) -> None:
    """Check a machine document and print it as JSON, as the REST API takes it."""
    from formats.files.document_files import UnreadableFile, read_machine
    from service.commands.document_warnings import print_warnings

    try:
        described = read_machine(machine)
        print_warnings(described)
        print_text(json.dumps(described.model_dump(mode="json"), indent=1))
    except UnreadableFile as error:
        fail(str(error))


@app.command()
def sample(
    machine: Annotated[str, typer.Argument(help="FILE or FILE:SCENARIO; " + ", ".join(get_args(Scenario)))],
    file: Annotated[Path, typer.Argument(help="CSV to write; its sidecar stands beside it")],
    progress: Annotated[float, typer.Option(min=0, max=1, help="how far the scenario has gone")] = 1.0,
    samples: Annotated[int, typer.Option(min=10)] = 200,
    seed: Annotated[int, typer.Option(min=0, help="of the machine: the same one in every run")] = 1,
    run_seed: Annotated[int, typer.Option(min=0, help="of the run: its scatter and noise")] = 1,
    weight: Annotated[
        list[str] | None,
        typer.Option(help="trial weight that is on: DISC=AMOUNT,ANGLE in g mm and °, such as core=2000,90"),
    ] = None,
    start: Annotated[
        datetime | None,
        typer.Option(
            formats=["%Y-%m-%dT%H:%M:%S", "%Y-%m-%d"],
            help="time of the first sample, in UTC; by default a day after the machine's newest recording beside FILE",
        ),
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Write one simulated run-down as a recording, to try the commands on."""
    from formats.files.document_files import UnreadableFile
    from formats.recordings.next_start import next_start
    from formats.recordings.written_recording import write_recording
    from formats.wire import as_sent
    from rotorundown.simulation import simulate as simulate_run

    if file.exists():
        fail(f"{file} is there already: name another file, or delete it first")
    try:
        described, scenario = _machine_and_scenario(machine)
        on = trial_weights(weight or [])
        with working("simulating"):
            run = simulate_run(
                described, scenario=scenario, progress=progress, samples=samples, seed=seed, run_seed=run_seed, weights=on
            )
        gaps = run.measurement.gaps
        write_recording(
            file,
            described,
            speed_rpm=run.speed_rpm,
            phasor=run.recorded.phasor,
            interval_s=run.interval_s,
            gap_um=None if gaps is None else as_sent(gaps.place, described),
            weights=on,
            start=next_start(file.parent, described.id) if start is None else start,
        )
    except (UnreadableFile, ValueError, OSError) as error:
        fail(words_of(error))
    if as_json:
        said = {disc: {"amount_g_mm": amount, "angle_deg": angle} for disc, (amount, angle) in on.items()}
        told = {"machine": described.id, "scenario": scenario, "file": file, "samples": len(run)}
        print_json(told | {"weights": said, "truth": run.truth})
    else:
        print_line(f"{file} is written with {len(run)} samples of '{described.id}', {scenario}, and its sidecar beside it")


app.command()(init)
app.command()(check)
app.command("identify")(identify_offline)
app.command()(model)
app.command()(compare)
app.command()(calibrate)
app.command("slow-roll")(show_slow_roll)
app.command("balance")(balance_machine)


@app.command()
def demo(
    leave: Annotated[bool, typer.Option("--exit", help="stop after the summary; status 0 only if it came out right")] = False,
    port: Annotated[int, typer.Option(help="port of the REST API; 0 takes a free one")] = 0,
    as_json: JsonOption = False,
) -> None:
    """Demonstrate the service from end to end: three simulated machines, one of them going out of alignment."""
    from service.commands import demo as demonstration

    try:
        right = demonstration.run(leave=leave, port=port, as_json=as_json)
    except demonstration.DemoFailed as error:
        fail(str(error))
    if leave and not right:
        raise typer.Exit(1)


def _machine_and_scenario(text: str) -> "tuple[Machine, Scenario]":
    from formats.files.document_files import UnreadableFile, read_machine

    name, colon, scenario = text.rpartition(":")
    if scenario in get_args(Scenario):
        return read_machine(named_file(Path(name))), scenario  # type: ignore[return-value]
    if colon and found_example(Path(name)).is_file():
        known = get_args(Scenario)
        raise UnreadableFile(f"'{scenario}' is no scenario; there are {', '.join(known)}{did_you_mean(scenario, known)}")
    return read_machine(named_file(Path(text))), "healthy"


def _stop_on_signal() -> threading.Event:
    stop = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: stop.set())
    return stop


def _log_as_set() -> Settings:
    """Configure logging by the settings, and return them."""
    settings = _settings({})
    log_to_terminal(settings.log_level, settings.log_format)
    return settings


def _settings(given: dict[str, Any]) -> Settings:
    """Return the settings from the command line and the environment; end the command where they are wrong."""
    try:
        return settings_of(**given)
    except SettingsWrong as error:
        fail(str(error))
