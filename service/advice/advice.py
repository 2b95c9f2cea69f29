"""Advice on a finding: its texts with its numbers in them, the same in every channel."""

import logging
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from datetime import datetime
from typing import Any

from estimator.diagnosis.finding_kind import SizePart
from service.advice.site_texts import SiteTexts
from service.advice.urgency import gone, urgency
from service.alerts.advice_message import Action, Advice, Certainty, Figure
from service.alerts.lifecycle import Severity
from service.monitoring.rules.drift_rule import RATE_RULE
from service.monitoring.rules.finding_catalogue import finding_at, is_finding, rule_of_kind
from service.wording.described_finding import DescribedFinding
from service.wording.finding_texts import FindingTexts
from service.wording.finding_words import UNITS, compared_words, described_parts, part_words, rounded, second_order_words
from service.wording.language import ENGLISH, Language

logger = logging.getLogger(__name__)

FAULTS_OF_CONTENT = (ValueError, TypeError, KeyError, IndexError, AttributeError, OverflowError)
"""Errors that stored numbers of a form of another release, or none at all, lead to."""
LARGEST_EXPONENT = 13.8
"""Logarithm of a million: beyond it nobody reads a factor."""


@dataclass(frozen=True)
class FindingFacts:
    """A finding with its facts, as texts need them.

    severity: severity of its alert, None of a diagnosis by itself. measured_at: when the run was measured that shows it last.
    is_gone: whether its alert's cause is gone.
    """

    machine: str
    kind: str
    element: str
    evidence: Mapping[str, Any]
    severity: Severity | None
    measured_at: datetime
    is_gone: bool = False


def advice_of(facts: FindingFacts, texts: SiteTexts) -> Advice | None:
    """Return the advice on a finding; None where its kind is unknown or an older release has stored too few numbers."""
    finding = DescribedFinding(facts.kind, facts.element, facts.evidence, texts.language)
    of_rate = facts.kind == RATE_RULE.kind and "per_week_per_cent" in facts.evidence
    if not of_rate and not (is_finding(facts.kind) and finding.is_tellable()):
        return None
    try:
        return _advice(finding, facts, texts.of(facts.kind, finding.element_kind))
    except FAULTS_OF_CONTENT:
        # Of evidence that another release has stored; whoever reads it still gets its kind and element.
        logger.exception("%s of %s at %s cannot be put into words", facts.kind, facts.element, facts.machine)
        return None


def plain_message(kind: str, element: str, language: Language = ENGLISH) -> str:
    """Return the message on a finding of which only kind and element are known."""
    words = finding_at(kind, element, language)
    return words[:1].upper() + words[1:]


def _advice(finding: DescribedFinding, facts: FindingFacts, texts: FindingTexts) -> Advice:
    rule = rule_of_kind(finding.kind)
    filled = texts.filled(
        {
            "id": finding.id,
            "element": finding.language.element(finding.element)
            if finding.id != finding.element
            else finding.language.translate("the_machine"),
            "machine": facts.machine,
            "since": str(finding.evidence.get("since", ""))[:10],
            "sigma": f"{finding.evidence.get('sigma') or 0.0:.0f} σ",
            "runs": str(finding.evidence.get("runs", "")),
            "compared": compared_words(finding),
            **rule.words(finding),
        }
    )
    return Advice(
        what=filled.what,
        how_far=[_figure(one, finding) for one in described_parts(finding)],
        how_sure=_certainty(finding),
        how_urgent=gone(finding.language) if facts.is_gone else urgency(finding, facts.severity, facts.measured_at),
        check=list(filled.check),
        actions=list(_actions(filled, None if facts.is_gone else facts.severity)),
        confirm=list(filled.confirm),
        not_determined=[*rule.open_questions(finding), *filled.not_determined],
    )


def _figure(one: SizePart, finding: DescribedFinding) -> Figure:
    return Figure(
        of=one.name,
        words=part_words(one, finding.language),
        unit=UNITS.get(one.unit, one.unit),
        value=one.value,
        lower=one.lower,
        upper=one.upper,
        sigma=one.sigma,
        runs=finding.runs_of(one),
        parameters=list(one.members),
        allowed=one.allowed,
        before=one.before,
        against=one.against,
    )


def _certainty(finding: DescribedFinding) -> Certainty:
    said, language = finding.evidence, finding.language
    if finding.kind == RATE_RULE.kind:
        words = language.translate("sure.drift", runs=said["runs"])
        return Certainty(words=words, sigma=None, runs=said["runs"], evidence=None, next_best=None)
    runs, sigma, evidence = said.get("runs"), said.get("sigma"), said.get("evidence")
    others = said.get("runners_up") or []
    next_best = plain_message(others[0]["kind"], others[0]["element"], language) if others else None
    within = finding_at(others[0]["kind"], others[0]["element"], language) if others else ""
    words = language.translate("sure.beyond_chance")
    if sigma is not None and list(finding.parts()):
        words = language.translate("sure.sigma", sigma=float(sigma))
    words += (
        "" if runs is None else language.translate("sure.runs", runs=runs) if runs != 1 else language.translate("sure.run")
    )
    if next_best is not None and evidence is not None and evidence >= others[0]["evidence"]:
        lead = evidence - others[0]["evidence"]
        many = lead > LARGEST_EXPONENT
        factor = language.translate("sure.million") if many else rounded(2.718281828**lead, 2, language)
        words += language.translate("sure.lead", factor=factor, next=within)
    words += second_order_words(finding, within)
    return Certainty(words=words, sigma=sigma, runs=runs, evidence=evidence, next_best=next_best)


def _actions(texts: FindingTexts, severity: Severity | None) -> Iterator[Action]:
    if severity is Severity.DANGER:
        yield from (Action(opportunity="now", text=one) for one in texts.if_danger)
    yield from (Action(opportunity="in operation", text=one) for one in texts.in_operation)
    yield from (Action(opportunity="at the next stop", text=one) for one in texts.at_next_stop)
