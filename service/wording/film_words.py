"""Sizes of findings on oil films in words: what has moved and how far, what is allowed, and which loads follow."""

from collections.abc import Iterator, Mapping

import scipy.special

from estimator.fit.estimates import CONFIDENCE_95
from estimator.machine.parameter_description import describe

BEYOND = 0.95
"""Probability from which on an alignment is said to be beyond what is allowed [-]."""
LEAST_LOAD = 2.0
"""Smallest change of a bearing's load that is named [%]."""
PLANES: Mapping[str, tuple[str, str, str, str]] = {
    "vertical": ("higher", "lower", "rises more from the coupling on", "rises less from the coupling on"),
    "horizontal": ("further along +x", "further along -x", "runs more towards +x", "runs more towards -x"),
}
"""Words by plane: an offset up and down, an angle up and down."""


Numbers = Mapping[str, float]
"""Numbers of a size, by name with the unit at its end."""


def alignment_judgement(numbers: Numbers) -> str:
    """Return what is said of a coupling whose alignment has changed, beside by how much."""
    parts = [
        _probability_beyond(numbers, name)
        for name in numbers
        if name.endswith("_allowed_um") or name.endswith("_allowed_urad")
    ]
    return "is out of alignment" if max(parts, default=0.0) >= BEYOND else "has changed its alignment"


def alignment_words(numbers: Numbers) -> str:
    """Return by how much a coupling's alignment has changed, with what follows from it."""
    told = [*_offsets(numbers), *_angles(numbers)]
    beside = [*_undetermined(numbers), *_loads(numbers), *_equivalents(numbers)]
    return "; ".join([*told, *beside])


def undetermined_alignment(numbers: Numbers) -> list[str]:
    """Return the offsets and angles that are not determined."""
    return list(_undetermined(numbers))


def settlement_words(q: Numbers) -> str:
    """Return by how much a bearing has settled by itself."""
    parts = [
        f"{shown(abs(q[f'{plane}_um']), CONFIDENCE_95 * q[f'{plane}_error_um'])} µm "
        + (words[0] if q[f"{plane}_um"] > 0 else words[1])
        for plane, words in PLANES.items()
        if abs(q.get(f"{plane}_um", 0.0)) > CONFIDENCE_95 * q.get(f"{plane}_error_um", 0.0)
    ]
    return " and ".join(parts) or "elsewhere"


def wear_words(q: Numbers) -> str:
    """Return by how much a bearing's clearance has grown."""
    grown = shown(q["clearance_per_cent"], CONFIDENCE_95 * q["clearance_error_per_cent"])
    return f"{grown} % larger, {q['after_um']:.0f} µm in place of {q['before_um']:.0f} µm"


def shown(value: float, half: float) -> str:
    """Return a value with the half width of its interval, both to the digit that the half width has two of."""
    digits = 0 if half >= 2.0 else 1 if half >= 0.2 else 2
    return f"{value:.{digits}f} ± {half:.{digits}f}"


def _probability_beyond(numbers: Numbers, allowed_name: str) -> float:
    """Return the probability that a change is larger than what is allowed (normal distribution) [-]."""
    stem, _, unit = allowed_name.rpartition("_allowed_")
    allowed, value = numbers[allowed_name], numbers[f"{stem}_{unit}"]
    error = max(numbers[f"{stem}_half_width_{unit}"] / CONFIDENCE_95, 1e-12 * allowed)
    return float(scipy.special.ndtr((-allowed - value) / error) + scipy.special.ndtr((value - allowed) / error))


def _offsets(q: Mapping[str, float]) -> Iterator[str]:
    for plane, (up, down, _, _) in PLANES.items():
        value, half = q.get(f"offset_{plane}_um"), q.get(f"offset_{plane}_half_width_um", 0.0)
        if value is not None and abs(value) > half:
            yield (
                f"the driven shaft lies {shown(abs(value), half)} µm {up if value > 0 else down} "
                f"(allowed {q[f'offset_{plane}_allowed_um']:.0f} µm at {q['allowed_at_rpm']:.0f} r/min)"
            )


def _angles(q: Mapping[str, float]) -> Iterator[str]:
    for plane, (_, _, up, down) in PLANES.items():
        value, half = q.get(f"angle_{plane}_urad"), q.get(f"angle_{plane}_half_width_urad", 0.0)
        if value is not None and abs(value) > half:
            yield (
                f"it {up if value > 0 else down}, by {shown(abs(value), half)} µrad "
                f"(allowed {q[f'angle_{plane}_allowed_urad']:.0f} µrad)"
            )


def _undetermined(q: Mapping[str, float]) -> Iterator[str]:
    for what, unit in (("offset", "um"), ("angle", "urad")):
        missing = [plane for plane in PLANES if f"{what}_{plane}_{unit}" not in q]
        if missing:
            which = "" if len(missing) == len(PLANES) else f"{missing[0]} "
            yield f"the {which}{what} is not determined"


def _loads(q: Mapping[str, float]) -> Iterator[str]:
    loads = {describe(name).element_id: value for name, value in q.items() if name.endswith(".load_per_cent")}
    parts = [
        f"{bearing} {'carries ' if place == 0 else ''}{abs(value):.0f} % {'more' if value > 0 else 'less'}"
        for place, (bearing, value) in enumerate(one for one in loads.items() if abs(one[1]) >= LEAST_LOAD)
    ]
    if parts:
        yield f"bearing {', '.join(parts)}"


def _equivalents(q: Mapping[str, float]) -> Iterator[str]:
    found = []
    for name, value in q.items():
        said = describe(name)
        plane = said.quantity.removesuffix("_um")
        if said.element_kind == "bearing" and plane in PLANES:
            up, down, *_ = PLANES[plane]
            found.append(f"{said.element_id} {abs(value):.0f} µm {up if value > 0 else down}")
    if found:
        yield f"the same as bearing {', or '.join(found)}"
