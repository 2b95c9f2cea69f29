"""Writes what the service declares as TypeScript for the page: findings, terms of coefficients, channels, stored sentences.

`python -m service.commands.page_declarations dashboard/src/declarations` writes the files anew; they are committed.
"""

import json
import sys
from collections.abc import Callable, Mapping
from pathlib import Path

from estimator.bearings.terms import TERMS, Term
from service.delivery.channels import CHANNEL_KINDS
from service.monitoring.rules.drift_rule import RATE_RULE
from service.monitoring.rules.finding_catalogue import (
    ALERT_RULES,
    LIMITED_RULES,
    PRESENT,
    alerting_lists,
    is_named_as_element,
)
from service.monitoring.rules.finding_rules import FINDING_RULES
from service.monitoring.rules.limit_rule import QUANTITIES
from service.wording.language import LANGUAGES, Language
from service.wording.stored_sentences import STORED_SENTENCES

FINDINGS, ELEMENTS, TERMS_OF_COEFFICIENTS = "findings.ts", "elements.ts", "terms.ts"
CHANNELS, STORED = "channels.ts", "stored-sentences.ts"
HEAD = "// Written by `python -m service.commands.page_declarations` from {source}; not to be changed here.\n\n"


def documents() -> Mapping[str, str]:
    """Return the text of each file by its name."""
    return {
        FINDINGS: _findings(),
        ELEMENTS: _elements(),
        TERMS_OF_COEFFICIENTS: _terms(),
        CHANNELS: _channels(),
        STORED: _stored_sentences(),
    }


def write(folder: Path) -> None:
    """Write all files into a folder."""
    for name, text in documents().items():
        (folder / name).write_text(text, encoding="utf-8")


def _findings() -> str:
    names = ", ".join(_written(name) for name in LIMITED_RULES)
    quantities = "".join(f"  {name}: {_written(rule.quantities)},\n" for name, rule in LIMITED_RULES.items())
    limits = ", ".join(_written(name) for name in QUANTITIES)
    declared = (*FINDING_RULES, RATE_RULE)
    named_as_elements = [one.kind for one in declared if is_named_as_element(one.kind)]
    mended = "".join(
        f"  {name}: {_written(rule.mended_by_balancing)},\n" for name, rule in ALERT_RULES.items() if rule.mended_by_balancing
    )
    return (
        HEAD.format(source="service/monitoring/rules/finding_rules.py")
        + "/** Kinds of findings that have limits of their own. */\n"
        + f"export const RULES = [{names}] as const;\n\n"
        + "export type RuleName = (typeof RULES)[number];\n\n"
        + "/** Kinds of findings that alerts are of, with and without limits. */\n"
        + f"export const ALERT_RULES: readonly string[] = {_written(list(ALERT_RULES))};\n\n"
        + "/** Quantities that a limit may name. */\n"
        + f"export const LIMIT_NAMES = [{limits}] as const;\n\n"
        + "export type LimitName = (typeof LIMIT_NAMES)[number];\n\n"
        + "/** Quantities that the limits of each kind may name. */\n"
        + f"export const QUANTITIES: Record<RuleName, readonly LimitName[]> = {{\n{quantities}}};\n\n"
        + "/** Kinds of findings that are called as elements are, and so are the element's own. */\n"
        + f"export const NAMED_AS_ELEMENTS: readonly string[] = {_written(named_as_elements)};\n\n"
        + "/** Kinds of elements at which balancing mends what an alert reports, by the alert's rule. */\n"
        + f"export const MENDED_BY_BALANCING: Readonly<Record<string, readonly string[]>> = {{\n{mended}}};\n\n"
        + "/** Conditions of an alert whose cause is present. */\n"
        + f"export const PRESENT: readonly string[] = {_written(PRESENT)};\n\n"
        + "/** Names of all kinds of findings, by language. */\n"
        + _by_language("FINDING_NAMES", lambda language: {one.kind: one.name_in(language) for one in declared})
    )


def _elements() -> str:
    lists = "".join(f"  [{_written(kind)}, {_written(name)}],\n" for kind, name in alerting_lists().items())
    return (
        HEAD.format(source="estimator/diagnosis/finding_kinds.py")
        + "/** Kinds of elements that alerts may concern, with the list of a machine's document that names them. */\n"
        + f"export const ALERTING_LISTS = [\n{lists}] as const;\n"
    )


def _terms() -> str:
    quantities = " | ".join(dict.fromkeys(_written(one.quantity) for one in TERMS.values()))
    lines = "".join(f"  {name}: {_term(one)},\n" for name, one in TERMS.items())
    return (
        HEAD.format(source="estimator/bearings/terms.py")
        + f"export type TermQuantity = {quantities};\n\n"
        + "/** direct: positive by nature, unlike a cross-coupled term. order: power of jω with which it acts. */\n"
        + "export interface Term {\n  quantity: TermQuantity;\n  direct: boolean;\n  order: number;\n}\n\n"
        + "/** Terms of the coefficients of bearings, seals, couplings and pedestals, by name. */\n"
        + f"export const TERMS: Readonly<Record<string, Term>> = {{\n{lines}}};\n"
    )


def _term(one: Term) -> str:
    return f"{{ quantity: {_written(one.quantity)}, direct: {_written(one.direct)}, order: {one.order} }}"


def _channels() -> str:
    kinds = "".join(f"  {{ kind: {_written(one.kind)}, reports: {_written(one.reporting)} }},\n" for one in CHANNEL_KINDS)
    return (
        HEAD.format(source="service/delivery/channels.py")
        + "/** Ways in which people and programs are told of alerts; reports: whether reports of machines go there. */\n"
        + f"export const CHANNELS = [\n{kinds}] as const;\n\n"
        + "/** Their names, by language. */\n"
        + _by_language("CHANNEL_NAMES", lambda language: {one.kind: one.title[language.code] for one in CHANNEL_KINDS})
        + "\n/** Forms of their addresses in words, by language. */\n"
        + _by_language("ADDRESS_FORMS", _address_forms)
    )


def _address_forms(language: Language) -> str:
    forms = dict.fromkeys(one.address[language.code] for one in CHANNEL_KINDS if one.address is not None)
    said = language.translate("or").join(forms)
    without = ", ".join(one.kind for one in CHANNEL_KINDS if one.address is None)
    return language.translate("addresses", forms=said, without=without) if without else said


def _stored_sentences() -> str:
    lines = "".join(
        f"  {code}: {{\n" + "".join(f"    {_written(one)}: {_written(said)},\n" for one, said in sentences.items()) + "  },\n"
        for code, sentences in STORED_SENTENCES.items()
    )
    return (
        HEAD.format(source="service/wording/stored_sentences.py")
        + "/** Sentences that the service stores in English, by language: what matches one is said in its words. */\n"
        + f"export const STORED_SENTENCES: Readonly<Record<string, Readonly<Record<string, string>>>> = {{\n{lines}}};\n"
    )


def _by_language(name: str, said: Callable[[Language], object]) -> str:
    """Return a constant that holds what is said in each language, by its code."""
    lines = "".join(f"  {language.code}: {_written(said(language))},\n" for language in LANGUAGES)
    return f"export const {name} = {{\n{lines}}};\n"


def _written(value: object) -> str:
    return json.dumps(value, ensure_ascii=False)


if __name__ == "__main__":
    write(Path(sys.argv[1]))
