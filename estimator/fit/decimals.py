"""Number of decimals to which a value and its interval are rounded."""

LEAST_WIDTHS = (2.0, 0.2, 0.02)
"""Half widths from which on none, one and two decimals show two digits of them."""


def decimals(half: float) -> int:
    """Return the decimals that show two digits of a half width, three at most.

    Args:
        half: Half width of an interval [unit in which it is told]; 0 where there is none.

    Returns:
        Number of decimals [-].
    """
    if half == 0.0:
        return 2
    return next((number for number, least in enumerate(LEAST_WIDTHS) if half >= least), len(LEAST_WIDTHS))
