"""Consistency of a machine document: the checks of parts and rules against each other that no field alone can make."""

import re
from collections import Counter
from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from fnmatch import fnmatchcase, translate
from typing import Any, Protocol

from pydantic_core import InitErrorDetails, PydanticCustomError

from estimator.bearings.model import BearingForm, WholeTrain
from estimator.bearings.terms import TERMS
from estimator.close_matches import did_you_mean
from estimator.machine.bearings_on_films import BearingOnFilm, bearings_on_films
from estimator.machine.films import StaticLoad
from estimator.machine.parameter_description import describe
from estimator.machine.part_coefficients import (
    ELEMENTS,
    Elements,
    coefficient_names,
    coefficient_values,
    given_over_speed,
    nominal_value,
    planes,
)
from estimator.machine.parts import STATION_TOLERANCE, Disc, Material, Probe, Shaft
from estimator.machine.rules import Condition, Operation, ParameterRule, SpeedRange
from estimator.machine.sparkplug import Sparkplug

CONTRADICTION = "machine_document"
"""Type of the errors that say what contradicts what."""
CELSIUS = "degC"
"""Unit of an operating condition that an oil's temperature follows."""


class Train(Elements, Protocol):
    """Parts and rules of a train that are checked against each other."""

    @property
    def materials(self) -> Mapping[str, Material]:
        """Return the materials by id."""

    @property
    def shafts(self) -> Sequence[Shaft]:
        """Return the shafts in the document's order."""

    @property
    def discs(self) -> Sequence[Disc]:
        """Return the discs in the document's order."""

    @property
    def probes(self) -> Sequence[Probe]:
        """Return the probes in the document's order."""

    @property
    def static_loads(self) -> Sequence[StaticLoad]:
        """Return the static forces in the document's order."""

    @property
    def conditions(self) -> Sequence[Condition]:
        """Return the operating conditions in the document's order."""

    @property
    def speed_range(self) -> SpeedRange:
        """Return the speeds at which samples are taken seriously."""

    @property
    def operation(self) -> Operation:
        """Return the operation of the machine."""

    @property
    def sparkplug(self) -> Sparkplug | None:
        """Return how the machine's metrics are named in Sparkplug B."""

    @property
    def parameters(self) -> Sequence[ParameterRule]:
        """Return the rules of parameters, later ones above earlier ones."""


def _problem(location: tuple[int | str, ...], value: Any, message: str) -> InitErrorDetails:
    # The message goes in as context: it may hold braces of its own.
    error = PydanticCustomError(CONTRADICTION, "{message}", {"message": message})
    return InitErrorDetails(type=error, loc=location, input=value)


def reference_problems(train: Train) -> Iterator[InitErrorDetails]:
    """Find every contradiction between the parts and rules of a train.

    Args:
        train: The train.

    Yields:
        The contradictions with their places in the document.
    """
    yield from _material_problems(train)
    yield from _duplicate_problems(train)
    yield from _condition_problems(train)
    yield from _sparkplug_problems(train)
    yield from _station_problems(train)
    yield from _speed_problems(train)
    yield from _coupling_problems(train)
    yield from _alignment_problems(train)
    yield from _pedestal_problems(train)
    yield from _dependence_problems(train)
    yield from _whole_train_problems(train)
    yield from _support_problems(train)
    yield from _supply_problems(train)
    yield from _rule_problems(train)


def naming_problems(train: Train) -> Iterator[InitErrorDetails]:
    """Find the contradictions between names and places of parts, which do not ask whether all parts are there.

    Args:
        train: The train, of which parts may be missing.

    Yields:
        The contradictions with their places in the document.
    """
    yield from _material_problems(train)
    yield from _duplicate_problems(train)
    yield from _condition_problems(train)
    yield from _station_problems(train)
    yield from _coupling_problems(train)
    yield from _alignment_problems(train)
    yield from _pedestal_problems(train)


def _speed_problems(train: Train) -> Iterator[InitErrorDetails]:
    running, highest = train.operation.running_rpm, train.speed_range.maximum_rpm
    if running is not None and running > highest:
        message = f"lies above the speed range, which ends at {highest:g} r/min"
        yield _problem(("operation", "running_rpm"), running, message)


def _material_problems(train: Train) -> Iterator[InitErrorDetails]:
    known = ", ".join(train.materials)
    for i, shaft in enumerate(train.shafts):
        for j, section in enumerate(shaft.sections):
            if section.material not in train.materials:
                message = f"'{section.material}' is not one of the materials: {known}"
                yield _problem(("shafts", i, "sections", j, "material"), section.material, message)


def _duplicate_problems(train: Train) -> Iterator[InitErrorDetails]:
    for name in ("shafts", "discs", "bearings", "couplings", "seals", "pedestals", "static_loads", "probes"):
        parts = getattr(train, name)
        counts = Counter(part.id for part in parts)
        for i, part in enumerate(parts):
            if counts[part.id] > 1:
                yield _problem((name, i, "id"), part.id, f"'{part.id}' stands more than once among the {name}")
    conditions = [condition.name for condition in train.conditions]
    names = Counter(conditions)
    for i, name in enumerate(conditions):
        if names[name] > 1:
            yield _problem(("conditions", i, "name"), name, f"'{name}' stands more than once among the conditions")


def _condition_problems(train: Train) -> Iterator[InitErrorDetails]:
    """Find parts that follow an operating condition that is not there, or has another unit than they need."""
    units = {condition.name: condition.unit for condition in train.conditions}
    known = ", ".join(units) or "there are none"
    for i, load in enumerate(train.static_loads):
        if load.scaled_by is not None and load.scaled_by not in units:
            message = f"'{load.scaled_by}' is not one of the operating conditions: {known}"
            yield _problem(("static_loads", i, "scaled_by"), load.scaled_by, message)
    for i, bearing in enumerate(train.bearings):
        name = None if bearing.film is None else bearing.film.oil.temperature_from
        if name is None or units.get(name) == CELSIUS:
            continue
        message = (
            f"'{name}' comes in {units[name]}; the temperature of an oil must come in {CELSIUS}"
            if name in units
            else f"'{name}' is not one of the operating conditions: {known}"
        )
        yield _problem(("bearings", i, "film", "oil", "temperature_from"), name, message)


def _station_problems(train: Train) -> Iterator[InitErrorDetails]:
    lengths = {shaft.id: shaft.length for shaft in train.shafts}
    for name in ("discs", "bearings", "seals", "static_loads", "probes"):
        for i, part in enumerate(getattr(train, name)):
            if part.shaft not in lengths:
                message = f"'{part.shaft}' is not one of the shafts: {', '.join(lengths)}"
                yield _problem((name, i, "shaft"), part.shaft, message)
            elif part.station > lengths[part.shaft] + STATION_TOLERANCE:
                message = f"{part.station} lies beyond shaft '{part.shaft}', which is {lengths[part.shaft]:.6g} m long"
                yield _problem((name, i, "station"), part.station, message)


def _coupling_problems(train: Train) -> Iterator[InitErrorDetails]:
    known = [shaft.id for shaft in train.shafts]
    for i, coupling in enumerate(train.couplings):
        for end in ("driver", "driven"):
            if getattr(coupling, end) not in known:
                message = f"'{getattr(coupling, end)}' is not one of the shafts: {', '.join(known)}"
                yield _problem(("couplings", i, end), getattr(coupling, end), message)
        if coupling.driver == coupling.driven:
            yield _problem(("couplings", i, "driven"), coupling.driven, "a coupling joins two different shafts")
    yield from _ring_problems(train)
    for end in ("driver", "driven"):
        counts = Counter(getattr(coupling, end) for coupling in train.couplings)
        for i, coupling in enumerate(train.couplings):
            if counts[getattr(coupling, end)] > 1:
                message = f"shaft '{getattr(coupling, end)}' is the {end} of more than one coupling"
                yield _problem(("couplings", i, end), getattr(coupling, end), message)


def _alignment_problems(train: Train) -> Iterator[InitErrorDetails]:
    known = [coupling.id for coupling in train.couplings]
    for field, what in (("alignment_tolerances", "tolerances"), ("alignment_targets", "targets")):
        said = getattr(train.operation, field)
        named = Counter(one.coupling for one in said)
        for i, one in enumerate(said):
            place, there = ("operation", field, i, "coupling"), ", ".join(known) or "none"
            if one.coupling not in known:
                yield _problem(place, one.coupling, f"'{one.coupling}' is not one of the couplings: {there}")
            elif named[one.coupling] > 1:
                yield _problem(place, one.coupling, f"{what} of coupling '{one.coupling}' stand here more than once")


def _pedestal_problems(train: Train) -> Iterator[InitErrorDetails]:
    known = [bearing.id for bearing in train.bearings]
    counts = Counter(pedestal.bearing for pedestal in train.pedestals)
    for i, pedestal in enumerate(train.pedestals):
        if pedestal.bearing not in known:
            message = f"'{pedestal.bearing}' is not one of the bearings: {', '.join(known)}"
            yield _problem(("pedestals", i, "bearing"), pedestal.bearing, message)
        elif counts[pedestal.bearing] > 1:
            message = f"bearing '{pedestal.bearing}' stands on more than one pedestal"
            yield _problem(("pedestals", i, "bearing"), pedestal.bearing, message)
    for i, probe in enumerate(train.probes):
        if probe.mounted_on is not None and probe.mounted_on not in known:
            message = f"'{probe.mounted_on}' is not one of the bearings: {', '.join(known)}"
            yield _problem(("probes", i, "mounted_on"), probe.mounted_on, message)
        if probe.mounted_on is not None and probe.absolute:
            message = "stands on the ground: then it is mounted on no bearing's pedestal"
            yield _problem(("probes", i, "absolute"), probe.absolute, message)


def _ring_problems(train: Train) -> Iterator[InitErrorDetails]:
    """Find couplings that join the shafts to a ring: from driver to driven a train must not come back."""
    behind = {coupling.driver: coupling.driven for coupling in train.couplings}
    for i, coupling in enumerate(train.couplings):
        shaft: str | None = coupling.driven
        for _ in train.couplings:
            if shaft == coupling.driver != coupling.driven:
                yield _problem(("couplings", i, "driven"), coupling.driven, "the couplings join the shafts to a ring")
                break
            shaft = behind.get(shaft) if shaft is not None else None


def _dependence_problems(train: Train) -> Iterator[InitErrorDetails]:
    for place in ELEMENTS:
        for i, part in enumerate(getattr(train, place)):
            form = part.speed_dependence
            known = coefficient_names(part)
            for name in (form and form.coefficients) or ():
                if name not in known:
                    message = f"'{name}' is not identified here; what is: {', '.join(known)}"
                    yield _problem((place, i, "speed_dependence", "coefficients"), name, message)
            for name in known:
                value = getattr(part, name)
                if form is not None and value is not None and form.nominal(name, train.speed_range.middle_rpm) is not None:
                    message = "stands in the table of speed_dependence, too: give it in one place only"
                    yield _problem((place, i, name), value, message)


def _whole_train_problems(train: Train) -> Iterator[InitErrorDetails]:
    """Find parts that do not fit a form of which one model gives all bearings' coefficients, as the films' does."""
    for place in ELEMENTS:
        for i, part in enumerate(getattr(train, place)):
            form, declared = part.speed_dependence, _whole_train(part.speed_dependence)
            if place != "bearings" and declared is not None:
                with_part = "" if declared.part is None else f" with a {declared.part}"
                message = f"form '{form.form}' is of bearings{with_part} only"
                yield _problem((place, i, "speed_dependence", "form"), form.form, message)
    forms = [one.speed_dependence for one in train.bearings]
    first = next((one for one in forms if _whole_train(one) is not None), None)
    if first is not None and first.whole_train is not None:
        yield from _common_form_problems(train, first.form, first.whole_train)


def _whole_train(form: BearingForm | None) -> WholeTrain | None:
    """Return what a form declares of one model for all bearings of a train, where it has one."""
    return None if form is None else form.whole_train


def _common_form_problems(train: Train, name: str, declared: WholeTrain) -> Iterator[InitErrorDetails]:
    """Find rules for coefficients of bearings of one form, bearings of another one where it stands alone, and missing fields
    that it needs."""
    have_it = [one.speed_dependence is not None and one.speed_dependence.form == name for one in train.bearings]
    ruled = [f"bearing.{one.id}.{term}" for one, has in zip(train.bearings, have_it, strict=True) if has for term in TERMS]
    for i, rule in enumerate(train.parameters):
        if any(fnmatchcase(one, rule.names) for one in ruled):
            message = f"coefficients of {declared.of} follow from form '{name}': its own spreads say how well they are known"
            yield _problem(("parameters", i), rule.names, message)
    for i, (bearing, has) in enumerate(zip(train.bearings, have_it, strict=True)):
        if not has and declared.reason is not None:
            message = f"needs the form '{name}', as the other bearings: {declared.reason}"
            yield _problem(("bearings", i, "speed_dependence"), None, message)
        elif has and declared.part is not None and getattr(bearing, declared.part) is None:
            message = f"form '{name}' needs the bearing's {declared.part}: {declared.contents}"
            yield _problem(("bearings", i, declared.part), None, message)


def _support_problems(train: Train) -> Iterator[InitErrorDetails]:
    """Find bearings beside others on films whose stiffness the document does not give, and elevations that say nothing."""
    films = bearings_on_films(train.bearings)
    on_films = {one.number for one in films}
    for i, rule in enumerate(train.parameters):
        if rule.tied_to in {f"bearing.{one.id}" for one in films}:
            message = f"'{rule.tied_to}' is on a film, whose coefficients follow from the train's loads: tie to no film"
            yield _problem(("parameters", i, "tied_to"), rule.tied_to, message)
    for i, bearing in enumerate(train.bearings):
        if bearing.elevation is not None and (i in on_films or not on_films):
            told = "film.elevation_x, film.elevation_y and elevation_spread of its form" if on_films else "leave it out"
            what = "is of bearings with coefficients of their own beside others of the form 'journal'"
            yield _problem(("bearings", i, "elevation"), None, f"{what}: {told}")
        if not on_films or i in on_films:
            continue
        for term in ("kxx", "kyy"):
            if nominal_value(bearing, term, rpm=train.speed_range.middle_rpm) is None:
                message = "needs a value: loads on the films beside it follow from the stiffness of each bearing"
                yield _problem(("bearings", i, term), None, message)


def _supply_problems(train: Train) -> Iterator[InitErrorDetails]:
    """Find films of one oil supply whose viscosities have different priors, although they share one factor."""
    first: dict[str, BearingOnFilm] = {}
    for one in bearings_on_films(train.bearings):
        if one.film.oil.supply is None and one.form.viscosity_ratio_spread > 0.0:
            message = "is over the viscosity of an oil supply: film.oil.supply must name it"
            where = ("bearings", one.number, "speed_dependence", "viscosity_ratio_spread")
            yield _problem(where, one.form.viscosity_ratio_spread, message)
        if one.film.oil.supply is not None:
            known = first.setdefault(one.film.oil.supply, one).form
            for name in ("viscosity_spread", "viscosity_slope_spread"):
                value, expected = getattr(one.form, name), getattr(known, name)
                if value != expected:
                    message = f"is another one than that of the first bearing of supply '{one.film.oil.supply}', {expected:g}"
                    yield _problem(("bearings", one.number, "speed_dependence", name), value, message)


def _matching(pattern: str, names: Iterable[str]) -> list[str]:
    """List those of the names that a rule's pattern fits."""
    fits = re.compile(translate(pattern)).match
    return [name for name in names if fits(name)]


def _fitting(train: Train, names: Iterable[str]) -> dict[str, list[str]]:
    """List the names that each rule's pattern fits."""
    return {pattern: _matching(pattern, names) for pattern in {rule.names for rule in train.parameters}}


def _rule_problems(train: Train) -> Iterator[InitErrorDetails]:
    coefficients, over_speed = coefficient_values(train), given_over_speed(train, rpm=train.speed_range.middle_rpm)
    values = coefficients | planes(train.discs)
    fitting = _fitting(train, values)
    in_force = {name: i for i, rule in enumerate(train.parameters) for name in fitting[rule.names]}
    by_rule: dict[int, list[str]] = {}
    for name, i in in_force.items():
        by_rule.setdefault(i, []).append(name)
    for i, rule in enumerate(train.parameters):
        if not fitting[rule.names]:
            message = f"'{rule.names}' matches no parameter; one of them is {next(iter(values))}"
            yield _problem(("parameters", i, "names"), rule.names, message)
        for message in _value_problems(rule, by_rule.get(i, []), values, over_speed, frozenset(coefficients)):
            yield _problem(("parameters", i), rule.names, message)
    tied = {name: i for name, i in in_force.items() if train.parameters[i].tied_to is not None}
    yield from _tie_problems(train, coefficients, tied)


def _value_problems(
    rule: ParameterRule,
    ruled: Sequence[str],
    values: Mapping[str, float | None],
    over_speed: Container[str],
    coefficients: Container[str],
) -> Iterator[str]:
    """Yield what a rule asks of parameters that their nominal values do not allow. ruled: parameters that the rule is in force
    for."""
    given = [name for name in ruled if name in over_speed]
    if given and rule.tied_to is None:
        yield f"{', '.join(given)} follow a table: its scale_spread says how far it may be off, 0 that it is exact"
    unknown = [name for name in ruled if values[name] is None and name not in over_speed]
    if unknown and rule.tied_to is None:
        yield f"needs a nominal value of {', '.join(unknown)}"
    nothing = [name for name in ruled if name not in coefficients and values[name] == 0.0]
    if nothing and rule.spread is not None:
        yield f"a part of {', '.join(nothing)} is no spread: its nominal magnitude is zero"


def _tie_problems(train: Train, coefficients: dict[str, float | None], tied: dict[str, int]) -> Iterator[InitErrorDetails]:
    """Find parameters that cannot be tied as a rule says; tied: by name of a tied parameter, the rule that ties it."""
    known = {describe(name).element for name in coefficients}
    absent = {i for i in tied.values() if train.parameters[i].tied_to not in known}
    for i in sorted(absent):
        missing = str(train.parameters[i].tied_to)
        own = {describe(name).element for name, by in tied.items() if by == i}
        yield _problem(("parameters", i, "tied_to"), missing, _absent_words(missing, known - own))
    for name, i in tied.items():
        target = train.parameters[i].tied_to
        if i in absent:
            continue
        leader = f"{target}.{describe(name).quantity}"
        if leader == name:
            message = f"'{name}' cannot be tied to itself"
        elif leader not in coefficients or name not in coefficients:
            message = (
                f"'{name}' cannot be tied to '{leader}': both must be coefficients of bearings, couplings, seals or pedestals"
            )
        elif leader in tied:
            message = f"'{leader}' is itself tied: tie to an element that stands on its own"
        else:
            continue
        yield _problem(("parameters", i, "tied_to"), target, message)


def _absent_words(target: str, known: Iterable[str]) -> str:
    """State that there is no element of this name, with those that there are of its kind, or of all kinds."""
    kind = describe(target).element_kind
    alike = sorted(one for one in known if describe(one).element_kind == kind)
    of_kind = kind in ELEMENTS.values()
    told = f"there is no {kind} '{describe(target).element_id}'" if of_kind else f"'{target}' has no coefficients"
    there = f": there are {', '.join(alike)}" if alike else ""
    return f"{told} to tie to{did_you_mean(target, alike) or there}"


def _sparkplug_problems(train: Train) -> Iterator[InitErrorDetails]:
    """Find probes and operating conditions that metrics are named for and that there are not."""
    if train.sparkplug is None:
        return
    known = {"channels": [one.id for one in train.probes], "conditions": [one.name for one in train.conditions]}
    for part, names in known.items():
        for name in getattr(train.sparkplug, part):
            if name not in names:
                told = f"the document has none of this name; it has {', '.join(names) or 'none at all'}"
                yield _problem(("sparkplug", part, name), name, told)
    yield from _sparkplug_gap_problems(train.sparkplug, {one.id: one for one in train.probes})


def _sparkplug_gap_problems(mapping: Sparkplug, probes: Mapping[str, Probe]) -> Iterator[InitErrorDetails]:
    """Find gaps with a metric that cannot be converted, since their sign or scale is missing."""
    for name, channel in mapping.channels.items():
        probe = probes.get(name)
        if channel.gap is None or probe is None:
            continue
        place = ("sparkplug", "channels", name, "gap")
        if probe.gap_grows is None:
            yield _problem(place, channel.gap, "a gap needs the probe's `gap_grows`: away or towards")
        if mapping.gap_unit == "V" and probe.sensitivity is None:
            yield _problem(place, channel.gap, "a gap in V needs the probe's `sensitivity` [V/m]")
