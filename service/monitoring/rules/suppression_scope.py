"""Checks what a suppression names: a rule and an element of which the machine can have an alert."""

from collections.abc import Collection, Iterator, Sequence

from estimator.close_matches import did_you_mean
from estimator.errors import Invalid
from estimator.machine.document import Machine
from estimator.machine.parameter_description import describe
from service.monitoring.rules.finding_catalogue import ALERT_RULES, alerting_lists, concerned_elements

WHOLE_MACHINE = "machine"
"""Element of alerts that concern the machine as a whole."""
MOST_LISTED = 40
"""Most names that a message lists."""


class SuppressionRefused(Invalid):
    """The machine cannot have an alert of this rule or element. `problems`: what is wrong, as (field, message)."""

    def __init__(self, problems: list[tuple[str, str]]) -> None:
        super().__init__("; ".join(f"{field}: {message}" for field, message in problems))
        self.problems = problems

    @property
    def field_errors(self) -> Sequence[tuple[str, str]]:
        """Return the fields of the request that are wrong, with what is wrong."""
        return self.problems


def require_possible(
    machine: Machine, rule: str | None, element: str | None, *, of_alerts: Collection[tuple[str, str]] = ()
) -> None:
    """Raise SuppressionRefused for a rule or element of which the machine can have no alert: it would suppress nothing.

    of_alerts: rules and elements of the alerts that are open, which an earlier revision or release may have raised.
    """
    problems = [
        *_rule_problems(rule, {one for one, _ in of_alerts}),
        *_element_problems(machine, element, {one for _, one in of_alerts}),
    ]
    if not problems and rule is not None and element is not None and (rule, element) not in of_alerts:
        problems += _pair_problems(rule, element)
    if problems:
        raise SuppressionRefused(problems)


def _rule_problems(rule: str | None, of_alerts: set[str]) -> Iterator[tuple[str, str]]:
    if rule is not None and rule not in ALERT_RULES and rule not in of_alerts:
        yield "rule", f"'{rule}' is no alert rule{_instead(rule, list(ALERT_RULES))}"


def _element_problems(machine: Machine, element: str | None, of_alerts: set[str]) -> Iterator[tuple[str, str]]:
    known = [
        WHOLE_MACHINE,
        *(f"{kind}.{part.id}" for kind, name in alerting_lists().items() for part in getattr(machine, name)),
    ]
    if element is not None and element not in known and element not in of_alerts:
        said = f"'{element}' is not an element of machine '{machine.id}' that alerts may concern"
        yield "element", f"{said}{_instead(element, known)}"


def _pair_problems(rule: str, element: str) -> Iterator[tuple[str, str]]:
    kinds = concerned_elements(ALERT_RULES[rule]) if rule in ALERT_RULES else ()
    if kinds and describe(element).element_kind not in kinds:
        yield "element", f"alerts of {rule} are never of '{element}': they are of a {' or '.join(kinds)}"


def _instead(name: str, known: Sequence[str]) -> str:
    """Return the known names close to an unknown one; all of them where none is close."""
    more = ", …" if len(known) > MOST_LISTED else ""
    return did_you_mean(name, known) or f"; there are {', '.join(known[:MOST_LISTED])}{more}"
