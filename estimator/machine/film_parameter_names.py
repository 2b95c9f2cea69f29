"""Names of the parameters that a film's own numbers are identified as, by its document alone."""

from collections.abc import Sequence

from estimator.bearings.journal import JournalForm
from estimator.machine.films import JournalFilm, StaticLoad


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
        "elevation_x": f"{own}.elevation_x",
        "elevation_y": f"{own}.elevation_y",
    }
    if supply is not None and form.viscosity_ratio_spread > 0.0:
        found["viscosity_ratio"] = f"{own}.viscosity_ratio"
    return found | ({"viscosity_slope": f"{oil}.viscosity_slope"} if form.viscosity_slope_spread > 0.0 else {})


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
