"""The language that a person asks a command for."""

from typing import TYPE_CHECKING

from service.commands.exit import fail

if TYPE_CHECKING:
    from service.wording.language import Language


def find_language(code: str) -> "Language":
    """Return the language of a code; end the command where there is none."""
    from service.wording.language import LANGUAGES

    found = [one for one in LANGUAGES if one.code == code]
    if not found:
        fail(f"there is no language '{code}': there are {', '.join(one.code for one in LANGUAGES)}")
    return found[0]
