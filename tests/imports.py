"""Finds which modules a module imports, directly and by way of others, as its text says: nothing is imported to find out."""

import ast
import functools
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parent.parent


def imported_by(module: str) -> set[str]:
    """All modules of this project that one imports at run time, and the packages of others, by their first name."""
    found: set[str] = set()
    waiting = [module]
    while waiting:
        one = waiting.pop()
        if one in found:
            continue
        path = path_of(one)
        if path is None:
            continue
        found.add(one)
        for name in _named_in(path):
            waiting.append(name)
            if path_of(name.split(".")[0]) is None:
                found.add(name.split(".")[0])
    return found


def imported_directly_by(module: str) -> set[str]:
    """Return what one module names in its imports at run time."""
    path = path_of(module)
    assert path is not None
    return set(_named_in(path))


@functools.cache
def _named_in(path: Path) -> tuple[str, ...]:
    return tuple(_named(ast.parse(path.read_text())))


def _named(node: ast.AST) -> Iterator[str]:
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.If) and isinstance(child.test, ast.Name) and child.test.id == "TYPE_CHECKING":
            continue
        if isinstance(child, ast.Import):
            yield from (one.name for one in child.names)
        elif isinstance(child, ast.ImportFrom) and child.module is not None:
            yield child.module
            yield from (f"{child.module}.{one.name}" for one in child.names)
        yield from _named(child)


def path_of(module: str) -> Path | None:
    """Return the file of a module of this project; None of another's."""
    path = ROOT.joinpath(*module.split("."))
    for one in (path.with_suffix(".py"), path / "__init__.py"):
        if one.is_file():
            return one
    return None
