"""Signatures of webhooks by the Standard Webhooks rules: HMAC-SHA256 over id, time and body.

Source: Standard Webhooks specification 1.0, "symmetric signatures".
"""

import base64
import hashlib
import hmac
import secrets

PREFIX = "whsec_"
SECRET_BYTES = 32


def new_secret() -> str:
    """Generate a random secret."""
    return PREFIX + base64.b64encode(secrets.token_bytes(SECRET_BYTES)).decode()


def key_of(secret: str) -> bytes:
    """Return the key in a secret. Raises ValueError for a malformed one."""
    try:
        return base64.b64decode(secret.removeprefix(PREFIX), validate=True)
    except ValueError:
        raise ValueError(f"a secret is {PREFIX} and base64") from None


def signed_headers(secret: str, *, message_id: str, seconds: int, body: bytes) -> dict[str, str]:
    """Return the headers that authenticate a body and its time. Raises ValueError for a malformed secret."""
    signature = hmac.new(key_of(secret), f"{message_id}.{seconds}.".encode() + body, hashlib.sha256).digest()
    return {
        "webhook-id": message_id,
        "webhook-timestamp": str(seconds),
        "webhook-signature": f"v1,{base64.b64encode(signature).decode()}",
    }
