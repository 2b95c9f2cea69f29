"""Text and JSON as every database takes them: no NUL and no halves of characters, no NaN and no infinity."""

import json
import math
import re
from typing import Any


def plain_text(text: str) -> str:
    """Control characters and halves of characters escaped: PostgreSQL takes no NUL, and nothing takes half a character."""
    return "".join(c if c.isprintable() or c == " " else c.encode("unicode_escape").decode() for c in text)


def plain_lines(text: str) -> str:
    """The same of each of its lines."""
    return "\n".join(map(plain_text, text.split("\n")))


def nul_escaped(text: str) -> str:
    """A text that holds NUL with `\\x00` for it and its backslashes doubled, so that `nul_unescaped` can tell; else as is."""
    return text.replace("\\", "\\\\").replace("\0", "\\x00") if "\0" in text else text


def nul_unescaped(text: str) -> str:
    """What `nul_escaped` was given, if that changed it."""
    return re.sub(r"\\(\\|x00)", lambda found: "\\" if found[1] == "\\" else "\0", text) if "\\x00" in text else text


def json_text(value: Any) -> str:
    """Return the JSON text of a value, with null where a number is NaN or infinite."""
    try:
        return json.dumps(value, allow_nan=False)
    except ValueError:
        return json.dumps(finite(value), allow_nan=False)


def finite(value: Any) -> Any:
    """The same with null wherever a number is none."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {key: finite(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [finite(one) for one in value]
    return value
