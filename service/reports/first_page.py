"""The first page of a report, for who decides: finding, picture of the train, what to do, and by when."""

from service.alerts.advice_message import Advice
from service.reports.contents import PeriodCounts, ReportContents, ReportedAlert
from service.reports.page_parts import escaped, headed, muted, shown_day, shown_time
from service.reports.train_figure import train_figure

MOST_DETAILED = 3
"""Open alerts that are told with all that is to be done; others with one sentence."""


def first_page(contents: ReportContents) -> str:
    """Return the page."""
    machine, alerts = contents.machine, contents.open_alerts
    title = machine.name or machine.id
    period = f"{shown_day(contents.first)} to {shown_day(contents.last)}"
    head = (
        f'<h1 data-name="{escaped(title)}, {period}">{escaped(title)}</h1>'
        f'<p class="muted">{escaped(contents.plant)}/{escaped(machine.id)}, {period} (UTC), '
        f"made {shown_time(contents.made_at)}</p>"
    )
    picture = f'<div class="panel">{train_figure(machine, [one.last.element for one in alerts])}</div>'
    leading = "".join(_finding(one) for one in alerts[:1]) or _calm(contents)
    others = "".join(_finding(one) for one in alerts[1:MOST_DETAILED])
    rest = [f"{one.last.severity}: {one.last.message}" for one in alerts[MOST_DETAILED:]]
    more = f'<div class="panel alert">{headed("Further open alerts", rest)}</div>' if rest else ""
    return head + leading + picture + others + more + muted(_counted(contents.counts))


def calm_words(contents: ReportContents) -> str:
    """Return what is told without an open alert: only of a machine that was measured can it be said that there is none."""
    fit, turned = contents.fit, contents.counts.turned_until
    if fit is None and turned is None:
        return "Nothing has been measured of this machine yet: it cannot be judged."
    if fit is None:
        return (
            f"No run of this machine was identified and accepted yet: it cannot be judged. It last ran {shown_time(turned)}."
        )
    if not fit.baseline:
        day = shown_time(fit.measured_at)
        return f"No alert is open, but the newest accepted run, of {day}, was compared with no baseline: no change could show."
    return f"No alert is open. The newest accepted run was that of {shown_time(fit.measured_at)}."


def _calm(contents: ReportContents) -> str:
    judged = contents.fit is not None and bool(contents.fit.baseline)
    return f'<div class="panel{" calm" if judged else ""}"><p class="lead">{escaped(calm_words(contents))}</p></div>'


def _finding(one: ReportedAlert) -> str:
    event, advice = one.last, one.last.advice
    state = event.state.replace("_", " ")
    since = f"{event.severity}, {state}, open since {shown_time(event.opened_at)}"
    told = "" if advice is None else _told(advice)
    return f'<div class="panel {event.severity}"><p class="lead">{escaped(event.message)}</p>{muted(since)}{told}</div>'


def _told(advice: Advice) -> str:
    by = advice.how_urgent.by
    when = f"By {shown_day(by)}: " if by is not None else ""
    parts = [f'<p class="by">{escaped(when + advice.how_urgent.words)}</p>']
    opportunities = dict.fromkeys(one.opportunity for one in advice.actions)
    parts += [
        headed(f"To do {when}", [one.text for one in advice.actions if one.opportunity == when]) for when in opportunities
    ]
    parts.append(headed("How far", [one.words for one in advice.how_far]))
    parts.append(headed("How sure", [advice.how_sure.words]))
    parts.append(headed("To check", advice.check))
    parts.append(headed("Would confirm it", advice.confirm))
    parts.append(headed("Not determined", advice.not_determined))
    return "".join(parts)


def _counted(counts: PeriodCounts) -> str:
    found = (
        f"In this period: {_number(counts.runs, 'run')}, {_number(counts.identifications, 'identification')}, of which "
        f"{counts.accepted} accepted"
    )
    return f"{found}." if counts.turned_until is None else f"{found}; newest run until {shown_time(counts.turned_until)}."


def _number(count: int, what: str) -> str:
    return f"{count} {what}{'' if count == 1 else 's'}"
