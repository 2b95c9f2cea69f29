"""Sentences about trains on oil films: what has moved and how far, what is allowed, and which loads follow."""

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from estimator.machine.parameter_description import describe

if TYPE_CHECKING:
    from estimator.diagnosis.finding_kind import ChangeSize

BEYOND = 0.95
"""Probability from which on an alignment is said to be beyond what is allowed [-]."""
LEAST_LOAD = 2.0
"""Smallest change of a bearing's load that is named [%]."""
PLANES: Mapping[str, tuple[str, str, str, str]] = {
    "vertical": ("higher", "lower", "rises more from the coupling on", "rises less from the coupling on"),
    "horizontal": ("further along +x", "further along -x", "runs more towards +x", "runs more towards -x"),
}
"""Words by plane: an offset up and down, an angle up and down."""


def alignment_sentence(coupling: str, size: "ChangeSize") -> str:
    """Return the sentence on a coupling whose alignment has changed, to be followed by "against the baseline, since …"."""
    told = [*_offsets(size.quantities), *_angles(size.quantities)]
    beyond = size.beyond_tolerance is not None and size.beyond_tolerance >= BEYOND
    head = f"Coupling {coupling} is out of alignment" if beyond else f"The alignment of coupling {coupling} has changed"
    beside = [*_undetermined(size.quantities), *_loads(size.quantities), *_equivalents(size.quantities)]
    return f"{head}: {'; '.join([*told, *beside])}"


def settlement_sentence(bearing: str, size: "ChangeSize") -> str:
    """Return the sentence on a bearing that has settled by itself."""
    q = size.quantities
    parts = [
        f"{shown(abs(q[f'{plane}_um']), 1.96 * q[f'{plane}_error_um'])} µm {words[0] if q[f'{plane}_um'] > 0 else words[1]}"
        for plane, words in PLANES.items()
        if abs(q.get(f"{plane}_um", 0.0)) > 1.96 * q.get(f"{plane}_error_um", 0.0)
    ]
    return f"Bearing {bearing} stands {' and '.join(parts) or 'elsewhere'}"


def wear_sentence(bearing: str, size: "ChangeSize") -> str:
    """Return the sentence on a bearing whose clearance has grown."""
    q = size.quantities
    grown = shown(q["clearance_per_cent"], 1.96 * q["clearance_error_per_cent"])
    return (
        f"Bearing {bearing} is worn: its radial clearance is {grown} % larger, {q['after_um']:.0f} µm in place of "
        f"{q['before_um']:.0f} µm"
    )


def film_sentence(bearing: str, size: "ChangeSize") -> str:
    """Return the sentence on a film that has changed otherwise than by wear, oil or load."""
    times = size.quantities["deviation_times_allowed"]
    return (
        f"The oil film of bearing {bearing} has changed, and neither by wear nor by oil nor by load: its coefficients deviate "
        f"{times:.1f} times as far from the model as its document says"
    )


def oil_sentence(size: "ChangeSize") -> str:
    """Return the sentence on an oil that is another one."""
    return (
        f"The oil in the bearings is of another viscosity, {size.quantities['viscosity_per_cent']:+.0f} %: look at its grade "
        "and temperature"
    )


def shown(value: float, half: float) -> str:
    """Return a value with the half width of its interval, both to the digit that the half width has two of."""
    digits = 0 if half >= 2.0 else 1 if half >= 0.2 else 2
    return f"{value:.{digits}f} ± {half:.{digits}f}"


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
