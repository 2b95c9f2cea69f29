"""Machine with the moduli and densities of its materials multiplied by factors, such as fitted ones."""

from collections.abc import Mapping

from estimator.machine.document import Machine

SCALED = ("young_modulus", "density")
"""Properties of a material that may be multiplied."""


def with_scaled_materials(machine: Machine, factors: Mapping[str, float]) -> Machine:
    """Return a machine with its materials' properties multiplied.

    Args:
        machine: The machine.
        factors: Factor by name, such as `material.steel.density` [-]; 1 where none is given.

    Returns:
        The machine.
    """
    materials = {
        name: material.model_copy(
            update={what: getattr(material, what) * factors.get(f"material.{name}.{what}", 1.0) for what in SCALED}
        )
        for name, material in machine.materials.items()
    }
    return machine.model_copy(update={"materials": materials})
