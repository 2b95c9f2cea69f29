"""Writes the OpenAPI document of this release: `python -m service.commands.openapi docs/openapi.json`.

A test fails when the committed file is out of date.
"""

import json
import sys
from pathlib import Path
from typing import Any

from service.api.application import application
from storage.database.engine import Database


def document() -> dict[str, Any]:
    """Return the document of this release."""
    made = application(Database("sqlite://"), dict).openapi()
    # The version is the API's: a release of the service does not change it.
    return made | {"info": made["info"] | {"version": "1"}}


def text() -> str:
    """Return the document in the form of the committed file."""
    return json.dumps(document(), indent=1, ensure_ascii=False, sort_keys=True) + "\n"


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(text(), encoding="utf-8")
