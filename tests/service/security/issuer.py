"""A real issuer on loopback: keys, tokens, a key set over HTTP, and the two steps of a login."""

import hashlib
import json
import secrets
import threading
import time
from base64 import urlsafe_b64encode
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from types import TracebackType
from typing import Any, Self
from urllib.parse import parse_qs, urlencode, urlsplit

import jwt
from cryptography.hazmat.primitives.asymmetric import ec, rsa
from jwt.algorithms import ECAlgorithm, RSAAlgorithm

AUDIENCE = "rundown"
CLIENT = "rundown-page"
AN_HOUR = 3600
PrivateKey = rsa.RSAPrivateKey | ec.EllipticCurvePrivateKey


class Issuer:
    """Signs tokens by two published keys, `r1` and `e1`. claims: what the next login says of the person."""

    def __init__(self) -> None:
        self.keys: dict[str, PrivateKey] = {
            "r1": rsa.generate_private_key(public_exponent=65537, key_size=2048),
            "e1": ec.generate_private_key(ec.SECP256R1()),
        }
        self.published = ["r1", "e1"]
        self.asked = 0
        self.claims: dict[str, Any] = {"sub": "anna", "name": "Anna"}
        self._codes: dict[str, dict[str, str]] = {}
        issuer = self

        class IssuerHandler(BaseHTTPRequestHandler):
            def do_GET(self) -> None:
                where = urlsplit(self.path)
                if where.path == "/keys":
                    issuer.asked += 1
                    self._say(issuer.key_set())
                elif where.path == "/.well-known/openid-configuration":
                    self._say(issuer.configuration())
                else:
                    self.send_response(303)
                    self.send_header("Location", issuer.authorized(dict(x for x in _pairs(where.query))))
                    self.end_headers()

            def do_POST(self) -> None:
                form = dict(_pairs(self.rfile.read(int(self.headers["content-length"])).decode()))
                answer = issuer.exchanged(form)
                self._say(answer, 200 if "id_token" in answer else 400)

            def _say(self, what: Any, status: int = 200) -> None:
                body = json.dumps(what).encode()
                self.send_response(status)
                self.send_header("Content-Type", "application/json")
                self.send_header("Content-Length", str(len(body)))
                self.end_headers()
                self.wfile.write(body)

            def log_message(self, format: str, *args: Any) -> None:
                """Log nothing."""

        self._server = ThreadingHTTPServer(("127.0.0.1", 0), IssuerHandler)
        self.url = f"http://127.0.0.1:{self._server.server_address[1]}"
        self._thread = threading.Thread(target=self._server.serve_forever, kwargs={"poll_interval": 0.02})

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self._server.shutdown()
        self._thread.join()
        self._server.server_close()

    def key_set(self) -> dict[str, Any]:
        """The published keys."""
        return {"keys": [public(name, self.keys[name]) for name in self.published]}

    def configuration(self) -> dict[str, str]:
        """Return the document that OpenID Connect Discovery asks for."""
        return {
            "issuer": self.url,
            "jwks_uri": f"{self.url}/keys",
            "authorization_endpoint": f"{self.url}/authorize",
            "token_endpoint": f"{self.url}/token",
        }

    def token(self, *, key: str = "r1", algorithm: str | None = None, kid: str | None = None, **changes: Any) -> str:
        """A token; a change of None leaves a claim out."""
        now = int(time.time())
        claims = {"iss": self.url, "aud": AUDIENCE, "sub": "anna", "name": "Anna", "iat": now, "exp": now + AN_HOUR}
        claims |= {"rundown_role": "viewer", "rundown_plants": "*"} | changes
        held = self.keys[key]
        natural = "RS256" if isinstance(held, rsa.RSAPrivateKey) else "ES256"
        claims = {name: value for name, value in claims.items() if value is not None}
        return jwt.encode(claims, held, algorithm or natural, headers={"kid": kid or key})

    def authorized(self, asked: dict[str, str]) -> str:
        """Return where a browser goes on after a login that needs no clicking."""
        code = secrets.token_urlsafe(8)
        self._codes[code] = asked
        return f"{asked['redirect_uri']}?{urlencode({'code': code, 'state': asked['state']})}"

    def exchanged(self, form: dict[str, str]) -> dict[str, Any]:
        """An ID token for a code, once, to who knows the verifier."""
        asked = self._codes.pop(form.get("code", ""), None)
        if asked is None:
            return {"error": "invalid_grant"}
        challenge = urlsafe_b64encode(hashlib.sha256(form["code_verifier"].encode()).digest()).rstrip(b"=").decode()
        if challenge != asked["code_challenge"] or asked["code_challenge_method"] != "S256":
            return {"error": "invalid_grant"}
        if form["redirect_uri"] != asked["redirect_uri"] or form["client_id"] != asked["client_id"]:
            return {"error": "invalid_grant"}
        return {"id_token": self.token(aud=CLIENT, nonce=asked["nonce"], **self.claims)}


def public(name: str, key: PrivateKey) -> dict[str, Any]:
    """A key as a key set has it."""
    made = (
        RSAAlgorithm.to_jwk(key.public_key(), as_dict=True)
        if isinstance(key, rsa.RSAPrivateKey)
        else ECAlgorithm.to_jwk(key.public_key(), as_dict=True)
    )
    return dict(made) | {"kid": name, "use": "sig"}


def _pairs(query: str) -> list[tuple[str, str]]:
    return [(name, values[0]) for name, values in parse_qs(query).items()]
