"""Text and JSON that every database accepts: no NUL, no lone surrogates, no NaN and no infinity."""

import json
import math
import re
from typing import Any


def plain_text(text: str) -> str:
    """Return a text with control characters and lone surrogates escaped: PostgreSQL rejects NUL, and every database lone
    surrogates."""
    return "".join(c if c.isprintable() or c == " " else c.encode("unicode_escape").decode() for c in text)


def plain_lines(text: str) -> str:
    """Return a text of several lines, each escaped by `plain_text`."""
    return "\n".join(map(plain_text, text.split("\n")))


def nul_escaped(text: str) -> str:
    """Return a text with NUL as `\\x00` and backslashes doubled, for `nul_back`; a text without NUL unchanged."""
    return text.replace("\\", "\\\\").replace("\0", "\\x00") if "\0" in text else text


def nul_unescaped(text: str) -> str:
    """Return the text that `nul_escaped` was given, if that changed it."""
    return re.sub(r"\\(\\|x00)", lambda found: "\\" if found[1] == "\\" else "\0", text) if "\\x00" in text else text


def json_text(value: Any) -> str:
    """Return the JSON text of a value, with null where a number is NaN or infinite."""
    try:
        return json.dumps(value, allow_nan=False)
    except ValueError:
        return json.dumps(finite(value), allow_nan=False)


def finite(value: Any) -> Any:
    """Return a value with null in place of NaN and infinite numbers."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {key: finite(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [finite(one) for one in value]
    return value
