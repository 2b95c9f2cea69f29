"""The alert's state machine against the transitions of ISA-18.2, written out here once more as a table."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.alerts.lifecycle import (
    Acknowledged,
    AlertCondition,
    AlertStatus,
    Cleared,
    Forbidden,
    LifecycleEvent,
    Raised,
    Released,
    Reset,
    Severity,
    Suppressed,
    Suppression,
    advance,
)

# Condition after an event without suppression, for an alert that does not latch and for one that does; "-" is refused.
TABLE = """
                         raised          cleared                 cleared, latching       acknowledged         reset
normal                   unacknowledged  normal                  normal                  -                    -
unacknowledged           unacknowledged  returned                latched_unacknowledged  acknowledged         -
acknowledged             acknowledged    normal                  latched_acknowledged    -                    -
returned                 unacknowledged  returned                returned                normal               -
latched_unacknowledged   unacknowledged  latched_unacknowledged  latched_unacknowledged  latched_acknowledged -
latched_acknowledged     unacknowledged  latched_acknowledged    latched_acknowledged    -                    normal
"""
ROWS = {line.split()[0]: line.split()[1:] for line in TABLE.strip().splitlines()[1:]}
EVENTS: tuple[tuple[LifecycleEvent, bool], ...] = (
    (Raised(), False),
    (Cleared(), False),
    (Cleared(), True),
    (Acknowledged(), False),
    (Reset(), False),
)
CASES = [
    (AlertCondition(condition), event, latching, expected)
    for condition, row in ROWS.items()
    for (event, latching), expected in zip(EVENTS, row, strict=True)
]


def test_the_table_names_every_condition() -> None:
    assert set(ROWS) == set(AlertCondition)


@pytest.mark.parametrize(("condition", "event", "latching", "expected"), CASES)
def test_transitions_of_the_standard(condition: AlertCondition, event: LifecycleEvent, latching: bool, expected: str) -> None:
    standing = AlertStatus(condition, latching=latching)
    if expected == "-":
        with pytest.raises(Forbidden):
            advance(standing, event)
    else:
        assert advance(standing, event).condition == expected


def test_an_acknowledged_alert_that_gets_worse_calls_again() -> None:
    seen = AlertStatus(AlertCondition.ACKNOWLEDGED, Severity.ALERT)
    assert advance(seen, Raised(Severity.DANGER)) == AlertStatus(AlertCondition.UNACKNOWLEDGED, Severity.DANGER)
    worst = AlertStatus(AlertCondition.ACKNOWLEDGED, Severity.DANGER)
    assert advance(worst, Raised(Severity.ALERT)) == AlertStatus(AlertCondition.ACKNOWLEDGED, Severity.ALERT)


@pytest.mark.parametrize("suppression", Suppression)
def test_a_suppressed_alert_calls_nobody_and_follows_its_cause(suppression: Suppression) -> None:
    quiet = advance(AlertStatus(AlertCondition.ACKNOWLEDGED), Suppressed(suppression))
    assert quiet.state == suppression.value
    assert advance(quiet, Cleared()).closed
    with pytest.raises(Forbidden, match="end that first"):
        advance(quiet, Acknowledged())
    assert advance(quiet, Released(suppression)).condition is AlertCondition.UNACKNOWLEDGED  # it calls again
    risen = advance(advance(AlertStatus(), Suppressed(suppression)), Raised())
    assert risen.state == suppression.value
    assert advance(risen, Released(suppression)).state == "unacknowledged"


def test_several_suppressions_hold_until_the_last_one_ends() -> None:
    standing = AlertStatus(AlertCondition.ACKNOWLEDGED)
    for suppression in reversed(Suppression):
        standing = advance(standing, Suppressed(suppression))
    shown = []
    for suppression in Suppression:
        shown.append(standing.state)
        standing = advance(standing, Released(suppression))
    assert shown == ["out_of_service", "suppressed_by_design", "shelved"]
    assert standing.state == "unacknowledged"


def test_what_is_not_suppressed_is_not_released() -> None:
    with pytest.raises(Forbidden, match="not shelved"):
        advance(AlertStatus(AlertCondition.UNACKNOWLEDGED), Released(Suppression.SHELVED))


def test_a_latched_alert_is_acknowledged_before_it_is_reset() -> None:
    with pytest.raises(Forbidden, match="acknowledge it, then reset it"):
        advance(AlertStatus(AlertCondition.LATCHED_UNACKNOWLEDGED), Reset())


events = st.one_of(
    st.builds(Raised, st.sampled_from(Severity)),
    st.just(Cleared()),
    st.just(Acknowledged()),
    st.just(Reset()),
    st.builds(Suppressed, st.sampled_from(Suppression)),
    st.builds(Released, st.sampled_from(Suppression)),
)


@given(st.booleans(), st.lists(events, max_size=60))
def test_laws_of_any_life(latching: bool, lived: list[LifecycleEvent]) -> None:
    standing, cause, quiet = AlertStatus(latching=latching), False, set[Suppression]()
    for event in lived:
        try:
            after = advance(standing, event)
        except Forbidden:
            assert isinstance(event, Acknowledged | Reset | Released)
            continue
        cause = {Raised: True, Cleared: False}.get(type(event), cause)
        if isinstance(event, Suppressed):
            quiet.add(event.suppression)
        if isinstance(event, Released):
            quiet.remove(event.suppression)
        # Its cause shows, nothing is suppressed by itself, and only a person or a vanished cause closes it.
        assert (after.condition in (AlertCondition.UNACKNOWLEDGED, AlertCondition.ACKNOWLEDGED)) == cause
        assert after.suppressions == quiet
        if after.closed and not standing.closed:
            assert isinstance(event, Cleared | Acknowledged | Reset)
            assert not latching or isinstance(event, Reset | Acknowledged)
        assert advance(after, Raised(after.severity)).condition in (AlertCondition.UNACKNOWLEDGED, AlertCondition.ACKNOWLEDGED)
        standing = after
