"""The first page of a report, for who decides: finding, picture of the train, what to do, and by when."""

from service.advice.advice_lines import by_opportunity
from service.alerts.advice_message import Advice
from service.reports.contents import PeriodCounts, ReportContents, ReportedAlert
from service.reports.page_parts import escaped, headed, muted, shown_day, shown_time
from service.reports.train_figure import train_figure
from service.wording.language import Language

MOST_DETAILED = 3
"""Open alerts that are printed with all recommended actions; others with one sentence."""


def first_page(contents: ReportContents) -> str:
    """Return the page."""
    machine, alerts, language = contents.machine, contents.open_alerts, contents.language
    title = machine.name or machine.id
    period = language.translate("report.period", first=shown_day(contents.first), last=shown_day(contents.last))
    made = language.translate(
        "report.made", machine=f"{contents.plant}/{machine.id}", period=period, at=shown_time(contents.made_at)
    )
    head = f'<h1 data-name="{escaped(title)}, {period}">{escaped(title)}</h1>{muted(made)}'
    train = train_figure(machine, [one.last.element for one in alerts])
    picture = f'<div class="panel">{train}{muted(language.translate("report.train_key"))}</div>'
    leading = "".join(_finding(one, language) for one in alerts[:1]) or _calm(contents)
    others = "".join(_finding(one, language) for one in alerts[1:MOST_DETAILED])
    rest = [f"{language.named(one.last.severity)}: {one.last.message}" for one in alerts[MOST_DETAILED:]]
    more = f'<div class="panel alert">{headed(language.translate("report.further"), rest)}</div>' if rest else ""
    return head + leading + picture + others + more + muted(_counted(contents.counts, language))


def no_alert_text(contents: ReportContents) -> str:
    """Return the text for a machine without an open alert; it says so where nothing was measured."""
    fit, turned, translate = contents.fit, contents.counts.turned_until, contents.language.translate
    if fit is None:
        if turned is None:
            return translate("report.nothing_measured")
        return translate("report.not_identified", at=shown_time(turned))
    return translate("report.calm" if fit.baseline else "report.no_baseline", at=shown_time(fit.measured_at))


def _calm(contents: ReportContents) -> str:
    judged = contents.fit is not None and bool(contents.fit.baseline)
    return f'<div class="panel{" calm" if judged else ""}"><p class="lead">{escaped(no_alert_text(contents))}</p></div>'


def _finding(one: ReportedAlert, language: Language) -> str:
    event, advice = one.last, one.last.advice
    severity, state = language.named(event.severity), language.named(event.state)
    since = language.translate("report.open_since", severity=severity, state=state, at=shown_time(event.opened_at))
    told = "" if advice is None else _advice_html(advice, language)
    return f'<div class="panel {event.severity}"><p class="lead">{escaped(event.message)}</p>{muted(since)}{told}</div>'


def _advice_html(advice: Advice, language: Language) -> str:
    by, translate = advice.how_urgent.by, language.translate
    when = translate("report.by", day=shown_day(by)) if by is not None else ""
    parts = [f'<p class="by">{escaped(when + advice.how_urgent.words)}</p>']
    parts += [headed(head, texts) for head, texts in by_opportunity(advice, language)]
    parts.append(headed(translate("head.how_far"), [one.words for one in advice.how_far]))
    parts.append(headed(translate("head.how_sure"), [advice.how_sure.words]))
    parts.append(headed(translate("head.check"), advice.check))
    parts.append(headed(translate("head.confirm"), advice.confirm))
    parts.append(headed(translate("head.not_determined"), advice.not_determined))
    return "".join(parts)


def _counted(counts: PeriodCounts, language: Language) -> str:
    runs, identifications = _number(counts.runs, "run", language), _number(counts.identifications, "identification", language)
    found = language.translate("report.counted", runs=runs, identifications=identifications, accepted=counts.accepted)
    if counts.turned_until is None:
        return f"{found}."
    return language.translate("report.turned", counted=found, at=shown_time(counts.turned_until))


def _number(count: int, what: str, language: Language) -> str:
    return language.translate(f"report.{what}") if count == 1 else language.translate(f"report.{what}s", count=count)
