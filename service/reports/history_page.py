"""The history at the end of a report: alerts of the period, who did and wrote what, notes and maintenance."""

from collections.abc import Iterator

from service.advice.advice import plain_message
from service.alerts.event_message import AlertEvent
from service.reports.contents import ReportContents, ReportedAlert
from service.reports.page_parts import muted, section, shown_time, table
from service.wording.language import Language


def history_page(contents: ReportContents) -> str:
    """Return the page."""
    return section(contents.language.translate("report.history"), "".join(_parts(contents, contents.language)))


def _parts(contents: ReportContents, language: Language) -> Iterator[str]:
    translate = language.translate
    if contents.alerts:
        heads = [translate(f"report.{one}") for one in ("alert", "severity", "state", "opened", "closed")]
        yield table(heads, (_alert(one, language) for one in contents.alerts))
    else:
        yield muted(translate("report.no_alert"))
    if contents.events:
        heads = [translate(f"report.{one}") for one in ("when", "alert_column", "what_happened", "by_whom", "comment")]
        yield table(heads, (_event(one, language) for one in contents.events))
    if contents.notes:
        heads = [translate(f"report.{one}") for one in ("when", "kind", "by_whom", "note")]
        rows = ((shown_time(one.at), language.named(one.kind), one.by, one.text) for one in contents.notes)
        yield table(heads, rows)
    else:
        yield muted(translate("report.no_notes"))
    if contents.left_out:
        yield muted(translate("report.left_out", what=", ".join(contents.left_out)))


def _alert(one: ReportedAlert, language: Language) -> tuple[str, ...]:
    severity, state = language.named(one.last.severity), language.named(one.last.state)
    return one.last.message, severity, state, shown_time(one.last.opened_at), shown_time(one.closed_at)


def _event(one: AlertEvent, language: Language) -> tuple[str, ...]:
    kind, severity, state = (language.named(each) for each in (one.kind, one.severity, one.state))
    return (
        shown_time(one.at),
        plain_message(one.rule, one.element, language),
        f"{kind}: {severity}, {state}",
        one.by,
        one.comment,
    )
