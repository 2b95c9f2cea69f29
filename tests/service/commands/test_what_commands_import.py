"""A command waits for nothing that it does not need: web server, database and science are imported by who uses them."""

import subprocess
import sys

TAKE_LONG = ("scipy", "sqlalchemy", "fastapi", "zenoh", "aiohttp", "matplotlib")


def loaded(code: str) -> list[str]:
    """Those of `TAKE_LONG` that are loaded after some code."""
    told = f"{code}; import sys; print(*[one for one in {TAKE_LONG!r} if one in sys.modules])"
    return subprocess.run([sys.executable, "-c", told], capture_output=True, text=True, check=True).stdout.split()


def test_the_list_of_commands_loads_nothing_that_takes_long() -> None:
    assert loaded("import service.commands.app") == []


def test_the_service_starts_without_what_only_a_computation_needs() -> None:
    found = loaded("import service.commands.serve; import sys; [print(one) for one in sys.modules if one.count('.') == 1]")
    assert {"scipy", "fastapi"} <= set(found), "the look at imports sees nothing"
    assert {"scipy.optimize", "scipy.interpolate", "scipy.stats"}.isdisjoint(found)
