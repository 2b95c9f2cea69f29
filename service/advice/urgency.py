"""Urgency of a finding: whether its danger limit is reached, else the weeks until it is, by the rate since it began."""

from collections.abc import Mapping
from datetime import datetime, timedelta
from typing import Any

from service.alerts.advice_message import Urgency
from service.alerts.lifecycle import Severity
from service.wording.told_finding import ToldFinding

FEWEST_RUNS = 4
"""Runs since a change began from which on its rate is told."""
LONGEST_WEEKS = 520.0
"""Weeks, ten years, beyond which no time is told."""


def urgency(told: ToldFinding, severity: Severity | None, measured_at: datetime) -> Urgency:
    """Return how urgent a finding is. severity: of its alert, None without one. measured_at: when the newest run was."""
    if told.kind == "rate_of_change":
        return _of_rate(told.evidence, severity, measured_at)
    progress: Mapping[str, Any] = told.evidence.get("progress") or {}
    unit = "%" if told.evidence.get("tolerance_per_cent") is None else "% of what is allowed"
    rate = tuple(progress.get(name) for name in ("per_week", "lower", "upper"))
    said = _rate_words(progress, unit)
    ahead = progress.get("ahead")
    if severity is Severity.DANGER:
        return _answer(f"The danger limit is reached; {said}", unit, rate, reached=True)
    if ahead is None:
        limit = "There is no danger limit ahead" if rate[0] is not None else "No time can be given"
        return _answer(f"{limit}: {said}", unit, rate)
    return _until(ahead, unit, rate, said, measured_at)


def _of_rate(evidence: Mapping[str, Any], severity: Severity | None, measured_at: datetime) -> Urgency:
    rate = tuple(evidence[f"{name}_per_cent"] for name in ("per_week", "lower", "upper"))
    far = evidence.get("change_per_cent")
    so_far = "" if far is None else f"it has changed by {far:+.1f} % so far; "
    said = f"{so_far}it drifts by {rate[0]:+.2g} % a week ({rate[1]:+.2g} to {rate[2]:+.2g})"
    ahead = evidence.get("ahead")
    if ahead is not None:
        return _until(ahead, "%", rate, said, measured_at)
    fast = "It drifts faster than its danger limit for rates; " if severity is Severity.DANGER else ""
    words = f"{fast}no time to a limit of its size can be given: {said}"
    return _answer(words[0].upper() + words[1:], "%", rate, reached=severity is Severity.DANGER)


def _rate_words(progress: Mapping[str, Any], unit: str) -> str:
    runs, newest = progress.get("runs", 0), progress.get("newest")
    size = "" if newest is None else f"the newest run shows {newest:.0f} {unit}; "
    if progress.get("per_week") is None:
        counted = f"{runs} run{'' if runs == 1 else 's'} since it began"
        return f"{size}{counted}, and {FEWEST_RUNS} tell how fast it grows"
    rate, low, high = (progress[name] for name in ("per_week", "lower", "upper"))
    told = f"{rate:+.2g} {unit} a week ({low:+.2g} to {high:+.2g}) over {runs} runs"
    if low > 0.0:
        return f"{size}it grows by {told}"
    return f"{size}it falls, {told}" if high < 0.0 else f"{size}no growth is certain, {told}"


def _until(ahead: Mapping[str, Any], unit: str, rate: tuple[float | None, ...], said: str, measured_at: datetime) -> Urgency:
    weeks, earliest, latest = (ahead[name] for name in ("expected", "earliest", "latest"))
    if weeks is None or weeks > LONGEST_WEEKS:
        limit = f"The danger limit of {ahead['limit']:g} {unit} is not approached measurably"
        return _answer(f"{limit}: {said}", unit, rate, limit=ahead["limit"])
    end = "it may also never" if latest is None or latest > LONGEST_WEEKS else f"{_weeks(latest)} at the latest"
    interval = f"{_weeks(earliest)} at the earliest, {end}" if earliest is not None else end
    words = f"Reaches its danger limit of {ahead['limit']:g} {unit} in {_weeks(weeks)} ({interval}): {said}"
    found = _answer(words, unit, rate, limit=ahead["limit"])
    last = None if latest is None or latest > LONGEST_WEEKS else latest
    by = measured_at + timedelta(weeks=weeks)
    return found.model_copy(update={"weeks": weeks, "weeks_earliest": earliest, "weeks_latest": last, "by": by})


def _weeks(weeks: float) -> str:
    if weeks < 2.0:
        days = round(7.0 * weeks)
        return f"{days} day{'' if days == 1 else 's'}"
    return f"{weeks:.0f} weeks"


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
