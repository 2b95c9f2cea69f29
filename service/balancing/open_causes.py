"""Open alerts that say that something else than unbalance is wrong: weights would hide it, and the trial runs would lie."""

from collections.abc import Callable, Sequence

from sqlalchemy.orm import Session

from estimator.errors import Conflict
from service.wording.language import ENGLISH, Language
from storage.alerts import alerts
from storage.alerts.alerts import ListedAlert

BALANCED_AWAY = ("unbalance",)
"""Rules whose alerts a balancing is the answer to."""
DRIFTING_UNBALANCE = ("rate_of_change", "disc.")
"""Rule and element of an alert that an unbalance drifts, which is balanced away, too."""
GONE = ("normal", "returned")
"""Conditions of an alert whose cause is gone."""
MOST = 1000

FindingWords = Callable[[str, str, Language], str]
"""Function that returns the words on a finding, by its kind and element, in a language."""


class SomethingElseWrong(Conflict):
    """Raised when no masses are proposed because an open alert names another cause of the vibration."""


def require_nothing_else(session: Session, machine_id: str, finding_words: FindingWords, language: Language = ENGLISH) -> None:
    """Raise SomethingElseWrong while an open alert of the machine has a present cause that no weight mends, in a language."""
    found = alerts.find(session, machine_id=machine_id, only_open=True, limit=MOST)
    other = [one for one in found if one.condition not in GONE and not _is_of_unbalance(one)]
    if other:
        raise SomethingElseWrong(_words(other, finding_words, language))


def _is_of_unbalance(alert: ListedAlert) -> bool:
    rule, element = DRIFTING_UNBALANCE
    return alert.rule in BALANCED_AWAY or (alert.rule == rule and alert.element.startswith(element))


def _words(other: Sequence[ListedAlert], finding_words: FindingWords, language: Language) -> str:
    names = dict.fromkeys(alert.element.rpartition(".")[2] or language.translate("balance.what_is_wrong") for alert in other)
    told = "; ".join(_alert_text(alert, finding_words, language) for alert in other[:3])
    more = language.translate("balance.more", count=len(other) - 3) if len(other) > 3 else ""
    return language.translate("balance.first", names=", ".join(names), alerts=told + more)


def _alert_text(alert: ListedAlert, finding_words: FindingWords, language: Language) -> str:
    return language.translate("balance.alert", id=alert.id, finding=finding_words(alert.rule, alert.element, language))
