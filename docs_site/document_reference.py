"""The reference of the machine document, from the declarations of its parts: every field's meaning, unit and default."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from docs_site.cli_reference import table_cell
from docs_site.usual_values import USUAL
from estimator.machine.document import Machine
from formats.files.document_files import read_machine

HEAD = """# Machine document: reference

Every part and field that a document may have, in SI units unless a name ends in another. `rundown init` writes a commented
one, `rundown check` names each wrong field. Axes: z along the train from driver to driven, x horizontal, y vertical. What is
usual: the smallest and the largest number that the documents in `examples/` give; where none gives any, what is met in
practice, or the default. It is a hint, no bound.
"""
EXAMPLES = Path(__file__).parents[1] / "examples"


def document_page() -> str:
    """Return the page: the document, then its parts in the order in which they are met."""
    schema = Machine.model_json_schema()
    parts = schema["$defs"]
    usual = _usual()
    lines = [HEAD, *_part("Machine", schema, parts, usual)]
    for name in _met(schema, parts):
        lines += _part(name, parts[name], parts, usual)
    return "\n".join([*lines, ""])


def _met(schema: dict[str, Any], parts: dict[str, Any]) -> list[str]:
    """Return the names of the parts, breadth first from the document."""
    found: list[str] = []
    ahead = [schema]
    while ahead:
        for name in _named(ahead.pop(0)):
            if name not in found:
                found.append(name)
                ahead.append(parts[name])
    return found


def _named(node: Any) -> Iterator[str]:
    if isinstance(node, dict):
        if "$ref" in node:
            yield node["$ref"].rpartition("/")[2]
        for key, one in node.items():
            if key not in ("$defs", "discriminator"):
                yield from _named(one)
    elif isinstance(node, list):
        for one in node:
            yield from _named(one)


def _usual() -> dict[tuple[str, str], list[float]]:
    """Return the numbers that the examples give, by part and field."""
    found: dict[tuple[str, str], list[float]] = {}

    def look(name: str, field: str, value: Any) -> None:
        if isinstance(value, BaseModel):
            for one in value.model_fields_set:
                look(type(value).__name__, one, getattr(value, one))
        elif isinstance(value, Mapping | tuple | list):
            for one in value.values() if isinstance(value, Mapping) else value:
                look(name, field, one)
        elif isinstance(value, int | float) and not isinstance(value, bool):
            found.setdefault((name, field), []).append(float(value))

    for file in sorted(EXAMPLES.glob("*.yaml")):
        look("", "", read_machine(file))
    return found


def _part(
    name: str, schema: dict[str, Any], parts: dict[str, Any], usual: dict[tuple[str, str], list[float]]
) -> Iterator[str]:
    # A heading's anchor is its name in small letters.
    yield from ("", f"## {name}", "", schema.get("description", ""), "")
    if "properties" not in schema:
        if "enum" in schema:
            yield ", ".join(f"`{one}`" for one in schema["enum"])
        return
    yield from ("| field | kind | default | meaning | usual |", "|---|---|---|---|---|")
    needed = set(schema.get("required", ()))
    for field, said in schema["properties"].items():
        default = "needed" if field in needed else _default(said.get("default"))
        bounds = _bounds(said)
        meaning = "; ".join(part for part in (table_cell(_meaning(said, parts)), bounds) if part)
        yield f"| `{field}` | {_kind(said)} | {default} | {meaning} | {_usual_words(name, field, said, usual)} |"


def _usual_words(part: str, field: str, said: dict[str, Any], usual: dict[tuple[str, str], list[float]]) -> str:
    known = _range(usual.get((part, field), [])) or USUAL.get((part, field), "")
    return known or ("the default" if "number" in _kind(said) and said.get("default") is not None else "")


def _meaning(said: dict[str, Any], parts: dict[str, Any]) -> str:
    """Return what a field says of itself, else what the part says that it holds."""
    if "description" in said:
        return str(said["description"])
    held = next(_named(said), None)
    first = "" if held is None else str(parts[held].get("description", "")).partition("\n\n")[0]
    return first[:1].lower() + first[1:].removesuffix(".")


def _range(numbers: list[float]) -> str:
    if not numbers:
        return ""
    least, most = min(numbers), max(numbers)
    return f"{least:.6g}" if least == most else f"{least:.6g} to {most:.6g}"


def _default(value: Any) -> str:
    if value is None:
        return "left out"
    return f"`{value}`" if not isinstance(value, dict | list) or not value else "its own"


def _kind(said: dict[str, Any]) -> str:
    if "$ref" in said:
        name = said["$ref"].rpartition("/")[2]
        return f"[{name}](#{name.lower()})"
    several = said.get("anyOf") or said.get("oneOf") or said.get("allOf")
    if several:
        return " or ".join(dict.fromkeys(_kind(one) for one in several if one.get("type") != "null"))
    if "const" in said:
        return f"`{said['const']}`"
    if "enum" in said:
        return " or ".join(f"`{one}`" for one in said["enum"])
    if said.get("type") == "array":
        return f"list of {_kind(said['items'])}" if "items" in said else "list"
    if said.get("type") == "object":
        within = said.get("additionalProperties") or next(iter(said.get("patternProperties", {}).values()), None)
        return f"{_kind(within)} by name" if isinstance(within, dict) else "object"
    return {"string": "text", "integer": "whole number", "boolean": "true or false"}.get(said.get("type", ""), "number")


def _bounds(said: dict[str, Any]) -> str:
    places = [said, *(said.get("anyOf") or ())]
    words = {"minimum": "at least", "exclusiveMinimum": "more than", "maximum": "at most", "exclusiveMaximum": "less than"}
    found = [f"{text} {one[name]:g}" for one in places for name, text in words.items() if name in one]
    return ", ".join(one for one in found if not one.endswith(("e+15", "e-30")))
