"""Names of parameters and derived quantities as people read them: `kφx of coupling C1`, `critical speed 2`."""

import re

from estimator.machine.parameter_description import COMPONENTS, describe
from service.wording.language import ENGLISH, Language

_NUMBERED = (
    (re.compile(r"critical_speed\.(?P<number>\d+)"), "critical_speed"),
    (re.compile(r"damping_ratio\.(?P<number>\d+)"), "damping_ratio"),
    (re.compile(r"splitting\.(?P<one>\d+)-(?P<other>\d+)"), "splitting"),
    (re.compile(r"probe\.(?P<probe>[^.]+)\.amplification_factor\.(?P<number>\d+)"), "amplification_factor"),
    (re.compile(r"probe\.(?P<probe>[^.]+)\.second_over_first"), "second_over_first"),
)
"""Names whose numbers stand within a sentence."""
_SCALE = re.compile(r"(?P<coefficient>[kc][xy]{2})_scale")
_ANGULAR = re.compile(r"[kc][xy]?_phi[xy]{1,2}")


def parameter_words(name: str, language: Language = ENGLISH) -> str:
    """Return the words for a parameter or derived quantity, by its name in the API."""
    for form, key in _NUMBERED:
        found = form.fullmatch(name)
        if found:
            return language.translate(f"parameter.{key}", **found.groupdict())
    said = describe(name)
    if not said.quantity:  # of the machine as a whole
        return language.named(said.element_id or said.element)
    words = language.translate(
        "size.of_element", quantity=quantity_words(said.quantity, language), element=language.element(said.element)
    )
    if said.knot is not None:
        words = language.translate(
            "parameter.at_knot", words=words, knot=said.knot.replace("rpm", f" {language.named('rpm')}")
        )
    return words if said.component not in COMPONENTS else f"{words}, {language.named(said.component)}"


def quantity_words(quantity: str, language: Language = ENGLISH) -> str:
    """Return the words for a quantity of an element; coefficients keep their symbols, `kφx` for `k_phix`."""
    if scaled := _SCALE.fullmatch(quantity):
        return language.translate("parameter.scale", coefficient=scaled["coefficient"])
    return quantity.replace("_phi", "φ") if _ANGULAR.match(quantity) else language.named(quantity)
