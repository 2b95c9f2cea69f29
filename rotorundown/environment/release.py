"""The release: its one version, which `pyproject.toml` takes from here."""

VERSION = "0.3.0"
"""Version of the release; CITATION.cff and CHANGELOG.md name it too, and a test compares them."""
