"""Urgency of a finding: whether its danger limit is reached, else the weeks until it is, by the rate since it began."""

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import Any

from service.alerts.advice_message import Urgency
from service.alerts.lifecycle import Severity
from service.wording.described_finding import ToldFinding
from service.wording.language import Language

FEWEST_RUNS = 4
"""Runs since a change began from which on its rate is told."""
LONGEST_WEEKS = 520.0
"""Weeks, ten years, beyond which no time is told."""


def urgency(told: ToldFinding, severity: Severity | None, measured_at: datetime) -> Urgency:
    """Return how urgent a finding is. severity: severity of its alert, None without one. measured_at: when the newest run
    was."""
    if told.kind == "rate_of_change":
        return _of_rate(told, severity, measured_at)
    language = told.language
    progress: Mapping[str, Any] = told.evidence.get("progress") or {}
    unit = "%" if told.evidence.get("tolerance_per_cent") is None else language.say("unit.allowed")
    rate = tuple(progress.get(name) for name in ("per_week", "lower", "upper"))
    said = _rate_words(progress, unit, language)
    ahead = progress.get("ahead")
    if severity is Severity.DANGER:
        return _answer(language.say("urgent.reached", said=said), unit, rate, reached=True)
    if ahead is None:
        key = "urgent.no_limit" if rate[0] is not None else "urgent.no_time"
        return _answer(language.say(key, said=said), unit, rate)
    return _until(ahead, _Rate(unit, rate, said), measured_at, language)


@dataclass(frozen=True)
class _Rate:
    """A rate a week with the ends of its interval, its unit, and what is said of it."""

    unit: str
    numbers: tuple[float | None, ...]
    said: str


def _of_rate(told: ToldFinding, severity: Severity | None, measured_at: datetime) -> Urgency:
    evidence, language = told.evidence, told.language
    rate = tuple(float(evidence[f"{name}_per_cent"]) for name in ("per_week", "lower", "upper"))
    far = evidence.get("change_per_cent")
    so_far = "" if far is None else language.say("urgent.so_far", far=float(far))
    said = so_far + language.say("urgent.drifts", rate=rate[0], lower=rate[1], upper=rate[2])
    ahead = evidence.get("ahead")
    if ahead is not None:
        return _until(ahead, _Rate("%", rate, said), measured_at, language)
    danger = severity is Severity.DANGER
    words = language.say("urgent.drift_fast" if danger else "urgent.drift_no_time", said=said)
    return _answer(words, "%", rate, reached=danger)


def _rate_words(progress: Mapping[str, Any], unit: str, language: Language) -> str:
    runs, newest = progress.get("runs", 0), progress.get("newest")
    size = "" if newest is None else language.say("urgent.newest", newest=float(newest), unit=unit)
    if progress.get("per_week") is None:
        return size + language.say("urgent.run_needed" if runs == 1 else "urgent.runs_needed", runs=runs, needed=FEWEST_RUNS)
    rate, low, high = (float(progress[name]) for name in ("per_week", "lower", "upper"))
    told = language.say("urgent.rate", rate=rate, unit=unit, lower=low, upper=high, runs=runs)
    key = "grows" if low > 0.0 else "falls" if high < 0.0 else "no_growth"
    return size + language.say(f"urgent.{key}", rate=told)


def _until(ahead: Mapping[str, Any], rate: _Rate, measured_at: datetime, language: Language) -> Urgency:
    weeks, earliest, latest = (ahead[name] for name in ("expected", "earliest", "latest"))
    limit = float(ahead["limit"])
    if weeks is None or weeks > LONGEST_WEEKS:
        words = language.say("urgent.not_approached", limit=limit, unit=rate.unit, said=rate.said)
        return _answer(words, rate.unit, rate.numbers, limit=ahead["limit"])
    never = latest is None or latest > LONGEST_WEEKS
    end = language.say("urgent.never") if never else language.say("urgent.latest", weeks=_weeks(latest, language))
    interval = end
    if earliest is not None:
        interval = language.say("urgent.earliest", weeks=_weeks(earliest, language), end=end)
    words = language.say(
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
        return language.say("day" if days == 1 else "days", count=days)
    return language.say("weeks", weeks=float(weeks))


def _answer(
    words: str, unit: str, rate: tuple[float | None, ...], *, limit: float | None = None, reached: bool = False
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
