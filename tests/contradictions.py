"""One figure for one thing: what alert, event, diagnosis, deviations, trend tests, trends and alignment say of a machine.

Each place is asked for what it says of which quantity, as of which identification and over how many runs. Two places that say
different numbers of one thing contradict each other; so does a text that lacks the number beside it, a common factor that is
told more than once, and a parameter that is called moved although the identification does not determine it.
"""

import math
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

Get = Callable[[str], Any]
"""Function that returns the JSON of a GET below the prefix."""
SAME = 1e-9
"""Relative difference from which on two numbers differ."""
LINEAR = 1e-6
"""The same of alignments, which the API computes anew."""
PLAIN = {"µm": "um", "g·mm": "g mm", "mrad": "urad"}
"""Units of figures as evidence has them."""
DIRECT = re.compile(r"\.(kxx|kyy|cxx|cyy|k_phix|k_phiy|clearance|viscosity)$")
"""Names of parameters that are positive by nature, of which deviations are factors."""
SCALES = {"m": ("um", 1e6), "rad": ("urad", 1e6), "N": ("N", 1.0)}


@dataclass(frozen=True)
class StatedFigure:
    """Statement of one place about a quantity. key: the quantity, its measure, the identification, and of how many runs it
    is."""

    place: str
    key: tuple[Any, ...]
    value: float
    same: float = SAME


def contradictions(get: Get, machine: str) -> tuple[list[str], int]:
    """Everything in which the places contradict each other, and how many claims were compared."""
    alerts = get(f"/machines/{machine}/alerts?open=true")
    claims = [one for alert in alerts for one in _alert_claims(get, alert)]
    for number in sorted({one.key[2] for one in claims}):
        claims += [
            *_diagnosis_claims(get, number),
            *_deviation_claims(get, machine, number),
            *_trend_claims(get, machine, number),
        ]
        claims += _alignment_claims(get, machine, number)
    by_key: dict[tuple[Any, ...], list[StatedFigure]] = {}
    for one in claims:
        by_key.setdefault(one.key, []).append(one)
    wrong = [
        f"{one.key}: {one.place} says {one.value!r}, {first.place} {first.value!r}"
        for first, *others in by_key.values()
        for one in others
        if not math.isclose(one.value, first.value, rel_tol=max(one.same, first.same), abs_tol=1e-9)
    ]
    compared = sum(len(same) - 1 for same in by_key.values())
    return [*wrong, *(fault for alert in alerts for fault in _own_faults(get, alert))], compared


def _alert_claims(get: Get, alert: dict[str, Any]) -> Iterator[StatedFigure]:
    number, evidence = alert["identification"], alert["evidence"]
    yield from _advice_claims("alert", number, alert["advice"])
    yield from _cause_claims("alert's evidence", number, evidence)
    for event in get(f"/alerts/{alert['id']}/events"):
        if event["advice"] is not None:
            yield from _advice_claims("event", event["identification"], event["advice"])
            if event["identification"] == number and event["severity"] == alert["severity"]:
                same = event["advice"] == alert["advice"] and event["message"] == alert["message"]
                yield StatedFigure("event", ("told as the alert", alert["id"], number, None), float(same))
                yield StatedFigure("alert", ("told as the alert", alert["id"], number, None), 1.0)


def _diagnosis_claims(get: Get, number: int) -> Iterator[StatedFigure]:
    for cause in get(f"/identifications/{number}/diagnosis")["causes"]:
        yield from _cause_claims("diagnosis", number, cause)
        yield from _advice_claims("diagnosis's advice", number, cause["advice"])


def _cause_claims(place: str, number: int, cause: dict[str, Any]) -> Iterator[StatedFigure]:
    for part in cause.get("parts", ()):
        alone = part["before"] is not None or "allowed_at_rpm" in cause["quantities"]
        yield from _size_claims(place, number, part, 1 if alone else cause["runs"])
    for one in cause.get("moved", ()):
        yield from _deviation_row(place, number, one)
        yield StatedFigure(place, (one["parameter"], "unit", number, 1), hash(one["unit"]))


def _advice_claims(place: str, number: int, advice: dict[str, Any]) -> Iterator[StatedFigure]:
    for figure in advice["how_far"]:
        factor = 1e3 if figure["unit"] == "mrad" else 1.0
        said = {"name": figure["of"], "against": figure["against"], "unit": PLAIN.get(figure["unit"], figure["unit"])}
        said |= {what: factor * figure[what] for what in ("value", "lower", "upper")}
        yield from _size_claims(place, number, said, figure["runs"])


def _size_claims(place: str, number: int, part: dict[str, Any], runs: int, same: float = SAME) -> Iterator[StatedFigure]:
    for what in ("value", "lower", "upper"):
        size = f"size {what} against the {part.get('against', 'baseline')} [{part['unit']}]"
        yield StatedFigure(place, (part["name"], size, number, runs), part[what], same)
    if part.get("before") is not None:
        yield StatedFigure(place, (part["name"], "itself", number, 1), part["before"] + part["value"])


def _deviation_row(place: str, number: int, row: dict[str, Any]) -> Iterator[StatedFigure]:
    for what in ("per_cent", "lower_per_cent", "upper_per_cent", "sigma"):
        yield StatedFigure(place, (row["parameter"], what, number, 1), row[what])


def _deviation_claims(get: Get, machine: str, number: int) -> Iterator[StatedFigure]:
    found = get(f"/machines/{machine}/deviations?identification={number}")
    for row in found["parameters"]:
        yield from _deviation_row("deviations", number, row)
    for element in found["elements"]:
        for part in element["together"]:
            yield from _size_claims("deviations", number, part, part["runs"])


def _trend_claims(get: Get, machine: str, number: int) -> Iterator[StatedFigure]:
    """Yield what trend tests and trends say of parameters as of an identification, beside the baseline."""
    found = get(f"/machines/{machine}/deviations?identification={number}")
    tests = get(f"/machines/{machine}/trend-tests?identification={number}")["tests"]
    real = [row["parameter"] for row in found["parameters"] if row["added"] is None]
    for one in tests:
        if one["name"] in real:
            yield StatedFigure("trend tests", (one["name"], "per_cent", number, 1), one["newest"])
    loads = [
        part["name"]
        for cause in get(f"/identifications/{number}/diagnosis")["causes"]
        for part in cause["parts"]
        if part["before"] is not None
    ]
    direct = [] if found["adjusted_for"] else [name for name in real if DIRECT.search(name)]
    asked = "&".join(f"parameter={name}" for name in [*direct, *loads])
    for series in get(f"/machines/{machine}/trends?{asked}")["series"] if asked else ():
        name, value = series["parameter"], dict(zip(series["identification"], series["value"], strict=True))
        if number not in value:  # a store without estimates has no trends
            continue
        if name in loads:
            yield StatedFigure("trends", (name, "itself", number, 1), value[number])
        else:
            before = [math.log(value[one]) for one in found["baseline"]["identifications"]]
            change = 100.0 * math.expm1(math.log(value[number]) - sum(before) / len(before))
            yield StatedFigure("trends", (name, "per_cent", number, 1), change)


def _alignment_claims(get: Get, machine: str, number: int) -> Iterator[StatedFigure]:
    found = get(f"/machines/{machine}/alignment?identification={number}")
    for one in [*found["numbers"], *found["loads"]]:
        change = one["change"]
        if change is not None and change["value"] is not None:
            unit, factor = SCALES[one["unit"]]
            part = {"name": one["name"], "unit": unit} | {what: factor * change[what] for what in ("value", "lower", "upper")}
            yield from _size_claims("alignment", number, part, 1, LINEAR)


def _own_faults(get: Get, alert: dict[str, Any]) -> Iterator[str]:
    """Yield what contradicts itself within an alert."""
    advice, evidence = alert["advice"], alert["evidence"]
    if alert["message"] != advice["what"]:
        yield f"alert {alert['id']}: the message is not its advice's"
    for figure in advice["how_far"]:
        if not any(_shows(text, figure) for text in [figure["words"]]):
            yield f"alert {alert['id']}: '{figure['words']}' does not show {figure['value']}"
    elements = [part["name"].rsplit(".", 1)[0] for part in evidence.get("parts", ()) if part["name"].endswith(".coefficients")]
    told_one_by_one = [part["name"] for part in evidence.get("parts", ()) if part["name"].endswith((".stiffness", ".damping"))]
    for name in told_one_by_one:
        if name.rsplit(".", 1)[0] in elements:
            yield f"alert {alert['id']}: {name} is told beside all coefficients together"
    unknown = {
        one["parameter"] for one in get(f"/identifications/{alert['identification']}")["estimates"] if one["value"] is None
    }
    moved = {one["parameter"] for one in evidence.get("moved", ())}
    members = {name for part in evidence.get("parts", ()) for name in part["members"]}
    for name in sorted((moved | members) & unknown):
        yield f"alert {alert['id']}: {name} is called moved, and is not estimable"
    for one in evidence.get("moved", ()):
        if one["unit"] == "1":
            yield f"alert {alert['id']}: the change of {one['parameter']} is a logarithm"


def _shows(text: str, figure: dict[str, Any]) -> bool:
    """Return whether a text shows a figure's number, its rounding allowed for."""
    numbers = [float(one) for one in re.findall(r"(?<![\w.])[-+]?\d+(?:\.\d+)?", text)]
    factor = 1e3 if figure["unit"] == "mrad" else 1.0
    shown = factor * (figure["value"] + (figure["before"] or 0.0))
    half = factor * (figure["upper"] - figure["lower"]) / 2.0
    return any(abs(abs(one) - abs(shown)) <= max(0.51, 0.05 * half) for one in numbers)
