"""The principal of a request: a person or a program, with a role and the plants that they may see."""

from contextvars import ContextVar
from dataclasses import dataclass
from typing import Annotated, Literal

from pydantic import BeforeValidator, StringConstraints

from service.security.role import Role
from storage.database.plant_scope import Plants

PrincipalKind = Literal["open", "anonymous", "key", "token", "session"]


@dataclass(frozen=True)
class Principal:
    """A person or a program.

    kind: open where the service asks for no credentials. plants: None for all. identity: unambiguous, for the audit trail and
    for limits. token: required with a change from a browser.
    """

    name: str
    role: Role | None
    plants: Plants | None
    kind: PrincipalKind
    identity: str
    token: str | None = None

    @property
    def known(self) -> bool:
        """Check whether this principal was authenticated."""
        return self.kind in ("key", "token", "session")

    @property
    def in_full(self) -> str:
        """Return name and identity, for the audit trail."""
        return self.identity if self.name in self.identity else f"{self.name} ({self.identity})"

    def sees(self, plant: str | None) -> bool:
        """Check whether a plant is visible; None stands for an object whose plant is unknown."""
        return self.plants is None or (plant is not None and plant in self.plants)


OPEN = Principal("", Role.ADMIN, None, "open", "open")
"""Everybody on loopback, as long as there is neither a key nor an issuer."""
ANONYMOUS = Principal("", None, frozenset(), "anonymous", "anonymous")
"""A client without credentials, where some are needed."""

current: ContextVar[Principal] = ContextVar("principal", default=OPEN)
"""Principal of the request that is being handled."""

MAXIMUM_CHARACTERS = 120


def _author(said: object) -> object:
    who = current.get()
    return who.name[:MAXIMUM_CHARACTERS] if who.known else said


Author = Annotated[
    str, BeforeValidator(_author), StringConstraints(min_length=1, max_length=MAXIMUM_CHARACTERS, pattern=r"^[^\x00-\x1f]*$")
]
"""Author of a change: the authenticated principal, whatever name was given; without authentication the given name."""
