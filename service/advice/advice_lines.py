"""Advice as lines of text, for a mail or an annotation."""

from service.alerts.advice_message import Advice
from service.wording.language import ENGLISH, Language


def advice_lines(advice: Advice, language: Language = ENGLISH) -> list[str]:
    """Return advice as lines of text. language: language of the headings; the advice has its own already."""
    parts = [
        (language.translate("head.how_far"), [one.words for one in advice.how_far]),
        (language.translate("head.how_sure"), [advice.how_sure.words]),
        (language.translate("head.how_urgent"), [advice.how_urgent.words]),
        (language.translate("head.check"), advice.check),
        *by_opportunity(advice, language),
        (language.translate("head.confirm"), advice.confirm),
        (language.translate("head.not_determined"), advice.not_determined),
    ]
    return [line for head, texts in parts if texts for line in (f"{head}:", *(f"- {one}" for one in texts))]


def by_opportunity(advice: Advice, language: Language = ENGLISH) -> list[tuple[str, list[str]]]:
    """Return the actions below a heading for each opportunity, the most urgent first."""
    found: dict[str, list[str]] = {}
    for one in advice.actions:
        found.setdefault(one.opportunity, []).append(one.text)
    return [
        (language.translate("head.do", when=language.named(when.replace(" ", "_"))), texts) for when, texts in found.items()
    ]
