"""The bearing models there are: a new one is its module and its form's name here.

A form is a `Part` with a literal field `form` and the methods of `BearingForm`.
"""

from typing import TYPE_CHECKING, Annotated, Union, get_args

from pydantic import Field

from estimator.bearing_model import BearingForm, OwnParameter
from estimator.constant_coefficients import Constant
from estimator.knot_coefficients import SpeedDependence

FORMS = (SpeedDependence,)
"""Forms of `speed_dependence` in a machine document."""

CONSTANT = Constant()
"""The form where a document gives none."""

if TYPE_CHECKING:
    DeclaredForm = BearingForm
else:
    DeclaredForm = FORMS[0] if len(FORMS) == 1 else Annotated[Union[FORMS], Field(discriminator="form")]  # noqa: UP007

OWN_PARAMETERS: dict[str, OwnParameter] = {one.name: one for form in FORMS for one in form.own_parameters}
"""Kinds of parameters that the models have beside coefficients, by the last part of their names."""

FORM_NAMES = {name for form in FORMS for name in get_args(form.model_fields["form"].annotation)}
"""What `form` may be."""


def without_form(location: tuple[int | str, ...]) -> tuple[int | str, ...]:
    """Return the place of an error in a document without the form's name, which is no field of it."""
    behind = zip(location, ("", *location), strict=False)
    return tuple(part for part, before in behind if not (before == "speed_dependence" and part in FORM_NAMES))
