"""Makes one shaft of ROSS's shaft elements: layers between two nodes are joined, equal neighbours too."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from rotorundown.ross.tables import NotInROSS, float_of, number_of, require_zero

SAME = 1e-9
"""Difference of two lengths that are the same [m]."""


@dataclass(frozen=True)
class ROSSShaft:
    """A shaft as parts of a machine document.

    Attributes:
        materials: Materials by name.
        sections: Sections from the first node on.
        places: Distance of each node from the first one [m].
    """

    materials: dict[str, dict[str, float]]
    sections: list[dict[str, Any]]
    places: dict[int, float]

    def station(self, name: str, node: int) -> float:
        """Return the place of a node [m]. Raises NotInROSS. name: the element there, for the message."""
        if node not in self.places:
            known = f"{min(self.places)} to {max(self.places)}"
            raise NotInROSS(f"'{name}' sits at node {node}, which the shaft does not have: it has {known}")
        return self.places[node]


def one_shaft(elements: Sequence[tuple[str, Mapping[str, Any]]]) -> ROSSShaft:
    """Return the shaft of elements, each with its tag. Raises NotInROSS."""
    layers: dict[int, list[tuple[str, Mapping[str, Any]]]] = {}
    for name, one in elements:
        _require_plain(name, one)
        layers.setdefault(number_of(name, one, "n"), []).append((name, one))
    nodes = sorted(layers)
    if nodes != list(range(nodes[0], nodes[0] + len(nodes))):
        raise NotInROSS("its shaft has a gap: the elements' nodes must follow one another")
    materials: dict[str, dict[str, float]] = {}
    sections: list[dict[str, Any]] = []
    places, end = {nodes[0]: 0.0}, 0.0
    for node in nodes:
        section = _section(sorted(layers[node], key=lambda one: float_of(one[0], one[1], "idl")), materials)
        end += section["length"]
        places[node + 1] = end
        if sections and {**sections[-1], "length": 0.0} == {**section, "length": 0.0}:
            sections[-1]["length"] += section["length"]
        else:
            sections.append(section)
    return ROSSShaft(materials, sections, places)


def _require_plain(name: str, one: Mapping[str, Any]) -> None:
    for left, right in (("idl", "idr"), ("odl", "odr")):
        if one.get(right) is not None and abs(float_of(name, one, left) - float_of(name, one, right)) > SAME:
            raise NotInROSS(f"'{name}' is conical ({left} and {right} differ): divide it into cylinders")
    for term in ("axial_force", "torque"):
        require_zero(name, one, term, "the shaft's model has no static axial force or torque")
    for term in ("alpha", "beta"):
        require_zero(name, one, term, "state the damping of shafts once, as `damping` of the document")
    for term in ("shear_effects", "rotary_inertia", "gyroscopic"):
        if one.get(term) is False:
            raise NotInROSS(f"'{name}' leaves out {term}, which the shaft's model here always has")


def _section(layers: Sequence[tuple[str, Mapping[str, Any]]], materials: dict[str, dict[str, float]]) -> dict[str, Any]:
    """Return the section of the layers of one element, the innermost first, and note its material."""
    name, inner = layers[0]
    length, material = float_of(name, inner, "L"), _material(name, inner, materials)
    for (before, inside), (above, outside) in zip(layers, layers[1:], strict=False):
        if abs(float_of(before, inside, "odl") - float_of(above, outside, "idl")) > SAME:
            raise NotInROSS(f"'{before}' and '{above}' are layers that do not touch: a section here is one tube or one bar")
        if abs(float_of(above, outside, "L") - length) > SAME:
            raise NotInROSS(f"'{before}' and '{above}' lie between the same nodes, but differ in length")
        if _material(above, outside, materials) != material:
            raise NotInROSS(f"'{before}' and '{above}' are layers of different materials: a section here has one")
    outer = layers[-1]
    return {
        "length": length,
        "outer_diameter": float_of(outer[0], outer[1], "odl"),
        "inner_diameter": float_of(name, inner, "idl"),
        "material": material,
    }


def _material(name: str, one: Mapping[str, Any], materials: dict[str, dict[str, float]]) -> str:
    """Return the name of an element's material in the document; another one of the same name gets a number."""
    given = one.get("material")
    if not isinstance(given, dict):
        raise NotInROSS(f"'{name}' has no material beside it: save the model with ROSS's Rotor.save")
    modulus, density = float_of(f"{name}'s material", given, "E"), float_of(f"{name}'s material", given, "rho")
    shear = float_of(f"{name}'s material", given, "G_s")
    if shear <= 0.0:
        raise NotInROSS(f"'{name}' has a material with G_s = {shear:g}: a shear modulus is positive")
    value = {"young_modulus": modulus, "density": density, "poisson_ratio": modulus / (2.0 * shear) - 1.0}
    wanted = re.sub(r"[^A-Za-z0-9_-]+", "-", str(given.get("name", "")))[:60]
    found, number = wanted or "material", 2
    while materials.get(found, value) != value:
        found, number = f"{wanted}-{number}", number + 1
    materials[found] = value
    return found
