"""What the parameters of a machine and the quantities derived from them are called, and their SI units, by the document alone.

So that what was never identified can be told from what the machine has not.
"""

import re
from collections.abc import Iterator, Mapping

from estimator.condensation import scale_spreads
from estimator.machine import Machine
from estimator.parameters import UNITS, Coefficient, is_direct, unknowns
from estimator.rotor import assemble_rotor

NUMBER = re.compile(r"[1-9][0-9]{0,2}")
"""Of a critical speed: how many there are says the model, not the document."""
PAIR = re.compile(rf"({NUMBER.pattern})-({NUMBER.pattern})")
PLACES = {".N": ".1", ".M-N": ".1-2"}
"""What stands in names of derived quantities for the number of a critical speed, or of two; the first that can be there."""


def parameter_units(machine: Machine) -> dict[str, str]:
    """SI unit by name, such as `bearing.B1.kxx`, of every parameter that an identification of a machine can have."""
    rotor = assemble_rotor(machine)
    unknown = unknowns(machine, rotor)
    found = {name: one.unit for one in unknown.coefficients for name in _knots(one)}
    found |= {one.name: one.unit for one in unknown.excitations}
    found |= dict.fromkeys(scale_spreads(machine, rotor), UNITS["scale factor"])
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
    if is_direct(name):
        return "1"
    stem = name.removesuffix(".real").removesuffix(".imaginary")
    of_probe = {"gain": UNITS["gain"], "run_out": UNITS["run-out"]} if stem.startswith("probe.") else {}
    return units.get(stem) or of_probe.get(stem.rpartition(".")[2])


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


def _knots(one: Coefficient) -> Iterator[str]:
    """Names of a coefficient's estimates: one for each knot of what follows the speed, and is free to."""
    if one.speed_dependence is None or one.fixed or one.tied_to is not None:
        yield one.name
    else:
        yield from (f"{one.name}@{knot:g}rpm" for knot in one.speed_dependence.knots_rpm)
