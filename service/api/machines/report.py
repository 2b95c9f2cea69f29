"""Serves the report of a machine as PDF, printed in a worker process and kept while nothing changes that it tells."""

from dataclasses import replace
from typing import Annotated, Any, cast

from fastapi import APIRouter, Query, Request, Response

from service.api.cache.computed_cache import ComputedCache
from service.api.cache.worker_computation import caller_of, has_gone
from service.api.conventions.dependencies import MachineId, Period, database
from service.api.conventions.problems import RESPONSES
from service.api.conventions.reader_language import reader_language
from service.http.problem import Problem
from service.reports.period import asked_period
from service.reports.reading import read_contents
from service.reports.report_process import ReportProcess
from service.reports.state_stamp import report_stamp
from service.security.requirement import VIEWER
from service.wording.language import Language, Locale
from service.wording.shown_units import ShownUnits, UnitsName, units_of
from storage.clock import now, to_datetime
from storage.machines import machines

router = APIRouter(prefix="/machines", tags=["machines"], responses=RESPONSES, dependencies=[VIEWER])

PDF = "application/pdf"
ReportLocale = Annotated[Locale | None, Query(description="language of the report: en, de")]
ReportUnits = Annotated[
    UnitsName | None,
    Query(
        description="units of plots, tables and sentences, as the page's switch names them: µm or mil, peak-to-peak (pp) or "
        "0-to-peak (p), r/min or Hz; by default mil where Accept-Language asks for the units of the US, else the site's"
    ),
]
DAY_NS = 86_400 * 10**9
"""A report without an end is of the day on which it is asked for [ns]."""
ANSWERS: dict[int | str, dict[str, Any]] = {
    200: {"content": {PDF: {"schema": {"type": "string", "format": "binary"}}}, "description": "the report"},
    503: {
        "model": Problem,
        "content": {"application/problem+json": {}},
        "description": "too many reports wait, this one cannot be printed, or the extra `report` is not installed",
        "headers": {"Retry-After": {"description": "when to ask again [s]", "schema": {"type": "integer"}}},
    },
}


@router.get("/{machine_id}/report.pdf", operation_id="read_report", response_class=Response, responses=ANSWERS)
def read_report(
    request: Request, machine_id: MachineId, period: Period, locale: ReportLocale = None, units: ReportUnits = None
) -> Response:
    """Read a report as PDF: findings and what to do, trends, plots, alignment, balance, history.

    Without `to` it ends now, without `from` it begins a year before its end. Without `locale` it is in the
    language that Accept-Language asks for, else the site's.
    """
    moment = now()
    reader = reader_language(request)
    shown = _asked_units(request, units, reader)
    language = Language(reader.code if locale is None else locale, shown.length)
    asked = asked_period(period.first, period.last, moment=moment)
    with database(request).reading() as session:
        machines.get(session, machine_id)
        stamp = report_stamp(session, machine_id)
    cache: ComputedCache = request.app.state.report_cache
    process: ReportProcess = request.app.state.report_process

    def work() -> bytes:
        with database(request).reading() as reading:
            contents = read_contents(
                reading,
                machine_id,
                asked,
                texts=request.app.state.texts.in_language(language),
                baseline_runs=cast(int, request.app.state.baseline_runs),
                units=shown,
            )
        return process.printed(contents)

    day = moment // DAY_NS if period.last is None else None
    key = (machine_id, period, day, stamp, language, shown)
    pdf = cache.compute_queued(key, work, long=True, caller=caller_of(request), wanted=lambda: not has_gone(request))
    name = f"{machine_id}-{to_datetime(asked.last):%Y-%m-%d}.pdf"
    return Response(
        pdf,
        media_type=PDF,
        headers={
            "Content-Disposition": f'inline; filename="{name}"',
            "Content-Language": language.code,
            "Vary": "Accept-Language",
        },
    )


def _asked_units(request: Request, name: UnitsName | None, reader: Language) -> ShownUnits:
    """Return the requested units; without any, mils where the language asks for them, or the site's."""
    if name is not None:
        return units_of(name)
    site = units_of(request.app.state.report_units)
    return replace(site, length="mil") if reader.length_unit == "mil" else site
