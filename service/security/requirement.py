"""Requirements of operations on their callers, declared with the operation."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from fastapi import Depends, HTTPException, Request, status
from fastapi.params import Depends as Dependency

from service.security.principal import Principal
from service.security.role import Role


@dataclass(frozen=True)
class Requirement:
    """Requirement of an operation.

    role: the least role; None: neither role nor credentials are needed. sources: the role source is enough, too. every_plant:
    only for principals who see all plants. recorded: changes are written to the audit trail.
    """

    role: Role | None
    sources: bool = False
    every_plant: bool = False
    recorded: bool = True

    def met(self, who: Principal) -> bool:
        """Check whether a principal has the role; the plants are checked where the object is known."""
        if self.every_plant and who.plants is not None:
            return False
        return self.role is None or (
            who.role is not None and (who.role >= self.role or (self.sources and who.role is Role.SOURCE))
        )

    async def __call__(self, request: Request) -> None:
        """Check the principal set by the guard; without a guard every request is refused."""
        who = getattr(request.state, "principal", None)
        if who is None or not self.met(who):
            raise HTTPException(status.HTTP_403_FORBIDDEN, "this operation needs another role")

    @property
    def words(self) -> str:
        """Return the requirement in words."""
        if self.role is None:
            return "nothing"
        also = " or source" if self.sources else ""
        return f"the role {self.role.label}{also}{' for all plants' if self.every_plant else ''}"


ANYBODY = Depends(Requirement(None, recorded=False))
VIEWER = Depends(Requirement(Role.VIEWER))
ANALYST = Depends(Requirement(Role.ANALYST))
OPERATOR = Depends(Requirement(Role.OPERATOR))
ADMIN = Depends(Requirement(Role.ADMIN))
SOURCE = Depends(Requirement(Role.OPERATOR, sources=True, recorded=False))
ADMIN_OF_ALL = Depends(Requirement(Role.ADMIN, every_plant=True))


def strictest(dependencies: Sequence[Dependency] | None) -> Requirement | None:
    """Combine the requirements of a router and its operation; None where nothing is declared."""
    found: list[Any] = [one.dependency for one in dependencies or () if isinstance(one.dependency, Requirement)]
    if not found:
        return None
    return max(found, key=lambda one: -1 if one.role is None else one.role)  # type: ignore[no-any-return]
