"""A static load that a document calls exact and a fit's residuals doubt, as `omitted_forces` finds it."""

from msgspec import Struct

from estimator.arrays import Floats


class DoubtedForce(Struct, frozen=True, eq=False):
    """Component of a static load that a document calls exact and a fit's residuals doubt.

    Attributes:
        name: Its name, such as `static_load.gear.force_y`.
        size: How far it may be off, rms [N].
        answer: Change (N,) of the coordinates per newton that leaves the data as they are [SI or 1 per N].
    """

    name: str
    size: float
    answer: Floats
