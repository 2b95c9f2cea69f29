"""Folders of the repository, wherever a test lies."""

from pathlib import Path

ROOT = Path(__file__).parents[1]
EXAMPLES = ROOT / "examples"
DATA = ROOT / "tests" / "data"
PACKAGES = ("estimator", "storage", "formats", "service", "rotorundown")
"""Packages that are installed; a test compares them with what the distribution names."""
