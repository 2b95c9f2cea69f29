"""Converts trends into the requested units."""

from dataclasses import replace

from estimator.trends.baseline_band import Band
from service.api.conventions.parameter_units import ParameterUnits, shown_in
from service.api.trends.columns import Columns


def in_units(columns: Columns, units: ParameterUnits) -> Columns:
    """Return a history, with its bands, in the chosen units."""
    history = columns.history
    if history.unit is None or history.unit not in units:
        return columns
    written, size = shown_in(history.unit, units)
    converted = {name: getattr(history, name) / size for name in ("value", "standard_error", "lower", "upper", "imaginary")}
    bands = [replace(one, band=_scaled(one.band, size)) for one in columns.baselines]
    return replace(
        columns,
        history=replace(history, unit=written, **converted),
        value=columns.value / size,
        standard_error=columns.standard_error / size,
        baselines=bands,
    )


def _scaled(band: Band, size: float) -> Band:
    return replace(band, centre=band.centre / size, lower=band.lower / size, upper=band.upper / size)
