"""Physical quantities of parameters, their SI units, and how those of coefficients act."""

from typing import Literal

Quantity = Literal[
    "stiffness",
    "damping",
    "inertia",
    "angular stiffness",
    "angular damping",
    "coupled stiffness",
    "unbalance",
    "bow",
    "force",
    "moment",
    "scale factor",
    "gain",
    "run-out",
    "clearance",
    "viscosity",
    "elevation",
    "slope",
    "rotating offset",
    "rotating angle",
]
"""Physical quantity of a parameter."""

UNITS: dict[Quantity, str] = {
    "stiffness": "N/m",
    "damping": "N s/m",
    "inertia": "kg",
    "angular stiffness": "N m/rad",
    "angular damping": "N m s/rad",
    "coupled stiffness": "N/rad",
    "unbalance": "kg m",
    "bow": "m",
    "force": "N",
    "moment": "N m",
    "scale factor": "1",
    "gain": "1",
    "run-out": "m",
    "clearance": "m",
    "viscosity": "Pa s",
    "elevation": "m",
    "slope": "1",
    "rotating offset": "m",
    "rotating angle": "rad",
}
"""SI unit of each quantity."""
ORDER: dict[Quantity, int] = {"damping": 1, "angular damping": 1, "inertia": 2}
"""Power of jω with which a coefficient acts; 0 where it is not named."""
