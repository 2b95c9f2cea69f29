"""Names of the parameters that a film's own numbers are identified as, by its document alone."""

from estimator.bearings.journal import JournalForm
from estimator.machine.films import JournalFilm


def film_parameter_names(bearing: str, film: JournalFilm, form: JournalForm) -> dict[str, str]:
    """Return the names of a film's parameters; films of one oil supply have those of their oil in common.

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
    return found | ({"viscosity_slope": f"{oil}.viscosity_slope"} if form.viscosity_slope_spread > 0.0 else {})
