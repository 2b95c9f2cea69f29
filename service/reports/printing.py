"""Prints a report as PDF with WeasyPrint, in a worker process: it needs no browser, and loads nothing from anywhere."""

from typing import Any

from estimator.errors import Unavailable
from service.reports.contents import ReportContents
from service.reports.first_page import first_page
from service.reports.history_page import history_page
from service.reports.page_parts import escaped, style
from service.reports.result_pages import result_pages
from service.workers.time_limit import limit_time


class PrinterMissing(Unavailable):
    """The packages, or system libraries, that print are not installed."""


def report_html(contents: ReportContents) -> str:
    """Return a report as HTML that needs nothing beside it."""
    language = contents.language
    title = escaped(language.translate("report.title", machine=contents.machine.name or contents.machine.id))
    results = result_pages(contents)
    behind = f'<div class="next">{results}</div>' if results else ""
    pages = first_page(contents) + behind + history_page(contents)
    head = f'<meta charset="utf-8"/><title>{title}</title><style>{style(language)}</style>'
    return f'<!doctype html><html lang="{language.code}"><head>{head}</head><body>{pages}</body></html>\n'


def report_pdf(contents: ReportContents) -> bytes:
    """Return a report as PDF. Raises PrinterMissing."""
    return printed_html(report_html(contents))


def printed_html(page: str) -> bytes:
    """Return HTML as PDF; nothing that lies outside of it is loaded. Raises PrinterMissing."""
    weasyprint = _printer()
    nothing = weasyprint.urls.URLFetcher(allowed_protocols=())
    printed: bytes = weasyprint.HTML(string=page, url_fetcher=nothing).write_pdf()
    return printed


def print_in_time(seconds: float, contents: ReportContents) -> bytes:
    """Return a report as PDF within a time [s]. Raises OutOfTime, PrinterMissing."""
    with limit_time(seconds):
        return report_pdf(contents)


def _printer() -> Any:
    try:
        import weasyprint
    except (ImportError, OSError) as error:  # OSError: without Pango
        why = "reports as PDF need WeasyPrint and Pango where this service runs: pip install 'rotorundown[report]'"
        raise PrinterMissing(f"{why} and the system package libpangoft2-1.0-0 ({error})") from None
    return weasyprint
