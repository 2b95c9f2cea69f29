"""Docstrings of service, storage and benchmarks: every public part has one, and that of a function begins with a verb.

The rooms of the estimator have a stricter test beside them, which checks arguments, units and shapes as well. In tests,
examples and the documentation's build no docstring begins with "What …", "How …" and the like.
"""

import ast
import builtins
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.estimator.test_docstrings import NO_OPENING, QUESTIONS, VERBS
from tests.paths import PACKAGES as INSTALLED
from tests.paths import ROOT
from tests.syntax_trees import parsed, statements

PACKAGES = (*sorted({*INSTALLED} - {"estimator"}), "benchmarks")
OWN_VERBS = (
    "Accept Acknowledge Acquire Allow Answer Append Apply Ask Begin Bind Call Cancel Claim Clear Close Commit Complete "
    "Compose Compress Configure Confirm Copy Create Decode Decrypt Delete Deliver Demonstrate Disable Disconnect Drop "
    "Enable Encode Encrypt Fail Fetch Fill Finish Generate Give Group Handle Hash Hold Ignore Install Keep Kill Leave Let "
    "Load Log Measure Migrate Monitor Notify Open Parse Pass Pause Post Print Probe Publish Push Put Quarantine Queue Raise "
    "Reactivate Receive Record Redirect Refuse Register Reject Release Remind Remove Render Reply Require Reset Resolve "
    "Retry Revoke Save Seal Select Send Serve Set Shelve Show Simulate Sort Split Start Stop Store Stream Submit Subscribe "
    "Suppress Tell Try Tune Unlatch Update Verify Wait Write "
    "Concatenate Do Flush Freeze Limit Lock Note Order Overwrite Pack Pickle Process Rename Restrict Rewrite Transfer "
    "Undeclare Unlock Upgrade Work Abandon Continue Declare Deregister Exclude File Forget Go Have Iterate Look Postpone "
    "Query Reopen Request Say Warn Plot Calibrate"
)
"""First words of a function's docstring, beside those of the estimator; a verb that is missing may be added."""
ALEMBIC = ("upgrade", "downgrade")
"""Functions that every migration has: its file says what they do."""
ALLOWED = frozenset({*VERBS.split(), *OWN_VERBS.split()})

Function = ast.FunctionDef | ast.AsyncFunctionDef


def room_of(path: Path) -> str:
    """Return the room of a file: its package, and the folder in it."""
    return "/".join(path.relative_to(ROOT).parent.parts[:2])


FILES = [path for package in PACKAGES for path in sorted((ROOT / package).rglob("*.py"))]
ROOMS = sorted({room_of(path) for path in FILES})


@pytest.mark.parametrize("room", list(ROOMS))
def test_docstrings_are_there_and_begin_with_a_verb(room: str) -> None:
    assert faults_of_room(room) == []


def faults_of_room(room: str) -> list[str]:
    """List the faults of a room's docstrings, with file and line."""
    files = [path for path in FILES if room_of(path) == room]
    return [f"{path.relative_to(ROOT)}:{fault}" for path in files for fault in faults(path.read_text())]


def faults(source: str) -> Iterator[str]:
    """Name the missing and the wrong docstrings of a file, with the line."""
    tree = parsed(source)
    if not ast.get_docstring(tree):
        yield "1: the file has no docstring"
    yield from _missing(tree)
    for node in statements(tree):
        if isinstance(node, Function):
            yield from _faults_of_opening(node)
    for line, text in _documented_constants(tree):
        if text.startswith(NO_OPENING):
            yield f"{line}: the docstring begins with '{text.split()[0]}'"
        if text.rstrip(".").endswith("…"):
            yield f"{line}: the sentence does not end"


def question_openings(source: str) -> Iterator[str]:
    """Name the docstrings of a file that begin as an indirect question does, with the line."""
    tree = parsed(source)
    texts = [(node.lineno, ast.get_docstring(node) or "") for node in statements(tree) if isinstance(node, Function)]
    for line, text in (*texts, *_documented_constants(tree)):
        if text.startswith(QUESTIONS):
            yield f"{line}: the docstring begins with '{text.split()[0]}'"


OTHERS = ("tests", "examples", "docs_site")
"""Folders whose docstrings only have to begin rightly."""
FRAGMENTS = ("Also ", "As ", "At ", "From ", "In ", "It ", "Nothing.", "Of ", "On ", "Over ", "Until ", "With ")
"""Openings of half a sentence, whose other half the function's name would have to be."""


def fragment_openings(source: str) -> Iterator[str]:
    """Name the docstrings of a file's functions, tests aside, that begin with half a sentence, with the line."""
    for node in statements(parsed(source)):
        if isinstance(node, Function) and not node.name.startswith("test_"):
            text = ast.get_docstring(node) or ""
            if text.startswith(FRAGMENTS):
                yield f"{node.lineno}: the docstring of {node.name} begins with '{text.split()[0]}', which no verb precedes"


@pytest.mark.parametrize("folder", OTHERS)
def test_docstrings_of_tests_begin_with_a_verb_or_a_noun(folder: str) -> None:
    files = [path for path in sorted((ROOT / folder).rglob("*.py")) if "node_modules" not in path.parts]
    assert files
    found = [
        f"{path.relative_to(ROOT)}:{fault}"
        for path in files
        for openings in (question_openings, fragment_openings)
        for fault in openings(path.read_text())
    ]
    assert found == []


def test_a_question_as_opening_is_found() -> None:
    assert list(question_openings(GOOD)) == []
    for good in ("A file.", "Largest number of attempts.", "A queue.", "Count the entries."):
        assert list(question_openings(GOOD.replace(good, "Where entries wait.")))


def test_half_a_sentence_as_opening_is_found() -> None:
    assert list(fragment_openings(GOOD)) == []
    assert list(fragment_openings(GOOD.replace("Count the entries.", "Of the entries, how many.")))
    assert not list(fragment_openings(GOOD.replace("def size", "def test_size").replace("Count the", "Of the")))


GLOSS = re.compile(r"(?:^|[.;]\s+)\w+: of (?=[a-z])", re.MULTILINE)
"""A field that is explained by half a sentence: `size: of the message` instead of `size: size of the message`."""


def test_fields_are_explained_in_whole_words() -> None:
    found = [
        f"{path.relative_to(ROOT)}:{getattr(node, 'lineno', 1)}: {gloss[0].strip()}"
        for path in FILES
        for node in statements(parsed(path.read_text()))
        if isinstance(node, ast.Module | ast.ClassDef | Function)
        for gloss in [GLOSS.search(ast.get_docstring(node) or "")]
        if gloss is not None
    ]
    assert found == []
    assert GLOSS.search("A message. size: of the whole message [bytes].")


RAISED = re.compile(r"\b[Rr]aises?:?\s+((?:[^.;\n]|\n(?!\s*\n))*)")
"""Text behind "Raises" in a docstring, up to the end of the sentence."""
CLASS_NAME = re.compile(r"\b[A-Z][a-z]+[A-Z]\w*")
OF_LIBRARIES = {"UaStatusCodeError"}
"""Errors that libraries raise and that no file of ours names in its code."""


def unknown_errors(source: str, known: frozenset[str]) -> list[str]:
    """Return the classes that docstrings of a file say are raised and that it neither imports nor anything defines."""
    tree = parsed(source)
    own = {
        one.asname or one.name
        for node in statements(tree)
        if isinstance(node, ast.Import | ast.ImportFrom)
        for one in node.names
    }
    own |= {node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute)}
    texts = [ast.get_docstring(node) or "" for node in statements(tree) if isinstance(node, ast.ClassDef | Function)]
    named = {name for text in texts for clause in RAISED.findall(text) for name in CLASS_NAME.findall(clause)}
    return sorted(named - own - known - OF_LIBRARIES)


def test_errors_that_docstrings_name_exist() -> None:
    every = [*FILES, *sorted((ROOT / "estimator").rglob("*.py"))]
    nodes = (node for path in every for node in statements(parsed(path.read_text())))
    known = frozenset({*dir(builtins), *(node.name for node in nodes if isinstance(node, ast.ClassDef))})
    found = {path.relative_to(ROOT).as_posix(): unknown_errors(path.read_text(), known) for path in every}
    assert {path: names for path, names in found.items() if names} == {}
    wrong = 'def held() -> None:\n    """Check the lease. Raises NotHeld, KeyError."""\n'
    assert unknown_errors(wrong, known) == ["NotHeld"]


def _missing(node: ast.Module | ast.ClassDef) -> Iterator[str]:
    for one in node.body:
        if isinstance(one, Function | ast.ClassDef) and not one.name.startswith("_") and one.name not in ALEMBIC:
            if not ast.get_docstring(one):
                yield f"{one.lineno}: {one.name} has no docstring"
            if isinstance(one, ast.ClassDef):
                yield from _missing(one)


def _faults_of_opening(function: Function) -> Iterator[str]:
    words = (ast.get_docstring(function) or "").split()
    if words and words[0].rstrip(".,:;") not in ALLOWED:
        yield f"{function.lineno}: the docstring of {function.name} begins with '{words[0]}', which is no verb of the list"


def _documented_constants(tree: ast.Module) -> Iterator[tuple[int, str]]:
    """Yield the docstrings of files, classes and constants with their lines."""
    for node in statements(tree):
        if isinstance(node, ast.Module | ast.ClassDef):
            for one in node.body:
                if isinstance(one, ast.Expr) and isinstance(one.value, ast.Constant) and isinstance(one.value.value, str):
                    yield one.lineno, one.value.value.strip()


GOOD = '''
"""A file."""

LIMIT = 3
"""Largest number of attempts."""


class Queue:
    """A queue."""

    def size(self) -> int:
        """Count the entries."""
        return 0
'''


def test_no_fault_is_found_where_there_is_none() -> None:
    assert list(faults(GOOD)) == []


@pytest.mark.parametrize(
    ("good", "bad", "fault"),
    [
        ('"""A file."""', "", "the file has no docstring"),
        ('    """A queue."""\n', "", "Queue has no docstring"),
        ('"""Count the entries."""', "", "size has no docstring"),
        ("Count the entries.", "The number of entries.", "begins with 'The'"),
        ("Count the entries.", "How many there are.", "begins with 'How'"),
        ("Largest number of attempts.", "What is too much.", "begins with 'What'"),
        ("Largest number of attempts.", "So often it is tried, …", "the sentence does not end"),
        ("Largest number of attempts.", "… and then it ends.", "begins with '…'"),
    ],
)
def test_each_fault_is_found(good: str, bad: str, fault: str) -> None:
    assert good in GOOD
    assert any(fault in one for one in faults(GOOD.replace(good, bad, 1)))
