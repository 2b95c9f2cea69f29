"""Names: a class or type alias stands for one thing in the packages and the benchmarks, a function has a word of the trade."""

import ast
import re
from collections import defaultdict
from collections.abc import Iterator

from tests.paths import PACKAGES as INSTALLED
from tests.paths import ROOT
from tests.syntax_trees import parsed, statements

PACKAGES = (*INSTALLED, "benchmarks")

_DIALECT = """
ails anew befalls doubt giving happen hasten heard holes lest letter noted news people putting said say some spoken tell
tells told unheeded
"""
DIALECT = frozenset(_DIALECT.split())
"""Words of no trade, instead of report, send, describe, translate, record, change, event, reason, mail."""
_TYPE_DIALECT = """
ailing apart away beginnings came happened lately learnt lent nobody stands trouble
"""
TYPE_DIALECT = DIALECT - {"doubt"} | frozenset(_TYPE_DIALECT.split())
"""The same in names of classes and modules."""
WORD = re.compile("[A-Z]?[a-z0-9]+")
API_NAMES = {"ToldCause", "Happened"}
"""Classes whose names the API's document holds."""


def type_names(source: str) -> Iterator[tuple[str, int]]:
    """Yield the names of classes, type aliases and type variables of a file, with their lines.

    A type alias is what a module assigns to a name in capitals and small letters; type variables of one letter are left out.
    """
    tree = parsed(source)
    for node in statements(tree):
        if isinstance(node, ast.ClassDef):
            yield node.name, node.lineno
    for node in tree.body:
        if isinstance(node, ast.FunctionDef):
            yield from _if_type(node.name, node.lineno)
        elif isinstance(node, ast.Assign):
            for one in node.targets:
                if isinstance(one, ast.Name):
                    yield from _if_type(one.id, node.lineno)
        elif isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            yield from _if_type(node.target.id, node.lineno)
        elif type(node).__name__ == "TypeAlias":  # the statement `type A = …` of Python 3.12
            yield node.name.id, node.lineno  # type: ignore[attr-defined]


def _if_type(name: str, line: int) -> Iterator[tuple[str, int]]:
    if name[:1].isupper() and not name.isupper():
        yield name, line


def test_no_two_classes_or_type_aliases_have_one_name() -> None:
    found = defaultdict[str, list[str]](list)
    for package in PACKAGES:
        for path in sorted((ROOT / package).rglob("*.py")):
            for name, line in type_names(path.read_text()):
                found[name].append(f"{path.relative_to(ROOT)}:{line}")
    assert len(found) > 1000
    assert {name: places for name, places in found.items() if len(places) > 1} == {}


SAME_IN_TESTS = {
    "Floats": "the same arrays",
    "Complexes": "the same arrays",
    "Indices": "the same arrays",
    "Document": "the same machine documents",
    "Service": "the same service, which the tests start and users reach",
    "Function": "the same statements",
}
"""Names that tests have, too, for the same thing, or several of their files."""
APART = ROOT / "tests" / "film_plant"
"""Simulated trains whose bearings and shafts share no code with the estimator's: they are the same things by other physics."""


def test_a_class_of_the_tests_stands_for_one_thing() -> None:
    own = {name for package in PACKAGES for path in (ROOT / package).rglob("*.py") for name, _ in type_names(path.read_text())}
    paths = [path for path in sorted((ROOT / "tests").rglob("*.py")) if APART not in path.parents]
    assert len(paths) > 300
    found = {(name, f"{path.relative_to(ROOT)}:{line}") for path in paths for name, line in type_names(path.read_text())}
    assert {(name, place) for name, place in found if name in own and name not in SAME_IN_TESTS} == set()
    assert set(SAME_IN_TESTS) <= own | {"Function"}
    places = defaultdict[str, set[str]](set)
    for name, place in found:
        places[name].add(place)
    assert {name: where for name, where in places.items() if len(where) > 1 and name not in SAME_IN_TESTS} == {}


def test_each_kind_of_definition_is_seen() -> None:
    source = """
Level = Literal["ok", "wrong"]
Kind: TypeAlias = str | None
Number = NewType("Number", int)
LIMIT = 3
T = TypeVar("T")


def Name(length: int) -> String: ...


def name() -> None:
    class Inner: ...
"""
    assert [name for name, _ in type_names(source)] == ["Inner", "Level", "Kind", "Number", "Name"]


def dialect(source: str) -> list[str]:
    """Return the functions of a file whose names hold a word of no trade."""
    functions = (node for node in statements(parsed(source)) if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef))
    return [node.name for node in functions if DIALECT & set(node.name.strip("_").split("_"))]


def test_functions_are_called_by_words_of_the_trade() -> None:
    paths = [path for package in PACKAGES[:-1] for path in sorted((ROOT / package).rglob("*.py"))]
    assert len(paths) > 500
    assert {path.relative_to(ROOT).as_posix(): found for path in paths if (found := dialect(path.read_text()))} == {}


FIXED_FIELDS = {
    "noted": "option of `rundown audit verify`",
    "noted_in": "option of `rundown audit verify`",
    "holes": "option of `rundown balance`",
    "told": "stored in the state of a machine's collection",
    "told_of": "relation of a table",
}
"""Fields and parameters whose names users or stores know."""


def field_dialect(source: str) -> list[str]:
    """Return the fields of a file's public classes and the parameters of its public functions that hold a word of no trade."""
    names = []
    for node in statements(parsed(source)):
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            names += [
                one.target.id for one in node.body if isinstance(one, ast.AnnAssign) and isinstance(one.target, ast.Name)
            ]
        elif isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) and not node.name.startswith("_"):
            given = node.args
            names += [one.arg for one in (*given.posonlyargs, *given.args, *given.kwonlyargs)]
    words = DIALECT - {"doubt"}
    return [name for name in names if words & set(name.strip("_").split("_")) and not name.startswith("_")]


def test_fields_and_parameters_are_called_by_words_of_the_trade() -> None:
    paths = [path for package in PACKAGES[:-1] for path in sorted((ROOT / package).rglob("*.py"))]
    found = {path.relative_to(ROOT).as_posix(): field_dialect(path.read_text()) for path in paths}
    assert {name for names in found.values() for name in names} == set(FIXED_FIELDS), {k: v for k, v in found.items() if v}


def test_a_word_of_no_trade_is_seen_in_fields_and_parameters() -> None:
    source = """
class Rate:
    said: str
    unit: str
    _held: int
    told_at: int = 0


class _Own:
    said: str


def show(alert: str, *, tell: bool = True) -> None: ...
def _show(tell: bool) -> None: ...
"""
    assert field_dialect(source) == ["said", "told_at", "tell"]


def type_dialect(module: str, source: str) -> list[str]:
    """Return those of the names of a module, its classes and its type aliases that hold a word of no trade."""
    names = [module, *(name for name, _ in type_names(source))]
    return [one for one in names if TYPE_DIALECT & {word.lower() for word in WORD.findall(one)}]


def test_classes_and_modules_are_called_by_words_of_the_trade() -> None:
    paths = [path for package in PACKAGES[:-1] for path in sorted((ROOT / package).rglob("*.py"))]
    found = {(path.stem, name) for path in paths for name in type_dialect(path.stem, path.read_text())}
    assert {name for _, name in found} == API_NAMES, found


def test_a_word_of_no_trade_is_seen_in_types_and_modules() -> None:
    source = "AsItCame = tuple[str, int]\n\nclass _Beginnings: ...\n\nclass Somewhere: ...\n"
    assert sorted(type_dialect("lent_threads", source)) == ["AsItCame", "_Beginnings", "lent_threads"]


def test_a_word_of_no_trade_is_seen() -> None:
    source = """
def reported(message: str) -> None: ...


class Sender:
    async def _tell_all(self) -> None: ...
    def told_names(self) -> None: ...
"""
    assert sorted(dialect(source)) == ["_tell_all", "told_names"]
