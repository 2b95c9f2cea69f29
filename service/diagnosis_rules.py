"""The rules that a diagnosis speaks by: which rule speaks of a kind of cause, how patient it is, and how severe a cause is."""

from typing import Any, Literal, get_args

from service.alert_life import Severity
from service.limits import Limits, RuleName, severity_of

DataRule = Literal["misfit", "outliers"]
RULES = frozenset({*get_args(RuleName), *get_args(DataRule)}) - {"rate_of_change"}
"""Rules that a diagnosis speaks by."""
DATA_RULES: tuple[DataRule, ...] = get_args(DataRule)
"""What is wrong with the data has no size and no limits …"""
DATA_DELAY = 2
"""… and is an alert after so many runs in a row, and none after so many good ones."""


def rule_of(kind: str) -> Any:
    """The rule that speaks of a kind of causes: a bow is a run-out of a whole shaft."""
    return "run_out" if kind == "bow" else kind


def delays(limits: Limits, kind: str, element: str) -> tuple[int, int]:
    """How many runs in a row open and clear an alert."""
    rule = rule_of(kind)
    if rule in DATA_RULES:
        return DATA_DELAY, DATA_DELAY
    chosen = limits.rule(rule, element)
    return chosen.on_delay, chosen.off_delay


def cause_severity(
    limits: Limits,
    *,
    kind: str,
    element: str,
    sigma: float,
    per_cent: float | None,
    force: float | None,
    present: Severity | None,
) -> Severity | None:
    """How severe a cause is; None while it reaches no limit. sigma: standard deviations of its change.

    per_cent: its size, None where it has none. force: in the coupling [N]. present: severity that its alert has so far.
    """
    rule = rule_of(kind)
    if rule in DATA_RULES or per_cent is None:
        return Severity.ALERT
    return severity_of(limits, rule, sigma=sigma, per_cent=per_cent, force=force, present=present, element=element)
