"""Registry of bearing models: a new one is its module and its form's name here.

A form is a `Part` with a literal field `form` and the methods of `BearingForm`.
"""

from collections.abc import Iterable
from typing import TYPE_CHECKING, Annotated, Any, TypeVar, Union, get_args

from pydantic import BaseModel, Discriminator, Tag

from estimator.bearings.constant import Constant
from estimator.bearings.journal import JournalForm
from estimator.bearings.knots import SpeedDependence
from estimator.bearings.model import BearingForm, OwnParameter
from estimator.bearings.table import Table

T = TypeVar("T")

FORMS = (SpeedDependence, Table, JournalForm)
"""Forms of `speed_dependence` in a machine document."""

CONSTANT = Constant()
"""Form of an element whose document gives none."""


def _by_name(named: Iterable[tuple[str, T]]) -> dict[str, T]:
    """Return a dictionary of registered objects. Raises ValueError for a name that is registered twice."""
    found: dict[str, T] = {}
    for name, one in named:
        if name in found:
            raise ValueError(f"bearing models register '{name}' twice: each form and each parameter needs a name of its own")
        found[name] = one
    return found


def _require_members(form: type[BaseModel]) -> None:
    """Check that a form has all methods and fields of `BearingForm`. Raises TypeError."""
    asked = [name for name in vars(BearingForm) if not name.startswith("_")]
    missing = [name for name in asked if name not in form.model_fields and not hasattr(form, name)]
    if missing:
        raise TypeError(f"the bearing form {form.__name__} lacks {', '.join(missing)}")


for _form in FORMS:
    _require_members(_form)

OWN_PARAMETERS: dict[str, OwnParameter] = _by_name((one.name, one) for form in FORMS for one in form.own_parameters)
"""Kinds of parameters that the models have beside coefficients, by the last part of their names."""

_CLASSES = _by_name((name, form) for form in FORMS for name in get_args(form.model_fields["form"].annotation))
FORM_NAMES = tuple(_CLASSES)
"""Values that `form` may have."""
_UNKNOWN = "unknown_form"


def _tag(value: Any) -> str | None:
    """Return the name of the class that a part of a document, or its content, belongs to; None where `form` names none."""
    form = value.get("form") if isinstance(value, dict) else getattr(value, "form", None)
    return _CLASSES[form].__name__ if isinstance(form, str) and form in _CLASSES else None


def _declared() -> Any:
    """Return the type of a document's field that takes any of the forms, told apart by `form`."""
    if len(FORMS) == 1:
        return FORMS[0]
    tagged = tuple(Annotated[form, Tag(form.__name__)] for form in FORMS)
    names = ", ".join(map(repr, FORM_NAMES[:-1]))
    message = f"Input should be {names} or {FORM_NAMES[-1]!r}"
    return Annotated[Union[tagged], Discriminator(_tag, custom_error_type=_UNKNOWN, custom_error_message=message)]  # noqa: UP007


if TYPE_CHECKING:
    DeclaredForm = BearingForm
else:
    DeclaredForm = _declared()


def place_of(error: Any) -> tuple[int | str, ...]:
    """Return the place in a document of a pydantic error: pydantic also names the form's class, which is left out.

    Args:
        error: The error as pydantic lists it.

    Returns:
        Names and indices from the document down.
    """
    location = tuple(error["loc"])
    classes = {form.__name__ for form in FORMS}
    behind = zip(location, ("", *location), strict=False)
    place = tuple(part for part, before in behind if not (before == "speed_dependence" and part in classes))
    return (*place, "form") if error["type"] == _UNKNOWN else place
