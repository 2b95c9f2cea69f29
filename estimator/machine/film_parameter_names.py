"""Names of the parameters that a film's own numbers are identified as, by its document alone."""

from collections.abc import Mapping, Sequence

from estimator.bearings.journal import JournalForm
from estimator.machine.document import Machine
from estimator.machine.films import JournalFilm, StaticLoad
from estimator.machine.parameter_description import describe

LOAD_BALANCE = 2
"""Version of the balance of loads on oil films where the stiffness of couplings or pedestals is identified beside them: they
follow the stiffness that is identified; at first they followed the document's."""


def load_balance(coordinates: Sequence[str]) -> int | None:
    """Return the version of the balance of loads on films that a fit's values follow from, by the names of its coordinates.

    Values of another version are not of the same quantities: a change of it is no change of the machine.

    Args:
        coordinates: Names of the coordinates.

    Returns:
        The version; None without films, or where couplings and pedestals are as the document says in any case.
    """
    described = [describe(name) for name in coordinates]
    on_films = any(one.element_kind == "bearing" and one.quantity == "clearance" for one in described)
    stiff = any(
        one.element_kind in ("coupling", "pedestal") and one.term is not None and one.term.direct and one.term.order == 0
        for one in described
    )
    return LOAD_BALANCE if on_films and stiff else None


def film_parameter_names(bearing: str, film: JournalFilm, form: JournalForm) -> dict[str, str]:
    """Return the names of a film's parameters; films of one oil supply have those of their oil in common, but for a ratio.

    Args:
        bearing: Id of the bearing.
        film: What the document says of its film.
        form: How far that may be off.

    Returns:
        Name by the number that the parameter gives, such as `viscosity`, in the order in which they are fitted.
    """
    own, supply = f"bearing.{bearing}", film.oil.supply
    oil = own if supply is None else f"oil.{supply}"
    found = {
        "clearance": f"{own}.clearance",
        "viscosity": f"{oil}.viscosity" if supply is None else f"{oil}.viscosity_factor",
        **elevation_names(bearing),
    }
    if supply is not None and form.viscosity_ratio_spread > 0.0:
        found["viscosity_ratio"] = f"{own}.viscosity_ratio"
    return found | ({"viscosity_slope": f"{oil}.viscosity_slope"} if form.viscosity_slope_spread > 0.0 else {})


def elevation_names(bearing: str) -> dict[str, str]:
    """Return the names of the elevation of a bearing that is no film itself, beside others on films.

    Args:
        bearing: Id of the bearing.

    Returns:
        Name by the number that the parameter gives, such as `elevation_y`.
    """
    return {name: f"bearing.{bearing}.{name}" for name in ("elevation_x", "elevation_y")}


def with_open_forces(machine: Machine, spreads: Mapping[str, float]) -> tuple[Machine, tuple[float, ...]]:
    """Return a machine in which components of static loads may be off that its document calls exact.

    Args:
        machine: The machine.
        spreads: How far each may be off, rms [N], by the name of its parameter.

    Returns:
        The machine, and the components' values [N] in the order of `spreads`.
    """
    loads = {one.id: one for one in machine.static_loads}
    stated = []
    for name, spread in spreads.items():
        load, component = describe(name).element_id, describe(name).quantity
        stated.append(float(getattr(loads[load], component)))
        loads[load] = loads[load].model_copy(update={f"{component}_spread": spread})
    return machine.model_copy(update={"static_loads": tuple(loads.values())}), tuple(stated)


def unknown_forces(loads: Sequence[StaticLoad]) -> dict[str, tuple[int, int]]:
    """Return the components of static loads that may be off.

    Args:
        loads: Static loads of a document.

    Returns:
        Number of the load and of the component, 0 along x and 1 along y, by the name of the parameter.
    """
    return {
        f"static_load.{one.id}.force_{axis}": (number, component)
        for number, one in enumerate(loads)
        for component, (axis, spread) in enumerate((("x", one.force_x_spread), ("y", one.force_y_spread)))
        if spread > 0.0
    }
