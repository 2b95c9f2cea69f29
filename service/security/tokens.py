"""Bearer tokens of an issuer (JWT, RFC 7519, verified after RFC 8725): RS256 and ES256 only, with the issuer's keys."""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import jwt

from service.security.key_set import KeySet
from service.security.principal import MAXIMUM_CHARACTERS, Principal
from service.security.role import Role
from storage.encoding.text import plain_text

LEEWAY_S = 30.0
EVERY_PLANT = "*"
LONGEST = 8192
LONGEST_SUBJECT = 64
"""Largest length of a subject shown in full; longer ones are shortened, with a digest."""


class TokenRefused(ValueError):
    """A token is not accepted; the message says why."""


@dataclass(frozen=True)
class Claims:
    """Names of claims. role, plants, name: paths of claims, with dots between levels; roles: roles by the issuer's names."""

    role: str = "rundown_role"
    plants: str = "rundown_plants"
    name: str = "name"
    roles: Mapping[str, str] = field(default_factory=dict)


class Tokens:
    """Tokens of one issuer for one audience."""

    def __init__(self, *, issuer: str, audience: str, keys: KeySet, claims: Claims) -> None:
        self._issuer = issuer
        self._audience = audience
        self._keys = keys
        self._claims = claims

    def principal(self, token: str) -> Principal:
        """Return the principal of a token. Blocks while keys are fetched. Raises TokenRefused, KeysUnavailable."""
        return self.stands_for(self.checked(token, audience=self._audience))

    def stands_for(self, claims: Mapping[str, Any]) -> Principal:
        """Return the principal of checked claims."""
        subject = str(claims["sub"])
        name = str(_inside(claims, self._claims.name) or claims.get("preferred_username") or subject)
        return Principal(_display_name(name, subject), self._role(claims), self._plants(claims), "token", f"token {subject}")

    def checked(self, token: str, *, audience: str, nonce: str | None = None) -> dict[str, Any]:
        """Verify a token of the issuer for an audience, and return its claims. Raises as `principal`."""
        if len(token) > LONGEST:
            raise TokenRefused(f"a token of more than {LONGEST} characters")
        try:
            header = jwt.get_unverified_header(token)
            if header.get("alg") not in ("RS256", "ES256"):
                raise TokenRefused(f"signed by {str(header.get('alg'))[:20]}: RS256 or ES256 is needed")
            found = self._keys.find(header.get("kid"))
            if found is None or found[0] != header["alg"]:
                raise TokenRefused("signed with a key that the issuer does not publish")
            claims: dict[str, Any] = jwt.decode(
                token,
                found[1],
                algorithms=[found[0]],
                audience=audience,
                issuer=self._issuer,
                leeway=LEEWAY_S,
                options={"require": ["exp", "iss", "aud", "sub"]},
            )
        except jwt.PyJWTError as error:
            raise TokenRefused(str(error)) from error
        if nonce is not None and claims.get("nonce") != nonce:
            raise TokenRefused("made for another login")
        return claims

    def _role(self, claims: Mapping[str, Any]) -> Role | None:
        """Return the highest known role of the claims; None, which permits nothing, without one."""
        found = []
        for said in _words(_inside(claims, self._claims.role)):
            label = self._claims.roles.get(said, said)
            if label in {role.label for role in Role}:
                found.append(Role.of(label))
        return max(found, default=None)

    def _plants(self, claims: Mapping[str, Any]) -> frozenset[str] | None:
        """Return the plants of the claims; none without the claim, None for all."""
        said = frozenset(_words(_inside(claims, self._claims.plants)))
        return None if EVERY_PLANT in said else said


def _display_name(name: str, subject: str) -> str:
    """Return the name followed by the subject: people may choose their names, the issuer assigns the subject."""
    shown = plain_text(subject)
    if len(shown) > LONGEST_SUBJECT:
        digest = hashlib.sha256(subject.encode("utf-8", "backslashreplace")).hexdigest()[:16]
        shown = f"{shown[: LONGEST_SUBJECT - 17]}…{digest}"
    return f"{plain_text(name)[: MAXIMUM_CHARACTERS - len(shown) - 3]} ({shown})"


def _inside(claims: Mapping[str, Any], path: str) -> Any:
    if path in claims:
        return claims[path]
    found: Any = claims
    for part in path.split("."):
        found = found.get(part) if isinstance(found, Mapping) else None
    return found


def _words(value: Any) -> list[str]:
    if isinstance(value, str):
        return value.split()
    return [one for one in value if isinstance(one, str)] if isinstance(value, list) else []
