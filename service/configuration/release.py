"""The release of the installed package."""

from importlib.metadata import version

VERSION = version("rundown")
"""Number of the release, as `pyproject.toml` says it."""
