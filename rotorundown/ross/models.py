"""Reads rotor models that ROSS has saved (`Rotor.save`), as machine documents.

The format is that of ROSS 1 and 2 (Timbó et al., J. Open Source Softw. 5 (2020) 2120, doi:10.21105/joss.02120): a TOML table
per element, named by its class and tag, with the arguments of its class in SI units. Both programs have x and y across the
shaft, z along it, and turn from x towards y, so that coefficients keep their signs.
"""

import re
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from numbers import Real
from os import PathLike
from pathlib import Path
from typing import Any

from estimator.errors import Invalid
from estimator.machine.checks.document_size import accepted_machine
from estimator.machine.document import DocumentError, Machine
from estimator.machine.parts import Probe
from estimator.units import RAD_PER_S
from rotorundown.ross.shafts import one_shaft
from rotorundown.ross.tables import NotInROSS, float_of, number_of, require_zero

SHAFT = "S1"
LATERAL = ("kxx", "kxy", "kyx", "kyy", "cxx", "cxy", "cyx", "cyy")
DIRECT = ("kxx", "kyy", "cxx", "cyy")
INERTIA = ("mxx", "mxy", "myx", "myy")
PLAIN = ("ross_version", "parameters")
"""Entries of a file that are no elements."""


class WrongROSSModel(Invalid):
    """Raised for a file that is no ROSS model, or whose parts a machine document cannot describe."""


def read_ross_model(
    file: str | Path,
    *,
    machine: str,
    probes: Sequence[Mapping[str, Any] | Probe],
    speed_range_rpm: tuple[float, float],
    plant: str = "plant",
) -> Machine:
    """Return the machine that a saved ROSS model describes, with the probes that a model does not have.

    Layers of a shaft between the same nodes become one section. Axial coefficients are left out: the model here is lateral. A
    direct stiffness or damping of zero is left out, too: it counts as unknown.

    Args:
        file: Path of a file that ROSS's `Rotor.save` wrote.
        machine: Id of the machine.
        probes: Probes as in a machine document, such as `{"id": "B1X", "station": 0.1, "angle_deg": 45}`; their shaft is S1.
        speed_range_rpm: Lowest and highest speed of the machine [r/min].
        plant: Id of the plant.

    Returns:
        The machine: shaft S1, discs, bearings and seals named by their tags.

    Raises:
        WrongROSSModel: The file cannot be read, or an element cannot be described; the message names it.
    """
    if not isinstance(file, str | PathLike):
        raise WrongROSSModel(f"file is a {type(file).__name__}: give the path of what ROSS's Rotor.save wrote")
    limits = _speed_range(speed_range_rpm)
    if isinstance(probes, str | Mapping | Probe) or not all(isinstance(one, Mapping | Probe) for one in _several(probes)):
        raise WrongROSSModel('probes are a list such as [{"id": "B1X", "station": 0.1, "angle_deg": 45}]')
    elements = _elements(Path(file))
    try:
        shaft = one_shaft([(name, one) for kind, name, one in elements if kind == "ShaftElement"])
        document: dict[str, Any] = {
            "id": machine,
            "plant": plant,
            "name": machine,
            "speed_range": dict(zip(("minimum_rpm", "maximum_rpm"), limits, strict=True)),
            "materials": shaft.materials,
            "shafts": [{"id": SHAFT, "sections": shaft.sections}],
            "discs": [],
            "bearings": [],
            "seals": [],
            "probes": [{"shaft": SHAFT} | (one.model_dump() if isinstance(one, Probe) else dict(one)) for one in probes],
        }
        for kind, name, one in elements:
            if kind != "ShaftElement":
                place, part = _part(kind, name, one)
                part["station"] = shaft.station(name, part.pop("node"))
                document[place].append({"id": _free_id(name, document[place]), "shaft": SHAFT} | part)
        return accepted_machine(document)
    except NotInROSS as error:
        raise WrongROSSModel(f"{file}: {error}") from None
    except DocumentError as error:
        problems = "\n".join(f"  {field}: {message}" for field, message in error.problems)
        raise WrongROSSModel(f"{file} gives no machine document:\n{problems}") from None


def _speed_range(given: Any) -> list[Any]:
    """Return the lowest and the highest speed [r/min]. Raises WrongROSSModel."""
    limits = _several(given)
    if len(limits) != 2 or not all(isinstance(one, Real) and not isinstance(one, bool) for one in limits):
        raise WrongROSSModel(
            f"speed_range_rpm is the lowest and the highest speed [r/min], such as (300, 3000), not {given!r:.40}"
        )
    return [float(one) for one in limits]


def _several(given: Any) -> list[Any]:
    """Return what a list holds, or what is none as its only part."""
    return list(given) if isinstance(given, Iterable) and not isinstance(given, str) else [given]


def _elements(file: Path) -> list[tuple[str, str, dict[str, Any]]]:
    """Return class, tag and arguments of each element. Raises WrongROSSModel."""
    try:
        content = tomllib.loads(file.read_text(encoding="utf-8"))
    except OSError as error:
        raise WrongROSSModel(f"{file}: {error.strerror}") from None
    except (UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise WrongROSSModel(f"{file} is no TOML: {error}") from None
    found = []
    for title, one in content.items():
        if title in PLAIN:
            continue
        kind, joint, tag = title.partition("_")
        if not joint or not isinstance(one, dict):
            raise WrongROSSModel(f"{file} is no model that ROSS saved: '{title}' is no element")
        found.append((kind, tag, one))
    if not any(kind == "ShaftElement" for kind, _, _ in found):
        raise WrongROSSModel(f"{file} is no model that ROSS saved: it has no ShaftElement")
    return found


def _part(kind: str, name: str, one: Mapping[str, Any]) -> tuple[str, dict[str, Any]]:
    """Return where an element belongs in the document and what it is there, with its node. Raises NotInROSS."""
    if kind == "DiskElement":
        inertias = {"diametral_inertia": float_of(name, one, "Id"), "polar_inertia": float_of(name, one, "Ip")}
        return "discs", {"node": number_of(name, one, "n"), "mass": float_of(name, one, "m")} | inertias
    if "kxx" not in one or "cxx" not in one:
        raise NotInROSS(f"{kind} '{name}' cannot be described: only shafts, discs, bearings and seals can; leave it out")
    if one.get("n_link") is not None:
        raise NotInROSS(f"{kind} '{name}' stands on another element (n_link): describe its support as a pedestal by hand")
    part: dict[str, Any] = {"node": number_of(name, one, "n")} | _coefficients(name, one)
    seal = "Seal" in kind
    for inertia in INERTIA:
        if seal and inertia in ("mxx", "myy"):
            value = _constant(name, one, inertia)
            if value:
                part[inertia] = value
        else:
            require_zero(name, one, inertia, "fluid inertia is known of seals only, and along x and y")
    return "seals" if seal else "bearings", part


def _coefficients(name: str, one: Mapping[str, Any]) -> dict[str, Any]:
    """Return constant coefficients, or a table over the speed. Raises NotInROSS."""
    lists = {term: _list(name, one, term) for term in LATERAL}
    speeds = _list(name, one, "frequency") if one.get("frequency") is not None else []
    lengths = {len(values) for values in lists.values()} - {1}
    if not lengths:
        return {term: values[0] for term, values in lists.items() if values[0] or term not in DIRECT}
    if lengths != {len(speeds)}:
        raise NotInROSS(f"'{name}': its coefficients need one value at each of its {len(speeds)} frequencies")
    columns = {term: values if len(values) > 1 else values * len(speeds) for term, values in lists.items()}
    return {"speed_dependence": {"form": "table", "speed_rpm": [speed / RAD_PER_S["rpm"] for speed in speeds]} | columns}


def _list(name: str, one: Mapping[str, Any], term: str) -> list[float]:
    """Return a coefficient's values; kyy and cyy are those along x where they are left out, others zero."""
    given = one.get(term, one.get({"kyy": "kxx", "cyy": "cxx"}.get(term, ""), 0.0))
    values = given if isinstance(given, list) else [given]
    if not values or not all(isinstance(value, int | float) for value in values):
        raise NotInROSS(f"'{name}': {term} holds no numbers")
    return [float(value) for value in values]


def _constant(name: str, one: Mapping[str, Any], term: str) -> float:
    values = set(_list(name, one, term))
    if len(values) > 1:
        raise NotInROSS(f"'{name}': {term} changes with the speed, which only stiffness and damping can")
    return values.pop()


def _free_id(tag: str, others: Sequence[Mapping[str, Any]]) -> str:
    """Return the tag as an id that no other has."""
    wanted = re.sub(r"[^A-Za-z0-9_-]+", "-", tag).strip("-")[:60] or "part"
    taken = {one["id"] for one in others}
    found, number = wanted, 2
    while found in taken:
        found, number = f"{wanted}-{number}", number + 1
    return found
