"""The history at the end of a report: alerts of the period, who did and wrote what, notes and maintenance."""

from collections.abc import Iterator

from service.alerts.event_message import AlertEvent
from service.reports.contents import ReportContents
from service.reports.page_parts import muted, section, shown_time, table


def history_page(contents: ReportContents) -> str:
    """Return the page."""
    return section("History", "".join(_parts(contents)))


def _parts(contents: ReportContents) -> Iterator[str]:
    if contents.alerts:
        heads = ("Alert", "severity", "state", "opened", "closed")
        rows = (
            (
                one.last.message,
                one.last.severity,
                one.last.state.replace("_", " "),
                shown_time(one.last.opened_at),
                shown_time(one.closed_at),
            )
            for one in contents.alerts
        )
        yield table(heads, rows)
    else:
        yield muted("No alert was open in this period.")
    if contents.events:
        yield table(("When (UTC)", "alert", "what happened", "by", "comment"), map(_event, contents.events))
    if contents.notes:
        heads = ("When (UTC)", "kind", "by", "note or maintenance")
        yield table(heads, ((shown_time(one.at), one.kind, one.by, one.text) for one in contents.notes))
    else:
        yield muted("No notes or maintenance in this period.")
    if contents.left_out:
        yield muted(f"Not shown: {', '.join(contents.left_out)}.")


def _event(one: AlertEvent) -> tuple[str, ...]:
    became = f"{one.kind.replace('_', ' ')}: {one.severity}, {one.state.replace('_', ' ')}"
    return shown_time(one.at), f"{one.rule.replace('_', ' ')} {one.element}", became, one.by, one.comment
