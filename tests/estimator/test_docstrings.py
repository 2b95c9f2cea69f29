"""Docstrings of the estimator: one convention, Google's, with units in brackets and shapes in parentheses.

Every function's docstring begins with a verb. A public function states each argument, its returned value and the errors it
raises; a public dataclass its fields, in `Attributes:` or behind each. A private function needs no docstring. No docstring
begins with "What …", and no sentence runs across two constants.
"""

import ast
import re
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.syntax_trees import parsed, statements

ROOT = next(folder for folder in Path(__file__).resolve().parents if folder.name == "tests").parent
FILES = sorted((ROOT / "estimator").rglob("*.py"))

VERBS = (
    "Add Assemble Assess Build Cache Calibrate Capture Check Choose Collect Combine Compare Compute Condense Convert Correct "
    "Count Derive Describe Diagnose Divide Draw Eliminate End Estimate Expand Filter Find Fit Follow Identify "
    "Integrate Interpolate Join Judge Keep Lay Linearise List Make Mark Minimise Move Multiply Name Pair Pick Place "
    "Predict Prepare Project Read Reduce Regress Replace Report Restore Return Run Scale Separate Smooth Solve "
    "State Subtract Sum Take Test Yield"
)
"""First words of a function's summary; a verb that is missing may be added."""
QUESTIONS = ("What ", "How ", "Whether ", "When ", "Where ", "Which ", "Who ", "Why ")
"""Openings of indirect questions."""
NO_OPENING = (*QUESTIONS, "The same ", "…")
NUMBERS = frozenset({"float", "complex", "Floats", "Complexes", "Numbers"})
ARRAYS = frozenset({"Floats", "Complexes", "Numbers", "Bools", "Integers", "Indices", "NDArray"})
DATA_BASES = ("Struct", "NamedTuple")
VALIDATORS = ("field_validator", "model_validator", "field_serializer", "model_serializer")

Function = ast.FunctionDef | ast.AsyncFunctionDef


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_docstrings_state_arguments_units_shapes_and_errors(path: Path) -> None:
    assert list(faults(path.read_text())) == []


def faults(source: str) -> Iterator[str]:
    """Name what the docstrings of a file leave out, with the line."""
    tree = parsed(source)
    for name, function in public_functions(tree):
        for fault in faults_of_function(function):
            yield f"{function.lineno} {name}: {fault}"
    for node in tree.body:
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            for fault in _faults_of_class(node):
                yield f"{node.lineno} {node.name}: {fault}"
    if not ast.get_docstring(tree):
        yield "1: the file has no docstring"
    yield from _faults_of_openings(tree)


def _faults_of_openings(tree: ast.Module) -> Iterator[str]:
    for node in statements(tree):
        text = ast.get_docstring(node) if isinstance(node, Function) else None
        if isinstance(node, Function) and text and text.split()[0] not in VERBS.split():
            yield f"{node.lineno} {node.name}: its summary begins with '{text.split()[0]}', which is no verb of the list"
    for line, text in _all_docstrings(tree):
        if text.startswith(NO_OPENING):
            yield f"{line}: a docstring begins with '{text.split()[0]}'"
        if text.rstrip(".").endswith("…"):
            yield f"{line}: the sentence does not end"


def public_functions(tree: ast.Module) -> Iterator[tuple[str, Function]]:
    """Yield the public functions and methods of a file with their names."""
    for node in tree.body:
        if isinstance(node, Function) and not node.name.startswith("_"):
            yield node.name, node
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            for one in node.body:
                if isinstance(one, Function) and one.name[0] != "_" and not _has_decorator(one, *VALIDATORS):
                    yield f"{node.name}.{one.name}", one


def faults_of_function(function: Function) -> Iterator[str]:
    """Name what a public function's docstring leaves out."""
    text = ast.get_docstring(function)
    if not text:
        yield "has no docstring"
        return
    if not text.partition("\n")[0].endswith("."):
        yield "its summary does not end in its first line"
    yield from _faults_of_arguments(function, text)
    yield from _faults_of_returned(function, text)
    for error in sorted(_raised(function) - set(_section(text, "Raises"))):
        yield f"Raises: says nothing of {error}"


def _faults_of_arguments(function: Function, text: str) -> Iterator[str]:
    stated = _section(text, "Args")
    arguments = {one.arg: one for one in _arguments(function)}
    for name in stated.keys() - arguments.keys():
        yield f"Args: there is no {name}"
    for name, one in arguments.items():
        if name not in stated:
            yield f"Args: says nothing of {name}"
        elif one.annotation is not None:
            yield from (f"Args: {name} {fault}" for fault in _faults_of_value(one.annotation, stated[name]))


def _faults_of_returned(function: Function, text: str) -> Iterator[str]:
    if function.returns is None or ast.unparse(function.returns) == "None":
        return
    is_property = _has_decorator(function, "property", "setter")
    said = text.partition("\nReturns:\n")[2] or text.partition("\nYields:\n")[2]
    if is_property:
        said = text
    elif not said:
        yield "has no Returns:"
        return
    yield from (
        f"its returned value {fault}" for fault in _faults_of_value(function.returns, said.partition("\nRaises:\n")[0])
    )


def _faults_of_value(annotation: ast.expr, said: str) -> Iterator[str]:
    """Compare what is said of an argument, a returned value or a field with its type."""
    # A function takes arguments of its own, which are none of these.
    kind = re.sub(r"Callable\[\[[^\]]*\]", "Callable[", ast.unparse(annotation))
    words = set(re.findall(r"\w+", kind))
    if words & NUMBERS and not re.search(r"\[[^\]]+\]", said):
        yield "has no unit in brackets ([-] where it has none)"
    if words & ARRAYS and not re.search(r"\([^)]*,[^)]*\)|\(\.\.\.\)", said):
        yield "has no shape"


def _faults_of_class(node: ast.ClassDef) -> Iterator[str]:
    text = ast.get_docstring(node)
    if not text:
        yield "has no docstring"
        return
    if not (_has_decorator(node, "dataclass") or any(ast.unparse(base).endswith(DATA_BASES) for base in node.bases)):
        return
    stated = _section(text, "Attributes")
    fields = dict(_fields(node))
    for name in stated.keys() - fields.keys():
        yield f"Attributes: there is no {name}"
    for name, (annotation, own) in fields.items():
        said = own or stated.get(name)
        if said is None:
            yield f"Attributes: says nothing of {name}"
        else:
            yield from (f"Attributes: {name} {fault}" for fault in _faults_of_value(annotation, said))


def _fields(node: ast.ClassDef) -> Iterator[tuple[str, tuple[ast.expr, str | None]]]:
    """Yield the public fields of a class with their type and the docstring behind them."""
    for one, following in zip(node.body, [*node.body[1:], None], strict=True):
        if not isinstance(one, ast.AnnAssign) or not isinstance(one.target, ast.Name) or one.target.id.startswith("_"):
            continue
        if "ClassVar" not in ast.unparse(one.annotation):
            yield one.target.id, (one.annotation, _text(following))


def _all_docstrings(tree: ast.Module) -> Iterator[tuple[int, str]]:
    for node in statements(tree):
        if isinstance(node, ast.Module | ast.ClassDef | Function):
            for one in node.body:
                text = _text(one)
                if text is not None:
                    yield one.lineno, text


def _text(node: ast.stmt | None) -> str | None:
    if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str):
        return node.value.value.strip()
    return None


def _arguments(function: Function) -> list[ast.arg]:
    rest = [one for one in (function.args.vararg, function.args.kwarg) if one is not None]
    named = function.args.posonlyargs + function.args.args + function.args.kwonlyargs + rest
    return [one for one in named if one.arg not in ("self", "cls") and not one.arg.startswith("_")]


def _has_decorator(node: Function | ast.ClassDef, *names: str) -> bool:
    return any(ast.unparse(one).partition("(")[0].endswith(names) for one in node.decorator_list)


def _raised(function: Function) -> set[str]:
    found = set()
    for node in statements(function):
        if isinstance(node, ast.Raise) and isinstance(node.exc, ast.Call):
            found.add(ast.unparse(node.exc.func).rpartition(".")[2])
    return found


def _section(text: str, title: str) -> dict[str, str]:
    """Read `name: text` entries of one section; continuation lines are indented deeper."""
    _, there, rest = text.partition(f"\n{title}:\n")
    if not there:
        return {}
    entries: dict[str, str] = {}
    name = ""
    for line in rest.splitlines():
        if line and not line.startswith("    "):
            break
        match = re.match(r" {4}(\w+): (.*)", line)
        if match:
            name = match[1]
            entries[name] = match[2]
        elif name:
            entries[name] += " " + line.strip()
    return entries


GOOD = '''
"""A file."""

LIMIT = 1.0
"""Largest speed [rad/s]."""


def speed(angle: Floats, *, time: float) -> Floats:
    """Compute the speed.

    Args:
        angle: Angles (n,) [rad].
        time: Time [s].

    Returns:
        Speeds (n,) [rad/s].

    Raises:
        ValueError: The time is not positive.
    """
    if time <= 0.0:
        raise ValueError("time must be positive")
    return angle / time


@dataclass
class Sweep:
    """A sweep.

    Attributes:
        speed: Speeds (n,) [rad/s].
    """

    speed: Floats
'''


def test_nothing_is_missed_where_nothing_is_missing() -> None:
    assert list(faults(GOOD)) == []


@pytest.mark.parametrize(
    ("good", "bad", "fault"),
    [
        ("Compute the speed.", "The speed.", "its summary begins with 'The'"),
        ("Compute the speed.", "Compute the\n    speed.", "its summary does not end"),
        ("Largest speed [rad/s].", "What is too fast.", "begins with 'What'"),
        ("Largest speed [rad/s].", "Largest speed, …", "the sentence does not end"),
        ("        time: Time [s].\n", "", "says nothing of time"),
        ("time: Time [s].", "time: Time [s].\n        place: Place [m].", "there is no place"),
        ("Time [s].", "Time.", "time has no unit"),
        ("Angles (n,) [rad].", "Angles [rad].", "angle has no shape"),
        ("    Returns:\n        Speeds (n,) [rad/s].\n", "", "has no Returns:"),
        ("Returns:\n        Speeds (n,) [rad/s].", "Returns:\n        Speeds (n,).", "returned value has no unit"),
        ("Returns:\n        Speeds (n,) [rad/s].", "Returns:\n        Speeds [rad/s].", "returned value has no shape"),
        ("ValueError: The time", "KeyError: The time", "Raises: says nothing of ValueError"),
        ("        speed: Speeds (n,) [rad/s].\n    ", "        other: Speeds (n,) [rad/s].\n    ", "says nothing of speed"),
        ('"""A file."""', "", "the file has no docstring"),
    ],
)
def test_each_fault_is_found(good: str, bad: str, fault: str) -> None:
    assert good in GOOD
    assert any(fault in one for one in faults(GOOD.replace(good, bad, 1)))


if __name__ == "__main__":
    for name in sys.argv[1:]:
        for one in faults(Path(name).read_text()):
            print(f"{name}:{one}")
