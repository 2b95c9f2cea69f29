"""The history at the end of a report: alerts of the period, who did and wrote what, notes and maintenance."""

from collections.abc import Iterator

from service.alerts.event_message import AlertEvent
from service.reports.contents import ReportContents, ReportedAlert
from service.reports.page_parts import muted, section, shown_time, table


def history_page(contents: ReportContents) -> str:
    """Return the page."""
    return section("History", "".join(_parts(contents)))


def _parts(contents: ReportContents) -> Iterator[str]:
    if contents.alerts:
        yield table(("Alert", "severity", "state", "opened", "closed"), map(_alert, contents.alerts))
    else:
        yield muted("No alert was open in this period.")
    if contents.events:
        yield table(("When (UTC)", "alert", "what happened", "by", "comment"), map(_event, contents.events))
    if contents.notes:
        yield table(
            ("When (UTC)", "kind", "by", "note or maintenance"),
            ((shown_time(one.at), one.kind, one.by, one.text) for one in contents.notes),
        )
    else:
        yield muted("No notes or maintenance in this period.")
    if contents.left_out:
        yield muted(f"Not shown: {', '.join(contents.left_out)}.")


def _alert(one: ReportedAlert) -> tuple[str, ...]:
    state = one.last.state.replace("_", " ")
    return one.last.message, one.last.severity, state, shown_time(one.last.opened_at), shown_time(one.closed_at)


def _event(one: AlertEvent) -> tuple[str, ...]:
    became = f"{one.kind.replace('_', ' ')}: {one.severity}, {one.state.replace('_', ' ')}"
    return shown_time(one.at), f"{one.rule.replace('_', ' ')} {one.element}", became, one.by, one.comment
