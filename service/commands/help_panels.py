"""Help of `rundown`: its commands in panels, in the order in which a person meets them, each with an example, and their
completion in a shell.
"""

from pathlib import Path
from typing import Any

from typer.core import TyperGroup

from service.commands.json_output import print_json

WRONG_USAGE = 2
"""Status of a command line that is wrong itself."""
PANELS: dict[str, tuple[str, ...]] = {
    "Try it": ("demo", "init", "check", "document", "sample"),
    "Analyse recorded runs": ("identify", "model", "compare", "calibrate", "balance", "slow-roll"),
    "Run the service": ("serve", "doctor", "key", "audit"),
    "Connect machines": ("edge", "replay", "simulate", "router"),
    "Keep the data": ("backup", "restore", "move", "export", "retention", "report"),
    "Grow": ("worker",),
}
"""Commands by panel; a command that is in none would not be shown where people look, and a test says so."""

EXAMPLES: dict[str, str] = {
    "demo": "rundown demo --exit",
    "init": "rundown init pump-12.yaml",
    "check": "rundown check pump-12.yaml healthy.csv",
    "document": "rundown document pump-12.yaml",
    "sample": "rundown sample pump-12.yaml:misalignment later.csv --run-seed 2",
    "identify": "rundown identify pump-12.yaml healthy.csv --advice",
    "model": "rundown model pump-12.yaml healthy.csv --service-rpm 2980",
    "compare": "rundown compare pump-12.yaml healthy.csv later.csv",
    "calibrate": "rundown calibrate pump-12.yaml healthy.csv trial-1.csv trial-2.csv",
    "balance": "rundown balance pump-12.yaml healthy.csv trial-1.csv trial-2.csv",
    "slow-roll": "rundown slow-roll pump-12.yaml healthy.csv 300:400",
    "serve": "rundown serve --config rundown.toml --port 8080",
    "doctor": "rundown doctor --url http://localhost:8080",
    "edge": "rundown edge edge.yaml --exit",
    "replay": "rundown replay healthy.csv --speedup 10",
    "simulate": "rundown simulate pump-12.yaml:misalignment --rate 200",
    "router": "rundown router --listen tcp/127.0.0.1:7446",
    "backup": "rundown backup /backup/monday",
    "restore": "rundown restore /backup/monday",
    "move": "rundown move sqlite:///rundown.db postgresql+psycopg://rundown@db/rundown",
    "export": "rundown export pump-12 /export/pump-12",
    "report": "rundown report pump-12 --output pump-12.pdf",
    "worker": "rundown worker tcp://10.0.0.5:8786 --processes 4",
    "key create": "rundown key create historian --role viewer --plant north",
    "key list": "rundown key list --json",
    "key rotate": "rundown key rotate 1a2b3c4d --overlap-days 7",
    "key confirm": "rundown key confirm --all",
    "key revoke": "rundown key revoke 1a2b3c4d",
    "audit verify": "rundown audit verify --json",
    "retention confirm": "rundown retention confirm",
}
"""An example of each command, those within a group too; the first ones go together, in an empty folder."""


INSTALL_COMPLETION = "--install-completion"


def complete_at_first_tab(command: str) -> None:
    """Let what typer has installed for zsh complete when zsh loads it, at the first Tab: by itself it only gets ready then."""
    file, call = Path.home() / f".zfunc/_{command}", f"\n_{command}_completion\n"
    if file.is_file() and not file.read_text().endswith(call):
        with file.open("a") as script:
            script.write(call)


class PanelledGroup(TyperGroup):
    """Group of commands that are listed by panel."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Read the arguments of the command line; completion is installed while they are read, which ends the command."""
        installs = INSTALL_COMPLETION in args
        try:
            return super().parse_args(ctx, args)
        finally:
            if installs:
                complete_at_first_tab(ctx.info_name)

    def invoke(self, ctx: Any) -> Any:
        """Run the command that is asked for; where its arguments are wrong and JSON is wanted, the error is JSON, too."""
        wanted = "--json" in ctx.args
        try:
            return super().invoke(ctx)
        except Exception as error:
            words = getattr(error, "format_message", None)  # of click's errors, which typer brings along in a form of its own
            if wanted and words is not None and getattr(error, "exit_code", None) == WRONG_USAGE:
                print_json({"error": words()})
            raise

    def list_commands(self, ctx: Any) -> list[str]:
        """Return the names of the commands in the order of their panels, then any others."""
        order = [name for names in PANELS.values() for name in names]
        return sorted(super().list_commands(ctx), key=lambda name: order.index(name) if name in order else len(order))

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Return a command with its panel and its example, a group with its first command's; None where none has the name."""
        found = super().get_command(ctx, cmd_name)
        if found is None:
            return None
        panel = next((panel for panel, names in PANELS.items() if cmd_name in names), None)
        if panel is not None:
            found.rich_help_panel = panel  # type: ignore[attr-defined]
        within = {f"{cmd_name} {name}": one for name, one in getattr(found, "commands", {}).items()}
        for name, one in {cmd_name: found, **within}.items():
            if name in EXAMPLES:
                one.epilog = f"Example: `{EXAMPLES[name]}`"
        if within:
            found.epilog = next((one.epilog for one in within.values() if one.epilog), None)
        return found
