"""The reference of findings, from their declarations: where each can lie, from when on it is an alert, what is said of it."""

from collections.abc import Iterator

from docs_site.cli_reference import table_cell
from estimator.diagnosis.finding_kind import FindingPlace
from estimator.diagnosis.finding_kinds import finding_kind
from service.monitoring.rules.drift_rule import RATE_RULE
from service.monitoring.rules.finding_rule import FindingRule
from service.monitoring.rules.finding_rules import FINDING_RULES
from service.monitoring.rules.limit_rule import Level, LimitQuantity
from service.wording.finding_texts import PLACES, FindingTexts
from service.wording.language import ENGLISH

HEAD = f"""# Findings: reference

What the service can find, from when on that is an alert unless a site sets other [limits](alerts.md#limits), and what it says:
words in braces are filled in ({", ".join(f"`{{{one}}}`" for one in PLACES)}, and those of a finding itself). A site may write
texts of its own ([alerts](alerts.md)). [Diagnosis](method-diagnosis.md) says how they are found.
"""
LISTS = {
    "check": "To look at",
    "in_operation": "While it runs",
    "at_next_stop": "At the next stop",
    "if_danger": "Where it is a danger",
    "confirm": "Would confirm it",
    "not_determined": "Not determined",
}
"""Titles of the lists of a finding's texts."""
PLACE_WORDS: dict[FindingPlace, str] = {
    "machine": "in the machine",
    "channels": "in a measuring channel, not in the machine",
    "data": "in the data, or in what the document says of the machine",
}
QUANTITY_WORDS: dict[LimitQuantity, str] = {
    "sigma": "{:g} standard deviations",
    "per_cent": "{:g} % against the baseline",
    "force": "{:g} N of force in the coupling",
    "rate_per_cent_per_week": "{:g} % a week",
    "tolerance_per_cent": "{:g} % of what is allowed",
    "beyond_tolerance": "a probability of {:g} that it is more than allowed",
}
"""Words of a limit's quantities, with a place for the number."""


def findings_page() -> str:
    """Return the page: a section for each finding, drifts at the end."""
    lines = [HEAD]
    for rule in (*FINDING_RULES, RATE_RULE):
        lines += _finding(rule)
    return "\n".join([*lines, ""])


def _finding(rule: FindingRule) -> Iterator[str]:
    texts = rule.texts_in(ENGLISH)
    yield from ("", f"## {rule.kind.replace('_', ' ').capitalize()}", "", f"> {texts.what}", "")
    yield from ("| | |", "|---|---|", f"| name | `{rule.kind}`, rule `{rule.rule.name}` |")
    if rule is not RATE_RULE:
        kind = finding_kind(rule.kind)
        yield f"| lies | {PLACE_WORDS[kind.place]}: at {' or '.join(f'a {one}' for one in kind.elements)} |"
    limits = rule.rule.limits
    yield f"| alert | {'always' if limits is None else level_words(limits.alert)} |"
    yield f"| danger | {'never' if limits is None or limits.danger is None else level_words(limits.danger)} |"
    yield from _lists(texts)
    for kind_of_element, own in rule.texts_of_elements.items():
        yield from ("", f"Of a {kind_of_element}:", "", "| | |", "|---|---|", *_lists(own["en"]))


def _lists(texts: FindingTexts) -> Iterator[str]:
    for name, title in LISTS.items():
        said = getattr(texts, name)
        if said:
            yield f"| {title} | {'<br>'.join(table_cell(one) for one in said)} |"


def level_words(level: Level) -> str:
    """Return a level in words: how certain, and any of its sizes."""
    words = {name: QUANTITY_WORDS[name].format(getattr(level, name)) for name in QUANTITY_WORDS if name in level.named}
    certain = words.pop("sigma", "")
    return " and ".join(part for part in (certain, " or ".join(words.values())) if part)
