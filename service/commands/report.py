"""The command `rundown report`: a machine's report as PDF, from the database, while the service runs or not."""

from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated

import typer

from service.commands.exit import fail, fail_for_unknown_machine, words_of
from service.commands.find_language import find_language
from service.commands.json_output import JsonOption, print_json
from service.commands.storage import DatabaseUrl, database_url
from service.commands.terminal import print_line, working


def report(
    machine: Annotated[str, typer.Argument(help="id of the machine")],
    output: Annotated[Path, typer.Option(help="PDF file to write")] = Path("report.pdf"),
    begin: Annotated[datetime | None, typer.Option("--from", help="UTC; by default a year before the end")] = None,
    end: Annotated[datetime | None, typer.Option("--to", help="UTC; by default now")] = None,
    locale: Annotated[str | None, typer.Option(help="language, en or de; by default the setting RUNDOWN_LOCALE")] = None,
    units: Annotated[
        str | None,
        typer.Option(help="um_pp, um_p, mil_pp or mil_p, then ,rpm or ,hz; by default the setting RUNDOWN_REPORT_UNITS"),
    ] = None,
    database: DatabaseUrl = None,
    as_json: JsonOption = False,
) -> None:
    """Write a machine's report as PDF: findings and what to do, trends, plots, alignment, balance, history."""
    from service.advice.site_texts import read_texts
    from service.configuration.settings import SettingsWrong, settings_of
    from service.reports.period import PeriodEmpty, asked_period
    from service.reports.printing import PrinterMissing, report_pdf
    from service.reports.reading import read_contents
    from service.wording.finding_texts import TextsWrong
    from service.wording.shown_units import UnitsUnknown, units_of
    from storage.clock import from_datetime, now
    from storage.database.claim import DatabaseUnusable
    from storage.database.engine import Database, require_file
    from storage.machines.machines import MachineUnknown

    first, last = (None if one is None else from_datetime(one.replace(tzinfo=UTC)) for one in (begin, end))
    try:
        url = database_url(database)
        settings = settings_of()
        texts, period = (
            read_texts(settings.finding_texts, settings.locale if locale is None else find_language(locale).code),
            asked_period(first, last, moment=now()),
        )
        shown = units_of(settings.report_units if units is None else units)
        require_file(url)
        opened = Database(url)
    except (DatabaseUnusable, PeriodEmpty, SettingsWrong, TextsWrong, UnitsUnknown) as error:
        fail(str(error))
    try:
        with working("printing the report"):
            with opened.reading() as session:
                contents = read_contents(
                    session, machine, period, texts=texts, baseline_runs=settings.baseline_runs, units=shown
                )
            output.write_bytes(report_pdf(contents))
    except MachineUnknown:
        fail_for_unknown_machine(opened, machine)
    except (PrinterMissing, OSError) as error:
        fail(words_of(error))
    finally:
        opened.close()
    size = output.stat().st_size
    if as_json:
        print_json({"machine": machine, "file": output, "bytes": size, "open_alerts": len(contents.open_alerts)})
        return
    print_line(f"{output}: {len(contents.open_alerts)} open alerts, {size / 1e3:.0f} kB")
