"""The reference of the command line, from the commands themselves."""

from collections.abc import Iterator
from typing import Any

import typer.main

from service.commands.app import app
from service.commands.help_panels import EXAMPLES, PANELS


def cli_page() -> str:
    """Return the page: each command with its help, arguments, options and example, by panels."""
    group: Any = typer.main.get_command(app)
    lines = [
        "# Command line: reference",
        "",
        "What `rundown COMMAND --help` says, in the order in which one meets the commands.",
    ]
    for panel, names in PANELS.items():
        lines += ["", f"## {panel}"]
        for name in names:
            lines += _command(f"rundown {name}", group.commands[name], EXAMPLES.get(name))
    return "\n".join([*lines, ""])


def _command(title: str, command: Any, example: str | None) -> Iterator[str]:
    yield from ("", f"### {title}", "", command.help or "")
    within = getattr(command, "commands", {})
    if not within:
        yield from _parameters([one for one in command.params if one.name != "help"])
    if example is not None:
        yield from ("", "```sh", example, "```")
    for name, one in within.items():
        yield from _command(f"{title} {name}", one, EXAMPLES.get(f"{title} {name}".removeprefix("rundown ")))


def _parameters(parameters: list[Any]) -> Iterator[str]:
    if not parameters:
        return
    yield from ("", "| argument or option | meaning | default |", "|---|---|---|")
    for one in parameters:
        option = one.param_type_name == "option"
        names = ", ".join(f"`{name}`" for name in [*one.opts, *one.secondary_opts]) if option else f"`{one.name.upper()}`"
        default = "needed" if one.required else _default(one.default)
        yield f"| {names} | {table_cell(one.help or '')} | {default} |"


def _default(value: Any) -> str:
    if value is None or value == [] or callable(value):
        return ""
    return f"`{', '.join(map(str, value)) if isinstance(value, list | tuple) else value}`"


def table_cell(text: str) -> str:
    """Return a text as a cell of a table."""
    return " ".join(text.split()).replace("|", "\\|")
