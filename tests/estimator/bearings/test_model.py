"""The seam of bearing models: what the fit relies on holds for every form that is registered."""

import ast
import re
from typing import Any, get_args

import numpy as np
import pytest
from pydantic import TypeAdapter

from estimator.bearings.model import BearingForm, CoefficientModel, ModelParameter
from estimator.bearings.registry import CONSTANT, FORMS, DeclaredForm, place_of
from estimator.machine.document import parse_machine
from estimator.machine.parameter_description import describe
from estimator.rotor.coefficient_models import expects_a_law
from tests.estimator.trains import chapter_3_document
from tests.paths import PACKAGES, ROOT

EXAMPLES: dict[str, dict[str, Any]] = {
    "piecewise": {"knots_rpm": [500, 1500, 3000]},
    "polynomial": {"knots_rpm": [500, 1500, 3000]},
    "table": {
        "speed_rpm": [500, 900, 1500, 2200, 3000],
        "kxx": [3e8, 2.4e8, 2e8, 1.9e8, 1.9e8],
        "kxy": [4e7, -2e7, -1e8, -1.2e8, -1.1e8],
        "scale_spread": 0.2,
    },
}
"""One document of each form; a form without one fails the tests."""
BY_ITSELF = sorted(
    name for form in FORMS if form.whole_train is None for name in get_args(form.model_fields["form"].annotation)
)
"""Forms that give the coefficients of each bearing by itself; tests/estimator/statics/test_film_model.py is of the others."""
SPEED = np.linspace(40.0, 330.0, 13)
DIRECT = ModelParameter("bearing.B1.kxx", "stiffness", "N/m", True, 2e8, 1e8, 1.0, coefficient="bearing.B1.kxx")
CROSS = ModelParameter("bearing.B1.kxy", "stiffness", "N/m", False, 0.0, 1e8, 10.0, coefficient="bearing.B1.kxy")
ELEMENT = (DIRECT, CROSS)


def form_of(name: str) -> BearingForm:
    if name == "constant":
        return CONSTANT
    found: BearingForm = TypeAdapter(DeclaredForm).validate_python({"form": name, **EXAMPLES[name]})
    return found


def models() -> list[Any]:
    names = ("constant", *BY_ITSELF)
    found = [(name, model) for name in names for model in form_of(name).models(ELEMENT)]
    return [pytest.param(model, id=f"{name}-{'-'.join(model.coefficients)}") for name, model in found]


def drawn(model: CoefficientModel) -> np.ndarray[Any, np.dtype[np.float64]]:
    return np.random.default_rng(3).normal(0.1, 0.3, len(model.parameters))


@pytest.mark.parametrize("model", models())
def test_derivatives_are_those_of_the_values(model: CoefficientModel) -> None:
    curves, at = model.at(SPEED), drawn(model)
    found = curves.derivatives(at, slice(2, 9))
    assert found.shape == (7, len(model.coefficients), len(model.parameters))
    for p in range(at.size):
        step = 1e-5 * np.eye(at.size)[p]
        difference = (curves.values(at + step) - curves.values(at - step))[2:9] / 2e-5
        assert found[:, :, p] == pytest.approx(difference, rel=1e-7, abs=1e-7 * ELEMENT[0].scale)


@pytest.mark.parametrize("model", models())
def test_a_level_is_the_same_at_every_speed(model: CoefficientModel) -> None:
    governed = [one for one in ELEMENT if one.name in model.coefficients]
    if expects_a_law(model):
        with pytest.raises(ValueError, match="cannot be constant"):
            model.level(np.full(len(governed), 0.2))
        return
    values = model.at(SPEED).values(model.level(np.full(len(governed), 0.2)))
    assert values == pytest.approx(np.tile([float(one.value(np.array(0.2))) for one in governed], (SPEED.size, 1)), rel=1e-12)


@pytest.mark.parametrize("name", ["constant", *BY_ITSELF])
def test_every_coefficient_is_given_once_and_every_parameter_counted(name: str) -> None:
    form = form_of(name)
    found = form.models(ELEMENT)
    assert sorted(one for model in found for one in model.coefficients) == sorted(one.name for one in ELEMENT)
    assert sum(len(model.parameters) for model in found) == form.parameter_count(["kxx", "kxy"])
    assert all(model.constant == (name == "constant") for model in found)


@pytest.mark.parametrize("model", models())
def test_names_say_what_is_positive(model: CoefficientModel) -> None:
    for one in model.parameters:
        assert (describe(one.name).element, describe(one.name).positive) == ("bearing.B1", one.positive)


def test_every_form_has_a_place_in_a_document() -> None:
    for name, fields in EXAMPLES.items():
        document = chapter_3_document()
        bearing = document["bearings"][1]
        document["bearings"][1] = {key: bearing[key] for key in bearing if key not in fields}  # a table gives them instead
        document["bearings"][1]["speed_dependence"] = {"form": name, **fields}
        form = parse_machine(document).bearings[1].speed_dependence
        assert form is not None
        assert form.governs("kxx")


def test_a_place_in_a_document_does_not_name_the_class_of_a_form() -> None:
    known = {"type": "missing", "loc": ("bearings", 1, "speed_dependence", "SpeedDependence", "knots_rpm")}
    assert place_of(known) == ("bearings", 1, "speed_dependence", "knots_rpm")
    assert place_of({"type": "unknown_form", "loc": ("seals", 0, "speed_dependence")}) == (
        "seals",
        0,
        "speed_dependence",
        "form",
    )
    assert place_of({"type": "missing", "loc": ("materials", "SpeedDependence", "density")})[1] == "SpeedDependence"


def test_only_one_place_asks_for_the_class_of_a_form() -> None:
    """All others ask what the form declares, so that one more form is no case of theirs."""
    names = {form.__name__ for form in FORMS}
    found = {
        path.relative_to(ROOT).as_posix()
        for package in PACKAGES
        for path in (ROOT / package).rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.Call) and ast.unparse(node.func) == "isinstance"
        if names & set(re.findall(r"\w+", ast.unparse(node.args[1])))
    }
    assert found == {"estimator/machine/bearings_on_films.py"}
