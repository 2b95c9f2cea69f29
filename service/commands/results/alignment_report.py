"""Reports the alignment of couplings on a terminal, in µm and µrad with 95 % intervals."""

from collections.abc import Sequence
from typing import Any

from estimator.alignment.alignment_comparison import AlignmentComparison
from estimator.updated_model.derived_quantities import Derived

MICRO = 1e6
WIDE = 20.0
"""Width of an interval from which on parts of a micrometre, or of a microradian, say nothing [µm, µrad]."""
SIGNS = "driven shaft over the driver's: up and along +x are positive, and faces that open below or on the side of -x"


def alignment_text(quantities: Sequence[Derived]) -> str:
    """Return a line per offset and angle, with the signs; empty where there are none."""
    if not quantities:
        return ""
    width = max(len(one.name) for one in quantities)
    return "\n".join(
        ["", f"Alignment, {SIGNS}; 95 % intervals", *(f"{one.name:<{width}}  {_value(one)}" for one in quantities)]
    )


def alignment_comparison_content(found: AlignmentComparison) -> dict[str, Any]:
    """Return the verdict, the changes with what is allowed, those of the loads, in SI units, and other causes."""
    changes = [
        {
            "name": one.name,
            "unit": one.unit,
            "change": one.value,
            "half_width": None if one.value is None else one.half,
            "allowed": one.allowed,
            "beyond": None if one.value is None else one.beyond,
            "reason": one.reason,
        }
        for one in found.changes
    ]
    loads = [
        {
            "name": one.name,
            "unit": "N",
            "before": one.before,
            "change": one.value,
            "half_width": one.half,
            "change_per_cent": None if one.part is None else 100.0 * one.part,
        }
        for one in found.loads
    ]
    others = [{"kind": kind, "element": element} for kind, element in found.others]
    return {"coupling": found.coupling, "verdict": found.verdict, "changes": changes, "loads": loads, "others": others}


def _value(one: Derived) -> str:
    if one.value is None or one.lower is None or one.upper is None:
        return f"not determined: {one.reason}"
    value, lower, upper = MICRO * one.value, MICRO * one.lower, MICRO * one.upper
    decimals = 0 if upper - lower >= WIDE else 1
    return f"{value:+.{decimals}f} µ{one.unit} ({lower:+.{decimals}f} to {upper:+.{decimals}f})"
