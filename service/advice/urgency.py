"""Urgency of a finding: whether its danger limit is reached, else the weeks until it is, by the rate since it began."""

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import Any

from service.alerts.advice_message import Urgency
from service.alerts.lifecycle import Severity
from service.wording.described_finding import DescribedFinding
from service.wording.language import Language

FEWEST_RUNS = 4
"""Fewest runs since a change began for which its rate is stated."""
LONGEST_WEEKS = 520.0
"""Weeks (ten years) beyond which no time is stated."""


def urgency(finding: DescribedFinding, severity: Severity | None, measured_at: datetime) -> Urgency:
    """Return how urgent a finding is. severity: severity of its alert, None without one. measured_at: when the newest run
    was."""
    if finding.kind == "rate_of_change":
        return _of_rate(finding, severity, measured_at)
    language = finding.language
    progress: Mapping[str, Any] = finding.evidence.get("progress") or {}
    unit = "%" if finding.evidence.get("tolerance_per_cent") is None else language.translate("unit.allowed")
    rate = tuple(progress.get(name) for name in ("per_week", "lower", "upper"))
    said = _size_words(finding, progress, unit) + _rate_words(progress, unit, language)
    ahead = progress.get("ahead")
    if severity is Severity.DANGER:
        return _answer(language.translate("urgent.reached", said=said), unit, rate, reached=True)
    if ahead is None:
        key = "urgent.no_limit" if rate[0] is not None else "urgent.no_time"
        return _answer(language.translate(key, said=said), unit, rate)
    return _until(ahead, _Rate(unit, rate, said), measured_at, language)


def gone(language: Language) -> Urgency:
    """Return that nothing is urgent any more: the cause is gone."""
    return _answer(language.translate("urgent.gone"), None, (None, None, None))


@dataclass(frozen=True)
class _Rate:
    """A rate a week with the ends of its interval, its unit, and what is said of it."""

    unit: str
    numbers: tuple[float | None, ...]
    said: str


def _of_rate(finding: DescribedFinding, severity: Severity | None, measured_at: datetime) -> Urgency:
    evidence, language = finding.evidence, finding.language
    rate = tuple(float(evidence[f"{name}_per_cent"]) for name in ("per_week", "lower", "upper"))
    far = evidence.get("change_per_cent")
    so_far = "" if far is None else language.translate("urgent.so_far", far=float(far))
    said = so_far + language.translate("urgent.drifts", rate=rate[0], lower=rate[1], upper=rate[2])
    ahead = evidence.get("ahead")
    if ahead is not None:
        return _until(ahead, _Rate("%", rate, said), measured_at, language)
    danger = severity is Severity.DANGER
    words = language.translate("urgent.drift_fast" if danger else "urgent.drift_no_time", said=said)
    return _answer(words, "%", rate, reached=danger)


def _size_words(finding: DescribedFinding, progress: Mapping[str, Any], unit: str) -> str:
    """Return the size that limits are for, in the newest run; where it is the mean of several elements, that is said."""
    newest = progress.get("newest")
    if newest is None:
        return ""
    elements = finding.elements_in_per_cent()
    size = finding.evidence.get("per_cent")
    if size is None or len(elements) < 2:
        return finding.language.translate("urgent.newest", newest=float(newest), unit=unit)
    return finding.language.translate("urgent.newest_mean", size=float(size), newest=float(newest), count=len(elements))


def _rate_words(progress: Mapping[str, Any], unit: str, language: Language) -> str:
    runs = progress.get("runs", 0)
    if progress.get("per_week") is None:
        return language.translate("urgent.run_needed" if runs == 1 else "urgent.runs_needed", runs=runs, needed=FEWEST_RUNS)
    rate, low, high = (float(progress[name]) for name in ("per_week", "lower", "upper"))
    finding = language.translate("urgent.rate", rate=rate, unit=unit, lower=low, upper=high, runs=runs)
    key = "grows" if low > 0.0 else "falls" if high < 0.0 else "no_growth"
    return language.translate(f"urgent.{key}", rate=finding)


def _until(ahead: Mapping[str, Any], rate: _Rate, measured_at: datetime, language: Language) -> Urgency:
    weeks, earliest, latest = (ahead[name] for name in ("expected", "earliest", "latest"))
    limit = float(ahead["limit"])
    if weeks is None or weeks > LONGEST_WEEKS:
        words = language.translate("urgent.not_approached", limit=limit, unit=rate.unit, said=rate.said)
        return _answer(words, rate.unit, rate.numbers, limit=ahead["limit"])
    never = latest is None or latest > LONGEST_WEEKS
    end = language.translate("urgent.never") if never else language.translate("urgent.latest", weeks=_weeks(latest, language))
    interval = end
    if earliest is not None:
        interval = language.translate("urgent.earliest", weeks=_weeks(earliest, language), end=end)
    words = language.translate(
        "urgent.until", limit=limit, unit=rate.unit, weeks=_weeks(weeks, language), interval=interval, said=rate.said
    )
    found = _answer(words, rate.unit, rate.numbers, limit=ahead["limit"])
    by = measured_at + timedelta(weeks=weeks)
    return found.model_copy(
        update={"weeks": weeks, "weeks_earliest": earliest, "weeks_latest": None if never else latest, "by": by}
    )


def _weeks(weeks: float, language: Language) -> str:
    if weeks < 2.0:
        days = round(7.0 * weeks)
        return language.translate("day" if days == 1 else "days", count=days)
    return language.translate("weeks", weeks=float(weeks))


def _answer(
    words: str, unit: str | None, rate: tuple[float | None, ...], *, limit: float | None = None, reached: bool = False
) -> Urgency:
    per_week, lower, upper = rate
    return Urgency(
        words=words,
        unit=unit,
        per_week=per_week,
        per_week_lower=lower,
        per_week_upper=upper,
        limit=limit,
        reached=reached,
        weeks=None,
        weeks_earliest=None,
        weeks_latest=None,
        by=None,
    )
