"""Import packages that are extras: what a plot or a table needs is asked for only when one is made."""

from importlib import import_module
from typing import Any

EXTRAS = {"matplotlib": "plots", "pandas": "frames"}
"""Extra of the distribution that brings a package."""


class PackageMissing(ImportError):
    """Raised when an optional package is not installed; the message says how to install it."""


def optional_package(name: str, *, needed_for: str) -> Any:
    """Return the module of an extra's package. needed_for: what needs it, for the message of PackageMissing."""
    try:
        return import_module(name)
    except ImportError:
        package = name.partition(".")[0]
        raise PackageMissing(f"{needed_for} need {package}: pip install 'rotorundown[{EXTRAS[package]}]'") from None
