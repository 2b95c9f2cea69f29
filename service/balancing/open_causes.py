"""Open alerts that say that something else than unbalance is wrong: weights would hide it, and the trial runs would lie."""

from collections.abc import Sequence

from sqlalchemy.orm import Session

from estimator.errors import Conflict
from estimator.machine.parameter_description import describe
from service.monitoring.rules.finding_catalogue import finding_at, speaks_against_balancing
from service.wording.language import ENGLISH, Language
from storage.alerts import alerts
from storage.alerts.alerts import ListedAlert

MOST = 1000


class SomethingElseWrong(Conflict):
    """Raised when no masses are proposed because an open alert names another cause of the vibration."""


def require_nothing_else(session: Session, machine_id: str, language: Language = ENGLISH) -> None:
    """Raise SomethingElseWrong while an open alert of the machine has a present cause that no weight mends, in a language."""
    found = alerts.find(session, machine_id=machine_id, only_open=True, limit=MOST)
    other = [one for one in found if speaks_against_balancing(one.rule, one.element, one.condition)]
    if other:
        raise SomethingElseWrong(_words(other, language))


def _words(other: Sequence[ListedAlert], language: Language) -> str:
    elements = [describe(alert.element) for alert in other]
    wrong = language.translate("balance.what_is_wrong")
    names = dict.fromkeys(one.element_id or one.element_kind or wrong for one in elements)
    told = "; ".join(_alert_text(alert, language) for alert in other[:3])
    more = language.translate("balance.more", count=len(other) - 3) if len(other) > 3 else ""
    return language.translate("balance.first", names=", ".join(names), alerts=told + more)


def _alert_text(alert: ListedAlert, language: Language) -> str:
    return language.translate("balance.alert", id=alert.id, finding=finding_at(alert.rule, alert.element, language))
