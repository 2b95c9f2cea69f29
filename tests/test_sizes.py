"""Sizes of classes and functions: what is larger has more than one idea in it."""

import ast
from collections.abc import Iterator

from tests.paths import PACKAGES, ROOT
from tests.syntax_trees import parsed, statements

LARGEST_CLASS = 200
"""Most lines of a class, docstrings included."""
MAXIMUM_METHODS = 15
"""Most methods of a class."""
LARGEST_FUNCTION = 60
"""Most lines of a function, docstring included."""
FLAT_CLIENTS = {("service/client.py", "Rundown"), ("rotorundown/result.py", "Result")}
"""Faces with a method for each operation of the API, or for each result of an identification: these may have more methods."""

Function = ast.FunctionDef | ast.AsyncFunctionDef


def test_classes_have_one_idea() -> None:
    too_large = []
    for file, tree in modules(*PACKAGES, "benchmarks"):
        for one in statements(tree):
            if isinstance(one, ast.ClassDef):
                methods = sum(isinstance(part, Function) for part in one.body)
                if lines(one) > LARGEST_CLASS or (methods > MAXIMUM_METHODS and (file, one.name) not in FLAT_CLIENTS):
                    too_large.append(f"{file}:{one.lineno} {one.name}: {lines(one)} lines, {methods} methods")
    assert not too_large, (
        f"{'; '.join(too_large)}: a class has at most {LARGEST_CLASS} lines and {MAXIMUM_METHODS} methods. Find the second "
        "idea in it (state that only some of its methods use) and give that a class or a module of its own"
    )


def test_functions_have_one_idea() -> None:
    too_long = [
        f"{file}:{one.lineno} {one.name}: {lines(one)} lines"
        for file, tree in modules(*PACKAGES, "benchmarks")
        for one in statements(tree)
        if isinstance(one, Function) and lines(one) > LARGEST_FUNCTION
    ]
    assert not too_long, (
        f"{'; '.join(too_long)}: a function has at most {LARGEST_FUNCTION} lines. Make functions of its steps, each named "
        "after its result"
    )


def modules(*packages: str) -> Iterator[tuple[str, ast.Module]]:
    """Yield each file of some packages but migrations, with its syntax tree."""
    for package in packages:
        files = [file for file in sorted((ROOT / package).rglob("*.py")) if "migrations" not in file.parts]
        assert files, f"{package} holds no modules: has it moved?"
        for file in files:
            yield str(file.relative_to(ROOT)), parsed(file.read_text())


def lines(node: ast.ClassDef | Function) -> int:
    """Return the number of lines of a class or function, its docstring included."""
    return (node.end_lineno or node.lineno) - node.lineno + 1
