"""The reference of error messages, from where they are declared and raised: what each says, means, and what to do."""

import ast
import builtins
import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple, get_args

from docs_site.cli_reference import table_cell
from estimator.errors import DomainError
from estimator.phasors.quality import MEANING
from formats.wire.rejection import Reason
from service.api.findings.job_remedies import ANY_OTHER, REMEDIES
from service.api.operation.refusal_words import refusal_words
from service.http.error_status import STATUS

ROOT = Path(__file__).parents[1]
PACKAGES = ("rotorundown", "service", "formats", "estimator", "storage")
DOCUMENTS = ("estimator/machine", "estimator/bearings")
"""Rooms whose plain ValueErrors name what a machine document may not say."""
CONTRADICTIONS = "estimator/machine"
"""Room whose `message`s say what contradicts what."""
HEAD = """# Error messages: reference

Look a message up by its words: `…` stands for what changes from case to case. Over HTTP it is the `detail` of a problem
(RFC 9457) with the status given here, `errors` names each wrong field; in Python it is the text of an exception of the name
given here; commands print it behind `rundown:`.
"""


class Wording(NamedTuple):
    """Text of an error, as it stands in the code: its class, or the room where it is raised; its words."""

    name: str
    room: str
    words: str


def errors_page() -> str:
    """Return the page: categories, errors with their texts, documents, refused samples, quality, failed jobs."""
    texts = list(wordings())
    lines = [HEAD, *_categories(), *_errors(texts), *_documents(texts), *_commands(texts)]
    lines += ["", "## Samples that are refused", "", "Reasons in the quarantine and in `ignored` of an answer.", ""]
    lines += _table("reason", {one: refusal_words(one) for one in get_args(Reason)})
    lines += ["", "## Phasors that a fit leaves out", "", "Flags of a run's quality.", ""]
    lines += _table("flag", {flag.label: words for flag, words in MEANING.items()})
    lines += ["", "## Jobs that fail", "", "What to do, by how the job's error begins.", ""]
    lines += _table("error", {**REMEDIES, "anything else": ANY_OTHER})
    return "\n".join([*lines, ""])


def wordings() -> Iterator[Wording]:
    """Yield every text with which the packages raise an error or end a command."""
    for package in PACKAGES:
        for file in sorted((ROOT / package).rglob("*.py")):
            room = str(file.parent.relative_to(ROOT))
            for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
                yield from _raised(node, room)


def _raised(node: ast.AST, room: str) -> Iterator[Wording]:
    call = node.exc if isinstance(node, ast.Raise) else node.value if isinstance(node, ast.Expr) else None
    if isinstance(node, ast.Assign) and getattr(node.targets[0], "id", "") == "message" and room == CONTRADICTIONS:
        yield Wording("message", room, _words(node.value))
    if not isinstance(call, ast.Call) or not isinstance(call.func, ast.Name) or not call.args:
        return
    if isinstance(node, ast.Raise) or call.func.id == "fail":
        words = next((found for one in call.args if (found := _words(one)).strip("… ")), "")
        if " " in words:
            yield Wording(call.func.id, room, words)


def _words(node: ast.expr) -> str:
    """Return a text with `…` for what is put in; nothing for what is no text."""
    if isinstance(node, ast.Constant):
        return node.value if isinstance(node.value, str) else ""
    if isinstance(node, ast.JoinedStr):
        return "".join(_words(one) if isinstance(one, ast.Constant) else "…" for one in node.values)
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add):
        return _words(node.left) + (_words(node.right) or "…")
    return ""


def _categories() -> Iterator[str]:
    yield from ("", "## Categories", "", "| status | category | means | what to do |", "|---|---|---|---|")
    for kind, status in STATUS.items():
        meaning = table_cell(_meaning(kind.__doc__))
        yield f"| {status.value} {status.phrase} | `{kind.__name__}` | {meaning} | {table_cell(kind.remedy)} |"


def _errors(texts: list[Wording]) -> Iterator[str]:
    classes = _declared()
    said: dict[str, list[str]] = {}
    for one in texts:
        said.setdefault(one.name, []).append(one.words)
    yield from ("", "## Errors by name")
    for name in sorted(classes):
        category = _category(name, classes)
        if name not in said and category is None:
            continue
        yield from ("", f"### {name}", "", _meaning(ast.get_docstring(classes[name])))
        if category is not None:
            yield from ("", f"HTTP {STATUS[category].value}. What to do: {category.remedy}")
        yield from _listed(said.get(name, ()))


def _declared() -> dict[str, ast.ClassDef]:
    """Return the public classes of errors that the packages declare by name, categories left out."""
    classes: dict[str, ast.ClassDef] = {}
    for package in PACKAGES:
        for file in sorted((ROOT / package).rglob("*.py")):
            found = [one for one in ast.parse(file.read_text(encoding="utf-8")).body if isinstance(one, ast.ClassDef)]
            classes |= {one.name: one for one in found if one.bases and not one.name.startswith("_")}
    categories = {kind.__name__ for kind in (*STATUS, DomainError)}
    return {name: one for name, one in classes.items() if name not in categories and _is_error(name, classes)}


def _is_error(name: str, classes: dict[str, ast.ClassDef]) -> bool:
    if name not in classes:
        kind = getattr(builtins, name, None)
        return isinstance(kind, type) and issubclass(kind, Exception)
    return any(_is_error(base, classes) for base in _bases(classes[name]))


def _category(name: str, classes: dict[str, ast.ClassDef]) -> type[DomainError] | None:
    """Return the category of an error, by its bases; None for one that is not reported over HTTP."""
    found = next((kind for kind in STATUS if kind.__name__ == name), None)
    if found is not None or name not in classes:
        return found
    return next((kind for base in _bases(classes[name]) if (kind := _category(base, classes)) is not None), None)


def _bases(declared: ast.ClassDef) -> list[str]:
    return [one.id for one in declared.bases if isinstance(one, ast.Name) and one.id != declared.name]


def _documents(texts: list[Wording]) -> Iterator[str]:
    yield from ("", "## Machine documents", "", "What a document may not say; the message begins with the field.")
    within = [one for one in texts if one.room.startswith(DOCUMENTS) and one.name in ("ValueError", "message")]
    yield from _listed(one.words for one in within)


def _commands(texts: list[Wording]) -> Iterator[str]:
    yield from ("", "## Commands", "", "What a command says by itself when it ends with status 1.")
    yield from _listed(one.words for one in texts if one.name == "fail")


def _listed(words: Iterable[str]) -> Iterator[str]:
    found = dict.fromkeys(" ".join(one.split()) for one in words if re.search("[a-z]{2}", one))
    if found:
        yield ""
    for one in found:
        yield f"- `` {one} ``" if "`" in one else f"- `{one}`"


def _table(first: str, rows: dict[str, str]) -> Iterator[str]:
    yield from (f"| {first} | meaning, and what to do |", "|---|---|")
    for name, words in rows.items():
        yield f"| `{name}` | {table_cell(words)} |"


def _meaning(docstring: str | None) -> str:
    """Return what an error's docstring says of it, without `Raised`."""
    words = " ".join((docstring or "").partition("\n\n")[0].split()).removeprefix("Raised ")
    return words[:1].upper() + words[1:]
