"""Values of a machine document that only a slip of the unit explains; looked for where documents enter, not in stored ones."""

from collections.abc import Iterator

from estimator.machine.document import Machine

SMALLEST_YOUNG_MODULUS = 1e8
"""Smallest Young's modulus of a shaft [N/m²]: that of a hard rubber."""
LARGEST_DIAMETER = 5.0
"""Largest diameter of a shaft [m]."""
SMALLEST_STIFFNESS = 1e3
"""Smallest direct stiffness of a bearing [N/m]: one that sinks by a millimetre under 0.1 kg."""


def implausible_values(machine: Machine) -> Iterator[tuple[str, str]]:
    """Find values of which the unit must be another.

    Args:
        machine: The machine.

    Yields:
        The field, and the value with its unit and what is usual.
    """
    for name, material in machine.materials.items():
        if material.young_modulus < SMALLEST_YOUNG_MODULUS:
            message = f"{material.young_modulus:g} N/m²: steel has 2.1e+11 N/m²; was {material.young_modulus:g} GPa meant?"
            yield f"materials.{name}.young_modulus", message
    for i, shaft in enumerate(machine.shafts):
        for j, section in enumerate(shaft.sections):
            if section.outer_diameter > LARGEST_DIAMETER:
                message = f"{section.outer_diameter:g} m: usual is 0.01 to 2 m; was {section.outer_diameter:g} mm meant?"
                yield f"shafts[{i}].sections[{j}].outer_diameter", message
    for i, bearing in enumerate(machine.bearings):
        for term in ("kxx", "kyy"):
            value = getattr(bearing, term)
            if value is not None and value < SMALLEST_STIFFNESS:
                message = f"{value:g} N/m: usual is 1e+6 to 1e+10 N/m; was {value:g} N/µm meant?"
                yield f"bearings[{i}].{term}", message
