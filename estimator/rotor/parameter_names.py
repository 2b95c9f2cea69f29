"""Names and SI units of a machine's parameters and of the quantities derived from them, by the document alone.

They tell a parameter that was never identified from one that the machine does not have.
"""

import re
from collections.abc import Mapping, Sequence

from estimator.bearings.registry import OWN_PARAMETERS
from estimator.bearings.terms import LATERAL
from estimator.machine.bearings_on_films import bearings_on_films
from estimator.machine.document import Machine
from estimator.machine.film_parameter_names import elevation_names, film_parameter_names, unknown_forces
from estimator.machine.film_speeds import follows_films, reported_rpm
from estimator.machine.parameter_description import describe
from estimator.quantities import UNITS
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.coefficient_models import governing_models
from estimator.rotor.parameters import Coefficient, scale_factors, unknowns

NUMBER = re.compile(r"[1-9][0-9]{0,2}")
"""Pattern of the number of a critical speed; how many there are is known from the model, not from the document."""
PAIR = re.compile(rf"({NUMBER.pattern})-({NUMBER.pattern})")
"""Pattern of two numbers of critical speeds."""
LOAD_UNITS = {"load_vertical": "N", "load_horizontal": "N"}
"""SI unit of each reported component of the load on a bearing at running speed, of a train on oil films."""
JOURNAL_UNITS = {"journal_x": "m", "journal_y": "m", "eccentricity_ratio": "1"}
"""SI unit of each reported quantity of a journal in its film at running speed."""
ALIGNMENT_UNITS = {"offset_vertical": "m", "offset_horizontal": "m", "angle_vertical": "rad", "angle_horizontal": "rad"}
"""SI unit of each reported quantity of a coupling's alignment on oil films."""
STATIC_LOAD_UNITS = {
    "static_shear_vertical": "N",
    "static_shear_horizontal": "N",
    "static_moment_vertical": "N m",
    "static_moment_horizontal": "N m",
}
"""SI unit of each reported quantity of the static load in a coupling on oil films."""
PLACES = {".N": ".1", ".M-N": ".1-2"}
"""Placeholder for the number of a critical speed, or of two, in names of derived quantities, and the first number it
can be."""


def parameter_units(machine: Machine) -> dict[str, str]:
    """Return the SI unit of every parameter that an identification of a machine can have.

    Args:
        machine: The machine.

    Returns:
        SI unit by name, such as `bearing.B1.kxx`.
    """
    rotor = assemble_rotor(machine)
    unknown = unknowns(machine, rotor)
    found = _coefficient_units([one for one in unknown.coefficients if one.form.whole_train is None])
    found |= _whole_train_units(machine)
    found |= _film_parameter_units(machine)
    found |= {one.name: one.unit for one in unknown.excitations}
    found |= dict.fromkeys((one.name for one in scale_factors(machine, rotor)), UNITS["scale factor"])
    for probe in machine.probes:
        if probe.gain_spread > 0.0:
            found[f"probe.{probe.id}.gain"] = UNITS["gain"]
        if probe.run_out_spread > 0.0:
            found[f"probe.{probe.id}.run_out"] = UNITS["run-out"]
    return found


def change_unit(name: str, units: Mapping[str, str]) -> str | None:
    """Return the SI unit in which a diagnosis states the change of a parameter or of a vector's component.

    Args:
        name: Name, such as `bearing.B1.kxy` or `disc.D1.unbalance.real`.
        units: SI units by name, as of `parameter_units`.

    Returns:
        The unit, 1 for a logarithm or a part; None for a name not among them.
    """
    said = describe(name)
    if said.positive:
        return "1"
    whole = name if said.component is None else said.whole
    of_probe = {"gain": UNITS["gain"], "run_out": UNITS["run-out"]} if said.element_kind == "probe" else {}
    return units.get(whole) or of_probe.get(said.quantity)


def derived_units(machine: Machine) -> dict[str, str]:
    """Return the SI unit of every quantity that can be derived.

    Args:
        machine: The machine.

    Returns:
        SI unit by name; N, and M below it, stand for numbers of critical speeds.
    """
    found = {"critical_speed.N": "rad/s", "damping_ratio.N": "1", "splitting.M-N": "1"}
    for coupling in machine.couplings:
        found |= {f"coupling.{coupling.id}.misalignment_force": "N", f"coupling.{coupling.id}.misalignment_moment": "N m"}
    for channel in machine.channels:
        found |= {f"probe.{channel}.amplification_factor.N": "1", f"probe.{channel}.second_over_first": "1"}
        found |= {f"probe.{channel}.second_amplitude": "m", f"probe.{channel}.second_phase": "rad"}
    return found | _film_units(machine)


def _whole_train_units(machine: Machine) -> dict[str, str]:
    """Return the SI unit by name of the parameters that a model of the whole train has of each bearing, films aside."""
    on_films = {one.id for one in bearings_on_films(machine.bearings)}
    return {
        f"bearing.{bearing.id}.{one.name}": one.unit
        for bearing in machine.bearings
        if bearing.id not in on_films
        if bearing.speed_dependence is not None and bearing.speed_dependence.whole_train is not None
        for one in bearing.speed_dependence.own_parameters
    }


def _film_parameter_units(machine: Machine) -> dict[str, str]:
    """Return the SI unit by name of the parameters of films that coefficients follow from, and of elevations beside them."""
    found: dict[str, str] = {}
    films = {one.number: one for one in bearings_on_films(machine.bearings)}
    for number, bearing in enumerate(machine.bearings if films else ()):
        one = films.get(number)
        names = elevation_names(bearing.id) if one is None else film_parameter_names(one.id, one.film, one.form)
        found |= {name: OWN_PARAMETERS[describe(name).quantity].unit for name in names.values()}
    if follows_films(machine):
        found |= dict.fromkeys(unknown_forces(machine.static_loads), UNITS["force"])
    return found


def _film_units(machine: Machine) -> dict[str, str]:
    """Return the SI unit by name of what is reported of oil films: coefficients at some speeds, journals at running speed,
    alignment.
    """
    if not follows_films(machine):
        return {}
    found: dict[str, str] = {}
    on_films = {one.number for one in bearings_on_films(machine.bearings)}
    for number, bearing in enumerate(machine.bearings):
        element = f"bearing.{bearing.id}"
        found |= {f"{element}.{name}": unit for name, unit in LOAD_UNITS.items()}
        if number in on_films:
            courses = [(one, rpm) for one in LATERAL for rpm in reported_rpm(machine)]
            found |= {f"{element}.{one.name}@{rpm:g}rpm": UNITS[one.quantity] for one, rpm in courses}
            found |= {f"{element}.{name}": unit for name, unit in JOURNAL_UNITS.items()}
    for coupling in machine.couplings:
        found |= {f"coupling.{coupling.id}.{name}": unit for name, unit in (ALIGNMENT_UNITS | STATIC_LOAD_UNITS).items()}
    return found


def derived_unit(machine: Machine, name: str) -> str | None:
    """Return the SI unit of a quantity that can be derived.

    Args:
        machine: The machine.
        name: Name, such as `critical_speed.1`.

    Returns:
        The unit; None for any other name.
    """
    return None if name.endswith(tuple(PLACES)) else derived_units(machine).get(without_number(name))


def number_as_word(name: str) -> str:
    """Replace N or M-N in a name of `derived_units` by the first numbers that it can have: `critical_speed.1 …`.

    Args:
        name: The name.

    Returns:
        The name with numbers.
    """
    stem, dot, place = name.rpartition(".")
    return f"{stem}{PLACES[dot + place]} …" if dot + place in PLACES else name


def without_number(name: str) -> str:
    """Replace the number of a critical speed in a name by N, or two, the lower one first, by M-N.

    Args:
        name: The name.

    Returns:
        The name as in `derived_units`.
    """
    stem, _, number = name.rpartition(".")
    pair = PAIR.fullmatch(number)
    if pair and int(pair[1]) < int(pair[2]):
        return f"{stem}.M-N"
    return f"{stem}.N" if NUMBER.fullmatch(number) else name


def _coefficient_units(coefficients: Sequence[Coefficient]) -> dict[str, str]:
    """Return the SI unit by name: of the parameters of the bearing models, and of each coefficient that has none."""
    models = {min(one.coefficients): one.model for one in governing_models(coefficients)}
    index = {one.name: k for k, one in enumerate(coefficients)}
    found: dict[str, str] = {}
    for k, one in enumerate(coefficients):
        if one.fixed or one.tied_to is not None:
            found[one.name] = one.unit
        elif k in models and not models[k].parameters:
            found |= {coefficients[index[name]].name: coefficients[index[name]].unit for name in models[k].coefficients}
        elif k in models:
            found |= {parameter.name: parameter.unit for parameter in models[k].parameters}
    return found
