"""The message of an identification on the broker: all its values, with intervals and units."""

import math
from collections.abc import Sequence
from typing import Any

import msgspec
from sqlalchemy import Row

from storage.clock import to_datetime
from storage.tables.findings import IdentificationRow


def trend_message(plant: str, row: IdentificationRow, values: Sequence[Row[Any]]) -> bytes:
    """Return an identification as JSON, in SI; null where the run does not determine a value."""
    return msgspec.json.encode(
        {
            "plant": plant,
            "machine": row.machine_id,
            "identification": row.id,
            "scope": row.scope,
            "run_kind": row.run_kind,
            "measured_at": to_datetime(row.measured_at),
            "computed_at": to_datetime(row.computed_at),
            "accepted": row.accepted,
            "verdict": row.verdict,
            "parameters": {one.parameter: _value(one) for one in values},
        }
    )


def _value(one: Row[Any]) -> dict[str, Any]:
    """Return a value with its interval; of an unbalance its magnitude, and its two parts."""
    parts = {} if one.imaginary is None else {"real": one.value, "imaginary": one.imaginary}
    value = one.value if one.imaginary is None or one.value is None else math.hypot(one.value, one.imaginary)
    return {"value": value, "lower": one.lower, "upper": one.upper, "unit": one.unit} | parts
