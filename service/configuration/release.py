"""The release of the installed package."""

from importlib.metadata import version

VERSION = version("rundown")
"""Version of the release, from `pyproject.toml`."""
