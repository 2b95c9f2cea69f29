"""Checks the visibility of objects named by path parameters: those of other plants are answered with 404."""

from collections.abc import Mapping
from typing import Any

from sqlalchemy import select
from sqlalchemy.orm import Session

from estimator.close_matches import did_you_mean
from estimator.errors import Missing
from service.security.principal import Principal
from service.security.role import Role
from storage.database.engine import Database
from storage.database.plant_scope import PlantScope
from storage.tables.machines import MachineRow

ScopedRows = Mapping[str, tuple[type[Any], str]]
"""Table and subject of each path parameter."""
FREE = frozenset({"name", "path"})
"""Parameters that name files of the pages, which are public."""
LARGEST = 2**62
MAXIMUM_ENTRIES = 10_000


def machines_like(session: Session, who: Principal, name: str) -> str:
    """Return a clause that names the machines like one that is not there, of those that a session sees; empty without any.

    A principal who may not list machines, as a source, is named none.
    """
    return "" if who.role is None or who.role < Role.VIEWER else did_you_mean(name, session.scalars(select(MachineRow.id)))


class NotThere(Missing):
    """An object is absent or not visible; the answer is the same."""

    def __init__(self, subject: str, key: str, close: str = "") -> None:
        """Set up. close: a clause that names what is like it."""
        super().__init__(f"{key}{close}")
        self.subject = subject


class Visibility:
    """Visible rows of a database. An object never changes its plant, and look-ups are cached."""

    def __init__(self, database: Database, rows: ScopedRows) -> None:
        self._database = database
        self._rows = rows
        self._plants: dict[str, str] = {}
        self._seen: set[tuple[frozenset[str], str, str]] = set()

    def known(self, who: Principal, parameters: Mapping[str, str]) -> bool:
        """Check whether all of these objects are cached as visible."""
        return who.plants is None or all((who.plants, name, value) in self._seen for name, value in parameters.items())

    def require(self, who: Principal, parameters: Mapping[str, str]) -> None:
        """Require that a principal sees all of these objects. Raises NotThere."""
        if who.plants is None:
            return
        with PlantScope(self._database, who.plants).reading() as session:
            for name, value in parameters.items():
                row, what = self._rows[name]
                key = _key(row, value)
                if key is None:
                    continue  # the endpoint rejects it
                if session.get(row, key) is None:
                    raise NotThere(what, value[:64], machines_like(session, who, value[:64]) if row is MachineRow else "")
                if len(self._seen) >= MAXIMUM_ENTRIES:
                    self._seen.clear()
                self._seen.add((who.plants, name, value))

    def plant(self, machine_id: str) -> str | None:
        """Return the plant of a machine."""
        found = self._plants.get(machine_id)
        if found is None:
            with self._database.reading() as session:
                row = session.get(MachineRow, machine_id)
            if row is not None:
                found = self._plants[machine_id] = row.plant
        return found

    def sees(self, who: Principal, machine_id: str) -> bool:
        """Check whether a principal sees a machine."""
        return who.plants is None or who.sees(self.plant(machine_id))


def _key(row: type[Any], value: str) -> str | int | None:
    """Return the primary key for a text; None where the text cannot be one."""
    if row is MachineRow:
        return value if value.isprintable() else None
    digits = value.isascii() and value.isdigit() and len(value) <= len(str(LARGEST))
    return int(value) if digits and int(value) <= LARGEST else None
