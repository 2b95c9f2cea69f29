"""InfluxDB line protocol: one line a point, `measurement,tag=… field=… time`.

Source: InfluxData, "Line protocol", InfluxDB OSS v2 documentation (escapes, types of fields).
"""

import math
import re
from collections.abc import Mapping

_TAG = re.compile(r"([,= ])")
_CONTROL = re.compile(r"[\x00-\x1f\x7f]")


def line(
    measurement: str, tags: Mapping[str, str], fields: Mapping[str, float | int | str | None], time_ns: int
) -> str | None:
    """Return a point as a line; None where it has no field with a value. Empty tags and missing values are left out."""
    told = [f"{_escaped(name)}={_field(value)}" for name, value in fields.items() if not _missing(value)]
    if not told:
        return None
    named = "".join(f",{_escaped(name)}={_escaped(value)}" for name, value in tags.items() if value)
    return f"{_escaped(measurement)}{named} {','.join(told)} {time_ns}"


def _escaped(text: str) -> str:
    """Return a name or a tag's value: separators escaped, nothing that ends a line, no backslash that escapes what follows."""
    return _TAG.sub(r"\\\1", _CONTROL.sub("_", text).replace("\\", "/"))


def _field(value: float | int | str | None) -> str:
    if isinstance(value, str):
        escaped = _CONTROL.sub(" ", value).replace("\\", "\\\\").replace('"', '\\"')
        return f'"{escaped}"'
    return f"{value}i" if isinstance(value, int) else repr(float(value or 0.0))


def _missing(value: float | int | str | None) -> bool:
    return value is None or (isinstance(value, float) and not math.isfinite(value))
