"""The reference of the REST API, from its OpenAPI document."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from docs_site.cli_reference import table_cell

DOCUMENT = Path(__file__).parents[1] / "docs" / "openapi.json"
HEAD = """# REST API: reference

All operations, from the OpenAPI document, which a service answers with at `/api/v1/openapi.json` and shows at `/api/v1/docs`.
[Integrators](integrators.md) say how to page, to ask for units and to authenticate.
"""


def rest_page() -> str:
    """Return the page: operations by tag, each with its parameters."""
    document = json.loads(DOCUMENT.read_text(encoding="utf-8"))
    tags: dict[str, list[str]] = {}
    for path, item in document["paths"].items():
        for method, operation in item.items():
            if isinstance(operation, dict) and "responses" in operation:
                tag = (operation.get("tags") or ["other"])[0]
                tags.setdefault(tag, []).extend(_operation(method.upper(), path, operation))
    lines = [HEAD]
    for tag, operations in sorted(tags.items()):
        lines += ["", f"## {tag.capitalize()}", *operations]
    return "\n".join([*lines, ""])


def _operation(method: str, path: str, operation: dict[str, Any]) -> Iterator[str]:
    yield from ("", f"### {operation.get('summary', operation.get('operationId', path))}", "", f"`{method} {path}`", "")
    yield operation.get("description", "")
    parameters = [one for one in operation.get("parameters", ()) if one.get("in") in ("query", "path")]
    if parameters:
        yield from ("", "| parameter | in | meaning |", "|---|---|---|")
        for one in parameters:
            said = one.get("description") or one.get("schema", {}).get("description", "")
            yield f"| `{one['name']}` | {one['in']} | {table_cell(said)} |"
