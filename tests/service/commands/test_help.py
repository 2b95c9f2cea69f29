"""Help of the command line: every command is in a panel with an example that parses, and no unit is taken for markup."""

import re
import shlex
from collections.abc import Iterator

import pytest
import typer.main
from typer.testing import CliRunner

from service.commands.app import app
from service.commands.help_panels import EXAMPLES, PANELS

WIDE = {"COLUMNS": "600", "TERM": "dumb", "NO_COLOR": "1"}
GROUP = typer.main.get_command(app)


def commands(group: object = GROUP, path: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], object]]:
    """All commands with their names, those of groups within the group too."""
    for name, one in getattr(group, "commands", {}).items():
        yield (*path, name), one
        yield from commands(one, (*path, name))


def plain(text: str) -> str:
    """Return a text without frames, line breaks and marks of Markdown."""
    return re.sub(r"[\s│`*]+", "", text)


def test_every_command_is_in_one_panel() -> None:
    listed = [name for names in PANELS.values() for name in names]
    assert sorted(listed) == sorted(GROUP.commands)  # type: ignore[attr-defined]


def test_every_command_without_commands_of_its_own_has_an_example() -> None:
    single = [" ".join(path) for path, one in commands() if not getattr(one, "commands", {})]
    assert sorted(EXAMPLES) == sorted(single)


@pytest.mark.parametrize("name", EXAMPLES)
def test_examples_parse(name: str) -> None:
    words = shlex.split(EXAMPLES[name])
    path = ["rundown", *name.split()]
    assert words[: len(path)] == path
    command = dict(commands())[tuple(path[1:])]
    with command.make_context(name, words[len(path) :]) as context:  # type: ignore[attr-defined]
        assert context.params


@pytest.mark.parametrize(("path", "command"), list(commands()), ids=[" ".join(path) for path, _ in commands()])
def test_help_shows_all_of_each_text(path: tuple[str, ...], command: object) -> None:
    shown = CliRunner().invoke(app, [*path, "--help"], env=WIDE)
    assert shown.exit_code == 0
    for parameter in getattr(command, "params", []):
        if parameter.help and not parameter.hidden:
            assert plain(parameter.help) in plain(shown.output), parameter.name
    example = next(one for name, one in EXAMPLES.items() if f"{name} ".startswith(f"{' '.join(path)} "))
    assert plain(f"Example: {example}") in plain(shown.output)
