"""What the parameters of a machine and the quantities derived from them are called, and their SI units, by the document alone.

So that what was never identified can be told from what the machine has not.
"""

import re
from collections.abc import Mapping, Sequence

from estimator.machine.document import Machine
from estimator.machine.parameter_description import describe
from estimator.quantities import UNITS
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.coefficient_models import governing_models
from estimator.rotor.parameters import Coefficient, scale_factors, unknowns

NUMBER = re.compile(r"[1-9][0-9]{0,2}")
"""Of a critical speed: how many there are says the model, not the document."""
PAIR = re.compile(rf"({NUMBER.pattern})-({NUMBER.pattern})")
PLACES = {".N": ".1", ".M-N": ".1-2"}
"""What stands in names of derived quantities for the number of a critical speed, or of two; the first that can be there."""


def parameter_units(machine: Machine) -> dict[str, str]:
    """SI unit by name, such as `bearing.B1.kxx`, of every parameter that an identification of a machine can have."""
    rotor = assemble_rotor(machine)
    unknown = unknowns(machine, rotor)
    found = _coefficient_units(unknown.coefficients)
    found |= {one.name: one.unit for one in unknown.excitations}
    found |= dict.fromkeys((one.name for one in scale_factors(machine, rotor)), UNITS["scale factor"])
    for probe in machine.probes:
        if probe.gain_spread > 0.0:
            found[f"probe.{probe.id}.gain"] = UNITS["gain"]
        if probe.run_out_spread > 0.0:
            found[f"probe.{probe.id}.run_out"] = UNITS["run-out"]
    return found


def change_unit(name: str, units: Mapping[str, str]) -> str | None:
    """SI unit in which a diagnosis tells the change of a parameter or of a vector's component; 1: a logarithm or a part.

    name: such as `bearing.B1.kxy` or `disc.D1.unbalance.real`; units: see `parameter_units`. None for a name not among them.
    """
    said = describe(name)
    if said.positive:
        return "1"
    whole = name if said.component is None else said.whole
    of_probe = {"gain": UNITS["gain"], "run_out": UNITS["run-out"]} if said.element_kind == "probe" else {}
    return units.get(whole) or of_probe.get(said.quantity)


def derived_units(machine: Machine) -> dict[str, str]:
    """SI unit by name of every quantity that can be derived; N, and M below it, stand for numbers of critical speeds."""
    found = {"critical_speed.N": "rad/s", "damping_ratio.N": "1", "splitting.M-N": "1"}
    for coupling in machine.couplings:
        found |= {f"coupling.{coupling.id}.misalignment_force": "N", f"coupling.{coupling.id}.misalignment_moment": "N m"}
    for channel in machine.channels:
        found |= {f"probe.{channel}.amplification_factor.N": "1", f"probe.{channel}.second_over_first": "1"}
    return found


def derived_unit(machine: Machine, name: str) -> str | None:
    """SI unit of a quantity that can be derived, such as `critical_speed.1`; None for any other name."""
    return None if name.endswith(tuple(PLACES)) else derived_units(machine).get(without_number(name))


def in_words(name: str) -> str:
    """A name of `derived_units` with the first numbers that it can have in the place of N or M-N: `critical_speed.1 …`."""
    stem, dot, place = name.rpartition(".")
    return f"{stem}{PLACES[dot + place]} …" if dot + place in PLACES else name


def without_number(name: str) -> str:
    """A name with N or M-N where it has the number of a critical speed, or of two, the lower one first."""
    stem, _, number = name.rpartition(".")
    pair = PAIR.fullmatch(number)
    if pair and int(pair[1]) < int(pair[2]):
        return f"{stem}.M-N"
    return f"{stem}.N" if NUMBER.fullmatch(number) else name


def _coefficient_units(coefficients: Sequence[Coefficient]) -> dict[str, str]:
    """SI unit by name: of the parameters of the bearing models, and of each coefficient that is fixed or tied."""
    models = {min(one.coefficients): one.model for one in governing_models(coefficients)}
    found: dict[str, str] = {}
    for k, one in enumerate(coefficients):
        if one.fixed or one.tied_to is not None:
            found[one.name] = one.unit
        elif k in models:
            found |= {parameter.name: parameter.unit for parameter in models[k].parameters}
    return found
