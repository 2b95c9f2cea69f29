"""The life of an alert, after ISA-18.2: a pure state machine.

An alert's condition follows the findings of identifications and the actions of people. Under a suppression it follows them
too, but notifies nobody. `advance` takes a standing and an event and returns the next standing, or raises Forbidden.

Source: ANSI/ISA-18.2-2016, the alarm state transition diagram (here as retold in public descriptions of it).
"""

from dataclasses import dataclass, replace
from enum import IntEnum, StrEnum

from estimator.errors import Conflict


class Severity(IntEnum):
    """Severity of an alert."""

    ALERT = 1
    DANGER = 2

    @property
    def label(self) -> str:
        """Return the name in answers and messages."""
        return self.name.lower()


class AlertCondition(StrEnum):
    """State of an alert with respect to its cause and its acknowledgement."""

    NORMAL = "normal"
    UNACKNOWLEDGED = "unacknowledged"
    ACKNOWLEDGED = "acknowledged"
    RETURNED = "returned"
    """The cause is gone; nobody has acknowledged the alert."""
    LATCHED_UNACKNOWLEDGED = "latched_unacknowledged"
    """The cause is gone; a person must acknowledge and reset."""
    LATCHED_ACKNOWLEDGED = "latched_acknowledged"
    """The cause is gone and the alert acknowledged; a person must reset it."""


class Suppression(StrEnum):
    """Reasons why an alert with a cause notifies nobody; the first that holds is the visible state."""

    OUT_OF_SERVICE = "out_of_service"
    SUPPRESSED_BY_DESIGN = "suppressed_by_design"
    SHELVED = "shelved"


ACTIVE = frozenset({AlertCondition.UNACKNOWLEDGED, AlertCondition.ACKNOWLEDGED})
"""Conditions with a present cause."""
CAUSE_GONE = frozenset(one.value for one in AlertCondition if one not in ACTIVE)
"""Visible states of alerts whose cause is gone; a suppression hides whether it is."""
LATCHED = frozenset({AlertCondition.LATCHED_UNACKNOWLEDGED, AlertCondition.LATCHED_ACKNOWLEDGED})
CALLING = frozenset({AlertCondition.UNACKNOWLEDGED, AlertCondition.RETURNED, AlertCondition.LATCHED_UNACKNOWLEDGED})
"""Conditions that wait for an acknowledgement."""


@dataclass(frozen=True)
class AlertStatus:
    """State of an alert. severity: severity of its cause, also after it is gone; latching: whether a person must reset it."""

    condition: AlertCondition = AlertCondition.NORMAL
    severity: Severity = Severity.ALERT
    latching: bool = False
    suppressions: frozenset[Suppression] = frozenset()

    @property
    def state(self) -> str:
        """Return the visible state: a suppression, or the condition."""
        for suppression in Suppression:
            if suppression in self.suppressions:
                return suppression.value
        return self.condition.value

    @property
    def closed(self) -> bool:
        """Return whether the episode is over. Suppressions may outlast it."""
        return self.condition is AlertCondition.NORMAL


@dataclass(frozen=True)
class Raised:
    """The cause is present, with this severity."""

    severity: Severity = Severity.ALERT


@dataclass(frozen=True)
class Cleared:
    """The cause is gone."""


@dataclass(frozen=True)
class Acknowledged:
    """A person has acknowledged the alert."""


@dataclass(frozen=True)
class Reset:
    """A person resets the latched alert."""


@dataclass(frozen=True)
class Suppressed:
    """A suppression begins: the alert notifies nobody."""

    suppression: Suppression


@dataclass(frozen=True)
class Released:
    """A suppression has ended."""

    suppression: Suppression


LifecycleEvent = Raised | Cleared | Acknowledged | Reset | Suppressed | Released


class Forbidden(Conflict):
    """The event is not allowed in the alert's state; the message says why and what would be right."""


def advance(standing: AlertStatus, event: LifecycleEvent) -> AlertStatus:
    """Return the next standing, an equal one when the event changes nothing. Raises Forbidden."""
    match event:
        case Raised(severity):
            return _with_severity(standing, severity)
        case Cleared():
            return _cleared(standing)
        case Acknowledged():
            return _acknowledged(standing)
        case Reset():
            return _reset(standing)
        case Suppressed(suppression):
            return replace(standing, suppressions=standing.suppressions | {suppression})
        case Released(suppression):
            return _released(standing, suppression)


def _with_severity(standing: AlertStatus, severity: Severity) -> AlertStatus:
    worse = severity > standing.severity
    if standing.condition is AlertCondition.ACKNOWLEDGED and not worse:
        return replace(standing, severity=severity)
    return replace(standing, condition=AlertCondition.UNACKNOWLEDGED, severity=severity)


def _cleared(standing: AlertStatus) -> AlertStatus:
    if standing.condition not in ACTIVE:
        return standing
    seen = standing.condition is AlertCondition.ACKNOWLEDGED
    if standing.latching:
        latched = AlertCondition.LATCHED_ACKNOWLEDGED if seen else AlertCondition.LATCHED_UNACKNOWLEDGED
        return replace(standing, condition=latched)
    # Nobody was called while it was suppressed, so nobody need answer.
    gone = seen or bool(standing.suppressions)
    return replace(standing, condition=AlertCondition.NORMAL if gone else AlertCondition.RETURNED)


def _acknowledged(standing: AlertStatus) -> AlertStatus:
    if standing.closed:
        raise Forbidden("the alert is closed: there is nothing to acknowledge")
    if standing.suppressions:
        raise Forbidden(f"the alert is {standing.state}: end that first")
    following = {
        AlertCondition.UNACKNOWLEDGED: AlertCondition.ACKNOWLEDGED,
        AlertCondition.RETURNED: AlertCondition.NORMAL,
        AlertCondition.LATCHED_UNACKNOWLEDGED: AlertCondition.LATCHED_ACKNOWLEDGED,
    }
    if standing.condition not in following:
        raise Forbidden("the alert is acknowledged already")
    return replace(standing, condition=following[standing.condition])


def _reset(standing: AlertStatus) -> AlertStatus:
    if standing.condition not in LATCHED:
        raise Forbidden(f"the alert is {standing.condition}, not latched: only a latched alert is reset")
    if standing.condition is AlertCondition.LATCHED_UNACKNOWLEDGED:
        raise Forbidden("the alert is not acknowledged yet: acknowledge it, then reset it")
    return replace(standing, condition=AlertCondition.NORMAL)


def _released(standing: AlertStatus, suppression: Suppression) -> AlertStatus:
    if suppression not in standing.suppressions:
        raise Forbidden(f"the alert is not {suppression}")
    left = standing.suppressions - {suppression}
    condition = standing.condition
    if not left and condition is AlertCondition.ACKNOWLEDGED:
        condition = AlertCondition.UNACKNOWLEDGED  # it calls again: who acknowledged it may long be gone
    return replace(standing, condition=condition, suppressions=left)
