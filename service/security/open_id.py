"""Login at an issuer: OpenID Connect's authorization code flow with PKCE (RFC 7636), state and nonce."""

import hashlib
import json
import secrets
import threading
import time
from base64 import urlsafe_b64encode
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any
from urllib.parse import urlencode

from service.configuration.hosts import encrypted
from service.security.key_set import fetched

KNOWN_FOR_S = 3600.0
CALLBACK = "/login/callback"


class LoginFailed(ValueError):
    """A login failed; the message says why."""


@dataclass(frozen=True)
class LoginAttempt:
    """A login under way.

    url: address to send the browser to. state: returned by the browser. verifier, nonce: secrets for its completion.
    """

    url: str
    state: str
    verifier: str
    nonce: str


class OpenId:
    """An issuer at which people log in, as the client `client_id`; they return to `public_url`."""

    def __init__(
        self,
        *,
        issuer: str,
        client_id: str,
        client_secret: str,
        scope: str,
        public_url: str,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._issuer = issuer
        self.client_id = client_id
        self._client_secret = client_secret
        self._scope = scope
        self._redirect_uri = public_url.rstrip("/") + CALLBACK
        self._clock = clock
        self._lock = threading.Lock()
        self._found: tuple[float, dict[str, Any]] | None = None

    def begin(self) -> LoginAttempt:
        """Begin a login. Blocks. Raises LoginFailed."""
        state, nonce, verifier = (secrets.token_urlsafe(32) for _ in range(3))
        challenge = urlsafe_b64encode(hashlib.sha256(verifier.encode()).digest()).rstrip(b"=").decode()
        asked = {
            "response_type": "code",
            "client_id": self.client_id,
            "redirect_uri": self._redirect_uri,
            "scope": self._scope,
            "state": state,
            "nonce": nonce,
            "code_challenge": challenge,
            "code_challenge_method": "S256",
        }
        return LoginAttempt(f"{self._endpoint('authorization_endpoint')}?{urlencode(asked)}", state, verifier, nonce)

    def finish(self, answer: Mapping[str, str], *, verifier: str) -> str:
        """Return the unverified ID token of a login that was begun here. Blocks. Raises LoginFailed."""
        if answer.get("iss", self._issuer) != self._issuer:
            raise LoginFailed("another issuer answered")
        if "code" not in answer:
            raise LoginFailed(f"the issuer refused: {answer.get('error', 'it gave no code')[:200]}")
        form = {
            "grant_type": "authorization_code",
            "code": answer["code"],
            "redirect_uri": self._redirect_uri,
            "client_id": self.client_id,
            "code_verifier": verifier,
        }
        if self._client_secret:
            form["client_secret"] = self._client_secret
        try:
            said = json.loads(fetched(self._endpoint("token_endpoint"), data=form))
            return str(said["id_token"])
        except (ConnectionError, ValueError, KeyError, TypeError) as error:
            raise LoginFailed("the issuer gave no ID token for the code") from error

    def keys_url(self) -> str:
        """Return the address of the issuer's keys. Raises LoginFailed."""
        return self._endpoint("jwks_uri")

    def _endpoint(self, name: str) -> str:
        with self._lock:
            if self._found is None or self._clock() - self._found[0] > KNOWN_FOR_S:
                self._found = self._clock(), self._discovered()
            url = str(self._found[1].get(name, ""))
        if not encrypted(url):
            raise LoginFailed(f"the issuer's {name} is not an https URL")
        return url

    def _discovered(self) -> dict[str, Any]:
        """Read the issuer's configuration. Source: OpenID Connect Discovery 1.0."""
        try:
            said = json.loads(fetched(self._issuer.rstrip("/") + "/.well-known/openid-configuration"))
            if said["issuer"] != self._issuer:
                raise LoginFailed(f"the issuer calls itself '{str(said['issuer'])[:200]}', not '{self._issuer}'")
            return dict(said)
        except (ConnectionError, ValueError, KeyError, TypeError) as error:
            raise LoginFailed(f"the issuer's configuration cannot be read: {error}") from error
