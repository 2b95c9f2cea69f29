"""Names of parameters are separated into their parts in one place; nothing else decides by a name's ends or letters."""

import ast
from collections.abc import Iterator

import pytest

from estimator.bearings.registry import OWN_PARAMETERS
from estimator.bearings.terms import TERMS
from estimator.machine.alignment_rules import CouplingPosition
from estimator.machine.part_coefficients import ELEMENTS
from estimator.quantities import UNITS
from tests.paths import PACKAGES as INSTALLED
from tests.paths import ROOT
from tests.syntax_trees import parsed

PACKAGES = (*INSTALLED, "benchmarks")
KINDS = {*ELEMENTS.values(), "disc", "films", "journal", "material", "oil", "probe", "shaft", "static_load"}
"""First parts of names, and what films are called."""
WORDS = (
    KINDS | set(OWN_PARAMETERS) | set(TERMS) | {one.replace(" ", "_") for one in UNITS} | set(CouplingPosition.model_fields)
)
LETTERS = {one[0] for one in TERMS} | {"p", "x", "y"}
"""First letters of terms, and those that tell an axis: `name[0] == "k"`."""
ENDS = ("startswith", "endswith", "removeprefix", "removesuffix")
CUTS = ("split", "rsplit", "partition", "rpartition")
PARSERS = {
    "estimator/machine/parameter_description.py": "the parser",
    "estimator/rotor/parameter_names.py": "numbers of critical speeds, which no machine document names",
    "estimator/bearings/table.py": "a bearing model stands below the parser; it cuts the term off",
    "service/wording/language.py": "the kind of an element is the key of its word in each language",
    "estimator/close_matches.py": "names of any kind, which it compares and does not understand",
    "service/security/tokens.py": "paths of claims",
    "service/__main__.py": "names of modules",
    "rotorundown/environment/optional_packages.py": "names of modules",
    "benchmarks/fluid_film/reference_arrays.py": "names of arrays in a file",
}
"""Modules that may cut a name at its dots, and why."""


def literals(node: ast.expr) -> Iterator[str]:
    """Yield the constant texts of an argument: of a string, of the beginning of an f-string, or of a tuple of either."""
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        yield node.value
    elif isinstance(node, ast.JoinedStr):
        yield from literals(node.values[0])
    elif isinstance(node, ast.Tuple):
        for one in node.elts:
            yield from literals(one)


def is_of_a_name(text: str) -> bool:
    """Return whether a text is of a parameter's name: a kind, or the beginning of a quantity, or anything between dots."""
    word = text.strip(".")
    return bool(word) and (word.partition(".")[0] in WORDS or any(one.startswith(word) for one in WORDS if len(word) > 2))


def _is_slice(node: ast.expr) -> bool:
    """Return whether an expression is a letter at a fixed place, or some letters, of a name."""
    if not isinstance(node, ast.Subscript) or not isinstance(node.value, ast.Name | ast.Attribute):
        return False
    return isinstance(node.slice, ast.Slice | ast.UnaryOp) or isinstance(getattr(node.slice, "value", None), int)


def faults(source: str, *, may_cut: bool) -> list[str]:
    """Return the calls that look at the ends of a parameter's name, or cut it at its dots where that is not allowed."""
    found = []
    for node in ast.walk(parsed(source)):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.args:
            texts = list(literals(node.args[0]))
            ends = node.func.attr in ENDS and any(is_of_a_name(one) for one in texts)
            if ends or (node.func.attr in CUTS and texts == ["."] and not may_cut):
                found.append(ast.unparse(node))
        elif isinstance(node, ast.Compare) and _is_slice(node.left):
            compared = [text for one in node.comparators for text in literals(one)]
            if any(text in LETTERS or is_of_a_name(text) for text in compared):
                found.append(ast.unparse(node))
    return found


@pytest.mark.parametrize("package", PACKAGES)
def test_names_of_parameters_are_parsed_in_one_place(package: str) -> None:
    paths = {path.relative_to(ROOT).as_posix(): path for path in (ROOT / package).rglob("*.py")}
    found = {name: faults(path.read_text(), may_cut=name in PARSERS) for name, path in paths.items()}
    assert {name: calls for name, calls in found.items() if calls} == {}, (
        "ask estimator.machine.parameter_description.describe"
    )


def test_modules_that_may_cut_names_still_do() -> None:
    assert [name for name in PARSERS if not faults((ROOT / name).read_text(), may_cut=False)] == []


@pytest.mark.parametrize(
    "call",
    [
        "name.startswith('bearing.')",
        "name.startswith(('coupling.', 'pedestal.'))",
        "name.startswith(f'films.{bearing}.')",
        "said.quantity.startswith('elevation')",
        "name.endswith('.unbalance')",
        "name.removeprefix('disc.')",
        "name.rpartition('.')[2]",
        "element.split('.')",
        "term[0] == 'k'",
        "name[-2:] in ('xx', 'yy', 'kxx')",
        "one.term[:1] != 'c'",
    ],
)
def test_a_name_that_is_looked_at_by_itself_is_found(call: str) -> None:
    assert len(faults(call, may_cut=False)) == 1


@pytest.mark.parametrize(
    "call",
    ["url.startswith('http')", "topic.split('/')", "line.endswith('\\n')", "text.startswith(end)", "parts[2] != 'samples'"],
)
def test_other_texts_are_not(call: str) -> None:
    assert faults(call, may_cut=False) == []
