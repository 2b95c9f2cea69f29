"""Sizes of findings on oil films in words: what has moved and how far, what is allowed, and which loads follow."""

from collections.abc import Iterator, Mapping

import scipy.special

from estimator.diagnosis.finding_kind import is_step_beside
from estimator.fit.decimals import decimals, signed_with_half
from estimator.fit.estimates import CONFIDENCE_95
from estimator.machine.parameter_description import describe
from service.wording.described_finding import MILLIRADIANS
from service.wording.language import ENGLISH, Language

BEYOND = 0.95
"""Probability from which on an alignment is said to be beyond what is allowed [-]."""
LEAST_LOAD = 2.0
"""Smallest change of a bearing's load that is named [%]."""
PLANES = ("vertical", "horizontal")
"""Planes of offsets and angles."""


Numbers = Mapping[str, float]
"""Numbers of a size, by name with the unit at its end."""


def alignment_judgement(numbers: Numbers, language: Language = ENGLISH) -> str:
    """Return the words that judge a coupling whose alignment has changed; `alignment_words` say by how much."""
    parts = [
        _probability_beyond(numbers, name)
        for name in numbers
        if name.endswith("_allowed_um") or name.endswith("_allowed_urad")
    ]
    judged = "misaligned" if max(parts, default=0.0) >= BEYOND else "alignment_changed"
    return language.translate(f"judgement.{judged}")


def alignment_words(numbers: Numbers, language: Language = ENGLISH) -> str:
    """Return by how much a coupling's alignment has changed, with what follows from it."""
    told = [*_offsets(numbers, language), *_angles(numbers, language), *_steps(numbers, language)]
    beside = [*_undetermined(numbers, language), *_loads(numbers, language), *_equivalents(numbers, language)]
    return "; ".join([*told, *beside])


def undetermined_alignment(numbers: Numbers, language: Language = ENGLISH) -> list[str]:
    """Return the offsets and angles that are not determined."""
    return list(_undetermined(numbers, language))


def settlement_words(q: Numbers, language: Language = ENGLISH) -> str:
    """Return by how much a bearing has settled by itself."""
    parts = [
        f"{shown_length(abs(q[f'{plane}_um']), CONFIDENCE_95 * q[f'{plane}_error_um'], language)} "
        + _direction("offset", plane, q[f"{plane}_um"], language)
        for plane in PLANES
        if abs(q.get(f"{plane}_um", 0.0)) > CONFIDENCE_95 * q.get(f"{plane}_error_um", 0.0)
    ]
    return language.translate("and").join(parts) or language.translate("elsewhere")


def wear_words(q: Numbers, language: Language = ENGLISH) -> str:
    """Return by how much a bearing's clearance has grown."""
    grown = shown(q["clearance_per_cent"], CONFIDENCE_95 * q["clearance_error_per_cent"], language)
    return language.translate(
        "wear", grown=grown, after=language.length(q["after_um"]), before=language.length(q["before_um"])
    )


def shown(value: float, half: float, language: Language = ENGLISH) -> str:
    """Return a value with the half width of its interval, both to the digit that the half width has two of."""
    digits = decimals(half)
    return language.digits(f"{value:.{digits}f} ± {half:.{digits}f}")


def signed_change(value: float, half: float, language: Language = ENGLISH) -> tuple[str, str]:
    """Return a change with its sign, and the half width of its interval, both to the same decimal."""
    change, width = signed_with_half(value, half)
    return language.digits(change), language.digits(width)


def shown_length(value: float, half: float, language: Language = ENGLISH) -> str:
    """Return a length with the half width of its interval [µm], in the unit that the reader asked for."""
    return f"{shown(language.in_length_unit(value), language.in_length_unit(half), language)} {language.length_unit}"


def _probability_beyond(numbers: Numbers, allowed_name: str) -> float:
    """Return the probability that a change is larger than what is allowed (normal distribution) [-]."""
    stem, _, unit = allowed_name.rpartition("_allowed_")
    allowed, value = numbers[allowed_name], numbers[f"{stem}_{unit}"]
    error = max(numbers[f"{stem}_half_width_{unit}"] / CONFIDENCE_95, 1e-12 * allowed)
    return float(scipy.special.ndtr((-allowed - value) / error) + scipy.special.ndtr((value - allowed) / error))


def _direction(what: str, plane: str, value: float, language: Language) -> str:
    return language.translate(f"{what}.{plane}.{'up' if value > 0 else 'down'}")


def _offsets(q: Numbers, language: Language) -> Iterator[str]:
    for plane in PLANES:
        value, half = q.get(f"offset_{plane}_um"), q.get(f"offset_{plane}_half_width_um", 0.0)
        if value is not None and abs(value) > half:
            yield language.translate(
                "offset.told",
                value=shown_length(abs(value), half, language),
                direction=_direction("offset", plane, value, language),
                allowed=language.length(q[f"offset_{plane}_allowed_um"]),
                rpm=q["allowed_at_rpm"],
            )


def _angles(q: Numbers, language: Language) -> Iterator[str]:
    for plane in PLANES:
        value, half = q.get(f"angle_{plane}_urad"), q.get(f"angle_{plane}_half_width_urad", 0.0)
        if value is not None and abs(value) > half:
            yield language.translate(
                "angle.told",
                value=shown(MILLIRADIANS * abs(value), MILLIRADIANS * half, language),
                direction=_direction("angle", plane, value, language),
                allowed=MILLIRADIANS * q[f"angle_{plane}_allowed_urad"],
            )


def _steps(q: Numbers, language: Language) -> Iterator[str]:
    """Yield the steps against the runs just before that read otherwise than the change since the baseline."""
    for what, unit in (("offset", "um"), ("angle", "urad")):
        for plane in PLANES:
            value, half = q.get(f"step_{what}_{plane}_{unit}"), q.get(f"step_{what}_{plane}_half_width_{unit}", 0.0)
            whole = q.get(f"{what}_{plane}_{unit}", 0.0)
            if value is not None and is_step_beside(value, half, whole=whole):
                shown_value = (
                    shown_length(abs(value), half, language)
                    if what == "offset"
                    else shown(MILLIRADIANS * abs(value), MILLIRADIANS * half, language)
                )
                direction = _direction(what, plane, value, language)
                yield language.translate(f"{what}.step", value=shown_value, direction=direction)


def _undetermined(q: Numbers, language: Language) -> Iterator[str]:
    for what, unit in (("offset", "um"), ("angle", "urad")):
        missing = [plane for plane in PLANES if f"{what}_{plane}_{unit}" not in q]
        if missing:
            yield language.translate(f"undetermined.{what}" + ("" if len(missing) == len(PLANES) else f".{missing[0]}"))


def _loads(q: Numbers, language: Language) -> Iterator[str]:
    loads = {describe(name).element_id: value for name, value in q.items() if describe(name).quantity == "load_per_cent"}
    parts = [
        language.translate(
            f"load.{'' if place == 0 else 'next_'}{'more' if value > 0 else 'less'}", bearing=bearing, change=abs(value)
        )
        for place, (bearing, value) in enumerate(one for one in loads.items() if abs(one[1]) >= LEAST_LOAD)
    ]
    if parts:
        yield language.translate("loads", loads=", ".join(parts))


def _equivalents(q: Numbers, language: Language) -> Iterator[str]:
    found = []
    for name, value in q.items():
        said = describe(name)
        plane = said.quantity.removesuffix("_um")
        if said.element_kind == "bearing" and plane in PLANES:
            direction = _direction("offset", plane, value, language)
            found.append(
                language.translate(
                    "equivalent", bearing=said.element_id, size=language.length(abs(value)), direction=direction
                )
            )
    if found:
        yield language.translate("equivalents", moves=language.translate("or").join(found))
