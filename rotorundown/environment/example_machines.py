"""Finds the example machines: beside the packages in a checkout, within this one where it is installed from a wheel."""

from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[1]


def examples_folder() -> Path:
    """Return the folder of the example machines' documents."""
    installed = PACKAGE / "examples"
    return installed if installed.is_dir() else PACKAGE.parent / "examples"
