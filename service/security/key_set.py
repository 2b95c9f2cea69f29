"""The issuer's public keys (JWKS, RFC 7517) from a file or a URL: cached, and fetched again when a token names a new one."""

import json
import logging
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jwt
from cryptography.hazmat.primitives.asymmetric.ec import SECP256R1, EllipticCurvePublicKey
from cryptography.hazmat.primitives.asymmetric.rsa import RSAPublicKey

from estimator.errors import Unavailable

logger = logging.getLogger(__name__)

KEPT_S = 600.0
"""Lifetime of fetched keys [s]: a withdrawn key works for no longer."""
STALE_S = 6 * 3600.0
"""Lifetime of keys while the issuer does not answer [s]."""
RETRY_S = 30.0
"""Least time between fetches [s]: anybody can invent tokens with unknown keys."""
LARGEST = 256 * 1024
SMALLEST_RSA_BITS = 2048
PATIENCE_S = 5.0

PublicKey = RSAPublicKey | EllipticCurvePublicKey
ALGORITHM: dict[str, str] = {"RSA": "RS256", "EC": "ES256"}


class KeysUnavailable(Unavailable):
    """The issuer's keys cannot be fetched; the message says from where and why."""


class KeySet:
    """Keys by their id. where: a path or a URL, or a function that returns one when it is needed."""

    def __init__(self, where: str | Callable[[], str], *, clock: Callable[[], float] = time.monotonic) -> None:
        self._where = where
        self._clock = clock
        self._lock = threading.Lock()
        self._keys: dict[str, tuple[str, PublicKey]] = {}
        self._read_at: float | None = None
        self._tried_at: float | None = None

    def find(self, key_id: str | None) -> tuple[str, PublicKey] | None:
        """Return algorithm and key of an id; without an id the only key. Blocks during a fetch. Raises KeysUnavailable."""
        with self._lock:
            now = self._clock()
            old = self._read_at is None or now - self._read_at > KEPT_S
            if old or self._chosen(key_id) is None:
                self._fetch(now)
            if self._read_at is None or now - self._read_at > STALE_S:
                raise KeysUnavailable(f"the issuer's keys are unavailable: they are fetched again every {RETRY_S:.0f} s")
            return self._chosen(key_id)

    def _chosen(self, key_id: str | None) -> tuple[str, PublicKey] | None:
        if key_id is None:
            return next(iter(self._keys.values())) if len(self._keys) == 1 else None
        return self._keys.get(key_id)

    def _fetch(self, now: float) -> None:
        if self._tried_at is not None and now - self._tried_at < RETRY_S:
            return
        self._tried_at = now
        try:
            self._keys = _parsed(json.loads(self._text()))
            self._read_at = now
        except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
            logger.error("the issuer's keys cannot be read: %s", error)

    def _text(self) -> bytes:
        where = self._where if isinstance(self._where, str) else self._where()
        return fetched(where) if where.startswith(("http://", "https://")) else Path(where).read_bytes()


def fetched(url: str, **post: Any) -> bytes:
    """Fetch an answer of the issuer; `data` posts a form. Redirects are not followed. Raises ConnectionError, ValueError."""
    import httpx  # half a second at every start, needed only with an issuer

    parts, size = [], 0
    try:
        with httpx.stream("POST" if post else "GET", url, timeout=PATIENCE_S, follow_redirects=False, **post) as answer:
            for part in answer.iter_bytes():
                parts.append(part)
                size += len(part)
                if size > LARGEST:
                    raise ValueError(f"more than {LARGEST} bytes")
    except httpx.HTTPError as error:
        raise ConnectionError(str(error)) from error
    if answer.status_code != httpx.codes.OK:
        raise ValueError(f"status {answer.status_code}: {b''.join(parts)[:200]!r}")
    return b"".join(parts)


def _parsed(document: Any) -> dict[str, tuple[str, PublicKey]]:
    """Return the keys for this service's signature algorithms; others are ignored."""
    found = {}
    for number, one in enumerate(document["keys"]):
        algorithm = ALGORITHM.get(one.get("kty", ""))
        if algorithm is None or one.get("use", "sig") != "sig" or one.get("alg", algorithm) != algorithm:
            continue
        try:
            key = jwt.PyJWK(one, algorithm).key
        except jwt.PyJWTError as error:  # an unknown curve or an incomplete key; the others remain usable
            logger.warning("a key of the issuer is not used: %s", error)
            continue
        if isinstance(key, RSAPublicKey) and key.key_size < SMALLEST_RSA_BITS:
            logger.warning("a key of the issuer has %d bits and is not used: %d are needed", key.key_size, SMALLEST_RSA_BITS)
            continue
        if isinstance(key, EllipticCurvePublicKey) and not isinstance(key.curve, SECP256R1):
            continue
        if isinstance(key, RSAPublicKey | EllipticCurvePublicKey):
            found[str(one.get("kid", f"#{number}"))] = (algorithm, key)
    return found
