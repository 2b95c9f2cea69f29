"""Reads settings from a TOML file, in which each stands by its own name."""

import os
import tomllib
from collections.abc import Collection
from pathlib import Path
from typing import Any

from estimator.close_matches import did_you_mean

VARIABLE = "RUNDOWN_CONFIG"
"""Environment variable that names the file for every command."""


class WrongSettingsFile(ValueError):
    """The file of settings cannot be read or holds something else; the message names the file, but no values."""


def settings_file() -> Path | None:
    """Return the path of the file that the environment names."""
    named = os.environ.get(VARIABLE)
    return Path(named) if named else None


def read_settings_file(path: Path, *, known: Collection[str]) -> dict[str, Any]:
    """Return the settings in a file. known: the names of all settings. Raises WrongSettingsFile."""
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise WrongSettingsFile(f"{path}: {error.strerror}") from None
    except (UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise WrongSettingsFile(f"{path} is no TOML: {error}") from None
    unknown = next((name for name in content if name not in known), None)
    if unknown is not None:
        raise WrongSettingsFile(f"{path}: '{unknown}' is no setting{_instead_of(unknown, content[unknown], known)}")
    return content


def _instead_of(name: str, value: Any, known: Collection[str]) -> str:
    """Return what should probably stand instead of an unknown setting: it may be a table, or as in the environment."""
    close = did_you_mean(name.removeprefix("RUNDOWN_").lower().replace("-", "_"), sorted(known))
    return close or (": settings are written at the top of the file, in no table" if isinstance(value, dict) else "")
