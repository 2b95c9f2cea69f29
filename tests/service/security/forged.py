"""Credentials that open nothing, each for a reason of its own."""

import base64
import hashlib
import hmac
import json
from collections.abc import Mapping
from functools import cache

import jwt
from cryptography.hazmat.primitives.asymmetric import rsa

from tests.service.security.issuer import AUDIENCE, Issuer

FAR = 32_503_680_000
"""The year 3000 [s]."""
KINDS = (
    "no key",
    "a made-up key",
    "another secret behind a prefix",
    "an expired key",
    "a revoked key",
    "another scheme",
    "a cookie of nobody",
    "a bad signature",
    "alg=none",
    "HS256 by the public key",
    "another key under a known id",
    "another key under its own id",
    "expired",
    "not valid yet",
    "without an end",
    "a wrong audience",
    "no audience",
    "another issuer",
)


def refused(issuer: Issuer, keys: Mapping[str, str]) -> dict[str, dict[str, str]]:
    """Headers by kind."""
    texts = {
        "a made-up key": "rundown_abcdef12_" + "A" * 43,
        "another secret behind a prefix": keys["admin"][:-4] + "AAAA",
        "an expired key": keys["expired"],
        "a revoked key": keys["revoked"],
        "a bad signature": _changed(issuer.token(rundown_role="admin")),
        "alg=none": jwt.encode(_claims(issuer), None, algorithm="none", headers={"kid": "r1"}),  # type: ignore[arg-type]
        "HS256 by the public key": _by_public_key(issuer),
        "another key under a known id": jwt.encode(_claims(issuer), _another(), "RS256", headers={"kid": "r1"}),
        "another key under its own id": jwt.encode(_claims(issuer), _another(), "RS256", headers={"kid": "x9"}),
        "expired": issuer.token(exp=1, iat=0, rundown_role="admin"),
        "not valid yet": issuer.token(nbf=FAR, rundown_role="admin"),
        "without an end": issuer.token(exp=None, rundown_role="admin"),
        "a wrong audience": issuer.token(aud="historian", rundown_role="admin"),
        "no audience": issuer.token(aud=None, rundown_role="admin"),
        "another issuer": issuer.token(iss="https://elsewhere.example", rundown_role="admin"),
    }
    others = {
        "no key": {},
        "another scheme": {"Authorization": "Basic YWRtaW46YWRtaW4="},
        "a cookie of nobody": {"Cookie": "rundown_session=made-up"},
    }
    return others | {kind: {"Authorization": f"Bearer {text}"} for kind, text in texts.items()}


def _claims(issuer: Issuer) -> dict[str, object]:
    """Return claims of an administrator of everything, without an end."""
    all_of_it = {"rundown_role": "admin", "rundown_plants": "*"}
    return {"iss": issuer.url, "aud": AUDIENCE, "sub": "mallory", "exp": FAR} | all_of_it


def _changed(token: str) -> str:
    """The same with one character of the signature changed."""
    return token[:-10] + ("A" if token[-10] != "A" else "B") + token[-9:]


@cache
def _another() -> rsa.RSAPrivateKey:
    return rsa.generate_private_key(public_exponent=65537, key_size=2048)


def _by_public_key(issuer: Issuer) -> str:
    """Return what is taken where the token chooses its algorithm: signed by something that everybody knows."""
    known = issuer.key_set()["keys"][0]["n"].encode()
    signed = f"{_part({'alg': 'HS256', 'kid': 'r1'})}.{_part(_claims(issuer))}"
    return f"{signed}.{_encoded(hmac.digest(known, signed.encode(), hashlib.sha256))}"


def _part(what: object) -> str:
    return _encoded(json.dumps(what).encode())


def _encoded(data: bytes) -> str:
    return base64.urlsafe_b64encode(data).rstrip(b"=").decode()
