"""Looks up the declarations of findings and their alert rules, by kind and by name.

The import of this module fails unless each of the estimator's `FINDING_KINDS` has exactly one declaration in `FINDING_RULES`.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import get_args

from estimator.diagnosis.finding_kind import ELEMENT_LISTS, ElementKind
from estimator.diagnosis.finding_kinds import FINDING_KINDS, finding_kind
from estimator.machine.parameter_description import describe
from service.alerts.lifecycle import ACTIVE
from service.monitoring.rules.drift_rule import RATE_OF_CHANGE, RATE_RULE
from service.monitoring.rules.finding_rule import AlertRule, FindingRule
from service.monitoring.rules.finding_rules import FINDING_RULES
from service.wording.language import Language


def require_complete(declared: Sequence[FindingRule], kinds: Iterable[str]) -> Mapping[str, FindingRule]:
    """Return the declarations by kind. Raises ValueError unless there is exactly one for each kind of finding."""
    found = {one.kind: one for one in declared}
    if len(found) < len(declared):
        raise ValueError(f"a finding is declared twice: {', '.join(one.kind for one in declared)}")
    missing, unknown = sorted(set(kinds) - set(found)), sorted(set(found) - set(kinds))
    if missing:
        raise ValueError(f"findings without texts and alert rule in FINDING_RULES: {', '.join(missing)}")
    if unknown:
        raise ValueError(f"FINDING_RULES has what is no kind of finding of the estimator: {', '.join(unknown)}")
    return found


_BY_KIND = require_complete(FINDING_RULES, [one.kind for one in FINDING_KINDS])


def finding_rule(kind: str) -> FindingRule:
    """Return the declaration of a kind of finding. Raises KeyError when there is none."""
    return _BY_KIND[kind]


def rule_of_kind(kind: str) -> FindingRule:
    """Return the declaration of a kind of finding, or of `rate_of_change`. Raises KeyError when there is none."""
    return RATE_RULE if kind == RATE_RULE.kind else _BY_KIND[kind]


def finding_name(kind: str, language: Language) -> str:
    """Return the name of a finding or alert rule; the identifier in words of one that only another release declares."""
    return rule_of_kind(kind).name_in(language) if is_finding(kind) or kind == RATE_RULE.kind else language.named(kind)


def finding_at(kind: str, element: str, language: Language) -> str:
    """Return a finding with its element as both stand within a sentence, such as `misalignment of coupling C1`."""
    said, finding = describe(element), finding_name(kind, language)
    if not said.element_id:  # of the machine as a whole
        return finding
    # A finding that is called as elements are is the element's own.
    if is_named_as_element(kind) or finding == language.named(said.element_kind):
        return language.translate("itself", element=language.element(element))
    return language.translate("finding_of", finding=finding, element=language.element(element))


def is_named_as_element(kind: str) -> bool:
    """Return whether a finding is called as a kind of element is, so that it is the element's own."""
    return kind in get_args(ElementKind)


def is_finding(kind: str) -> bool:
    """Return whether a kind of finding exists."""
    return kind in _BY_KIND


def _rules_by_name() -> Mapping[str, AlertRule]:
    """Return the alert rules of all findings. Raises ValueError for two different ones of one name."""
    found: dict[str, AlertRule] = {}
    for one in FINDING_RULES:
        if found.setdefault(one.rule.name, one.rule) is not one.rule:
            raise ValueError(f"two alert rules are called '{one.rule.name}': finding '{one.kind}' needs one of its own name")
        if one.rule.name not in _BY_KIND:
            raise ValueError(f"alert rule '{one.rule.name}' of finding '{one.kind}' needs a finding's name, which people know")
    return found


DIAGNOSIS_RULES = _rules_by_name()
"""Alert rules of the findings of a diagnosis, by name."""
ALERT_RULES: Mapping[str, AlertRule] = {**DIAGNOSIS_RULES, RATE_OF_CHANGE.name: RATE_OF_CHANGE}
"""All alert rules, by name, in the order of display."""
LIMITED_RULES: Mapping[str, AlertRule] = {name: rule for name, rule in ALERT_RULES.items() if rule.limits is not None}
"""Alert rules with limits, by name, in the order of display."""

PRESENT: tuple[str, ...] = tuple(sorted(ACTIVE))
"""Conditions of an alert whose cause is present."""


def concerned_elements(rule: AlertRule) -> tuple[ElementKind, ...]:
    """Return the kinds of elements that a rule concerns."""
    of_findings = (kind for one in FINDING_RULES if one.rule is rule for kind in finding_kind(one.kind).elements)
    return tuple(dict.fromkeys((*of_findings, *rule.elements)))


def alerting_lists() -> Mapping[ElementKind, str]:
    """Return the lists of a document whose elements alerts may concern, by kind of element."""
    concerned = {kind for rule in ALERT_RULES.values() for kind in concerned_elements(rule)}
    return {kind: name for kind, name in ELEMENT_LISTS.items() if kind in concerned}


def is_mended_by_balancing(rule: str, element: str) -> bool:
    """Return whether balancing mends what an alert of a rule reports at an element."""
    declared = ALERT_RULES.get(rule)
    return declared is not None and describe(element).element_kind in declared.mended_by_balancing


def speaks_against_balancing(rule: str, element: str, condition: str) -> bool:
    """Return whether an alert's cause is present and no weight mends it: balancing would hide it."""
    return condition in PRESENT and not is_mended_by_balancing(rule, element)
