"""Commands in the tests' own process."""

from typer.testing import CliRunner

from service.commands.app import app


def run(*arguments: str, status: int = 0) -> str:
    """Run `rundown` with these arguments; returns what it prints on either output. It must end with this status."""
    ended = CliRunner().invoke(app, list(arguments))
    assert ended.exit_code == status, ended.output
    return ended.output
