"""Users of OPC UA clients: the service's API keys, given as a user name and a password, and an issuer's tokens.

The user name is the key's name and the password the key itself; a token comes without a name. Where the service needs no
credentials, OPC UA needs none either: then the user name, or the application's name, says who does something, as a name does
over HTTP.
"""

import logging
from dataclasses import dataclass, replace
from typing import Any

from asyncua.crypto.permission_rules import User, UserRole

from service.security.authentication import Authentication, Unauthenticated
from service.security.key_set import KeysUnavailable
from service.security.principal import MAXIMUM_CHARACTERS, OPEN, Principal
from service.security.role import Role

logger = logging.getLogger(__name__)

SOMEBODY = "OPC UA client"


@dataclass
class ClientUser(User):
    """A user of the library's, with the principal behind it. secret: the key or token that was given."""

    role: UserRole = UserRole.User
    principal: Principal = OPEN
    secret: str = ""


class ClientUsers:
    """Users by API key. `needed` is renewed from time to time: a first key is noticed then, and credentials stay needed."""

    def __init__(self, authentication: Authentication) -> None:
        self._authentication = authentication
        self.needed = True
        """Whether credentials are needed."""

    async def refresh(self) -> None:
        """Look whether credentials are needed by now. Raises DBAPIError."""
        self.needed = await self._authentication.on()

    def get_user(
        self, iserver: object, username: str | None = None, password: str | None = None, certificate: Any = None
    ) -> ClientUser | None:
        """Return the user of a name and a key; None for anybody else. Raises DBAPIError."""
        del iserver, certificate  # they say which application it is, not who uses it
        if not self.needed:
            name = "".join(one for one in username or "" if one.isprintable())[:MAXIMUM_CHARACTERS]
            return ClientUser(name=name, principal=replace(OPEN, name=name))
        found = self._of_token(password) if username is None and password else self._of_key(password or "")
        if found is None or username not in (None, found.name):
            return None
        return ClientUser(name=found.name, principal=found, secret=password or "")

    def still_valid(self, user: ClientUser) -> bool:
        """Return whether the rights of a user's session are still valid. Raises DBAPIError."""
        if user.principal.kind == "open":
            return not self.needed
        found = self._of_token(user.secret) if user.principal.kind == "token" else self._of_key(user.secret)
        return found == user.principal

    def prepare(self, token: str) -> None:
        """Look at an issuer's token beforehand: its keys may have to be fetched. Blocks."""
        if token:
            self._of_token(token)

    def _of_key(self, text: str) -> Principal | None:
        try:
            found = self._authentication.key(text)
        except Unauthenticated:
            return None
        return _person(found)

    def _of_token(self, text: str) -> Principal | None:
        try:
            return _person(self._authentication.token(text))
        except Unauthenticated as error:
            logger.info("OPC UA: %s", error)
        except KeysUnavailable as error:
            logger.warning("OPC UA: a token cannot be checked: %s", error)
        return None


def _person(found: Principal) -> Principal | None:
    """Return the principal if its role may use OPC UA: a source only sends samples."""
    return found if found.role is not None and found.role >= Role.VIEWER else None


def named(user: ClientUser, application: str) -> ClientUser:
    """Return a user who gave no name under their application's."""
    if user.principal.name:
        return user
    words = "".join(one for one in f"{SOMEBODY} {application}".strip() if one.isprintable())
    return replace(user, principal=replace(user.principal, name=words[:MAXIMUM_CHARACTERS]))
