"""Reads what has changed in the store since the last look, for the server's address space."""

import logging
from collections.abc import Hashable
from dataclasses import dataclass, field

import msgspec
from sqlalchemy.exc import DBAPIError
from sqlalchemy.orm import Session

from service.advice.site_texts import SiteTexts
from service.opcua.alert_reading import AlertReading, events_since, open_readings
from service.opcua.machine_reading import MachineReading, read_machine
from service.opcua.unshown import Unshown, machine_name
from service.runs.collection_state import CollectionState
from storage.alerts import alerts
from storage.clock import now
from storage.database.change_counts import Changes
from storage.database.engine import Database
from storage.database.errors import error_message, is_database_wide
from storage.machines import fleet
from storage.machines.fleet import MachineGlance

logger = logging.getLogger(__name__)

TABLES = (*fleet.TABLES, "estimates", "derived_quantities")
"""Tables of which anything but speeds and states is read."""
STANDINGS = ("collectors",)
STANDINGS_NS = 500_000_000
"""Shortest time between looks at speeds and states, which change with every sample block [ns]."""
AGAIN_NS = 60_000_000_000
"""Time within which each machine is read again whatever seems to have changed [ns]."""
EVENTS = 500
"""Largest number of alert events in one look; more come with the next."""


@dataclass
class PlantChanges:
    """Changes since the last look. alerts: one entry an event; standings: states of run collection by machine."""

    machines: list[MachineReading] = field(default_factory=list)
    standings: dict[str, CollectionState] = field(default_factory=dict)
    alerts: list[AlertReading] = field(default_factory=list)


class PlantReader:
    """The state of all plants as last read. Its methods block, and are called one at a time."""

    def __init__(self, database: Database, texts: SiteTexts | None = None, unshown: Unshown | None = None) -> None:
        """Set up. unshown: takes the names of what cannot be read."""
        self._unshown = unshown or Unshown()
        self._alert_texts = texts or SiteTexts()
        self._database = database
        self._changes = Changes(database)
        self._mark: Hashable | None = None
        self._standings_mark: Hashable | None = None
        self._standings_at = 0
        self._glances: dict[str, MachineGlance] = {}
        self._texts: dict[str, str] = {}
        self._read_at: dict[str, int] = {}
        self._event = 0

    def open_alerts(self) -> list[AlertReading]:
        """Read the open alerts, and note the newest event: `read_changes` begins behind it."""
        with self._database.reading() as session:
            self._event = alerts.newest_event(session)
            return open_readings(session, self._alert_texts, self._unshown)

    def read_changes(self) -> PlantChanges:
        """Read what has changed since the last call. Raises DBAPIError; a later call then returns what this one has missed."""
        try:
            return self._read_all()
        except Exception:
            self._mark = self._standings_mark = None
            self._glances.clear()
            self._texts.clear()
            raise

    def _read_all(self) -> PlantChanges:
        found = PlantChanges()
        if now() >= self._standings_at + STANDINGS_NS:
            found.standings = self._standings()
        mark, aged = self._changes.mark(TABLES), self._aged()
        if mark is not None and mark == self._mark and aged is None:
            return found
        with self._database.reading() as session:
            told = events_since(session, self._event, self._alert_texts, self._unshown, limit=EVENTS)
            found.machines = self._machines(session, aged)
        found.alerts, self._event = told.readings, told.last
        # As long as a look is full, there may be more behind it.
        self._mark = mark if told.many < EVENTS else None
        return found

    def _machines(self, session: Session, aged: str | None) -> list[MachineReading]:
        listed = fleet.list_all(session)
        found = []
        for glance in fleet.glances(session, listed, since=now()):
            name = glance.machine.id
            if name != aged and self._glances.get(name) == glance:
                continue
            try:
                found.append(read_machine(session, glance))
            except (DBAPIError, ValueError) as error:
                if isinstance(error, DBAPIError) and is_database_wide(error):
                    raise
                logger.error("machine '%s' is not shown over OPC UA: it cannot be read: %s", name, error_message(error))
                self._unshown.note(machine_name(name))
            self._glances[name] = glance
            self._read_at[name] = now()
        return found

    def _aged(self) -> str | None:
        """Return the machine that was read longest ago, if that is too long ago: no glance shows every change."""
        if not self._read_at:
            return None
        name = min(self._read_at, key=lambda one: self._read_at[one])
        return name if now() >= self._read_at[name] + AGAIN_NS else None

    def _standings(self) -> dict[str, CollectionState]:
        mark = self._changes.mark(STANDINGS)
        self._standings_at = now()
        if mark is not None and mark == self._standings_mark:
            return {}
        with self._database.reading() as session:
            texts = fleet.collectors(session)
        self._standings_mark = mark
        changed = {name: text for name, text in texts.items() if self._texts.get(name) != text}
        self._texts |= changed
        found = ((name, _standing(name, text)) for name, text in changed.items())
        return {name: one for name, one in found if one is not None}


def _standing(machine: str, text: str) -> CollectionState | None:
    """Return the state of a machine's run collection; None where it cannot be read."""
    try:
        return CollectionState.restored(msgspec.json.decode(text))
    except (ValueError, TypeError, KeyError, AttributeError) as error:
        logger.error("the state of machine '%s' is not shown over OPC UA: it cannot be read: %r", machine, error)
        return None
