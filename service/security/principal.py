"""The principal of a request: a person or a program, with a role and the plants that it concerns."""

from contextvars import ContextVar
from dataclasses import dataclass
from enum import IntEnum
from typing import Annotated, Literal

from pydantic import BeforeValidator, StringConstraints

from storage.database.plant_scope import Plants


class Role(IntEnum):
    """Roles; each may do what those before it may. A source only sends samples."""

    SOURCE = 0
    VIEWER = 1
    ANALYST = 2
    OPERATOR = 3
    ADMIN = 4

    @property
    def label(self) -> str:
        """Write the role as in keys, tokens and answers."""
        return self.name.lower()

    @classmethod
    def of(cls, label: str) -> "Role":
        """Return the role of a label. Raises ValueError."""
        try:
            return cls[label.upper()]
        except KeyError:
            raise ValueError(f"'{label}' is no role; there are {', '.join(role.label for role in cls)}") from None


Kind = Literal["open", "anonymous", "key", "token", "session"]


@dataclass(frozen=True)
class Principal:
    """A person or a program. kind: open, where the service asks nobody who they are; plants: None for all.

    identity: unambiguous, for the audit trail and for limits; token: what a change from a browser must bring along.
    """

    name: str
    role: Role | None
    plants: Plants | None
    kind: Kind
    identity: str
    token: str | None = None

    @property
    def known(self) -> bool:
        """Tell whether it is known who this is."""
        return self.kind in ("key", "token", "session")

    @property
    def in_full(self) -> str:
        """Name and identity, for the audit trail."""
        return self.identity if self.name in self.identity else f"{self.name} ({self.identity})"

    def sees(self, plant: str | None) -> bool:
        """Tell whether a plant concerns them; None: something of no plant that is known."""
        return self.plants is None or (plant is not None and plant in self.plants)


OPEN = Principal("", Role.ADMIN, None, "open", "open")
"""Anybody, on loopback, as long as there is neither a key nor an issuer."""
ANONYMOUS = Principal("", None, frozenset(), "anonymous", "anonymous")
"""Somebody without credentials, where some are needed."""

current: ContextVar[Principal] = ContextVar("principal", default=OPEN)
"""Who asks what is being answered."""

MOST_CHARACTERS = 120


def _author(said: object) -> object:
    who = current.get()
    return who.name[:MOST_CHARACTERS] if who.known else said


Author = Annotated[
    str, BeforeValidator(_author), StringConstraints(min_length=1, max_length=MOST_CHARACTERS, pattern=r"^[^\x00-\x1f]*$")
]
"""Who does something: who is logged in, whatever they call themselves; where nobody is, the name that was given."""
